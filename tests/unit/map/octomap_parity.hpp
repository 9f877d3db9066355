#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <octomap/OcTree.h>
#include <opencv2/imgcodecs.hpp>

#include "saccade/core/depth_maps.hpp"
#include "saccade/core/frame.hpp"
#include "saccade/map/ior_map.hpp"
#include "saccade/map/ior_octree.hpp"

namespace saccade::testing {

/// One frame of `kitchen` as its depth camera saw it, with the dataset's pose of that camera.
struct KitchenDepth {
  DepthMaps maps;
  Pose T_WC;
};

inline std::filesystem::path kitchenDirectory() {
  return std::filesystem::path(SACCADE_TEST_DATA_DIR) / "kitchen";
}

inline KitchenDepth readKitchenDepth(int index, int reduction = 1) {
  std::ostringstream stem;
  stem << "frame-" << std::setw(6) << std::setfill('0') << index;
  const cv::Mat raw = cv::imread(kitchenDirectory() / (stem.str() + ".depth.png"), cv::IMREAD_UNCHANGED);
  KitchenDepth frame;
  frame.maps.camera = PinholeCamera{640, 480, 585, 585, 320, 240}.reducedBy(reduction);
  frame.maps.depth_m = cv::Mat1f(frame.maps.camera.height, frame.maps.camera.width, 0.0f);
  for (int v = 0; v < frame.maps.depth_m.rows; ++v) {
    for (int u = 0; u < frame.maps.depth_m.cols; ++u) {
      const auto mm = raw.at<std::uint16_t>(v * reduction, u * reduction);
      frame.maps.depth_m(v, u) = mm == 65535 ? 0.0f : static_cast<float>(mm) / 1000.0f;
    }
  }
  std::ifstream in(kitchenDirectory() / (stem.str() + ".pose.txt"));
  for (int r = 0; r < 4; ++r) {
    for (int c = 0; c < 4; ++c) in >> frame.T_WC.matrix()(r, c);
  }
  return frame;
}

/// The rival: OctoMap's discretised insertion of the same points under the same sensor model.
class OctoMapTwin {
 public:
  explicit OctoMapTwin(const IorMapConfig& config) : config_(config), tree_(config.leaf_size_m) {
    tree_.setProbHit(config.hit_probability);
    tree_.setProbMiss(config.miss_probability);
    tree_.setClampingThresMin(config.lowest_probability);
    tree_.setClampingThresMax(config.highest_probability);
  }
  void integrate(const DepthMaps& depth, const Pose& T_WC) {
    octomap::Pointcloud cloud;
    for (int v = 0; v < depth.depth_m.rows; ++v) {
      for (int u = 0; u < depth.depth_m.cols; ++u) {
        const double z = depth.depth_m(v, u);
        if (!(z > 0.0 && z >= config_.min_range_m && z <= config_.max_range_m)) continue;
        const Eigen::Vector3d p = T_WC * depth.camera.unproject(u, v, z);
        cloud.push_back(static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()));
      }
    }
    const Eigen::Vector3f t = T_WC.translation().cast<float>();
    tree_.insertPointCloud(cloud, octomap::point3d(t.x(), t.y(), t.z()), -1.0, false, true);
  }
  [[nodiscard]] const octomap::OcTree& tree() const { return tree_; }

 private:
  IorMapConfig config_;
  octomap::OcTree tree_;
};

enum State { kUnknown = 0, kFree = 1, kOccupied = 2 };

/// How two maps agree.
struct Parity {
  std::array<std::array<double, 3>, 3> volume{};  ///< finest leaves by [state in ours][state in OctoMap's]
  double agreement_over_leaves = 0.0;             ///< share of points drawn uniformly over leaves with equal state
  double contradiction_over_leaves = 0.0;         ///< share of these points occupied in one and free in the other

