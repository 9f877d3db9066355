#include "saccade/map/map_tiles.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>

#include "saccade/core/errors.hpp"
#include "saccade/map/ior_octree.hpp"

// A tile is: version (1 byte), kind of its root (1 byte), then the root. An inner node is three masks: which children
// exist, which of them are inner nodes, which of the leaves carry a payload; then the children in order. A leaf is its
// log-odds (float), then, with a payload, IOR (4 bytes) and surface (8 bytes). Little-endian.

namespace saccade {

static_assert(std::endian::native == std::endian::little, "tiles are written as values lie in memory");

namespace {

constexpr std::uint8_t kVersion = 1;
enum Kind : std::uint8_t { kPlainLeaf = 0, kLeafWithPayload = 1, kInner = 2 };

unsigned childIndex(const LeafKey& key, int depth) {
  const int bit = MapTree::kDepth - 1 - depth;
  return (key.x >> bit & 1u) | (key.y >> bit & 1u) << 1 | (key.z >> bit & 1u) << 2;
}

NodeKey childKey(const NodeKey& key, unsigned i) {
  const int bit = MapTree::kDepth - 1 - key.depth;
  return {{static_cast<std::uint16_t>(key.corner.x | (i & 1u) << bit),
           static_cast<std::uint16_t>(key.corner.y | (i >> 1 & 1u) << bit),
           static_cast<std::uint16_t>(key.corner.z | (i >> 2) << bit)},
          key.depth + 1};
}

std::string nameOf(const NodeKey& key) {
  return "tile " + std::to_string(key.corner.x) + " " + std::to_string(key.corner.y) + " " +
         std::to_string(key.corner.z) + " at depth " + std::to_string(key.depth);
}

bool hasPayload(MapNode leaf) {
  return leaf.ior() != IorState{} || leaf.surface() != LeafSurface{};
}

class TileWriter {
 public:
  explicit TileWriter(std::vector<std::byte>& out) : out_(out), size_(out.size()) {}

  /// The number of leaves written.
  std::size_t writeRoot(MapNode root) {
    makeRoom();
    put(kVersion);
    const Kind kind = !root.isLeaf() ? kInner : hasPayload(root) ? kLeafWithPayload : kPlainLeaf;
    put(kind);
    kind == kInner ? writeInner(root) : writeLeaf(root, kind == kLeafWithPayload);
    out_.resize(size_);
    return leaves_;
  }

 private:
  /// Enough for the root's two bytes and a leaf, or for the masks of a node and leaves that are all its children.
  static constexpr std::size_t kMostBetween = 256;
  /// What is asked for at a time: all of it is filled with zeros first.
  static constexpr std::size_t kStep = std::size_t{64} << 10;

  void makeRoom() {
    if (out_.size() - size_ < kMostBetween) out_.resize(size_ + kStep);
  }
  template <typename T>
  void put(const T& value) {
    std::memcpy(out_.data() + size_, &value, sizeof(T));
    size_ += sizeof(T);
  }
  void writeLeaf(MapNode leaf, bool payload) {
    ++leaves_;
    put(leaf.logOdds());
    if (!payload) return;
    put(leaf.ior().bits());
    put(leaf.surface());
  }
  void writeInner(MapNode node) {
    makeRoom();
    std::uint8_t inner = 0, payload = 0;
    const auto exists = static_cast<std::uint8_t>(node.childMask());
    for (unsigned i = 0; i < 8; ++i) {
      if ((exists >> i & 1u) == 0) continue;
      const MapNode child = node.child(i);
      if (!child.isLeaf()) {
        inner = static_cast<std::uint8_t>(inner | 1u << i);
        prefetchFamily(child);
      } else if (hasPayload(child)) {
        payload = static_cast<std::uint8_t>(payload | 1u << i);
      }
    }
    put(exists);
    put(inner);
    put(payload);
    for (unsigned i = 0; i < 8; ++i) {
      if ((exists >> i & 1u) == 0) continue;
      if ((inner >> i & 1u) != 0) {
        writeInner(node.child(i));
        makeRoom();  // for the leaves that follow
      } else {
        writeLeaf(node.child(i), (payload >> i & 1u) != 0);
      }
    }
  }

