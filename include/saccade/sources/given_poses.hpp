#pragma once

#include <optional>
#include <string>

#include "saccade/core/frame.hpp"
#include "saccade/sources/stamped_poses.hpp"

namespace saccade {

/// The poses of `--poses FILE|dataset`, taken instead of tracking.
///
/// FILE is a TUM trajectory of the colour camera, found by stamp; `dataset` are the poses that the frames bring along.
class GivenPoses {
 public:
  /// Reads `file`, or stands for the frames' own poses if it is the word "dataset". Throws IoError with the line if a
  /// number is not finite or a quaternion's length is off by more than 2 % (less is normalised), and if there is no
  /// pose.
  [[nodiscard]] static GivenPoses open(const std::string& file);

  [[nodiscard]] bool fromDataset() const { return from_dataset_; }
  /// Pose of the frame's colour camera: the nearest within 10 ms of its stamp; none where none is given.
  [[nodiscard]] std::optional<Pose> find(const RgbdFrame& frame) const;

 private:
  bool from_dataset_ = false;
  StampedPoses poses_;
};

}  // namespace saccade
