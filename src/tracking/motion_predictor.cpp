#include "saccade/tracking/motion_predictor.hpp"

#include <cmath>

#include "tracking/rigid_motion.hpp"

namespace saccade {

void MotionPredictorConfig::describe(ConfigVisitor& visitor) {
  visitor.number("decay_s", decay_s, {0.001, 100.0}, "s", "time in which an unconfirmed velocity falls to 1/e");
  visitor.number("blend", blend, {0.0, 1.0}, "", "share of the newest velocity in the estimate");
}

MotionPredictor::MotionPredictor(const Config& config) : config_(config) {
  requireValid(config_);
}

Pose MotionPredictor::predict(double stamp_s) const {
  const double gap_s = stamp_s - state_.stamp_s;
  if (!state_.known || !(gap_s > 0.0)) return state_.T_WC;
  const double effective_s = config_.decay_s * (1.0 - std::exp(-gap_s / config_.decay_s));
  return state_.T_WC * rigidMotion(state_.angular_C * effective_s, state_.linear_C * effective_s);
}

void MotionPredictor::observe(double stamp_s, const Pose& T_WC) {
  const double gap_s = stamp_s - state_.stamp_s;
  if (state_.known && gap_s > 0.0) {
    const Pose moved = state_.T_WC.inverse() * T_WC;
    const Eigen::Vector3d angular = rotationVector(moved.linear()) / gap_s;
    const Eigen::Vector3d linear = moved.translation() / gap_s;
    state_.angular_C += config_.blend * (angular - state_.angular_C);
    state_.linear_C += config_.blend * (linear - state_.linear_C);
  }
  state_.known = true;
  state_.stamp_s = stamp_s;
  state_.T_WC = T_WC;
}

void MotionPredictor::rest() {
  state_.linear_C.setZero();
  state_.angular_C.setZero();
}

}  // namespace saccade
