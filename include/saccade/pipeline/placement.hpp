#pragma once

#include <optional>
#include <string>

#include "saccade/core/config_fields.hpp"
#include "saccade/core/frame.hpp"
#include "saccade/pipeline/explorer.hpp"

namespace saccade {

enum class PlacementState {
  kUnlocalised,  ///< the camera may be anywhere
  kTentative,    ///< a place was found, or given by hand, and holds so far
  kVerified,     ///< the surface confirmed it frame after frame: exploration may go on
};

/// "unlocalised", "tentative" or "verified".
[[nodiscard]] const char* nameOf(PlacementState state);

/// Where the camera is in a scene that an Explorer knows from before, looked for until it is certain.
///
/// Reads the Explorer's memory and edits nothing in it: no leaf, no tick, no keyframe. A place that the keyframes find
/// and the surface verifies is tentative; the following frames must confirm it by being tracked from it, or the search
/// begins anew. Only then is the Explorer told.
class Placement {
 public:
  /// Frames that must confirm a tentative place before it is verified.
  static constexpr int kConfirmations = 2;

  /// `explorer` must outlive this. `guess`: a pose given by hand, from which the first frame is tried.
  explicit Placement(Explorer& explorer, const std::optional<Pose>& guess = std::nullopt);

  /// Looks at the next frame. On kVerified, which is final, the frame itself is still to be processed, by
  /// Explorer::process(): it is tracked from the place that was found.
  PlacementState offer(const RgbdFrame& frame);

  [[nodiscard]] PlacementState state() const { return state_; }
  /// The pose of the last frame offered, if it has one.
  [[nodiscard]] const std::optional<Pose>& T_WC() const { return T_WC_; }

 private:
  Explorer& explorer_;
  std::optional<Pose> T_WC_;
  PlacementState state_ = PlacementState::kUnlocalised;
  int confirmations_ = 0;
};

}  // namespace saccade
