#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <fstream>
#include <string>
#include <system_error>
#include <vector>

#include "exchange/octomap_header.hpp"
#include "saccade/core/errors.hpp"
#include "saccade/exchange/octomap_files.hpp"
#include "saccade/map/ior_octree.hpp"

namespace saccade {
namespace {

static_assert(std::endian::native == std::endian::little, "payloads are read as they lie in memory");

enum class NodeFormat { kOccupancy, kColor, kIor, kBinary };

NodeFormat formatOf(const OctomapHeader& header, const std::filesystem::path& path) {
  const std::string& type = header.tree_type;
  if (header.binary && (type == "OcTree" || type == "ColorOcTree")) return NodeFormat::kBinary;  // no colour in either
  if (!header.binary && type == "OcTree") return NodeFormat::kOccupancy;
  if (!header.binary && type == "ColorOcTree") return NodeFormat::kColor;
  if (!header.binary && type == "IorOcTree") return NodeFormat::kIor;
  throw IoError(
      path, header.binary ? "a tree of type OcTree or ColorOcTree" : "a tree of type OcTree, ColorOcTree or IorOcTree",
      "type \"" + type.substr(0, 64) + "\"");
}

/// A node whose children are still to be read, in the order of their numbers.
struct OpenNode {
  IorOcTreeNode* node = nullptr;
  unsigned waiting = 0;  ///< children to come, as bits
  int depth = 0;
};

/// Reads the nodes of one file, depth first as they lie in it, with a stack of its own.
class NodeReader {
 public:
  NodeReader(std::istream& in, const OctomapHeader& header, IorMap& map, const std::filesystem::path& path)
      : in_(in),
        header_(header),
        format_(formatOf(header, path)),
        tree_(map.tree()),
        path_(path),
        lowest_(map.tree().getClampingThresMinLog()),
        highest_(map.tree().getClampingThresMaxLog()) {}

  void read() {
    if (header_.nodes > 0) {
      count(1);
      IorOcTreeNode* root = tree_.ensureRoot();
      open(root, 0);
      while (!open_.empty()) readNext();
    }
    if (nodes_ != header_.nodes) {
      throw IoError(path_, std::to_string(header_.nodes) + " nodes, as its header says", std::to_string(nodes_));
    }
    if (in_.peek() != std::istream::traits_type::eof()) throw IoError(path_, "the end after the last node", "more");
    tree_.updateInnerNodes();
  }

 private:
  template <typename T>
  T take() {
    T value;
    in_.read(reinterpret_cast<char*>(&value), sizeof value);
    if (in_.gcount() != sizeof value) {
      throw IoError(path_, std::to_string(header_.nodes) + " nodes, as its header says",
                    "the end of the file after " + std::to_string(nodes_));
    }
    return value;
  }

  void count(unsigned nodes) {
    nodes_ += nodes;
    if (nodes_ > header_.nodes) {
      throw IoError(path_, std::to_string(header_.nodes) + " nodes, as its header says", "more");
    }
  }

  /// Reads one child that waits, or closes a node that has them all.
  void readNext() {
    OpenNode& top = open_.back();
    if (top.waiting == 0) {
      open_.pop_back();
      return;
    }
    const auto i = static_cast<unsigned>(std::countr_zero(top.waiting));
    top.waiting &= top.waiting - 1;
    open(top.node->child(i), top.depth + 1);  // `top` is no longer good
  }

  void open(IorOcTreeNode* node, int depth) {
    format_ == NodeFormat::kBinary ? openBinary(node, depth) : openFull(node, depth);
  }

  /// An `.ot` node: its payload, then which children it has.
  void openFull(IorOcTreeNode* node, int depth) {
    const auto value = take<float>();
    std::array<std::uint8_t, 3> color{255, 255, 255};
    IorState ior;
    LeafSurface surface;
    if (format_ == NodeFormat::kColor) color = take<std::array<std::uint8_t, 3>>();
    if (format_ == NodeFormat::kIor) {
      ior = IorState::fromBits(take<std::uint32_t>());
      surface = take<LeafSurface>();
    }
    const unsigned children = take<std::uint8_t>();
    if (children != 0) {
      addChildren(node, depth, children, children);
      return;
    }
    setLeaf(*node, value);
    if (!tree_.isNodeOccupied(node)) return;                    // a free leaf remembers nothing
    if (color != std::array<std::uint8_t, 3>{255, 255, 255}) {  // white is OctoMap's "no colour"
      surface.red = color[0];
      surface.green = color[1];
      surface.blue = color[2];
      surface.observations = 1;
    }
    node->setIor(ior);
    node->setSurface(surface);
  }

