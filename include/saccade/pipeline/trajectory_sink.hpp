#pragma once

#include <filesystem>
#include <fstream>
#include <ostream>

#include "saccade/core/frame.hpp"
#include "saccade/pipeline/frame_sink.hpp"

namespace saccade {

/// The first line of a trajectory file, a comment.
inline constexpr const char* kTumHeading = "# stamp_s tx ty tz qx qy qz qw   camera to world, metres\n";

/// Writes one line of TUM format: `stamp tx ty tz qx qy qz qw`, microseconds and tenths of a micrometre.
void writeTumPose(std::ostream& out, double stamp_s, const Pose& T_WC);

/// Writes the poses T_WC of the tracked frames in TUM format (`stamp tx ty tz qx qy qz qw`), each line as it comes, so
/// that the file stays readable when the program is killed.
class TrajectorySink final : public FrameSink {
 public:
  /// Throws IoError if the file cannot be made.
  explicit TrajectorySink(const std::filesystem::path& path);

  void accept(const RgbdFrame& frame, const FrameReport& report) override;
  void finish() override;

 private:
  std::filesystem::path path_;
  std::ofstream file_;
};

}  // namespace saccade
