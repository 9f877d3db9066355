#include "map/frame_integrator.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

constexpr int kFinest = MapTree::kDepth;
/// Stands for log-odds of 0, with the sign of the update that led there; OctoMap reads 0 as occupied.
constexpr float kNearlyZero = 1e-6f;
/// Observations beyond this no longer slow the running mean of colour and normal down.
constexpr int kMeanMemory = 15;

/// The child that a hit falls into, `level` levels above the finest leaves.
unsigned childOf(const EndpointLeaves::Endpoint& hit, int level) {
  return static_cast<unsigned>(hit.code >> (3 * level)) & 7u;
}

/// How many of `hits`, which are sorted and not empty, fall into the same child as the first.
std::size_t countOfFirstChild(std::span<const EndpointLeaves::Endpoint> hits, int level) {
  const unsigned i = childOf(hits.front(), level);
  if (hits.size() <= 16) {
    std::size_t n = 1;
    while (n < hits.size() && childOf(hits[n], level) == i) ++n;
    return n;
  }
  const auto end =
      std::partition_point(hits.begin(), hits.end(), [&](const auto& h) { return childOf(h, level) <= i; });
  return static_cast<std::size_t>(end - hits.begin());
}

/// Starts loading the children of a node: a descent that waits for each family waits most of its time.
void prefetchFamily(const IorOcTreeNode* node) {
  if (node->isLeaf()) return;
  const auto* first = reinterpret_cast<const std::byte*>(node->child(0));
  for (std::size_t offset = 0; offset < 8 * NodeLayout::kNodeBytes; offset += 64) __builtin_prefetch(first + offset);
}

std::uint8_t blend(std::uint8_t mean, std::uint8_t seen, int memory) {
  const int difference = seen - mean;
  const int rounding = difference >= 0 ? memory / 2 : -(memory / 2);
  return static_cast<std::uint8_t>(mean + (difference + rounding) / memory);
}

}  // namespace

IntegrationReport FrameIntegrator::integrate(IorOcTree& tree, const DepthMaps& depth, const cv::Mat3b& color,
                                             const Pose& T_WC) {
  tree_ = &tree;
  has_color_ = !color.empty();
  has_normals_ = !depth.normals.empty();
  report_ = {};
  prepare(depth, T_WC);
  endpoints_.collect(depth_, depth.camera, T_WC.linear(), cube_, depth.normals, color);
  rays_.build(endpoints_, depth_, depth.camera, R_CW_, cube_);
  prepareSiblings(depth.camera);
  report_.points = endpoints_.points();
  report_.dropped_points = endpoints_.droppedPoints();
  report_.hit_leaves = static_cast<int>(endpoints_.endpoints().size());
  if (report_.points > 0) {
    for (unsigned block = 0; block < 8; ++block) updateBlock(block);
  }
  return std::move(report_);
}

void FrameIntegrator::prepare(const DepthMaps& depth, const Pose& T_WC) {
  const PinholeCamera& camera = depth.camera;
  const auto scale = static_cast<float>(1.0 / config_.leaf_size_m);
  depth_.assign(depth.depth_m, static_cast<float>(config_.min_range_m), static_cast<float>(config_.max_range_m), scale);

  double widest = 0.0;  // longest ray per unit of depth
  for (const double u : {-0.5, camera.width - 0.5}) {
    for (const double v : {-0.5, camera.height - 0.5}) widest = std::max(widest, camera.unproject(u, v, 1.0).norm());
  }
  cube_ = FrameCube::around(T_WC.translation(), config_.max_range_m * widest, config_.leaf_size_m);
  R_WC_ = T_WC.linear().cast<float>();
  R_CW_ = R_WC_.transpose();
  hit_ = tree_->getProbHitLog();
  miss_ = tree_->getProbMissLog();
  lowest_ = tree_->getClampingThresMinLog();
  highest_ = tree_->getClampingThresMaxLog();
  occupied_ = tree_->getOccupancyThresLog();
}