  /// Starts loading the children: a walk that waits for each family waits most of its time.
  static void prefetchFamily(MapNode node) {
    const auto* family = static_cast<const std::byte*>(node.family());
    for (std::size_t line = NodeLayout::kFamilyNodes; line < NodeLayout::kFamilyBytes; line += 64) {
      __builtin_prefetch(family + line);
    }
  }

  std::vector<std::byte>& out_;
  std::size_t size_;  // what is written; out_ is longer meanwhile
  std::size_t leaves_ = 0;
};

/// Reads one tile; with a null tree it only checks.
class TileReader {
 public:
  TileReader(const MapTile& tile, const std::filesystem::path& source) : tile_(tile), source_(source) {}

  /// The number of leaves read.
  std::size_t read(IorOcTree* tree, IorOcTreeNode* node) {
    position_ = 0;
    const auto version = take<std::uint8_t>();
    if (version != kVersion) fail("version " + std::to_string(kVersion), "version " + std::to_string(version));
    const auto kind = take<std::uint8_t>();
    if (kind > kInner) fail("a kind of root from 0 to 2", std::to_string(kind));
    kind == kInner ? readInner(tree, node, tile_.root.depth) : readLeaf(node, kind == kLeafWithPayload);
    if (position_ != tile_.data.size()) {
      fail("the end after " + std::to_string(position_) + " bytes", std::to_string(tile_.data.size()) + " bytes");
    }
    return leaves_;
  }

 private:
  [[noreturn]] void fail(const std::string& expected, const std::string& found) const {
    throw IoError(source_, expected + " in map " + nameOf(tile_.root), found);
  }
  template <typename T>
  T take() {
    if (tile_.data.size() - position_ < sizeof(T)) {
      fail("more than " + std::to_string(position_) + " bytes", "the end");
    }
    T value;
    std::memcpy(&value, tile_.data.data() + position_, sizeof(T));
    position_ += sizeof(T);
    return value;
  }
  void readLeaf(IorOcTreeNode* leaf, bool payload) {
    const auto log_odds = take<float>();
    if (!std::isfinite(log_odds) || log_odds == 0.0f) fail("log-odds of a known leaf", std::to_string(log_odds));
    const IorState ior = payload ? IorState::fromBits(take<std::uint32_t>()) : IorState{};
    const LeafSurface surface = payload ? take<LeafSurface>() : LeafSurface{};
    ++leaves_;
    if (leaf == nullptr) return;
    leaf->setLogOdds(log_odds);
    leaf->setIor(ior);
    leaf->setSurface(surface);
  }
  void readInner(IorOcTree* tree, IorOcTreeNode* node, int depth) {
    if (depth >= MapTree::kDepth) fail("a leaf at the finest depth", "an inner node");
    const auto exists = take<std::uint8_t>(), inner = take<std::uint8_t>(), payload = take<std::uint8_t>();
    const bool sound = exists != 0 && (inner & ~exists) == 0 && (payload & ~(exists & ~inner)) == 0;
    if (!sound) {
      fail("masks of children, inner nodes and payloads that agree",
           std::to_string(exists) + ", " + std::to_string(inner) + ", " + std::to_string(payload));
    }
    if (tree != nullptr) tree->createFamily(node, exists);
    for (unsigned i = 0; i < 8; ++i) {
      if ((exists >> i & 1u) == 0) continue;
      IorOcTreeNode* child = node == nullptr ? nullptr : node->child(i);
      (inner >> i & 1u) != 0 ? readInner(tree, child, depth + 1) : readLeaf(child, (payload >> i & 1u) != 0);
    }
  }

