#pragma once

#include <optional>

#include "saccade/core/config_fields.hpp"
#include "saccade/core/frame.hpp"

namespace saccade {

struct MotionPredictorConfig {
  double decay_s = 0.15;  ///< time in which an unconfirmed velocity falls to 1/e
  double blend = 1.0;     ///< share of the newest velocity in the estimate; the rest is the previous estimate

  void describe(ConfigVisitor& visitor);
};

/// Where the camera will be: the last pose moved on by a velocity that decays, so that a prediction over a long gap
/// comes to rest instead of running away.
///
/// Owns the last pose and the velocity; whether a pose is good enough to learn from is the caller's decision.
class MotionPredictor {
 public:
  using Config = MotionPredictorConfig;

  /// Everything the predictor knows, to be saved and put back: run N+M = run N, save, load, run M.
  struct State {
    bool known = false;
    double stamp_s = 0.0;
    Pose T_WC = Pose::Identity();
    Eigen::Vector3d linear_C = Eigen::Vector3d::Zero();   ///< m/s, in the camera's frame
    Eigen::Vector3d angular_C = Eigen::Vector3d::Zero();  ///< rad/s, in the camera's frame
  };

  /// Throws std::invalid_argument if a field of `config` is out of range.
  explicit MotionPredictor(const Config& config = {});

  /// The pose expected at `stamp_s`; identity before the first observe(). A stamp at or before the last one gives the
  /// last pose.
  [[nodiscard]] Pose predict(double stamp_s) const;
  /// The last pose observed; identity before the first one.
  [[nodiscard]] const Pose& last() const { return state_.T_WC; }

  /// Learns that the camera was at `T_WC` at `stamp_s`. After a gap of more than `Config::decay_s` several times over,
  /// the velocity is the mean over the gap.
  void observe(double stamp_s, const Pose& T_WC);
  /// Forgets the velocity but not the pose: after a loss, the camera may be anywhere near.
  void rest();

  [[nodiscard]] const State& state() const { return state_; }
  void restore(const State& state) { state_ = state; }

 private:
  Config config_;
  State state_;
};

}  // namespace saccade
