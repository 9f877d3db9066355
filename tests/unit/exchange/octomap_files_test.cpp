#include "saccade/exchange/octomap_files.hpp"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <sstream>

#include <gtest/gtest.h>
#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>

#include "saccade/core/errors.hpp"
#include "saccade/map/ior_octree.hpp"
#include "support/ior_trees.hpp"
#include "support/temporary_folder.hpp"

namespace saccade {
namespace {

using test::TemporaryFolder;

void writeFile(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

IorMap randomMap(unsigned seed) {
  IorMapConfig config;
  config.leaf_size_m = 0.0123456789;  // does not survive six digits
  IorMap map(config);
  std::mt19937 random(seed);
  test::fillRandomly(map.tree(), random, 20, 400);
  map.setNow({17});
  return map;
}

std::string written(const std::function<void(std::ostream&)>& write) {
  std::ostringstream out;
  write(out);
  return out.str();
}

/// The state of a map's leaf as a number that two programs can agree on: 0 unknown, 1 free, 2 occupied.
template <typename Tree>
int stateAt(const Tree& tree, const octomap::OcTreeKey& key) {
  const auto* node = tree.search(key);
  return node == nullptr ? 0 : tree.isNodeOccupied(node) ? 2 : 1;
}

template <typename TreeA, typename TreeB>
int differingStates(const TreeA& a, const TreeB& b, int reach) {
  int different = 0;
  for (int x = -reach; x < reach; ++x) {
    for (int y = -reach; y < reach; ++y) {
      for (int z = -reach; z < reach; ++z) {
        const auto key = test::octoKey(MapTree::kCentreKey + x, MapTree::kCentreKey + y, MapTree::kCentreKey + z);
        different += stateAt(a, key) != stateAt(b, key) ? 1 : 0;
      }
    }
  }
  return different;
}

std::string complaintOf(const std::filesystem::path& path, const OctomapLimits& limits = {}) {
  try {
    (void)readOctomap(path, {}, limits);
  } catch (const IoError& error) {
    EXPECT_EQ(error.path(), path);
    return error.what();
  }
  return "";
}

constexpr int kReach = 26;  // a little more than fillRandomly() fills

TEST(OctomapFiles, AnIorOctreeComesBackWithItsMemoryTickAndLeafSize) {
  const TemporaryFolder folder;
  const IorMap map = randomMap(1);
  writeFile(folder / "m.ot", written([&](std::ostream& out) { writeIorOctree(map, out); }));
  const ForeignMap back = readOctomap(folder / "m.ot");
  EXPECT_EQ(back.map.now(), map.now());
  EXPECT_EQ(back.map.config().leaf_size_m, map.config().leaf_size_m);
  EXPECT_EQ(back.tree_type, "IorOcTree");
  EXPECT_TRUE(back.map.tree() == map.tree());
}

TEST(OctomapFiles, AColorOctreeOpensInOctomapWithTheSameStatesAndColours) {
  IorMap map = randomMap(2);
  for (int x = 0; x < 8; ++x) {  // leaves that were seen, in a place of their own
    const octomap::OcTreeKey key = test::octoKey(MapTree::kCentreKey + 100 + 2 * x, 30'000, 30'000);
    map.tree().setNodeValue(key, 2.0f);
    map.tree().findFinestLeaf(key)->setSurface({10, 20, static_cast<std::uint8_t>(30 + x), 0, 0, 0, 4});
  }
  map.tree().updateInnerNodes();
  std::istringstream in(written([&](std::ostream& out) { writeColorOctree(map, LeafPaint::kColor, out); }));
  const std::unique_ptr<octomap::AbstractOcTree> opened(octomap::AbstractOcTree::read(in));
  const auto* tree = dynamic_cast<octomap::ColorOcTree*>(opened.get());
  ASSERT_NE(tree, nullptr);
  EXPECT_EQ(differingStates(*tree, map.tree(), kReach), 0);
  int seen = 0, unseen = 0;
  map.forEachLeaf([&](const MapLeaf& leaf) {
    if (!leaf.occupied) return;
    const LeafKey& corner = leaf.key.corner;
    const octomap::ColorOcTreeNode* node = tree->search(octomap::OcTreeKey(corner.x, corner.y, corner.z));
    if (leaf.surface.observations == 0) {
      EXPECT_FALSE(node->isColorSet());
      ++unseen;
    } else {
      EXPECT_EQ(node->getColor(), octomap::ColorOcTreeNode::Color(leaf.surface.red, 20, 10));
      ++seen;
    }
  });
  EXPECT_EQ(seen, 8);
  EXPECT_GT(unseen, 100);
}

TEST(OctomapFiles, ABinaryOctreeOpensInOctomapWithTheSameStates) {
  const IorMap map = randomMap(3);
  std::istringstream in(written([&](std::ostream& out) { writeBinaryOctree(map, out); }));
  octomap::OcTree tree(0.1);
  ASSERT_TRUE(tree.readBinary(in));
  EXPECT_EQ(differingStates(tree, map.tree(), kReach), 0);
}

TEST(OctomapFiles, AMapThatIsOneFreeCubeKeepsItsStateAsBinaryOctree) {
  IorMap map;
  map.tree().ensureRoot()->setLogOdds(-1.0f);  // the whole world free: the format has no word for a lone root
  std::istringstream in(written([&](std::ostream& out) { writeBinaryOctree(map, out); }));
  octomap::OcTree tree(0.1);
  ASSERT_TRUE(tree.readBinary(in));
  EXPECT_EQ(stateAt(tree, test::octoKey(5, 40'000, 65'535)), 1);
}

TEST(OctomapFiles, AnEmptyMapGoesOutAndComesBackEmpty) {
  const TemporaryFolder folder;
  const IorMap map;
  writeFile(folder / "m.ot", written([&](std::ostream& out) { writeIorOctree(map, out); }));
  writeFile(folder / "m.bt", written([&](std::ostream& out) { writeBinaryOctree(map, out); }));
  EXPECT_EQ(readOctomap(folder / "m.ot").map.nodeCount(), 0U);
  EXPECT_EQ(readOctomap(folder / "m.bt").map.nodeCount(), 0U);
}

TEST(OctomapFiles, PaintByMemoryTellsInhibitedAttendedAndUntouchedLeavesApart) {
  constexpr Tick kNow{10};
  const LeafSurface grey{100, 100, 100, 0, 0, 0, 5};
  const Rgb untouched = paintLeaf({}, grey, kNow, LeafPaint::kIor);
  const Rgb attended = paintLeaf(IorState(30, false), grey, kNow, LeafPaint::kIor);
  const Rgb inhibited = paintLeaf(IorState(30, true), grey, kNow, LeafPaint::kIor);
  EXPECT_EQ(paintLeaf(IorState(10, true), grey, kNow, LeafPaint::kIor), untouched);  // forgotten
  EXPECT_EQ(untouched[0], untouched[2]);
  EXPECT_GT(attended[2], attended[0]);
  EXPECT_GT(inhibited[0], inhibited[2]);
  EXPECT_EQ(paintLeaf(IorState(30, true), grey, kNow, LeafPaint::kColor), (Rgb{100, 100, 100}));
}

TEST(OctomapFiles, MapsOfOtherProgramsReadAsOctomapReadsThem) {
  const std::filesystem::path data = std::filesystem::path(SACCADE_TEST_DATA_DIR) / "octomaps";
  if (!std::filesystem::exists(data)) GTEST_SKIP() << "no " << data;
  int compared = 0;
  for (const auto& entry : std::filesystem::directory_iterator(data)) {
    const std::filesystem::path path = entry.path();
    std::unique_ptr<octomap::AbstractOcTree> opened;
    if (path.extension() == ".bt") {
      auto tree = std::make_unique<octomap::OcTree>(0.1);
      ASSERT_TRUE(tree->readBinary(path.string()));
      opened = std::move(tree);
    } else if (path.extension() == ".ot") {
      opened.reset(octomap::AbstractOcTree::read(path.string()));
    } else {
      continue;
    }
    const ForeignMap ours = readOctomap(path);
    EXPECT_EQ(ours.map.nodeCount(), opened->size()) << path;
    EXPECT_DOUBLE_EQ(ours.map.config().leaf_size_m, opened->getResolution());
    std::size_t leaves = 0, different = 0;
    const auto compare = [&](const auto& tree) {
      for (auto leaf = tree.begin_leafs(), end = tree.end_leafs(); leaf != end; ++leaf) {
        ++leaves;
        const octomap::OcTreeKey key = leaf.getKey();
        const auto found = ours.map.findLeaf(LeafKey{key[0], key[1], key[2]});
        different += !found || found->occupied != tree.isNodeOccupied(*leaf) ? 1 : 0;
      }
    };
    if (const auto* color = dynamic_cast<octomap::ColorOcTree*>(opened.get())) {
      compare(*color);
    } else {
      compare(dynamic_cast<octomap::OcTree&>(*opened));
    }
    EXPECT_EQ(different, 0U) << path;
    EXPECT_EQ(leaves, ours.map.leafCount()) << path;
    ++compared;
  }
  EXPECT_EQ(compared, 7);
}

TEST(OctomapFiles, EveryTruncationIsOneClearError) {
  const TemporaryFolder folder;
  const IorMap map = randomMap(4);
  const std::vector<std::pair<std::string, std::string>> files = {
      {"m.ot", written([&](std::ostream& out) { writeIorOctree(map, out); })},
      {"m.bt", written([&](std::ostream& out) { writeBinaryOctree(map, out); })}};
  for (const auto& [name, whole] : files) {
    for (std::size_t size = 0; size < whole.size(); size += 1 + whole.size() / 300) {
      writeFile(folder / name, whole.substr(0, size));
      EXPECT_NE(complaintOf(folder / name), "") << name << " cut to " << size;
    }
    writeFile(folder / name, whole + "x");
    EXPECT_NE(complaintOf(folder / name).find("the end after the last node"), std::string::npos);
  }
}

TEST(OctomapFiles, AFileOfTheOtherKindIsNamedAsSuch) {
  const TemporaryFolder folder;
  const IorMap map = randomMap(5);
  writeFile(folder / "m.ot", written([&](std::ostream& out) { writeBinaryOctree(map, out); }));
  EXPECT_NE(complaintOf(folder / "m.ot").find("a .bt file by that name"), std::string::npos);
  writeFile(folder / "m.bt", written([&](std::ostream& out) { writeIorOctree(map, out); }));
  EXPECT_NE(complaintOf(folder / "m.bt").find("an .ot file by that name"), std::string::npos);
  writeFile(folder / "m.ot", "solid stl\n");
  EXPECT_NE(complaintOf(folder / "m.ot").find("something else"), std::string::npos);
  EXPECT_NE(complaintOf(folder / "absent.ot").find("nothing"), std::string::npos);
  EXPECT_NE(complaintOf(folder.path()).find("a folder"), std::string::npos);
}

std::string otFile(const std::string& id, const std::string& size, const std::string& res, const std::string& data) {
  return "# Octomap OcTree file\nid " + id + "\nsize " + size + "\nres " + res + "\ndata\n" + data;
}

std::string otNode(float log_odds, std::uint8_t children) {
  std::string bytes(5, '\0');
  std::memcpy(bytes.data(), &log_odds, 4);
  bytes[4] = static_cast<char>(children);
  return bytes;
}

TEST(OctomapFiles, NumbersOfAHeaderThatCannotBeTrueAreRefusedBeforeMemoryIsTaken) {
  const TemporaryFolder folder;
  const std::string node = otNode(1.0f, 0);
  const std::vector<std::pair<std::string, std::string>> files = {
      {otFile("OcTree", "4000000000", "0.05", node), "at most"},
      {otFile("OcTree", "-1", "0.05", node), "a number for \"size\""},
      {otFile("OcTree", "99999999999999999999999", "0.05", node), "a number for \"size\""},
      {otFile("OcTree", "5", "0.05", node), "at most 1 nodes"},
      {otFile("OcTree", "1", "0", node), "leaves of 0.001 to 1 m"},
      {otFile("OcTree", "1", "nan", node), "leaves of 0.001 to 1 m"},
      {otFile("OcTree", "1", "-0.05", node), "leaves of 0.001 to 1 m"},
      {otFile("SemanticOcTree", "1", "0.05", node), "SemanticOcTree"},
      {otFile("OcTree", "1", "0.05", otNode(std::nanf(""), 0)), "finite log-odds"},
      {"# Octomap OcTree file\nid OcTree\ndata\n" + node, "a header with"},
      {"# Octomap OcTree file\n" + std::string(10'000, 'a'), "a header that ends"}};
  for (const auto& [bytes, expected] : files) {
    writeFile(folder / "m.ot", bytes);
    EXPECT_NE(complaintOf(folder / "m.ot").find(expected), std::string::npos) << complaintOf(folder / "m.ot");
  }
  writeFile(folder / "m.ot", otFile("OcTree", "2", "0.05", otNode(1.0f, 1) + node));
  EXPECT_EQ(complaintOf(folder / "m.ot"), "");
  EXPECT_NE(complaintOf(folder / "m.ot", {1}).find("at most 1 nodes"), std::string::npos);
}

TEST(OctomapFiles, ATreeThatIsTooDeepIsRefused) {
  const TemporaryFolder folder;
  const auto chain = [](int inner_nodes) {
    std::string data;
    for (int depth = 0; depth < inner_nodes; ++depth) data += otNode(1.0f, 1);
    return otFile("OcTree", std::to_string(inner_nodes + 1), "0.05", data + otNode(1.0f, 0));
  };
  writeFile(folder / "m.ot", chain(16));
  EXPECT_EQ(complaintOf(folder / "m.ot"), "");
  for (const int inner_nodes : {17, 100'000}) {
    writeFile(folder / "m.ot", chain(inner_nodes));
    EXPECT_NE(complaintOf(folder / "m.ot").find("16 levels"), std::string::npos);
  }
}

TEST(OctomapFiles, FlippedBitsGiveAMapOrAnIoErrorAndNothingElse) {
  const TemporaryFolder folder;
  const IorMap map = randomMap(6);
  std::mt19937 random(7);
  for (const bool binary : {false, true}) {
    const std::string whole =
        written([&](std::ostream& out) { binary ? writeBinaryOctree(map, out) : writeIorOctree(map, out); });
    const std::filesystem::path path = folder / (binary ? "m.bt" : "m.ot");
    int refused = 0;
    for (int i = 0; i < 300; ++i) {
      std::string damaged = whole;
      char& byte = damaged[random() % damaged.size()];
      byte = static_cast<char>(byte ^ 1 << random() % 8);
      writeFile(path, damaged);
      try {
        const ForeignMap read = readOctomap(path);
        read.map.forEachLeaf([](const MapLeaf& leaf) { EXPECT_TRUE(std::isfinite(leaf.log_odds)); });
      } catch (const IoError&) {
        ++refused;
      }
    }
    EXPECT_GT(refused, 10);
  }
}

}  // namespace
}  // namespace saccade
