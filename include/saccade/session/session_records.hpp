#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "saccade/core/camera.hpp"
#include "saccade/core/frame.hpp"

namespace saccade {

/// One frame's row in a session: what was tracked and how many candidates there were.
struct FrameRecord {
  FrameIndex index;
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

/// One attended candidate's row.
struct CandidateRecord {
  FrameIndex frame;
  int rank = 0;
  double score = 0.0;
  std::string source;               ///< "colour" or "depth"
  cv::Rect box;                     ///< pixels of the input's colour image, as the mask
  std::array<double, 6> box3d_m{};  ///< min x y z, max x y z in W; all 0 without depth
  std::string mask_rle;             ///< compressed COCO run lengths
  std::vector<double> features;
  double revisited_share = 0.0;  ///< share of its leaves attended at any earlier tick
};

/// A part of the map as bytes; opaque to the session, which compresses and checks it.
struct BlobRecord {
  std::uint64_t key = 0;    ///< orders and names the part
  std::uint64_t items = 0;  ///< leaves, bricks or keys inside, for people
  std::string bytes;
};

/// What a session says about itself besides frames and map.
struct SessionMetadata {
  std::string saccade_version;
  std::string created_utc;  ///< ISO 8601
  std::string input;        ///< as given on the command line
  std::string input_kind;
  std::string config_yaml;  ///< the effective configuration
  PinholeCamera camera;
  double leaf_size_m = 0.0;
  std::uint32_t tick = 0;
  std::int64_t leaves = 0;
  std::int64_t frames_read = 0;
  std::int64_t frames_skipped = 0;
  bool interrupted = false;  ///< ended by Ctrl-C rather than by the end of the input
};

}  // namespace saccade
