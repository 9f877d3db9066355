#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "saccade/core/frame.hpp"

namespace saccade {

/// One line `key tx ty tz qx qy qz qw` of a trajectory; the key is a stamp, a frame number or a frame name.
struct PoseLine {
  std::size_t line = 0;  ///< 1-based line of the file
  std::string key;
  std::optional<double> stamp_s;  ///< the key as a number, if it is one
  std::optional<Pose> pose;       ///< none: the numbers are not a pose, see `complaint`
  std::string complaint;          ///< what is wrong with the numbers
  std::optional<double> last;     ///< the ninth number, where lines may have one
};

/// Reads all lines of a trajectory that are neither empty nor comments. A quaternion whose length is off by up to 2 %
/// is normalised (files are rounded); one farther off, or a number that is not finite, makes a complaint. Throws
/// IoError where the file cannot be read. `most_words` 9 also takes lines with a number behind the quaternion.
[[nodiscard]] std::vector<PoseLine> readPoseLines(const std::filesystem::path& path, std::size_t most_words = 8);

/// Sixteen numbers of a text file, row by row; none where it is missing or has other words.
[[nodiscard]] std::optional<Eigen::Matrix4d> readMatrix4(const std::filesystem::path& path);

/// Reads a 4x4 camera-to-world matrix (7-Scenes `pose.txt`); none where it is missing, not finite or not rigid. A
/// rotation within 2 % of orthonormal is made orthonormal.
[[nodiscard]] std::optional<Pose> readPoseMatrix(const std::filesystem::path& path);

/// The rigid transform nearest to a 4x4 matrix that is rigid up to rounding; none otherwise.
[[nodiscard]] std::optional<Pose> rigidFromMatrix(const Eigen::Matrix4d& matrix);

}  // namespace saccade
