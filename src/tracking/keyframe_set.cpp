#include "saccade/tracking/keyframe_set.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace saccade {

void KeyframeConfig::describe(ConfigVisitor& visitor) {
  visitor.number("spacing_m", spacing_m, {0.0, 100.0}, "m", "no other keyframe looks from within this distance ...");
  visitor.number("spacing_rad", spacing_rad, {0.0, 3.2}, "rad", "... and within this angle");
  visitor.integer("largest_count", largest_count, {0, 1000000}, "", "none are taken beyond it");
}

KeyframeSet::KeyframeSet(const Config& config) : config_(config) {
  requireValid(config_);
}

bool KeyframeSet::wants(const Pose& T_WC) const {
  if (keyframes_.size() >= static_cast<std::size_t>(config_.largest_count)) return false;
  // The trace of a rotation by an angle is 1 + 2 cos(angle); sum(A * B) is the trace of A' B.
  const double near_trace = 1.0 + 2.0 * std::cos(config_.spacing_rad);
  return std::none_of(keyframes_.begin(), keyframes_.end(), [&](const auto& keyframe) {
    const Pose& there = keyframe->T_WC;
    return (there.translation() - T_WC.translation()).squaredNorm() < config_.spacing_m * config_.spacing_m &&
           there.linear().cwiseProduct(T_WC.linear()).sum() > near_trace;
  });
}

void KeyframeSet::add(std::shared_ptr<const Keyframe> keyframe) {
  if (!keyframe) throw std::invalid_argument("KeyframeSet: no keyframe given");
  keyframes_.push_back(std::move(keyframe));
}

}  // namespace saccade
