#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "saccade/core/frame.hpp"

namespace saccade {

/// A trajectory in TUM format (`stamp tx ty tz qx qy qz qw`), asked at stamps of its own or between them. Queries cost
/// log n and may come from several threads.
class StampedPoses {
 public:
  StampedPoses() = default;
  /// Reads a TUM trajectory; lines that are not poses are left out and counted in `remarks`. Throws IoError where the
  /// file cannot be read.
  [[nodiscard]] static StampedPoses load(const std::filesystem::path& path, std::vector<std::string>& remarks);
  /// The same for a file in which every line must be a pose: throws IoError with the line's number if one is not, and
  /// if there is none at all.
  [[nodiscard]] static StampedPoses loadStrictly(const std::filesystem::path& path);

  void add(double stamp_s, const Pose& pose) { poses_.emplace_back(stamp_s, pose); }
  void sort();

  [[nodiscard]] bool empty() const { return poses_.empty(); }
  [[nodiscard]] std::size_t size() const { return poses_.size(); }
  /// The i-th by stamp.
  [[nodiscard]] double stamp(std::size_t i) const { return poses_[i].first; }
  [[nodiscard]] const Pose& pose(std::size_t i) const { return poses_[i].second; }
  /// Pose with the nearest stamp, if that is within `max_difference_s`.
  [[nodiscard]] std::optional<Pose> nearest(double stamp_s, double max_difference_s) const;
  /// Pose between the two neighbours if both are within `max_difference_s`, else the nearest, if that one is.
  [[nodiscard]] std::optional<Pose> interpolate(double stamp_s, double max_difference_s) const;

 private:
  std::vector<std::pair<double, Pose>> poses_;  // by stamp
};

}  // namespace saccade