void FrameIntegrator::prepareSiblings(const PinholeCamera& camera) {
  ProjectionConstants& p = projection_;
  p.fx = static_cast<float>(camera.fx);
  p.fy = static_cast<float>(camera.fy);
  p.cx = static_cast<float>(camera.cx);
  p.cy = static_cast<float>(camera.cy);
  for (int i = 0; i < 9; ++i) p.R_CW[static_cast<std::size_t>(i)] = R_CW_(i / 3, i % 3);
  const float margin = static_cast<float>(rays_.margin()) + 0.5f;
  const float left = p.cx + margin, right = static_cast<float>(camera.width - 1) + margin - p.cx;
  const float top = p.cy + margin, bottom = static_cast<float>(camera.height - 1) + margin - p.cy;
  p.margin_cells = 0.5f * static_cast<float>(rays_.margin());
  p.width_cells = static_cast<float>(rays_.widthCells());
  p.height_cells = static_cast<float>(rays_.heightCells());
  p.planes = {p.fx, 0, left, -p.fx, 0, right, 0, p.fy, top, 0, -p.fy, bottom};

  for (int d = 1; d <= kFinest; ++d) {
    SiblingFrame& s = siblings_[static_cast<std::size_t>(d)];
    s.half = 0.5f * static_cast<float>(1 << (kFinest - d));
    s.z_reach = s.half * R_CW_.row(2).cwiseAbs().sum();
    for (std::size_t k = 0; k < 4; ++k) {
      const Eigen::RowVector3f normal(p.planes[3 * k], p.planes[3 * k + 1], p.planes[3 * k + 2]);
      s.plane_reach[k] = s.half * (normal * R_CW_).cwiseAbs().sum();
    }
    for (unsigned i = 0; i < 8; ++i) {
      const Eigen::Vector3f offset =
          R_CW_ * Eigen::Vector3f((i & 1) != 0 ? s.half : -s.half, (i & 2) != 0 ? s.half : -s.half,
                                  (i & 4) != 0 ? s.half : -s.half);
      s.dx[i] = offset.x();
      s.dy[i] = offset.y();
      s.dz[i] = offset.z();
    }
  }
}

void FrameIntegrator::updateBlock(unsigned block) {
  const std::uint32_t edge = 1u << cube_.block_bits;
  Place place{kFinest - cube_.block_bits, 0, 0, 0, 0, 0, 0};
  place.x = (block & 1) != 0 ? edge : 0;
  place.y = (block & 2) != 0 ? edge : 0;
  place.z = (block & 4) != 0 ? edge : 0;
  const std::int64_t key[3] = {cube_.base[0] + place.x, cube_.base[1] + place.y, cube_.base[2] + place.z};
  if (std::any_of(key, key + 3, [](std::int64_t k) { return k < 0 || k > 65535; })) return;  // outside the key space

  const Eigen::Vector3f centre(static_cast<float>(place.x), static_cast<float>(place.y), static_cast<float>(place.z));
  const Eigen::Vector3f centre_C =
      R_CW_ * (centre + Eigen::Vector3f::Constant(0.5f * static_cast<float>(edge)) - cube_.camera_leaves);
  place.cx = centre_C.x();
  place.cy = centre_C.y();
  place.cz = centre_C.z();

  const auto all = endpoints_.endpoints();
  const int shift = 3 * cube_.block_bits;
  const auto first =
      std::partition_point(all.begin(), all.end(), [&](const auto& h) { return h.code >> shift < block; });
  const auto last = std::partition_point(first, all.end(), [&](const auto& h) { return h.code >> shift <= block; });

  const bool fresh = tree_->getRoot() == nullptr;
  IorOcTreeNode* root = tree_->ensureRoot();
  const bool coarse = !fresh && root->isLeaf();
  if (coarse) tree_->expandNode(root);
  const bool changed = updateFromRoot(
      root, 0,
      {static_cast<std::uint32_t>(key[0]), static_cast<std::uint32_t>(key[1]), static_cast<std::uint32_t>(key[2])},
      place, Hits(first, last));
  if (!changed && fresh) tree_->clear();  // nothing seen, nothing known
  if (!changed && coarse) tree_->pruneNode(root);
}

