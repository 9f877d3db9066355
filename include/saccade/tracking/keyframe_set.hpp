#pragma once

#include <memory>
#include <vector>

#include "saccade/core/config_fields.hpp"
#include "saccade/core/frame.hpp"
#include "saccade/tracking/frame_features.hpp"

namespace saccade {

/// A tracked frame that is remembered, so that its place is known again.
struct Keyframe {
  FrameIndex index;  ///< in the input that it came from
  double stamp_s = 0.0;
  Pose T_WC = Pose::Identity();
  FrameFeatures features;
};

struct KeyframeConfig {
  double spacing_m = 0.2;     ///< a frame is one if no keyframe looks from within this distance of it ...
  double spacing_rad = 0.26;  ///< ... and within this angle
  int largest_count = 2000;   ///< none are taken beyond it

  void describe(ConfigVisitor& visitor);
};

/// Which tracked frames are remembered: one for every place and direction looked from, so that their number grows with
/// the scene and not with time.
///
/// Owns the keyframes, in the order in which they came. Finding one again is the Relocaliser's part; whether a frame is
/// tracked well enough to become one, the caller's.
class KeyframeSet {
 public:
  using Config = KeyframeConfig;

  /// Throws std::invalid_argument if a field of `config` is out of range.
  explicit KeyframeSet(const Config& config = {});

  /// Whether a frame seen from `T_WC` should become a keyframe. Cost ~ number of keyframes, some ns each.
  [[nodiscard]] bool wants(const Pose& T_WC) const;
  /// Takes a keyframe, wanted or not: one that was saved comes back this way.
  void add(std::shared_ptr<const Keyframe> keyframe);

  [[nodiscard]] const std::vector<std::shared_ptr<const Keyframe>>& all() const { return keyframes_; }

 private:
  Config config_;
  std::vector<std::shared_ptr<const Keyframe>> keyframes_;
};

}  // namespace saccade
