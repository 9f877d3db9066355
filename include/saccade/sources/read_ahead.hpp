#pragma once

#include <memory>
#include <string>

#include "saccade/sources/frame_source.hpp"

namespace saccade {

/// Reads another source on a thread of its own, a few frames ahead, so that decoding runs beside the work on a frame.
///
/// The frames, skips and the end come in the order of the source; an exception of the source comes where its frame
/// would have come, and again at every later read. Buffers go round between reader and thread, nothing is allocated in
/// the steady state; pixels that somebody still shares (a second cv::Mat on them) are left to that owner. read() and
/// skipReason() belong to one thread. The destructor waits for the frame that is being decoded, no longer.
class ReadAhead final : public FrameSource {
 public:
  /// Keeps up to `frames_ahead` (1 to 64) decoded frames. Throws std::invalid_argument on another number or no source.
  explicit ReadAhead(std::unique_ptr<FrameSource> source, int frames_ahead = 3);
  ~ReadAhead() override;
  ReadAhead(const ReadAhead&) = delete;
  ReadAhead& operator=(const ReadAhead&) = delete;

  [[nodiscard]] const SourceDescription& description() const override;
  /// Swaps the next decoded frame with `frame`; waits where the thread is behind.
  [[nodiscard]] ReadStatus read(RgbdFrame& frame) override;
  [[nodiscard]] const std::string& skipReason() const override;
  [[nodiscard]] SourceProgress progress() const override;

 private:
  struct Queue;
  std::unique_ptr<Queue> queue_;
};

}  // namespace saccade