  [[nodiscard]] double jaccard() const {
    const double common = volume[kOccupied][kOccupied];
    double ours = 0.0, theirs = 0.0;
    for (int s = 0; s < 3; ++s) {
      ours += volume[kOccupied][s];
      theirs += volume[s][kOccupied];
    }
    return common / (ours + theirs - common);
  }
  [[nodiscard]] double known() const {
    double sum = 0.0;
    for (const auto& row : volume)
      for (const double v : row) sum += v;
    return sum - volume[kUnknown][kUnknown];
  }
  [[nodiscard]] double agreementOverVolume() const {
    return (volume[kFree][kFree] + volume[kOccupied][kOccupied]) / known();
  }
  /// Occupied in one and free in the other, as a share of the leaves occupied in either.
  [[nodiscard]] double contradictionOfOccupied() const {
    double occupied = 0.0;
    for (int s = 0; s < 3; ++s) occupied += volume[kOccupied][s] + (s == kOccupied ? 0.0 : volume[s][kOccupied]);
    return (volume[kOccupied][kFree] + volume[kFree][kOccupied]) / occupied;
  }
  [[nodiscard]] std::string text() const {
    std::ostringstream out;
    out << "Jaccard " << jaccard() << ", agreement over leaves " << agreement_over_leaves << ", over volume "
        << agreementOverVolume() << ", contradiction over leaves " << contradiction_over_leaves << ", of occupied "
        << contradictionOfOccupied() << "\n  ours\\theirs   unknown       free   occupied\n";
    const char* names[] = {"unknown", "free", "occupied"};
    for (int a = 0; a < 3; ++a) {
      out << "  " << std::setw(9) << names[a];
      for (int b = 0; b < 3; ++b) out << std::setw(12) << static_cast<std::int64_t>(volume[a][b]);
      out << "\n";
    }
    return out.str();
  }
};

template <typename Tree, typename Node>
int stateOf(const Tree& tree, const Node* node) {
  return node == nullptr ? kUnknown : tree.isNodeOccupied(node) ? kOccupied : kFree;
}

inline void compareVolume(const IorOcTree& ours, const IorOcTreeNode* a, const octomap::OcTree& theirs,
                          const octomap::OcTreeNode* b, int depth, Parity& parity) {
  const bool a_inner = a != nullptr && ours.nodeHasChildren(a);
  const bool b_inner = b != nullptr && theirs.nodeHasChildren(b);
  if (!a_inner && !b_inner) {
    parity.volume[static_cast<std::size_t>(stateOf(ours, a))][static_cast<std::size_t>(stateOf(theirs, b))] +=
        std::pow(8.0, 16 - depth);
    return;
  }
  for (unsigned i = 0; i < 8; ++i) {
    const IorOcTreeNode* child_a = !a_inner ? a : ours.nodeChildExists(a, i) ? ours.getNodeChild(a, i) : nullptr;
    const octomap::OcTreeNode* child_b = !b_inner                       ? b
                                         : theirs.nodeChildExists(b, i) ? theirs.getNodeChild(b, i)
                                                                        : nullptr;
    compareVolume(ours, child_a, theirs, child_b, depth + 1, parity);
  }
}

inline Parity compareWithOctoMap(const IorMap& map, const octomap::OcTree& theirs, int points = 100000) {
  const IorOcTree& ours = map.tree();
  Parity parity;
  compareVolume(ours, ours.getRoot(), theirs, theirs.getRoot(), 0, parity);
  std::vector<std::pair<octomap::OcTreeKey, unsigned>> leaves;
  for (auto it = ours.begin_leafs(); it != ours.end_leafs(); ++it) leaves.emplace_back(it.getKey(), it.getDepth());
  for (auto it = theirs.begin_leafs(); it != theirs.end_leafs(); ++it) {
    leaves.emplace_back(it.getKey(), it.getDepth());
  }
  std::sort(leaves.begin(), leaves.end(), [](const auto& a, const auto& b) {
    return std::tuple(a.first[0], a.first[1], a.first[2], a.second) <
           std::tuple(b.first[0], b.first[1], b.first[2], b.second);
  });
  leaves.erase(std::unique(leaves.begin(), leaves.end()), leaves.end());
  std::mt19937_64 random(1);
  int equal = 0, contradictions = 0;
  for (int i = 0; i < points; ++i) {
    const auto& [key, depth] = leaves[random() % leaves.size()];
    octomap::OcTreeKey finest;
    const unsigned edge = 1u << (16 - depth);
    for (unsigned axis = 0; axis < 3; ++axis) {
      const unsigned corner = key[axis] / edge * edge;  // a coarse leaf's key is its middle
      finest[axis] = static_cast<octomap::key_type>(corner + random() % edge);
    }
    const int a = stateOf(ours, ours.search(finest)), b = stateOf(theirs, theirs.search(finest));
    equal += a == b;
    contradictions += (a == kOccupied && b == kFree) || (a == kFree && b == kOccupied);
  }
  parity.agreement_over_leaves = static_cast<double>(equal) / points;
  parity.contradiction_over_leaves = static_cast<double>(contradictions) / points;
  return parity;
}

}  // namespace saccade::testing
