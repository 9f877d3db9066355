#include "session/reference_state.hpp"

#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "saccade/core/errors.hpp"
#include "support/painted_scene.hpp"

namespace saccade {
namespace {

using Points = PhotometricReference::Points;

PhotometricReference::State someState() {
  test::DepthScene scene = test::cornerWithBalls();
  const Pose T_WC = test::poseOf({1, 2, 3}, 10.0, {0.1, 0.2, -0.3});
  const PinholeCamera camera{320, 240, 292.5, 292.5, 159.5, 119.5};
  DepthMaps depth;
  DepthPreparation().prepare(scene.render(camera, T_WC), camera, depth);
  PhotometricReference reference;
  reference.take(depth, test::paintedIntensity(scene, camera, T_WC), T_WC);
  return reference.state();
}

TEST(ReferenceState, ComesBackBitForBit) {
  const PhotometricReference::State state = someState();
  ASSERT_GT(state.points.count, 100U);
  const std::string bytes = encodeReference(state);
  const PhotometricReference::State again = decodeReference(bytes, "a.saccade");
  EXPECT_EQ(again.T_WR.matrix(), state.T_WR.matrix());
  EXPECT_EQ(again.points.count, state.points.count);
  for (std::size_t level = 0; level < IntensityPyramid::kLevels; ++level) {
    EXPECT_EQ(again.points.levels[level].grey, state.points.levels[level].grey);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(again.points.position[axis], state.points.position[axis]);
      EXPECT_EQ(again.points.levels[level].slope[axis], state.points.levels[level].slope[axis]);
    }
  }
  EXPECT_EQ(encodeReference(again), bytes);
}

TEST(ReferenceState, MayHaveNoPoints) {
  const PhotometricReference::State again = decodeReference(encodeReference({}), "a.saccade");
  EXPECT_EQ(again.points.count, 0U);
}

TEST(ReferenceState, RefusesBytesThatItCannotHaveWritten) {
  const std::string whole = encodeReference(someState());
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{50}, std::size_t{96}, std::size_t{104}, whole.size() - 4}) {
    EXPECT_THROW((void)decodeReference(whole.substr(0, size), "a.saccade"), IoError) << size;
  }
  EXPECT_THROW((void)decodeReference(whole + std::string(44, '\0'), "a.saccade"), IoError);
  std::string huge = whole;
  std::memset(huge.data() + 96, 0xff, sizeof(std::uint64_t));
  EXPECT_THROW((void)decodeReference(huge, "a.saccade"), IoError);
  std::string not_finite = whole;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(not_finite.data() + 104, &nan, sizeof nan);
  EXPECT_THROW((void)decodeReference(not_finite, "a.saccade"), IoError);
}

}  // namespace
}  // namespace saccade
