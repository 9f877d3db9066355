#include "saccade/map/ior_map.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "map/frame_integrator.hpp"
#include "map/leaf_attention.hpp"
#include "saccade/map/ior_octree.hpp"

namespace saccade {
namespace {

std::string sizeText(const cv::Size& size) {
  return std::to_string(size.width) + " x " + std::to_string(size.height);
}

void requireSize(const char* name, const cv::Size& found, const PinholeCamera& camera) {
  const cv::Size expected(camera.width, camera.height);
  if (found == expected) return;
  throw std::invalid_argument(std::string(name) + " image is " + sizeText(found) + ", the camera " +
                              sizeText(expected));
}

template <typename Visit>
void visitLeaves(MapNode node, NodeKey key, const Visit& visit) {
  if (node.isLeaf()) {
    visit(node, key);
    return;
  }
  const int bit = MapTree::kDepth - 1 - key.depth;
  for (unsigned i = 0; i < 8; ++i) {
    if ((node.childMask() >> i & 1u) == 0) continue;
    const LeafKey corner{static_cast<std::uint16_t>(key.corner.x | (i & 1u) << bit),
                         static_cast<std::uint16_t>(key.corner.y | (i >> 1 & 1u) << bit),
                         static_cast<std::uint16_t>(key.corner.z | (i >> 2) << bit)};
    visitLeaves(node.child(i), {corner, key.depth + 1}, visit);
  }
}

}  // namespace

IorMap::IorMap(const Config& config) : config_(config) {
  requireValid(config_);
  if (config_.min_range_m >= config_.max_range_m) {
    throw std::invalid_argument("min_range_m " + std::to_string(config_.min_range_m) + " is not below max_range_m " +
                                std::to_string(config_.max_range_m));
  }
  tree_ = std::make_unique<IorOcTree>(config_.leaf_size_m);
  tree_->setProbHit(config_.hit_probability);
  tree_->setProbMiss(config_.miss_probability);
  tree_->setClampingThresMin(config_.lowest_probability);
  tree_->setClampingThresMax(config_.highest_probability);
  integrator_ = std::make_unique<FrameIntegrator>(config_);
  attention_ = std::make_unique<LeafAttention>(config_);
}

IorMap::~IorMap() = default;
IorMap::IorMap(IorMap&&) noexcept = default;
IorMap& IorMap::operator=(IorMap&&) noexcept = default;

IntegrationReport IorMap::integrate(const DepthMaps& depth, const cv::Mat3b& color, const Pose& T_WC) {
  requireSize("depth", depth.depth_m.size(), depth.camera);
  if (!color.empty()) requireSize("color", color.size(), depth.camera);
  if (!depth.normals.empty()) requireSize("normal", depth.normals.size(), depth.camera);
  if (!T_WC.matrix().allFinite()) throw std::invalid_argument("the pose of the camera is not finite");
  if (depth.depth_m.empty()) return {};
  return integrator_->integrate(*tree_, depth, color, T_WC);
}

AttentionReport IorMap::attend(std::span<const LeafKey> keys) {
  const Tick now = tree_->now();
  AttentionReport report = attention_->attend(*tree_, keys);
  tree_->setNow(Tick{now.value + 1});
  return report;
}

Tick IorMap::now() const {
  return tree_->now();
}
void IorMap::setNow(Tick now) {
  tree_->setNow(now);
}

std::optional<LeafKey> IorMap::keyAt(const Eigen::Vector3d& p_W) const {
  LeafKey key;
  std::uint16_t* out[3] = {&key.x, &key.y, &key.z};
  for (int axis = 0; axis < 3; ++axis) {
    const double k = std::floor(p_W[axis] / config_.leaf_size_m) + MapTree::kCentreKey;
    if (!(k >= 0.0 && k <= 65535.0)) return std::nullopt;
    *out[axis] = static_cast<std::uint16_t>(k);
  }
  return key;
}

Eigen::Vector3d IorMap::centre(LeafKey key) const {
  return (Eigen::Vector3d(key.x, key.y, key.z).array() - (MapTree::kCentreKey - 0.5)) * config_.leaf_size_m;
}

std::optional<MapLeaf> IorMap::findLeaf(const Eigen::Vector3d& p_W) const {
  const std::optional<LeafKey> key = keyAt(p_W);
  return key ? findLeaf(*key) : std::nullopt;
}

std::optional<MapLeaf> IorMap::findLeaf(LeafKey key) const {
  const MapTree tree = view();
  MapNode node = tree.root;
  if (!node) return std::nullopt;
  int depth = 0;
  for (; !node.isLeaf(); ++depth) {
    const int bit = MapTree::kDepth - 1 - depth;
    const unsigned i = (key.x >> bit & 1u) | (key.y >> bit & 1u) << 1 | (key.z >> bit & 1u) << 2;
    if ((node.childMask() >> i & 1u) == 0) return std::nullopt;
    node = node.child(i);
  }
  const auto corner = [depth](std::uint16_t k) {
    const int bits = MapTree::kDepth - depth;
    return static_cast<std::uint16_t>(k >> bits << bits);
  };
  return MapLeaf{{{corner(key.x), corner(key.y), corner(key.z)}, depth},
                 node.logOdds() >= tree.occupied_log_odds,
                 node.logOdds(),
                 node.ior(),
                 node.surface()};
}

void IorMap::forEachLeaf(const std::function<void(const MapLeaf&)>& visit) const {
  const MapTree tree = view();
  if (!tree.root) return;
  visitLeaves(tree.root, {}, [&](MapNode node, const NodeKey& key) {
    visit({key, node.logOdds() >= tree.occupied_log_odds, node.logOdds(), node.ior(), node.surface()});
  });
}

std::size_t IorMap::leafCount() const {
  return tree_->getNumLeafNodes();
}

std::size_t IorMap::occupiedLeafCount() const {
  const MapTree tree = view();
  std::size_t count = 0;
  if (tree.root) {
    visitLeaves(tree.root, {},
                [&](MapNode node, const NodeKey&) { count += node.logOdds() >= tree.occupied_log_odds; });
  }
  return count;
}

std::size_t IorMap::nodeCount() const {
  return tree_->size();
}
std::size_t IorMap::memoryBytes() const {
  return tree_->memoryUsage();
}
std::size_t IorMap::usedBytes() const {
  return tree_->usedBytes();
}
MapTree IorMap::view() const {
  return tree_->view();
}

}  // namespace saccade
