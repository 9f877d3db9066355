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
  /// `explorer` must outlive the sink; `outliner`: that of the input's camera and lens. Throws IoError as SessionWriter
  /// does.
  SessionSink(const std::filesystem::path& path, WhenSessionExists when_exists, const Explorer& explorer,
              CandidateOutliner outliner);

  void accept(const RgbdFrame& frame, const FrameReport& report) override;
  /// Writes the map and gives the file its name. setMetadata() must have been called.
  void finish() override;

  /// What the session says about itself; camera, tick, leaves and config are filled in here from the explorer.
  void setMetadata(const SessionMetadata& metadata) { metadata_ = metadata; }

 private:
  const Explorer& explorer_;
  SessionWriter writer_;
  SessionMetadata metadata_;
  CandidateOutliner outliner_;
};

}  // namespace saccade
