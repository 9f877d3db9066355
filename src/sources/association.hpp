#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "saccade/core/frame.hpp"

namespace saccade {

using StampPair = std::pair<std::size_t, std::size_t>;  ///< indices into the first and the second list

/// Pairs two rising lists of stamps one to one: always the closest pair that is left, as long as its stamps differ by
/// no more than `max_difference_s`. Sorted by the first index. Cost n log n for stamps no denser than the window.
[[nodiscard]] std::vector<StampPair> associate(const std::vector<double>& first_s, const std::vector<double>& second_s,
                                               double max_difference_s);

/// A trajectory with stamps, asked at other stamps.
class StampedPoses {
 public:
  StampedPoses() = default;
  /// Reads a TUM trajectory; lines that are not poses are left out and counted in `remarks`. Throws IoError.
  [[nodiscard]] static StampedPoses load(const std::filesystem::path& path, std::vector<std::string>& remarks);

  void add(double stamp_s, const Pose& pose) { poses_.emplace_back(stamp_s, pose); }
  void sort();

  [[nodiscard]] bool empty() const { return poses_.empty(); }
  [[nodiscard]] std::size_t size() const { return poses_.size(); }
  /// Pose with the nearest stamp, if that is within `max_difference_s`.
  [[nodiscard]] std::optional<Pose> nearest(double stamp_s, double max_difference_s) const;
  /// Pose between the two neighbours if both are within `max_difference_s`, else the nearest, if that one is.
  [[nodiscard]] std::optional<Pose> interpolate(double stamp_s, double max_difference_s) const;

 private:
  std::vector<std::pair<double, Pose>> poses_;  // by stamp
};

}  // namespace saccade
