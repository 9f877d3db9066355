#include "saccade/sources/stamped_poses.hpp"

#include <algorithm>
#include <cmath>

#include "saccade/core/errors.hpp"
#include "sources/pose_lines.hpp"
#include "sources/text_numbers.hpp"

namespace saccade {

StampedPoses StampedPoses::load(const std::filesystem::path& path, std::vector<std::string>& remarks) {
  StampedPoses poses;
  std::size_t bad = 0;
  for (const PoseLine& line : readPoseLines(path)) {
    if (line.pose && line.stamp_s && std::isfinite(*line.stamp_s)) {
      poses.add(*line.stamp_s, *line.pose);
    } else {
      ++bad;
    }
  }
  poses.sort();
  if (bad > 0) remarks.push_back(std::to_string(bad) + " lines of " + path.filename().string() + " are not poses");
  return poses;
}

StampedPoses StampedPoses::loadStrictly(const std::filesystem::path& path) {
  StampedPoses poses;
  for (const PoseLine& line : readPoseLines(path)) {
    const std::string where = "stamp tx ty tz qx qy qz qw in line " + std::to_string(line.line);
    if (!line.pose) throw IoError(path, where, line.complaint);
    if (!line.stamp_s || !std::isfinite(*line.stamp_s)) throw IoError(path, where, "the stamp " + inQuotes(line.key));
    poses.add(*line.stamp_s, *line.pose);
  }
  if (poses.empty()) throw IoError(path, "a trajectory (stamp tx ty tz qx qy qz qw)", "no pose");
  poses.sort();
  return poses;
}

void StampedPoses::sort() {
  std::stable_sort(poses_.begin(), poses_.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
}

std::optional<Pose> StampedPoses::nearest(double stamp_s, double max_difference_s) const {
  const auto after = std::lower_bound(poses_.begin(), poses_.end(), stamp_s,
                                      [](const auto& entry, double stamp) { return entry.first < stamp; });
  auto best = after;
  if (after != poses_.begin() &&
      (after == poses_.end() || stamp_s - std::prev(after)->first <= after->first - stamp_s)) {
    best = std::prev(after);
  }
  if (best == poses_.end() || std::abs(best->first - stamp_s) > max_difference_s) return std::nullopt;
  return best->second;
}

std::optional<Pose> StampedPoses::interpolate(double stamp_s, double max_difference_s) const {
  const auto after = std::lower_bound(poses_.begin(), poses_.end(), stamp_s,
                                      [](const auto& entry, double stamp) { return entry.first < stamp; });
  if (after == poses_.begin() || after == poses_.end()) return nearest(stamp_s, max_difference_s);
  const auto& [t0, T0] = *std::prev(after);
  const auto& [t1, T1] = *after;
  if (stamp_s - t0 > max_difference_s || t1 - stamp_s > max_difference_s) return nearest(stamp_s, max_difference_s);
  const double share = (stamp_s - t0) / (t1 - t0);
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::Quaterniond(T0.linear()).slerp(share, Eigen::Quaterniond(T1.linear())).toRotationMatrix();
  pose.translation() = (1.0 - share) * T0.translation() + share * T1.translation();
  return pose;
}

}  // namespace saccade
