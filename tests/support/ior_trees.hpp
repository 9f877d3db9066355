#pragma once

#include <cstdint>
#include <functional>
#include <random>

#include <Eigen/Geometry>

#include "saccade/core/camera.hpp"
#include "saccade/core/frame.hpp"
#include "saccade/map/ior_octree.hpp"

namespace saccade::test {

inline octomap::OcTreeKey octoKey(int x, int y, int z) {
  return {static_cast<octomap::key_type>(x), static_cast<octomap::key_type>(y), static_cast<octomap::key_type>(z)};
}

/// Makes the finest leaf at a key occupied, or free.
inline void setLeaf(IorOcTree& tree, int x, int y, int z, bool occupied) {
  tree.setNodeValue(octoKey(x, y, z), occupied ? 2.0f : -2.0f);
}

/// A camera that looks from `centre` along `forward` (both W), image rows falling along -`up` as far as that goes.
inline Pose lookAlong(const Eigen::Vector3d& centre, const Eigen::Vector3d& forward, const Eigen::Vector3d& up) {
  const Eigen::Vector3d z = forward.normalized();
  const Eigen::Vector3d x = z.cross(up).normalized();
  Pose T_WC = Pose::Identity();
  T_WC.linear() << x, z.cross(x), z;
  T_WC.translation() = centre;
  return T_WC;
}

/// A random pose within `reach_m` of `centre`.
inline Pose randomPose(std::mt19937& random, const Eigen::Vector3d& centre, double reach_m) {
  std::normal_distribution<double> gauss;
  std::uniform_real_distribution<double> offset(-reach_m, reach_m);
  const Eigen::Quaterniond rotation =
      Eigen::Quaterniond(gauss(random), gauss(random), gauss(random), gauss(random)).normalized();
  Pose T_WC = Pose::Identity();
  T_WC.linear() = rotation.toRotationMatrix();
  T_WC.translation() = centre + Eigen::Vector3d(offset(random), offset(random), offset(random));
  return T_WC;
}

/// Occupied and free leaves at random around the world's origin, coarse ones of both kinds among them, some leaves with
/// memory and surface.
inline void fillRandomly(IorOcTree& tree, std::mt19937& random, int reach, int leaves) {
  std::uniform_int_distribution<int> offset(-reach, reach);
  const auto part = [&] { return MapTree::kCentreKey + offset(random); };
  for (int i = 0; i < leaves; ++i) {
    const int x = part(), y = part(), z = part();
    setLeaf(tree, x, y, z, random() % 2 == 0);
  }
  for (int block = 0; block < 6; ++block) {  // 4³ equal leaves become one coarse leaf
    const int x = part() & ~3, y = part() & ~3, z = part() & ~3;
    for (int i = 0; i < 64; ++i) setLeaf(tree, x + (i & 3), y + (i >> 2 & 3), z + (i >> 4), block % 2 == 0);
  }
  for (int i = 0; i < leaves; ++i) {
    const int x = part(), y = part(), z = part();
    const IorOcTreeNode* found = tree.search(octoKey(x, y, z));
    if (found == nullptr || !tree.isNodeOccupied(found)) continue;
    IorOcTreeNode* leaf = tree.findFinestLeaf(octoKey(x, y, z));
    leaf->setIor(IorState(static_cast<std::uint32_t>(random() % 100), random() % 2 == 0));
    LeafSurface surface;
    surface.red = static_cast<std::uint8_t>(random());
    leaf->setSurface(surface);
  }
  tree.updateInnerNodes();
}

}  // namespace saccade::test
