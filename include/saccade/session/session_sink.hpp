#pragma once

#include <filesystem>

#include "saccade/discovery/candidate_outline.hpp"
#include "saccade/pipeline/explorer.hpp"
#include "saccade/pipeline/frame_sink.hpp"
#include "saccade/session/session_writer.hpp"

namespace saccade {

/// Keeps an exploration as a session file: a row per frame and attended candidate as they come, the map with its
/// attention memory, the surface volume and the attend log at the end.
class SessionSink final : public FrameSink {
 public:
  /// `explorer` must outlive the sink; `outliner`: that of the input's camera and lens; `run`: where the frames come
  /// from. Throws IoError as SessionWriter does.
  SessionSink(const std::filesystem::path& path, WhenSessionExists when_exists, const Explorer& explorer,
              CandidateOutliner outliner, RunRecord run);

  void accept(const RgbdFrame& frame, const FrameReport& report) override;
  /// Writes the map and gives the file its name.
  void finish() override;

  /// Counts a frame of the input that could not be used.
  void noteSkipped() { ++metadata_.frames_skipped; }
  /// The exploration ends by hand rather than by the end of the input.
  void noteInterrupted() { metadata_.state = SessionState::kInterrupted; }

 private:
  const Explorer& explorer_;
  SessionWriter writer_;
  SessionMetadata metadata_;
  CandidateOutliner outliner_;
};

}  // namespace saccade
