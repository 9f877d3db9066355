#include "saccade/pipeline/trajectory_sink.hpp"

#include <iomanip>

#include "saccade/core/errors.hpp"

namespace saccade {

TrajectorySink::TrajectorySink(const std::filesystem::path& path) : path_(path), file_(path) {
  file_ << "# stamp_s tx ty tz qx qy qz qw   camera to world, metres\n" << std::flush;
  if (!file_) throw IoError(path_, "a trajectory file that can be written", "none");
}

void TrajectorySink::accept(const RgbdFrame& /*frame*/, const FrameReport& report) {
  if (report.tracking.status != TrackingStatus::kTracked) return;
  const Eigen::Vector3d t = report.tracking.T_WC.translation();
  const Eigen::Quaterniond q(report.tracking.T_WC.linear());
  file_ << std::fixed << std::setprecision(6) << report.stamp_s << std::setprecision(7);
  for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) file_ << ' ' << value;
  file_ << '\n' << std::flush;
  if (!file_) throw IoError(path_, "room for the trajectory", "a full or failing disk");
}

void TrajectorySink::finish() {
  file_.close();
}

}  // namespace saccade