  /// A `.bt` node with children: two bits each, 01 free, 10 occupied, 11 with children of its own.
  void openBinary(IorOcTreeNode* node, int depth) {
    const auto pairs = take<std::uint16_t>();
    unsigned exists = 0, inner = 0;
    for (unsigned i = 0; i < 8; ++i) {
      const unsigned pair = pairs >> (2 * i) & 3u;
      exists |= (pair != 0 ? 1u : 0u) << i;
      inner |= (pair == 3u ? 1u : 0u) << i;
    }
    if (exists == 0) throw IoError(path_, "children below an inner node", "none");
    addChildren(node, depth, exists, inner);
    for (unsigned i = 0; i < 8; ++i) {
      const unsigned pair = pairs >> (2 * i) & 3u;
      if (pair == 1u || pair == 2u) setLeaf(*node->child(i), pair == 2u ? highest_ : lowest_);
    }
  }

  void addChildren(IorOcTreeNode* node, int depth, unsigned exists, unsigned waiting) {
    if (depth >= MapTree::kDepth) {
      throw IoError(path_, "an octree of at most " + std::to_string(MapTree::kDepth) + " levels", "a deeper one");
    }
    count(static_cast<unsigned>(std::popcount(exists)));
    tree_.createFamily(node, exists);
    open_.push_back({node, waiting, depth});
  }

  void setLeaf(IorOcTreeNode& leaf, float value) const {
    if (!std::isfinite(value)) throw IoError(path_, "finite log-odds in every leaf", std::to_string(value));
    constexpr float kHardlyOccupied = 1e-6f;  // 0 is occupied for OctoMap, but unknown for the map
    leaf.setLogOdds(value == 0.0f ? kHardlyOccupied : std::clamp(value, lowest_, highest_));
  }

  std::istream& in_;
  const OctomapHeader& header_;
  NodeFormat format_;
  IorOcTree& tree_;
  const std::filesystem::path& path_;
  float lowest_, highest_;
  std::uint64_t nodes_ = 0;
  std::vector<OpenNode> open_;
};

/// Refuses a header whose numbers cannot be true of a file of `data_bytes`, before memory is taken for them.
void requireBelievable(const OctomapHeader& header, std::uintmax_t data_bytes, const OctomapLimits& limits,
                       const std::filesystem::path& path) {
  constexpr double kSmallestLeaf_m = 0.001, kLargestLeaf_m = 1.0;
  if (!(header.leaf_size_m >= kSmallestLeaf_m && header.leaf_size_m <= kLargestLeaf_m)) {
    throw IoError(path, "leaves of 0.001 to 1 m", std::to_string(header.leaf_size_m) + " m");
  }
  if (header.nodes > limits.nodes) {
    throw IoError(path, "at most " + std::to_string(limits.nodes) + " nodes", std::to_string(header.nodes));
  }
  // An .ot node takes 5 bytes at least; two bytes of a .bt stand for eight nodes at most.
  const std::uintmax_t most = header.binary ? data_bytes / 2 * 8 + 1 : data_bytes / 5;
  if (header.nodes > most) {
    throw IoError(path,
                  "at most " + std::to_string(most) + " nodes in the " + std::to_string(data_bytes) + " bytes of data",
                  "a header that says " + std::to_string(header.nodes));
  }
}

}  // namespace

ForeignMap readOctomap(const std::filesystem::path& path, const IorMapConfig& config, const OctomapLimits& limits) {
  std::error_code failure;
  if (!std::filesystem::is_regular_file(path, failure)) {
    throw IoError(path, "an OctoMap file (.ot or .bt)",
                  std::filesystem::exists(path, failure) ? "a folder or device" : "nothing");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) throw IoError(path, "a file that can be read", "one that cannot");
  const OctomapHeader header = readOctomapHeader(file, path);
  const std::uintmax_t data_bytes = std::filesystem::file_size(path) - static_cast<std::uintmax_t>(file.tellg());
  requireBelievable(header, data_bytes, limits, path);
  IorMapConfig own = config;
  own.leaf_size_m = header.leaf_size_m;
  ForeignMap foreign{IorMap(own), header.tree_type, header.binary};
  NodeReader(file, header, foreign.map, path).read();
  foreign.map.setNow({header.tick});
  return foreign;
}

}  // namespace saccade
