#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "saccade/core/frame.hpp"
#include "saccade/discovery/candidate_outline.hpp"
#include "saccade/pipeline/frame_sink.hpp"

namespace saccade {

/// A candidate that was not inhibited, as an evaluation needs it.
struct RecordedCandidate {
  cv::Rect box;      ///< pixels of the input's colour image
  std::string mask;  ///< compressed COCO run lengths, the same pixels
  bool attended = false;
  std::optional<double> revisited_share;  ///< share of its leaves attended at any earlier tick, if the record says
};

/// What a run made of one frame.
struct RecordedFrame {
  FrameIndex index;
  std::string name;
  double stamp_s = 0.0;
  std::string tracking;                 ///< "tracked", "weak" or "lost"
  std::optional<Pose> T_WC;             ///< if it is not lost, and the record holds poses
  std::vector<RecordedCandidate> open;  ///< by falling score
  int inhibited = 0;
  double processing_ms = 0.0;
};

/// All frames of a run, in the order of processing.
struct RunRecording {
  cv::Size image_size;
  bool only_attended = false;  ///< a session keeps the attended candidates and no others
  std::vector<RecordedFrame> frames;
};

/// Keeps what an evaluation needs of a run that goes on in this process. About 25 KB a frame.
class RecordingSink final : public FrameSink {
 public:
  explicit RecordingSink(CandidateOutliner outliner) : outliner_(std::move(outliner)) {}

  void accept(const RgbdFrame& frame, const FrameReport& report) override;
  void finish() override {}

  [[nodiscard]] const RunRecording& recording() const { return recording_; }

 private:
  CandidateOutliner outliner_;
  RunRecording recording_;
};

/// Reads the record of an earlier run: a session (*.saccade; attended candidates only), or a file of candidate lines
/// (*.jsonl, see discovery/candidate_json.hpp; no poses and no times). Throws IoError with the line that is damaged.
[[nodiscard]] RunRecording loadRecording(const std::filesystem::path& path);

}  // namespace saccade
