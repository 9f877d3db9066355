#include "saccade/pipeline/trajectory_sink.hpp"

#include <iomanip>

#include "saccade/core/errors.hpp"

namespace saccade {

void writeTumPose(std::ostream& out, double stamp_s, const Pose& T_WC) {
  const Eigen::Vector3d t = T_WC.translation();
  const Eigen::Quaterniond q(T_WC.linear());
  out << std::fixed << std::setprecision(6) << stamp_s << std::setprecision(7);
  for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) out << ' ' << value;
  out << '\n';
}

TrajectorySink::TrajectorySink(const std::filesystem::path& path) : path_(path), file_(path) {
  file_ << kTumHeading << std::flush;
  if (!file_) throw IoError(path_, "a trajectory file that can be written", "none");
}

void TrajectorySink::accept(const RgbdFrame& /*frame*/, const FrameReport& report) {
  if (report.tracking.status != TrackingStatus::kTracked) return;
  writeTumPose(file_, report.stamp_s, report.tracking.T_WC);
  file_ << std::flush;
  if (!file_) throw IoError(path_, "room for the trajectory", "a full or failing disk");
}

void TrajectorySink::finish() {
  file_.close();
}

}  // namespace saccade
