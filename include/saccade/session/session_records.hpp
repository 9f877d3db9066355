#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "saccade/core/camera.hpp"
#include "saccade/core/frame.hpp"

namespace saccade {

/// Position of a frame in a session, over all its runs: unique there, which an index of an input is not. A type of its
/// own, so that neither is taken for the other.
struct FrameOrdinal {
  std::int64_t value = 0;
  friend auto operator<=>(const FrameOrdinal&, const FrameOrdinal&) = default;
};

/// One exploration that made the session or went on with it.
struct RunRecord {
  int run = 0;
  FrameOrdinal first;  ///< its frames go from here to the next run's first
  std::string input;   ///< as given on the command line
  std::string input_kind;
  std::string started_utc;  ///< ISO 8601
  std::string saccade_version;
};

/// One frame's row in a session: what was tracked and how many candidates there were.
struct FrameRecord {
  FrameOrdinal ordinal;  ///< given by the writer
  FrameIndex index;      ///< in the input of its run
  std::string name;
  double stamp_s = 0.0;
  std::string tracking;       ///< "tracked", "weak" or "lost"
  std::optional<Pose> T_WC;   ///< none when lost
  double inlier_share = 0.0;  ///< of the pixels that could be matched
  double rms_m = 0.0;         ///< point-to-plane residual of the inliers
  std::uint32_t tick = 0;     ///< the map's tick after the frame
  int open = 0;               ///< candidates that were not inhibited
  int inhibited = 0;
  int attended = 0;
  double processing_ms = 0.0;
};

/// How long each stage of a frame took.
struct MetricsRecord {
  FrameOrdinal ordinal;
  std::vector<std::pair<std::string, double>> stages_ms;
};

/// One attended candidate's row.
struct CandidateRecord {
  FrameOrdinal frame;
  int rank = 0;
  double score = 0.0;
  std::string source;               ///< "colour" or "depth"
  cv::Rect box;                     ///< pixels of the input's colour image, as the mask
  std::array<double, 6> box3d_m{};  ///< min x y z, max x y z in W; all 0 without depth
  std::string mask_rle;             ///< compressed COCO run lengths
  std::vector<double> features;
  double revisited_share = 0.0;  ///< share of its leaves attended at any earlier tick
};

/// A frame by which its place is known again.
struct KeyframeRecord {
  FrameOrdinal ordinal;
  Pose T_WC = Pose::Identity();  ///< kept exactly
  cv::Mat3b color;               ///< kept as JPEG, quality 90; empty where the session was thinned to save room
  /// Kept in steps of 0.25 mm (of 1 mm where something is farther than 16 m; beyond 65 m it is dropped). Empty as
  /// `color`.
  cv::Mat1f depth_m;
  std::string features;  ///< of the relocaliser, opaque here
};

/// A part of the map as bytes; opaque to the session, which compresses and checks it.
struct BlobRecord {
  std::uint64_t key = 0;    ///< orders and names the part
  std::uint64_t items = 0;  ///< leaves, bricks or keys inside, for people
  std::string bytes;
};

/// Such a part without its bytes.
struct BlobKey {
  std::uint64_t key = 0;
  std::uint64_t items = 0;
};

/// Whether a session is finished.
enum class SessionState {
  kExploring,    ///< being written, or its writer was killed: whole up to the last checkpoint
  kComplete,     ///< the input ended
  kInterrupted,  ///< ended by hand; all that was explored is in it
};

/// "exploring", "complete" or "interrupted", as in the file.
[[nodiscard]] const char* nameOf(SessionState state);

/// What a session says about itself besides frames and map.
struct SessionMetadata {
  std::string saccade_version;
  std::string created_utc;  ///< ISO 8601
  std::string input;        ///< as given on the command line, of the last run
  std::string input_kind;
  std::string config_yaml;  ///< the effective configuration
  PinholeCamera camera;
  double leaf_size_m = 0.0;
  std::uint32_t tick = 0;
  std::int64_t leaves = 0;
  std::int64_t frames_read = 0;
  std::int64_t frames_skipped = 0;
  std::int64_t range_step = 1;  ///< of the last run's frames in its input
  SessionState state = SessionState::kComplete;
};

}  // namespace saccade
