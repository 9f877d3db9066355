#pragma once

#include <optional>

#include "saccade/core/frame.hpp"
#include "saccade/session/session_reader.hpp"

namespace saccade {

/// Where one session lies in another, found by itself.
struct SessionAlignment {
  Pose T_AB = Pose::Identity();  ///< takes points of b's world frame to a's
  int found = 0;                 ///< keyframes of b whose place in a was verified
  int agreeing = 0;              ///< of these, those that say the same transform within 5 cm and 3 degrees
};

/// The transform between two sessions of one scene: keyframes of `b` are relocalised in `a` (point features, PnP, then
/// the surface decides), and the transform that most of them agree on is taken; between equals the first.
/// None unless two keyframes agree and they are more than half of those found: one alone may be mistaken.
/// At most 60 keyframes of b are tried, spread evenly. Throws IoError for damaged sessions.
[[nodiscard]] std::optional<SessionAlignment> alignSessions(const SessionReader& a, const SessionReader& b);

}  // namespace saccade
