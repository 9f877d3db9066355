#pragma once

#include "saccade/core/frame.hpp"
#include "saccade/pipeline/frame_report.hpp"

namespace saccade {

/// Something that wants to know of every frame: a session, a video, a list of candidates, a progress bar.
class FrameSink {
 public:
  virtual ~FrameSink() = default;

  /// Takes note of a processed frame. Throws IoError when its output cannot be written.
  virtual void accept(const RgbdFrame& frame, const FrameReport& report) = 0;
  /// Completes the output. Called once, after the last frame.
  virtual void finish() = 0;
};

}  // namespace saccade