bool FrameIntegrator::updateFromRoot(IorOcTreeNode* node, int depth, const std::array<std::uint32_t, 3>& block_key,
                                     const Place& place, Hits hits) {
  if (depth == place.depth) return updateChildren(node, place, hits);
  const int bit = kFinest - 1 - depth;
  const unsigned i = (block_key[0] >> bit & 1u) | (block_key[1] >> bit & 1u) << 1 | (block_key[2] >> bit & 1u) << 2;
  const bool fresh = (node->childMask() >> i & 1u) == 0;
  IorOcTreeNode* child = fresh ? tree_->createNodeChild(node, i) : node->child(i);
  const bool coarse = !fresh && child->isLeaf();
  if (coarse) tree_->expandNode(child);
  const bool changed = updateFromRoot(child, depth + 1, block_key, place, hits);
  if (changed) {
    refresh(node);
  } else if (fresh) {
    tree_->deleteNodeChild(node, i);
  } else if (coarse) {
    tree_->pruneNode(child);
  }
  return changed;
}

bool FrameIntegrator::updateChildren(IorOcTreeNode* node, const Place& place, Hits hits) {
  const int depth = place.depth + 1;  // of the children; the finest ones are never reached here
  SiblingBounds bounds;
  boundSiblings(projection_, siblings_[static_cast<std::size_t>(depth)], place.cx, place.cy, place.cz, bounds);
  for (unsigned mask = node->childMask() & ~bounds.outside; mask != 0; mask &= mask - 1) {
    prefetchFamily(node->child(static_cast<unsigned>(std::countr_zero(mask))));
  }
  std::array<Hits, 8> hits_of;
  unsigned hit = 0;
  while (!hits.empty()) {
    const unsigned i = childOf(hits.front(), kFinest - depth);
    hits_of[i] = hits.first(countOfFirstChild(hits, kFinest - depth));
    hits = hits.subspan(hits_of[i].size());
    hit |= 1u << i;
  }
  const unsigned unhit = ~hit & ~bounds.outside & ~settledChildren(node) & 0xFFu;
  RayPyramid::Sights sights = rays_.sights(bounds, unhit & bounds.bounded & ~bounds.empty);
  sights.hidden |= bounds.empty;
  bool changed = false;
  for (unsigned mask = hit | (unhit & ~sights.hidden); mask != 0; mask &= mask - 1) {
    const auto i = static_cast<unsigned>(std::countr_zero(mask));
    const bool free = (hit >> i & 1u) == 0 && (sights.free >> i & 1u) != 0;
    const Place child = childPlace(place, i);
    if (free) {
      changed |= freeChild(node, i, child);
    } else if (depth == kFinest - 1) {
      changed |= updateFinestFamily(node, i, child, hits_of[i], bounds);
    } else {
      changed |= updateInnerChild(node, i, child, hits_of[i]);
    }
  }
  if (changed) refresh(node);  // what did not change is not written either: most nodes near surfaces are only read
  return changed;
}

/// Children that are leaves and cannot become more free, as bits.
unsigned FrameIntegrator::settledChildren(const IorOcTreeNode* node) const {
  unsigned settled = 0;
  for (unsigned mask = node->childMask(); mask != 0; mask &= mask - 1) {
    const auto i = static_cast<unsigned>(std::countr_zero(mask));
    const IorOcTreeNode* child = node->child(i);
    settled |= static_cast<unsigned>(child->isLeaf() && child->getLogOdds() <= lowest_) << i;
  }
  return settled;
}

