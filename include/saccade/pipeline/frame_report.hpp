#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "saccade/core/depth_maps.hpp"
#include "saccade/core/frame.hpp"
#include "saccade/discovery/candidate.hpp"
#include "saccade/discovery/perception.hpp"
#include "saccade/map/ior_law.hpp"
#include "saccade/rendering/ior_view.hpp"
#include "saccade/tracking/keyframe_set.hpp"
#include "saccade/tracking/tracker.hpp"

namespace saccade {

/// Time that one stage took, milliseconds of the clock.
struct StageTime {
  const char* stage = "";
  double ms = 0.0;
};

/// What became of one frame. Owned by nobody but its reader; `seen`, `ior` and `depth` point into the Explorer and are
/// good until it processes the next frame.
struct FrameReport {
  FrameIndex index;
  std::string name;
  double stamp_s = 0.0;
  Tracking tracking;
  bool relocalised = false;  ///< tracking lost the camera, but the keyframes and the surface say where it is
  Tick tick;                 ///< the map's tick after the frame

  Candidates open;  ///< by falling score, at most 255; the first `attended` of them were attended
  std::size_t attended = 0;
  Candidates inhibited;                 ///< kept from the ranking by the 2D IOR map
  std::vector<double> revisited_share;  ///< per attended candidate: share of its leaves attended at any earlier tick

  const Perception* seen = nullptr;
  const IorView* ior = nullptr;      ///< null for a lost frame
  const DepthMaps* depth = nullptr;  ///< as `seen` saw it, completed by the map; null for a frame of colour alone

  std::shared_ptr<const Keyframe> keyframe;  ///< this frame with its features, if it became a keyframe

  std::vector<StageTime> stages;
  double total_ms = 0.0;

  /// Pose of the frame; none if it is lost.
  [[nodiscard]] std::optional<Pose> T_WC() const {
    return tracking.status == TrackingStatus::kLost ? std::nullopt : std::optional<Pose>(tracking.T_WC);
  }
};

/// "tracked", "weak" or "lost", as in every file that Saccade writes.
[[nodiscard]] const char* nameOf(TrackingStatus status);

}  // namespace saccade
