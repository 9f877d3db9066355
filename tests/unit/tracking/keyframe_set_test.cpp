#include "saccade/tracking/keyframe_set.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "support/depth_scene.hpp"

namespace saccade {
namespace {

using test::poseOf;

std::shared_ptr<const Keyframe> seenFrom(const Pose& T_WC) {
  return std::make_shared<const Keyframe>(Keyframe{{}, 0.0, T_WC, {}});
}

TEST(KeyframeSet, WantsTheFirstFrame) {
  EXPECT_TRUE(KeyframeSet().wants(Pose::Identity()));
}

TEST(KeyframeSet, WantsAFrameOnlyFromANewPlaceOrInANewDirection) {
  KeyframeSet keyframes;
  keyframes.add(seenFrom(Pose::Identity()));
  EXPECT_FALSE(keyframes.wants(Pose::Identity()));
  EXPECT_FALSE(keyframes.wants(poseOf({0, 1, 0}, 14.0, {0.0, 0.19, 0.0})));
  EXPECT_TRUE(keyframes.wants(poseOf({0, 1, 0}, 0.0, {0.0, 0.21, 0.0})));
  EXPECT_TRUE(keyframes.wants(poseOf({1, 1, 0}, 16.0, {0, 0, 0})));
  EXPECT_TRUE(keyframes.wants(poseOf({1, 1, 0}, 180.0, {0, 0, 0})));
}

TEST(KeyframeSet, GrowsWithTheSceneAndNotWithTime) {
  KeyframeSet keyframes;
  for (int round = 0; round < 3; ++round) {
    for (int i = 0; i < 360; ++i) {
      const Pose T_WC = poseOf({0, 1, 0}, i, {0, 0, 0});
      if (keyframes.wants(T_WC)) keyframes.add(seenFrom(T_WC));
    }
  }
  EXPECT_EQ(keyframes.all().size(), 24U);  // a turn of 360 degrees in steps of 15
}

TEST(KeyframeSet, TakesNoMoreThanItIsAllowed) {
  KeyframeConfig few;
  few.largest_count = 2;
  KeyframeSet keyframes(few);
  for (int i = 0; i < 5; ++i) {
    const Pose T_WC = poseOf({0, 1, 0}, 0.0, {1.0 * i, 0, 0});
    if (keyframes.wants(T_WC)) keyframes.add(seenFrom(T_WC));
  }
  EXPECT_EQ(keyframes.all().size(), 2U);
}

TEST(KeyframeSet, RefusesWhatIsNoKeyframeOrNoSetting) {
  KeyframeSet keyframes;
  EXPECT_THROW(keyframes.add(nullptr), std::invalid_argument);
  KeyframeConfig wrong;
  wrong.spacing_m = -1.0;
  EXPECT_THROW(KeyframeSet{wrong}, std::invalid_argument);
}

}  // namespace
}  // namespace saccade