bool FrameIntegrator::freeChild(IorOcTreeNode* node, unsigned i, const Place& place) {
  if ((node->childMask() >> i & 1u) != 0) return freeSubtree(node->child(i), place);
  miss(tree_->createNodeChild(node, i), place);
  return true;
}

bool FrameIntegrator::updateInnerChild(IorOcTreeNode* node, unsigned i, const Place& place, Hits hits) {
  const bool fresh = (node->childMask() >> i & 1u) == 0;
  IorOcTreeNode* child = fresh ? tree_->createNodeChild(node, i) : node->child(i);
  const bool coarse = !fresh && child->isLeaf();
  if (coarse) tree_->expandNode(child);
  const bool changed = updateChildren(child, place, hits);
  if (!changed && fresh) tree_->deleteNodeChild(node, i);  // opened in vain
  if (!changed && coarse) tree_->pruneNode(child);
  return changed;
}

bool FrameIntegrator::updateFinestFamily(IorOcTreeNode* node, unsigned i, const Place& place, Hits hits,
                                         const SiblingBounds& bounds) {
  const bool fresh = (node->childMask() >> i & 1u) == 0;
  IorOcTreeNode* family = fresh ? nullptr : node->child(i);
  const bool coarse = !fresh && family->isLeaf();
  unsigned hit_mask = 0, wanted = 0xFF;
  for (const EndpointLeaves::Endpoint& hit : hits) hit_mask |= 1u << (hit.code & 7u);
  if (coarse && family->getLogOdds() <= lowest_) wanted = 0;
  wanted &= ~hit_mask;
  if (!fresh && !coarse) wanted &= ~settledChildren(family);
  const unsigned missed = wanted != 0 ? passedLeaves(bounds, i, place, wanted) : 0;
  if ((missed | hit_mask) == 0) return false;
  if (fresh) family = tree_->createNodeChild(node, i);
  if (missed == 0xFF && (fresh || coarse)) {  // all the same: stays one leaf
    miss(family, place);
    return true;
  }
  if (coarse) {
    tree_->expandNode(family);
  } else if (fresh) {
    tree_->createFamily(family, missed | hit_mask);
  }
  return applyToFinest(family, place, hits, missed);
}

bool FrameIntegrator::applyToFinest(IorOcTreeNode* node, const Place& place, Hits hits, unsigned missed) {
  for (const EndpointLeaves::Endpoint& endpoint : hits) {
    const auto k = static_cast<unsigned>(endpoint.code & 7u);
    const bool fresh = (node->childMask() >> k & 1u) == 0;
    hit(fresh ? tree_->createInFamily(node, k) : node->child(k), endpoint);
  }
  for (; missed != 0; missed &= missed - 1) {
    const auto k = static_cast<unsigned>(std::countr_zero(missed));
    const bool fresh = (node->childMask() >> k & 1u) == 0;
    miss(fresh ? tree_->createInFamily(node, k) : node->child(k), childPlace(place, k));
  }
  refresh(node);
  return true;
}

bool FrameIntegrator::freeSubtree(IorOcTreeNode* node, const Place& place) {
  if (node->isLeaf()) {
    if (node->getLogOdds() <= lowest_) return false;
    miss(node, place);
    return true;
  }
  bool changed = false;
  for (unsigned i = 0; i < 8; ++i) {
    const Place child = childPlace(place, i);
    if ((node->childMask() >> i & 1u) == 0) {
      miss(tree_->createNodeChild(node, i), child);
      changed = true;
    } else {
      changed |= freeSubtree(node->child(i), child);
    }
  }
  if (changed) refresh(node);
  return changed;
}

void FrameIntegrator::refresh(IorOcTreeNode* node) {
  // Most nodes show at a glance that they cannot be pruned.
  const bool may_prune = node->childMask() == 0xFF && node->child(0)->isLeaf() && node->child(7)->isLeaf() &&
                         node->child(0)->getLogOdds() == node->child(7)->getLogOdds();
  if (!may_prune || !tree_->pruneNode(node)) node->updateOccupancyChildren();
}

