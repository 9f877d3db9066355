#pragma once

#include <filesystem>
#include <fstream>

#include "saccade/discovery/candidate_outline.hpp"
#include "saccade/pipeline/frame_sink.hpp"

namespace saccade {

/// Writes the candidates of each frame as one JSON line (see discovery/candidate_json.hpp), lost frames too, each line
/// as it comes, so that the file stays readable when the program is killed.
class CandidateSink final : public FrameSink {
 public:
  /// `outliner`: that of the input's camera and lens. Throws IoError if the file cannot be made.
  CandidateSink(const std::filesystem::path& path, CandidateOutliner outliner);

  void accept(const RgbdFrame& frame, const FrameReport& report) override;
  void finish() override;

 private:
  std::filesystem::path path_;
  std::ofstream file_;
  CandidateOutliner outliner_;
};

}  // namespace saccade
