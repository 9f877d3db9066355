#pragma once

#include <filesystem>
#include <fstream>

#include "saccade/pipeline/frame_sink.hpp"

namespace saccade {

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