unsigned FrameIntegrator::passedLeaves(const SiblingBounds& bounds, unsigned i, const Place& family,
                                       unsigned wanted) const {
  const float low[3] = {static_cast<float>(family.x) - cube_.camera_leaves.x(),
                        static_cast<float>(family.y) - cube_.camera_leaves.y(),
                        static_cast<float>(family.z) - cube_.camera_leaves.z()};
  if ((bounds.bounded >> i & 1u) == 0) return rays_.crossedLeaves(low, wanted);
  return (bounds.empty >> i & 1u) != 0 ? 0 : rays_.crossedLeaves(bounds, i, low, wanted);
}

FrameIntegrator::Place FrameIntegrator::childPlace(const Place& place, unsigned i) const {
  const int depth = place.depth + 1;
  const std::uint32_t edge = 1u << (kFinest - depth);
  const SiblingFrame& s = siblings_[static_cast<std::size_t>(depth)];
  return {depth,
          place.x + ((i & 1) != 0 ? edge : 0),
          place.y + ((i & 2) != 0 ? edge : 0),
          place.z + ((i & 4) != 0 ? edge : 0),
          place.cx + s.dx[i],
          place.cy + s.dy[i],
          place.cz + s.dz[i]};
}

void FrameIntegrator::hit(IorOcTreeNode* leaf, const EndpointLeaves::Endpoint& endpoint) {
  float log_odds = std::min(leaf->getLogOdds() + hit_, highest_);
  if (log_odds == 0.0f) log_odds = kNearlyZero;
  leaf->setLogOdds(log_odds);
  if (log_odds < occupied_) return;  // free leaves hold no payload
  LeafSurface surface = leaf->surface();
  const int memory = std::min<int>(surface.observations, kMeanMemory) + 1;
  if (has_color_) {
    surface.blue = blend(surface.blue, endpoint.blue, memory);
    surface.green = blend(surface.green, endpoint.green, memory);
    surface.red = blend(surface.red, endpoint.red, memory);
  }
  if (has_normals_) {
    const Eigen::Vector3f n_C(endpoint.normal_C[0], endpoint.normal_C[1], endpoint.normal_C[2]);
    if (n_C != Eigen::Vector3f::Zero()) {
      const Eigen::Vector3f n_W = R_WC_ * n_C;
      const Eigen::Vector3f mean(surface.nx, surface.ny, surface.nz);
      surface.setNormal((mean * (static_cast<float>(memory - 1) / 127.0f) + n_W).normalized());
    }
  }
  if (surface.observations < 0xFFFF) ++surface.observations;
  leaf->setSurface(surface);
}

void FrameIntegrator::miss(IorOcTreeNode* leaf, const Place& place) {
  float log_odds = std::max(leaf->getLogOdds() + miss_, lowest_);
  if (log_odds == 0.0f) log_odds = -kNearlyZero;
  leaf->setLogOdds(log_odds);
  if (log_odds >= occupied_) return;
  if (weight(leaf->ior(), tree_->now()) > 0) reportForgotten(place);  // a leaf that turns free is forgotten
  leaf->setIor({});
  leaf->setSurface({});
}

void FrameIntegrator::reportForgotten(const Place& place) {
  const std::uint32_t edge = 1u << (kFinest - place.depth);
  for (std::uint32_t x = 0; x < edge; ++x) {
    for (std::uint32_t y = 0; y < edge; ++y) {
      for (std::uint32_t z = 0; z < edge; ++z) {
        report_.forgotten.push_back({static_cast<std::uint16_t>(cube_.base[0] + place.x + x),
                                     static_cast<std::uint16_t>(cube_.base[1] + place.y + y),
                                     static_cast<std::uint16_t>(cube_.base[2] + place.z + z)});
      }
    }
  }
}

}  // namespace saccade
