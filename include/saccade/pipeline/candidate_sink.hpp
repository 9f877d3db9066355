#pragma once

#include <filesystem>
#include <memory>

#include "saccade/discovery/candidate_outline.hpp"
#include "saccade/pipeline/frame_sink.hpp"

namespace saccade {

/// Writes the candidates of each frame as one JSON line (see discovery/candidate_json.hpp), lost frames too, each line
/// as it comes, so that the file stays readable when the program is killed.
///
/// The frame thread only copies segments and candidates; outlines, boxes and text are made on a thread of its own, one
/// or two frames behind. What cannot be written is thrown by a later accept() or by finish().
class CandidateSink final : public FrameSink {
 public:
  /// `outliner`: that of the input's camera and lens. Throws IoError if the file cannot be made.
  CandidateSink(const std::filesystem::path& path, CandidateOutliner outliner);
  ~CandidateSink() override;

  void accept(const RgbdFrame& frame, const FrameReport& report) override;
  void finish() override;

 private:
  class Lines;

  std::unique_ptr<Lines> lines_;
};

}  // namespace saccade
