#include <bit>
#include <cmath>
#include <stdexcept>

#include "saccade/exchange/map_merge.hpp"
#include "saccade/map/ior_octree.hpp"

namespace saccade {
namespace {

/// What a map says about a region.
enum class RegionState { kUnknown, kFree, kMixed };

struct Cube {
  Eigen::Vector3d corner;  ///< in leaves from the lowest key
  double edge = 0.0;
};

/// State of all that touches the axis-aligned box (in leaves): unknown all over, free all over with the same log-odds
/// (which `log_odds` is set to), or neither.
class RegionQuery {
 public:
  RegionQuery(const MapTree& tree, const Eigen::AlignedBox3d& box) : tree_(tree), box_(box) {}

  RegionState state(float& log_odds) {
    if (!tree_.root) return RegionState::kUnknown;
    visit(tree_.root, {Eigen::Vector3d::Zero(), 65536.0});
    if (mixed_ || (free_ && unknown_)) return RegionState::kMixed;
    log_odds = value_;
    return free_ ? RegionState::kFree : RegionState::kUnknown;
  }

 private:
  void visit(MapNode node, const Cube& cube) {
    if (mixed_ || (free_ && unknown_)) return;
    if (node.isLeaf()) {
      mixed_ = node.logOdds() >= tree_.occupied_log_odds || (free_ && node.logOdds() != value_);
      free_ = true;
      value_ = node.logOdds();
      return;
    }
    for (unsigned i = 0; i < 8; ++i) {
      const double half = cube.edge / 2;
      const Cube part{cube.corner + half * Eigen::Vector3d(i & 1u, i >> 1 & 1u, i >> 2), half};
      const Eigen::AlignedBox3d bounds(part.corner, part.corner + Eigen::Vector3d::Constant(half));
      if ((bounds.min().array() >= box_.max().array()).any() || (bounds.max().array() <= box_.min().array()).any())
        continue;
      if ((node.childMask() >> i & 1u) == 0) {
        unknown_ = true;
      } else {
        visit(node.child(i), part);
      }
    }
  }

  const MapTree& tree_;
  const Eigen::AlignedBox3d& box_;
  bool free_ = false, unknown_ = false, mixed_ = false;
  float value_ = 0.0f;
};

/// Fills a tree from above: a node whose region is of one state becomes a leaf or stays away, others are opened.
class Resampler {
 public:
  Resampler(const IorMap& from, const Pose& T_WM, IorMap& to)
      : from_(from), source_(from.view()), T_MW_(T_WM.inverse()), to_(to), leaf_m_(to.config().leaf_size_m) {}

  void run() {
    if (!source_.root) return;
    IorOcTreeNode* root = to_.tree().ensureRoot();
    if (!fill(root, {Eigen::Vector3d::Zero(), 65536.0}, 0)) to_.tree().clear();
    to_.tree().updateInnerNodes();
    to_.tree().prune();
  }

 private:
  /// Box around the cube's image in the source, in the source's leaves.
  [[nodiscard]] Eigen::AlignedBox3d imageOf(const Cube& cube) const {
    const double source_leaf_m = source_.leaf_size_m;
    const Eigen::Vector3d origin = Eigen::Vector3d::Constant(MapTree::kCentreKey);
    const Eigen::Vector3d centre_W = (cube.corner + Eigen::Vector3d::Constant(cube.edge / 2) - origin) * leaf_m_;
    const Eigen::Vector3d centre = T_MW_ * centre_W / source_leaf_m + origin;
    const Eigen::Vector3d reach =
        T_MW_.linear().cwiseAbs() * Eigen::Vector3d::Constant(cube.edge / 2 * leaf_m_ / source_leaf_m);
    constexpr double kRounding = 1e-7;  // a face that touches is not within
    return {centre - reach + Eigen::Vector3d::Constant(kRounding),
            centre + reach - Eigen::Vector3d::Constant(kRounding)};
  }

  /// Whether the node is known, and stays.
  bool fill(IorOcTreeNode* node, const Cube& cube, int depth) {
    const Eigen::AlignedBox3d image = imageOf(cube);
    if (depth == MapTree::kDepth) return sample(node, image.center());
    float log_odds = 0.0f;
    switch (RegionQuery(source_, image).state(log_odds)) {
      case RegionState::kUnknown:
        return false;
      case RegionState::kFree:
        node->setLogOdds(log_odds);
        return true;
      case RegionState::kMixed:
        break;
    }
    const double half = cube.edge / 2;
    bool known = false;
    for (unsigned i = 0; i < 8; ++i) {
      IorOcTreeNode* child = to_.tree().createNodeChild(node, i);
      const Cube part{cube.corner + half * Eigen::Vector3d(i & 1u, i >> 1 & 1u, i >> 2), half};
      if (fill(child, part, depth + 1)) {
        known = true;
      } else {
        to_.tree().deleteNodeChild(node, i);
      }
    }
    return known;
  }

  bool sample(IorOcTreeNode* node, const Eigen::Vector3d& position) {
    if ((position.array() < 0.0).any() || (position.array() >= 65536.0).any()) return false;
    const auto part = [&](int i) { return static_cast<std::uint16_t>(position[i]); };
    const auto leaf = from_.findLeaf(LeafKey{part(0), part(1), part(2)});
    if (!leaf) return false;
    node->setLogOdds(leaf->log_odds);
    if (!leaf->occupied) return true;
    node->setIor(lasting(leaf->ior, source_.now));
    LeafSurface surface = leaf->surface;
    const Eigen::Vector3f normal = T_MW_.linear().transpose().cast<float>() * surface.normal();
    if (normal.squaredNorm() > 0.0f) surface.setNormal(normal);
    node->setSurface(surface);
    return true;
  }

  const IorMap& from_;
  const MapTree source_;
  const Pose T_MW_;
  IorMap& to_;
  double leaf_m_;
};

}  // namespace

IorMap resampleMap(const IorMap& map, const Pose& T_WM, const IorMapConfig& config) {
  if (!T_WM.matrix().allFinite()) throw std::invalid_argument("resampleMap: a pose that is not finite");
  IorMap result(config);
  result.setNow(map.now());
  Resampler(map, T_WM, result).run();
  return result;
}

}  // namespace saccade