  const MapTile& tile_;
  const std::filesystem::path& source_;
  std::size_t position_ = 0;
  std::size_t leaves_ = 0;
};

void collectTiles(MapNode node, const NodeKey& key, int depth, std::vector<NodeKey>& tiles) {
  if (node.isLeaf() || key.depth == depth) {
    tiles.push_back(key);
    return;
  }
  for (unsigned i = 0; i < 8; ++i) {
    if ((node.childMask() >> i & 1u) != 0) collectTiles(node.child(i), childKey(key, i), depth, tiles);
  }
}

/// Calls `visit` for the tiles below `node`, and `pass` for the nodes above them.
template <typename Node, typename Visit, typename Pass>
void walkTiles(Node* node, const NodeKey& key, int depth, const Visit& visit, const Pass& pass) {
  if (node->isLeaf() || key.depth == depth) {
    visit(node, key);
    return;
  }
  pass(node);
  for (unsigned i = 0; i < 8; ++i) {
    if ((node->childMask() >> i & 1u) != 0) walkTiles(node->child(i), childKey(key, i), depth, visit, pass);
  }
}

TileChange changeOf(const IorOcTreeNode* tile, const NodeKey& key) {
  return {key, MapNode(tile), tile->isLeaf() || tile->changedBelow()};
}

void requireTileDepth(int depth) {
  if (depth < 0 || depth > MapTree::kDepth) {
    throw std::invalid_argument("tiles at depth " + std::to_string(depth) + ", possible are 0 to 16");
  }
}

bool isSound(const NodeKey& key) {
  if (key.depth < 0 || key.depth > MapTree::kDepth) return false;
  const unsigned low_bits = (1u << (MapTree::kDepth - key.depth)) - 1u;
  return ((key.corner.x | key.corner.y | key.corner.z) & low_bits) == 0;
}

/// The still empty node for a tile, with the path to it; null where another tile already is.
IorOcTreeNode* makePlace(IorOcTree& tree, const NodeKey& key) {
  const bool empty = tree.getRoot() == nullptr;
  IorOcTreeNode* node = tree.ensureRoot();
  if (key.depth == 0) return empty ? node : nullptr;
  for (int depth = 0; depth < key.depth; ++depth) {
    const unsigned i = childIndex(key.corner, depth);
    const bool exists = (node->childMask() >> i & 1u) != 0;
    if (exists && (depth + 1 == key.depth || node->child(i)->isLeaf())) return nullptr;
    if (!exists && depth == 0 && node->isLeaf() && !empty) return nullptr;  // the root itself is a tile
    node = exists ? node->child(i) : tree.createNodeChild(node, i);
  }
  return node;
}

/// The nodes from the root down to `key`; empty if the map does not reach it.
std::vector<IorOcTreeNode*> pathTo(IorOcTree& tree, const NodeKey& key) {
  std::vector<IorOcTreeNode*> path;
  IorOcTreeNode* node = tree.getRoot();
  for (int depth = 0; node != nullptr; ++depth) {
    path.push_back(node);
    if (depth == key.depth) return path;
    const unsigned i = childIndex(key.corner, depth);
    node = (node->childMask() >> i & 1u) != 0 ? node->child(i) : nullptr;
  }
  return {};
}

}  // namespace

std::vector<NodeKey> listTiles(const IorMap& map, int depth) {
  requireTileDepth(depth);
  std::vector<NodeKey> tiles;
  if (map.view().root) collectTiles(map.view().root, {}, depth, tiles);
  return tiles;
}

std::vector<TileChange> takeTileChanges(IorMap& map, int depth) {
  requireTileDepth(depth);
  std::vector<TileChange> tiles;
  IorOcTreeNode* root = map.tree().getRoot();
  if (root == nullptr) return tiles;
  walkTiles(
      root, {}, depth,
      [&](IorOcTreeNode* tile, const NodeKey& key) {
        tiles.push_back(changeOf(tile, key));
        if (!tile->isLeaf()) tile->clearChanged();
      },
      [](IorOcTreeNode* above) { above->clearChanged(); });
  return tiles;
}

std::vector<TileChange> tileChanges(const IorMap& map, int depth) {
  requireTileDepth(depth);
  std::vector<TileChange> tiles;
  const IorOcTreeNode* root = map.tree().getRoot();
  if (root == nullptr) return tiles;
  walkTiles(
      root, {}, depth, [&](const IorOcTreeNode* tile, const NodeKey& key) { tiles.push_back(changeOf(tile, key)); },
      [](const IorOcTreeNode*) {});
  return tiles;
}

Eigen::AlignedBox3d boxOf(const NodeKey& node, double leaf_size_m) {
  const Eigen::Vector3d corner(node.corner.x, node.corner.y, node.corner.z);
  const Eigen::Vector3d low = (corner.array() - static_cast<double>(MapTree::kCentreKey)) * leaf_size_m;
  const double edge_m = leaf_size_m * static_cast<double>(1 << (MapTree::kDepth - node.depth));
  return {low, low + Eigen::Vector3d::Constant(edge_m)};
}

std::size_t appendTile(MapNode node, std::vector<std::byte>& out) {
  return TileWriter(out).writeRoot(node);
}

std::vector<std::byte> encodeTile(const IorMap& map, const NodeKey& root) {
  MapNode node = map.view().root;
  bool found = isSound(root) && static_cast<bool>(node);
  for (int depth = 0; found && depth < root.depth; ++depth) {
    const unsigned i = childIndex(root.corner, depth);
    found = !node.isLeaf() && (node.childMask() >> i & 1u) != 0;
    if (found) node = node.child(i);
  }
  if (!found) throw std::invalid_argument("the map holds no " + nameOf(root));
  std::vector<std::byte> data;
  appendTile(node, data);
  return data;
}

std::vector<MapTile> encodeTiles(const IorMap& map, int depth) {
  std::vector<MapTile> tiles;
  for (const NodeKey& root : listTiles(map, depth)) tiles.push_back({root, encodeTile(map, root)});
  return tiles;
}

std::size_t checkTile(const MapTile& tile, const std::filesystem::path& source) {
  if (!isSound(tile.root)) throw IoError(source, "a tile's place in the octree", nameOf(tile.root));
  return TileReader(tile, source).read(nullptr, nullptr);
}

void removeTile(IorMap& map, const NodeKey& root) {
  IorOcTree& tree = map.tree();
  const std::vector<IorOcTreeNode*> path = isSound(root) ? pathTo(tree, root) : std::vector<IorOcTreeNode*>();
  if (path.empty() || path.back()->isLeaf()) throw std::invalid_argument("the map holds no inner " + nameOf(root));
  // A node without children would be a leaf: those that held nothing else go too.
  int depth = root.depth;
  while (depth > 0 && std::has_single_bit(path[static_cast<std::size_t>(depth - 1)]->childMask())) --depth;
  if (depth == 0) {
    tree.clear();
  } else {
    tree.deleteNodeChild(path[static_cast<std::size_t>(depth - 1)], childIndex(root.corner, depth - 1));
  }
}

void insertTile(IorMap& map, const MapTile& tile, const std::filesystem::path& source) {
  checkTile(tile, source);
  IorOcTree& tree = map.tree();
  IorOcTreeNode* node = makePlace(tree, tile.root);
  if (node == nullptr) throw IoError(source, "tiles that do not overlap", nameOf(tile.root) + " over another");
  TileReader(tile, source).read(&tree, node);
  IorOcTree::updateInnerNodes(node);
  if (!node->isLeaf()) node->clearChanged();
  const std::vector<IorOcTreeNode*> path = pathTo(tree, tile.root);
  for (std::size_t depth = path.size() - 1; depth-- > 0;) path[depth]->updateOccupancyChildren();
}

IorMap restoreMap(const IorMapConfig& config, std::span<const MapTile> tiles, Tick now,
                  const std::filesystem::path& source) {
  IorMap map(config);
  map.setNow(now);
  IorOcTree& tree = map.tree();
  for (const MapTile& tile : tiles) {
    checkTile(tile, source);
    IorOcTreeNode* node = makePlace(tree, tile.root);
    if (node == nullptr) throw IoError(source, "tiles that do not overlap", nameOf(tile.root) + " over another");
    TileReader(tile, source).read(&tree, node);
  }
  tree.updateInnerNodes();
  return map;
}

}  // namespace saccade
