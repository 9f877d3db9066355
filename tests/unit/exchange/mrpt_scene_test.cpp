#include "saccade/exchange/mrpt_scene.hpp"

#include <mrpt/opengl/CBox.h>
#include <mrpt/opengl/COctoMapVoxels.h>
#include <mrpt/opengl/COpenGLScene.h>
#include <mrpt/opengl/CSetOfLines.h>

#include <gtest/gtest.h>

#include "saccade/core/errors.hpp"
#include "support/temporary_folder.hpp"

namespace saccade {
namespace {

TEST(MrptScene, MrptsOwnReaderGivesBackVoxelsPathAndBoxes) {
  const test::TemporaryFolder folder;
  const MapPoint leaf{{1.0F, 2.0F, 3.0F}, {0.0F, 0.0F, 1.0F}, {10, 20, 30}, 0, false, 1.0F, 0.25F};
  const std::vector<MapPoint> leaves(5, leaf);
  SceneContent content;
  content.leaves = leaves;
  content.path.assign(4, Pose::Identity());
  content.object_boxes.emplace_back(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 2, 3));
  const std::string path = folder / "m.3Dscene";
  writeMrptScene(content, path);

  mrpt::opengl::COpenGLScene scene;
  ASSERT_TRUE(scene.loadFromFile(path));
  const auto voxels = scene.getByClass<mrpt::opengl::COctoMapVoxels>();
  ASSERT_TRUE(voxels);
  ASSERT_EQ(voxels->getVoxelCount(0), 5U);
  EXPECT_EQ(voxels->getVoxel(0, 4).coords.y, 2.0F);
  EXPECT_EQ(voxels->getVoxel(0, 4).side_length, 0.25);
  EXPECT_EQ(voxels->getVoxel(0, 4).color.B, 30);
  const auto lines = scene.getByClass<mrpt::opengl::CSetOfLines>();
  ASSERT_TRUE(lines);
  EXPECT_EQ(lines->size(), 3U);
  EXPECT_TRUE(scene.getByClass<mrpt::opengl::CBox>());
}

TEST(MrptScene, APlaceThatIsNotThereIsAnIoError) {
  const test::TemporaryFolder folder;
  EXPECT_THROW(writeMrptScene({}, folder / "absent/m.3Dscene"), IoError);
}

}  // namespace
}  // namespace saccade
