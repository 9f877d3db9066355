#include "saccade/tracking/relocaliser.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "support/painted_room.hpp"
#include "tracking/rigid_motion.hpp"

namespace saccade {
namespace {

using test::PaintedRoom;
using test::poseOf;

// Against a volume of 1 cm cells, as when tracking.
constexpr double kPlaceError_m = 0.01;
constexpr double kPlaceError_rad = 0.01;

PinholeCamera camera() {
  return {320, 240, 292.5, 292.5, 159.5, 119.5};
}

struct Photograph {
  DepthMaps depth;
  FrameFeatures features;
};

Photograph photograph(const PaintedRoom& room, const Pose& T_WC) {
  const RgbdFrame frame = room.photograph(camera(), T_WC);
  Photograph photo;
  DepthPreparation().prepare(frame.depth_m, camera(), photo.depth);
  photo.features = FeatureExtractor().extract(frame.color, photo.depth);
  return photo;
}

// What a run that went once past the room leaves behind.
struct KnownRoom {
  PaintedRoom room;
  SurfaceVolume surface;
  Relocaliser relocaliser;

  KnownRoom() {
    for (int i = 0; i < 4; ++i) {
      const Pose T_WC = poseOf({0, 1, 0}, -12.0 + 8.0 * i, {0.05 * i, 0.0, 0.0});
      const Photograph photo = photograph(room, T_WC);
      surface.integrate(photo.depth, T_WC);
      relocaliser.add(std::make_shared<const Keyframe>(Keyframe{FrameIndex{i}, 0.0, T_WC, photo.features}));
    }
  }
};

TEST(Relocaliser, FindsTheCameraBetweenKeyframesWithoutAnIdeaOfWhereItIs) {
  KnownRoom known;
  for (const Pose& truth : {poseOf({0, 1, 0.2}, 3.0, {0.03, 0.04, 0.02}), poseOf({0.3, 1, 0}, -9.0, {0.1, -0.03, 0.05}),
                            poseOf({0, 0, 1}, 25.0, {0.05, 0.02, 0.0})}) {
    const Photograph photo = photograph(known.room, truth);
    const auto place = known.relocaliser.find(photo.features, photo.depth, known.surface);
    ASSERT_TRUE(place);
    EXPECT_EQ(place->tracking.status, TrackingStatus::kTracked);
    const Pose error = truth.inverse() * place->tracking.T_WC;
    EXPECT_LT(error.translation().norm(), kPlaceError_m);
    EXPECT_LT(rotationVector(error.linear()).norm(), kPlaceError_rad);
  }
}

TEST(Relocaliser, RefusesARoomOfTheSameShapeWithOtherPaint) {
  KnownRoom known;
  PaintedRoom other;
  other.seed = 2;
  const Photograph photo = photograph(other, poseOf({0, 1, 0}, 3.0, {0.03, 0.0, 0.0}));
  EXPECT_GT(photo.features.size(), 100U);
  EXPECT_FALSE(known.relocaliser.find(photo.features, photo.depth, known.surface));
}

TEST(Relocaliser, RefusesARoomOfTheSamePaintWithAnotherShape) {
  KnownRoom known;
  const Pose T_WC = poseOf({0, 1, 0}, 3.0, {0.03, 0.0, 0.0});
  Photograph photo = photograph(known.room, T_WC);
  // The features speak for the place, but what stood there is gone: the frame sees half a metre farther.
  const cv::Mat1f farther_m(known.room.photograph(camera(), T_WC).depth_m + 0.5);
  DepthPreparation().prepare(farther_m, camera(), photo.depth);
  EXPECT_FALSE(known.relocaliser.propose(photo.features, camera()).empty());
  EXPECT_FALSE(known.relocaliser.find(photo.features, photo.depth, known.surface));
}

TEST(Relocaliser, FindsNothingWithoutKeyframesOrFeatures) {
  KnownRoom known;
  const Photograph photo = photograph(known.room, Pose::Identity());
  EXPECT_FALSE(Relocaliser().find(photo.features, photo.depth, known.surface));
  EXPECT_FALSE(known.relocaliser.find({}, photo.depth, known.surface));
}

TEST(Relocaliser, GivesTheSameBytesAgain) {
  KnownRoom known, twin;
  const Photograph photo = photograph(known.room, poseOf({0, 1, 0.2}, 3.0, {0.03, 0.04, 0.02}));
  const auto first = known.relocaliser.find(photo.features, photo.depth, known.surface);
  const auto again = known.relocaliser.find(photo.features, photo.depth, known.surface);
  const auto elsewhere = twin.relocaliser.find(photo.features, photo.depth, twin.surface);
  ASSERT_TRUE(first && again && elsewhere);
  EXPECT_EQ(first->tracking.T_WC.matrix(), again->tracking.T_WC.matrix());
  EXPECT_EQ(first->tracking.T_WC.matrix(), elsewhere->tracking.T_WC.matrix());
}

TEST(Relocaliser, RefusesWhatIsNoKeyframe) {
  EXPECT_THROW(Relocaliser().add(nullptr), std::invalid_argument);
}

TEST(PlaceVerifier, RefusesThePoseOfAnotherPlace) {
  KnownRoom known;
  PlaceVerifier verifier;
  const Photograph photo = photograph(known.room, Pose::Identity());
  EXPECT_TRUE(verifier.verify(photo.depth, known.surface, poseOf({0, 1, 0}, 1.0, {0.02, 0.0, 0.0})));
  EXPECT_FALSE(verifier.verify(photo.depth, known.surface, poseOf({0, 1, 0}, 60.0, {0.5, 0.0, 0.0})));
  EXPECT_FALSE(verifier.verify(photo.depth, SurfaceVolume(), Pose::Identity()));
}

TEST(PlaceVerifier, NoticesThatASurfaceIsSeenThrough) {
  KnownRoom known;
  PaintedRoom emptied;
  emptied.scene.balls.clear();  // the frame sees the walls behind the balls of the model
  const Photograph photo = photograph(emptied, Pose::Identity());
  const VerifiedPlace there = PlaceVerifier().examine(photo.depth, known.surface, Pose::Identity());
  EXPECT_GT(there.contradicted_share, 0.05);
  EXPECT_LT(PlaceVerifier()
                .examine(photograph(known.room, Pose::Identity()).depth, known.surface, Pose::Identity())
                .contradicted_share,
            0.01);
}

}  // namespace
}  // namespace saccade
