#include <gtest/gtest.h>

#include "saccade/core/errors.hpp"
#include "saccade/sources/given_poses.hpp"
#include "saccade/sources/stamped_poses.hpp"
#include "sources/association.hpp"
#include "support/tiny_folders.hpp"

namespace saccade {
namespace {

using Pairs = std::vector<StampPair>;

TEST(Association, PairsOneToOneWithTheClosestFirst) {
  // 1.010 is within reach of both, but closer to 1.012.
  EXPECT_EQ(associate({1.000, 1.010}, {1.012}, 0.02), (Pairs{{1, 0}}));
  // The closest pair takes 1.010; the other partner is still within reach.
  EXPECT_EQ(associate({1.000, 1.010}, {1.012, 1.019}, 0.02), (Pairs{{0, 1}, {1, 0}}));
}

TEST(Association, KeepsTheLimitAndAcceptsEmptyLists) {
  EXPECT_EQ(associate({1.0, 2.0}, {1.019, 2.021}, 0.02), (Pairs{{0, 0}}));
  EXPECT_TRUE(associate({}, {1.0}, 0.02).empty());
  EXPECT_TRUE(associate({1.0}, {}, 0.02).empty());
}

TEST(Association, SurvivesAShiftBetweenTwoStreamsAndALostImage) {
  std::vector<double> color, depth;
  for (int i = 0; i < 100; ++i) {
    color.push_back(i / 30.0);
    if (i != 40) depth.push_back(i / 30.0 + 0.007);
  }
  const Pairs pairs = associate(color, depth, 0.02);
  ASSERT_EQ(pairs.size(), 99u);
  for (const auto& [first, second] : pairs) EXPECT_EQ(first, second < 40 ? second : second + 1);
}

TEST(GivenPoses, FindsThePoseWithinTenMilliseconds) {
  const test::TinyFolder folder;
  folder.write("poses.txt", std::string("# comment\n0.5 1 2 3 0 0 0 1.005\r\n0.1 4 5 6 0 0 0.7071 0.7071\n"));
  const GivenPoses poses = GivenPoses::open((folder / "poses.txt").string());
  RgbdFrame frame;
  frame.stamp_s = 0.109;
  ASSERT_TRUE(poses.find(frame));
  EXPECT_EQ(poses.find(frame)->translation(), Eigen::Vector3d(4, 5, 6));
  EXPECT_TRUE(poses.find(frame)->linear().isUnitary(1e-12)) << "a rounded quaternion is normalised";
  frame.stamp_s = 0.111;
  EXPECT_FALSE(poses.find(frame));
  frame.stamp_s = 0.495;
  EXPECT_EQ(poses.find(frame)->linear(), Eigen::Matrix3d::Identity());
}

TEST(GivenPoses, TakesTheFramesOwnPosesForTheWordDataset) {
  const GivenPoses poses = GivenPoses::open("dataset");
  RgbdFrame frame;
  EXPECT_FALSE(poses.find(frame));
  frame.T_WC = Pose(Eigen::Translation3d(1, 2, 3));
  EXPECT_EQ(poses.find(frame)->translation(), Eigen::Vector3d(1, 2, 3));
}

TEST(GivenPoses, RefusesWhatIsNotATrajectoryAndNamesTheLine) {
  const test::TinyFolder folder;
  EXPECT_THROW((void)GivenPoses::open((folder / "missing.txt").string()), IoError);
  for (const char* bad : {"0 0 0 0 0 0 0 1\n1 nan 0 0 0 0 0 1\n", "0 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 0.9\n",
                          "0 0 0 0 0 0 0 1\n1 0 0 0 0 0 1\n", "0 0 0 0 0 0 0 1\nnan 0 0 0 0 0 0 1\n",
                          "0 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 0\n", "0 0 0 0 0 0 0 1\n1 inf 0 0 0 0 0 1\n"}) {
    folder.write("poses.txt", std::string(bad));
    try {
      (void)GivenPoses::open((folder / "poses.txt").string());
      ADD_FAILURE() << "accepted " << bad;
    } catch (const IoError& error) {
      EXPECT_NE(std::string(error.what()).find("line 2"), std::string::npos) << error.what();
    }
  }
  folder.write("poses.txt", std::string("# empty\n"));
  EXPECT_THROW((void)GivenPoses::open((folder / "poses.txt").string()), IoError);
}

}  // namespace
}  // namespace saccade
