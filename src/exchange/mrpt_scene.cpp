#include "saccade/exchange/mrpt_scene.hpp"

#include <mrpt/opengl/CBox.h>
#include <mrpt/opengl/COctoMapVoxels.h>
#include <mrpt/opengl/COpenGLScene.h>
#include <mrpt/opengl/CSetOfLines.h>
#include <mrpt/opengl/stock_objects.h>

#include "saccade/core/errors.hpp"

namespace saccade {
namespace {

mrpt::math::TPoint3D pointOf(const Eigen::Vector3d& p) {
  return {p.x(), p.y(), p.z()};
}

mrpt::opengl::COctoMapVoxels::Ptr voxelsOf(std::span<const MapPoint> leaves) {
  auto voxels = mrpt::opengl::COctoMapVoxels::Create();
  voxels->setName("map");
  voxels->resizeVoxelSets(2);  // occupied and free, as MRPT's own octomaps have them; the free ones are left out
  voxels->reserveVoxels(0, leaves.size());
  Eigen::AlignedBox3d bounds(Eigen::Vector3d::Zero());
  for (const MapPoint& leaf : leaves) {
    const Eigen::Vector3d centre = leaf.p_W.cast<double>();
    bounds.extend(centre);
    voxels->push_back_Voxel(
        0, {{leaf.p_W.x(), leaf.p_W.y(), leaf.p_W.z()}, leaf.leaf_m, {leaf.color[0], leaf.color[1], leaf.color[2]}});
  }
  voxels->setBoundingBox(pointOf(bounds.min()), pointOf(bounds.max()));
  voxels->showVoxels(0, true);
  voxels->showVoxels(1, false);
  voxels->showGridLines(false);
  voxels->enableCubeTransparency(false);
  return voxels;
}

mrpt::opengl::CSetOfLines::Ptr linesOf(const std::vector<Pose>& path) {
  auto lines = mrpt::opengl::CSetOfLines::Create();
  lines->setName("camera path");
  lines->setLineWidth(2.0F);
  lines->setColor_u8(255, 140, 0);
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Eigen::Vector3d from = path[i - 1].translation(), to = path[i].translation();
    lines->appendLine(from.x(), from.y(), from.z(), to.x(), to.y(), to.z());
  }
  return lines;
}

}  // namespace

bool canWriteMrptScene() {
  return true;
}

void writeMrptScene(const SceneContent& content, const std::filesystem::path& path) {
  constexpr float kAxesLength_m = 0.2F;
  mrpt::opengl::COpenGLScene scene;
  scene.insert(voxelsOf(content.leaves));
  scene.insert(linesOf(content.path));
  scene.insert(mrpt::opengl::stock_objects::CornerXYZSimple(kAxesLength_m));
  for (const Eigen::AlignedBox3d& box : content.object_boxes) {
    auto wires = mrpt::opengl::CBox::Create(pointOf(box.min()), pointOf(box.max()), true);
    wires->setBoxBorderColor(mrpt::img::TColor(0, 220, 90));  // of a wireframe too
    scene.insert(wires);
  }
  if (!scene.saveToFile(path.string())) throw IoError(path, "room for the whole scene", "a full or failing disk");
}

}  // namespace saccade
