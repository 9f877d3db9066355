#include "saccade/tracking/motion_predictor.hpp"

#include <gtest/gtest.h>

#include "support/depth_scene.hpp"

namespace saccade {
namespace {

using test::poseOf;

constexpr double kFrame_s = 1.0 / 30.0;
constexpr double kRounding = 1e-9;

double difference(const Pose& a, const Pose& b) {
  return (a.matrix() - b.matrix()).norm();
}

MotionPredictor moving(const MotionPredictorConfig& config = {}) {
  MotionPredictor motion(config);
  Pose T_WC = Pose::Identity();
  for (int i = 0; i < 5; ++i) {
    motion.observe(i * kFrame_s, T_WC);
    T_WC = T_WC * poseOf({0, 1, 0}, 2.0, {0.01, 0, 0});
  }
  return motion;
}

TEST(MotionPredictor, StaysAtIdentityUntilItHasSeenAPose) {
  EXPECT_EQ(difference(MotionPredictor().predict(3.0), Pose::Identity()), 0.0);
}

TEST(MotionPredictor, ContinuesASteadyMotionIfVelocityHardlyDecays) {
  MotionPredictorConfig steady;
  steady.decay_s = 100.0;
  const MotionPredictor motion = moving(steady);
  const Pose expected = motion.last() * poseOf({0, 1, 0}, 2.0, {0.01, 0, 0});
  EXPECT_LT(difference(motion.predict(5 * kFrame_s), expected), 1e-4);
}

TEST(MotionPredictor, ComesToRestOverALongGap) {
  const MotionPredictor motion = moving();
  const Pose soon = motion.predict(4 * kFrame_s + 2.0);
  const Pose late = motion.predict(4 * kFrame_s + 200.0);
  EXPECT_LT(difference(soon, late), 1e-4);
  // 0.3 m/s for 0.15 s, at most.
  EXPECT_LT((late.translation() - motion.last().translation()).norm(), 0.3 * 0.15 + kRounding);
}

TEST(MotionPredictor, GivesTheLastPoseForAStampThatIsNotLater) {
  const MotionPredictor motion = moving();
  EXPECT_EQ(difference(motion.predict(4 * kFrame_s), motion.last()), 0.0);
  EXPECT_EQ(difference(motion.predict(-1.0), motion.last()), 0.0);
}

TEST(MotionPredictor, PredictsTheLastPoseAfterRest) {
  MotionPredictor motion = moving();
  motion.rest();
  EXPECT_LT(difference(motion.predict(1.0), motion.last()), kRounding);
}

TEST(MotionPredictor, GoesOnBitForBitFromASavedState) {
  MotionPredictor motion = moving(), resumed;
  resumed.restore(motion.state());
  EXPECT_EQ(difference(motion.predict(0.2), resumed.predict(0.2)), 0.0);
  motion.observe(0.2, poseOf({1, 0, 0}, 3.0, {0, 0.1, 0}));
  resumed.observe(0.2, poseOf({1, 0, 0}, 3.0, {0, 0.1, 0}));
  EXPECT_EQ(difference(motion.predict(0.3), resumed.predict(0.3)), 0.0);
}

}  // namespace
}  // namespace saccade
