#include <SQLiteCpp/SQLiteCpp.h>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>
#include <opencv2/imgproc.hpp>

#include "saccade/discovery/coco_rle.hpp"
#include "saccade/exchange/mrpt_scene.hpp"
#include "saccade/session/session_map.hpp"
#include "support/file_bytes.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"
#include "support/tools.hpp"

namespace saccade {
namespace {

using test::hasTool;
using test::ProgramRun;
using test::readFile;
using test::runSaccade;
using test::succeeds;
using test::TemporaryFolder;

/// The small sessions that lie in the project: a desk, and the same after an object was moved.
const std::string kBefore = SACCADE_SOURCE_DIR "/maps/desk_before.saccade";
const std::string kAfter = SACCADE_SOURCE_DIR "/maps/desk_after.saccade";

/// A file exported from the desk.
std::string exported(const TemporaryFolder& folder, const std::string& name, std::vector<std::string> more = {}) {
  const std::string path = folder / name;
  std::vector<std::string> command = {"export", kBefore, path};
  command.insert(command.end(), more.begin(), more.end());
  const ProgramRun run = runSaccade(command);
  EXPECT_EQ(run.exit_code, 0) << run.talk;
  EXPECT_EQ(run.output, "");
  return path;
}

std::size_t occupiedLeaves(const std::string& session) {
  return loadMap(SessionReader(session)).occupiedLeafCount();
}

TEST(Export, OctomapsOwnToolsTakeTheOctrees) {
  if (!hasTool("convert_octree")) GTEST_SKIP() << "no octomap-tools";
  const TemporaryFolder folder;
  const std::string bt = exported(folder, "m.bt"), color = exported(folder, "c.ot", {"--to", "color-ot"});
  ASSERT_TRUE(succeeds("convert_octree " + bt + " " + (folder / "of_bt.ot").string()));
  ASSERT_TRUE(succeeds("convert_octree " + color + " " + (folder / "of_color.bt").string()));
  // What they made of either comes back as the same map.
  for (const std::string name : {"of_bt.ot", "of_color.bt"}) {
    ASSERT_EQ(runSaccade({"import", folder / name, "-o", folder / (name + ".saccade")}).exit_code, 0) << name;
    ASSERT_EQ(runSaccade({"export", folder / (name + ".saccade"), folder / (name + ".again.bt")}).exit_code, 0) << name;
    EXPECT_EQ(readFile(folder / (name + ".again.bt")), readFile(bt)) << name;
  }
}

TEST(Export, PaintByMemoryShowsInTheColourOctree) {
  const TemporaryFolder folder;
  std::set<std::string> paints;
  for (const std::string paint : {"color", "ior"}) {
    const std::string path = exported(folder, paint + ".ot", {"--to", "color-ot", "--paint", paint});
    const std::unique_ptr<octomap::AbstractOcTree> tree(octomap::AbstractOcTree::read(path));
    ASSERT_NE(dynamic_cast<octomap::ColorOcTree*>(tree.get()), nullptr);
    paints.insert(readFile(path));
  }
  EXPECT_EQ(paints.size(), 2U);
}

TEST(Export, PclsOwnToolsTakeThePoints) {
  if (!hasTool("pcl_ply2pcd") || !hasTool("pcl_convert_pcd_ascii_binary")) GTEST_SKIP() << "no pcl-tools";
  const TemporaryFolder folder;
  const std::string ply = exported(folder, "m.ply"), pcd = exported(folder, "m.pcd");
  const std::string points = "POINTS " + std::to_string(occupiedLeaves(kBefore)) + "\n";
  EXPECT_NE(readFile(pcd).find(points), std::string::npos);
  ASSERT_TRUE(succeeds("pcl_ply2pcd " + ply + " " + (folder / "of_ply.pcd").string()));
  EXPECT_NE(readFile(folder / "of_ply.pcd").find(points), std::string::npos);
  ASSERT_TRUE(succeeds("pcl_convert_pcd_ascii_binary " + pcd + " " + (folder / "ascii.pcd").string() + " 0"));
  const std::string ascii = readFile(folder / "ascii.pcd");
  EXPECT_NE(ascii.find("normal_x normal_y normal_z rgb ior_weight ior_flag"), std::string::npos);
}

TEST(Export, TheTrajectoryIsThatOfTheTrackedFrames) {
  const TemporaryFolder folder;
  const std::string text = readFile(exported(folder, "t.txt"));
  std::size_t tracked = 0;
  for (const FrameRecord& frame : SessionReader(kBefore).frames()) tracked += frame.tracking == "tracked" ? 1 : 0;
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), static_cast<std::ptrdiff_t>(tracked + 1));  // and a heading
}

TEST(Export, TheCandidatesAreACocoDataset) {
  const TemporaryFolder folder;
  const nlohmann::json coco = nlohmann::json::parse(readFile(exported(folder, "c.json")));
  std::set<int> images, annotations;
  for (const auto& image : coco["images"]) {
    EXPECT_TRUE(images.insert(image["id"].get<int>()).second);
    EXPECT_TRUE(image["file_name"].is_string());
    EXPECT_EQ(image["width"], 640);
    EXPECT_EQ(image["height"], 480);
    EXPECT_EQ(image["T_WC"].size(), 16U);
  }
  ASSERT_EQ(coco["categories"].size(), 1U);
  for (const auto& annotation : coco["annotations"]) {
    EXPECT_TRUE(annotations.insert(annotation["id"].get<int>()).second);
    EXPECT_TRUE(images.contains(annotation["image_id"].get<int>()));
    EXPECT_EQ(annotation["category_id"], coco["categories"][0]["id"]);
    EXPECT_EQ(annotation["iscrowd"], 0);
    EXPECT_EQ(annotation["segmentation"]["size"], nlohmann::json({480, 640}));
    const cv::Mat1b mask = decodeCocoRle(annotation["segmentation"]["counts"].get<std::string>(), {640, 480});
    EXPECT_EQ(cv::countNonZero(mask), annotation["area"].get<int>());
    const cv::Rect box = cv::boundingRect(mask);
    EXPECT_EQ(annotation["bbox"], nlohmann::json({box.x, box.y, box.width, box.height}));
  }
  EXPECT_GT(images.size(), 1U);
  EXPECT_GT(annotations.size(), images.size());
}

TEST(Export, ObjectsAreAFolderOfPoints) {
  const TemporaryFolder folder;
  const std::string path = exported(folder, "objects", {"--to", "objects"});
  const ProgramRun listed = runSaccade({"inspect", kBefore, "objects", "--json"});
  ASSERT_EQ(listed.exit_code, 0) << listed.talk;
  std::size_t with_leaves = 0;
  const nlohmann::json list = nlohmann::json::parse(listed.output);
  for (const auto& object : list["objects"]) {
    if (object["leaves"].get<int>() == 0) continue;
    ++with_leaves;
    char name[32];
    std::snprintf(name, sizeof name, "object-%04d.ply", object["id"].get<int>());
    EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(path) / name)) << name;
  }
  EXPECT_GT(with_leaves, 0U);
}

TEST(Export, AFloorPlanIsAPictureAndAYamlFile) {
  const TemporaryFolder folder;
  const std::string picture = readFile(exported(folder, "plan.pgm", {"--cell", "0.02", "--height-band", "0", "2"}));
  EXPECT_EQ(picture.substr(0, 3), "P5\n");
  EXPECT_NE(picture.find('\0'), std::string::npos);  // something is occupied
  EXPECT_NE(readFile(folder / "plan.yaml").find("image: plan.pgm\n"), std::string::npos);
}

TEST(Export, AFileThatExistsAnUnknownKindAndAnAbsentSessionAreRefused) {
  const TemporaryFolder folder;
  const std::string path = exported(folder, "m.bt");
  const std::string before = readFile(path);
  EXPECT_EQ(runSaccade({"export", kAfter, path}).exit_code, 1);
  EXPECT_EQ(readFile(path), before);
  EXPECT_EQ(runSaccade({"export", kAfter, path, "--force"}).exit_code, 0);
  EXPECT_NE(readFile(path), before);
  EXPECT_EQ(runSaccade({"export", kBefore, folder / "m.xyz"}).exit_code, 2);
  EXPECT_EQ(runSaccade({"export", folder / "absent.saccade", folder / "n.bt"}).exit_code, 1);
  EXPECT_FALSE(std::filesystem::exists(folder / "n.bt"));
}

TEST(Import, WhatWasExportedComesBackAsItWas) {
  const TemporaryFolder folder;
  const std::string ot = exported(folder, "m.ot");
  const ProgramRun run = runSaccade({"import", ot, "-o", folder / "back.saccade"});
  ASSERT_EQ(run.exit_code, 0) << run.talk;
  ASSERT_EQ(runSaccade({"export", folder / "back.saccade", folder / "again.ot"}).exit_code, 0);
  EXPECT_EQ(readFile(folder / "again.ot"), readFile(ot));
  const ProgramRun inspect = runSaccade({"inspect", folder / "back.saccade", "--json"});
  EXPECT_EQ(inspect.exit_code, 0) << inspect.talk;
}

TEST(Import, TheOtherKindByAWrongNameIsOneClearError) {
  const TemporaryFolder folder;
  std::filesystem::copy(exported(folder, "m.bt"), folder / "wrong.ot");
  const ProgramRun run = runSaccade({"import", folder / "wrong.ot", "-o", folder / "s.saccade"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.talk.find("rename it to .bt"), std::string::npos) << run.talk;
  EXPECT_FALSE(std::filesystem::exists(folder / "s.saccade"));
}

/// The object that most leaves are inhibited of.
nlohmann::json mostInhibited(const std::string& session) {
  const ProgramRun run = runSaccade({"inspect", session, "objects", "--json"});
  EXPECT_EQ(run.exit_code, 0) << run.talk;
  nlohmann::json best;
  const nlohmann::json list = nlohmann::json::parse(run.output);
  for (const auto& object : list["objects"]) {
    if (best.is_null() || object["inhibited"] > best["inhibited"]) best = object;
  }
  return best;
}

TEST(Why, SaysWhichLooksInhibitAnObjectAndUntilWhen) {
  const nlohmann::json object = mostInhibited(kBefore);
  ASSERT_GT(object["inhibited"].get<int>(), 0);
  const std::string id = std::to_string(object["id"].get<int>());
  const ProgramRun run = runSaccade({"inspect", kBefore, "why", id, "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.talk;
  const nlohmann::json why = nlohmann::json::parse(run.output);
  EXPECT_EQ(why["looks"].size(), object["times_seen"].get<std::size_t>());
  EXPECT_FALSE(why["flags_on"].empty());
  EXPECT_GT(why["first_forgotten_at_tick"].get<int>(), why["tick"].get<int>());
  EXPECT_NE(runSaccade({"inspect", kBefore, "why", id}).output.find("it will be forgotten"), std::string::npos);
  EXPECT_EQ(runSaccade({"inspect", kBefore, "why", "999999"}).exit_code, 2);
}

TEST(Objects, LieInTheSessionForAnySqliteProgram) {
  SQLite::Database db(kBefore, SQLite::OPEN_READONLY);
  const ProgramRun run = runSaccade({"inspect", kBefore, "objects", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.talk;
  const nlohmann::json objects = nlohmann::json::parse(run.output)["objects"];
  EXPECT_EQ(db.execAndGet("SELECT count(*) FROM objects").getInt(), static_cast<int>(objects.size()));
  for (const auto& object : objects) {
    SQLite::Statement row(db,
                          "SELECT times_seen, leaves, (SELECT count(*) FROM object_looks WHERE object = id), "
                          "(SELECT name FROM frames WHERE ordinal = best_ordinal) FROM objects WHERE id = ?");
    row.bind(1, object["id"].get<int>());
    ASSERT_TRUE(row.executeStep());
    EXPECT_EQ(row.getColumn(0).getInt(), object["times_seen"].get<int>());
    EXPECT_EQ(row.getColumn(1).getInt(), object["leaves"].get<int>());
    EXPECT_EQ(row.getColumn(2).getInt(), object["times_seen"].get<int>());
    EXPECT_EQ(row.getColumn(3).getString(), object["best_view"]["frame"].get<std::string>());
  }
}

TEST(Forget, AnObjectIsForgottenAndTheRestIsNot) {
  const TemporaryFolder folder;
  const std::string session = folder / "s.saccade";
  std::filesystem::copy(kBefore, session);
  const std::size_t leaves = loadMap(SessionReader(session)).leafCount();
  const nlohmann::json object = mostInhibited(session);
  const std::string id = std::to_string(object["id"].get<int>());
  const auto inhibitedLeaves = [&] {
    std::size_t count = 0;
    const IorMap map = loadMap(SessionReader(session));
    map.forEachLeaf([&](const MapLeaf& leaf) { count += inhibited(leaf.ior, map.now()) ? 1 : 0; });
    return count;
  };
  const auto attendedLeaves = [&] {
    std::size_t count = 0;
    loadMap(SessionReader(session)).forEachLeaf([&](const MapLeaf& leaf) { count += wasAttended(leaf.ior) ? 1 : 0; });
    return count;
  };
  const std::size_t before = inhibitedLeaves();
  const ProgramRun run = runSaccade({"forget", session, "--id", id});
  ASSERT_EQ(run.exit_code, 0) << run.talk;
  EXPECT_EQ(inhibitedLeaves(), before - object["inhibited"].get<std::size_t>());
  EXPECT_EQ(loadMap(SessionReader(session)).leafCount(), leaves);
  const ProgramRun why = runSaccade({"inspect", session, "why", id, "--json"});
  const nlohmann::json answer = nlohmann::json::parse(why.output);
  EXPECT_EQ(answer["inhibited"], 0);
  ASSERT_EQ(answer["forgotten_by_hand"].size(), 1U);
  EXPECT_EQ(answer["forgotten_by_hand"][0]["what"], "object " + id);

  EXPECT_EQ(runSaccade({"forget", session, "--box", "9", "9", "9", "10", "10", "10"}).exit_code, 0);
  EXPECT_GT(inhibitedLeaves(), 0U);
  EXPECT_GT(attendedLeaves(), 0U);
  EXPECT_EQ(runSaccade({"forget", session, "--all"}).exit_code, 0);
  EXPECT_EQ(inhibitedLeaves(), 0U);
  EXPECT_EQ(attendedLeaves(), 0U) << "also what attention had forgotten by itself is new again";
}

TEST(Forget, WantsExactlyOneSelectionAndASessionThatIsThere) {
  EXPECT_EQ(runSaccade({"forget", kBefore}).exit_code, 2);
  EXPECT_EQ(runSaccade({"forget", kBefore, "--all", "--id", "1"}).exit_code, 2);
  EXPECT_EQ(runSaccade({"forget", kBefore + ".absent", "--all"}).exit_code, 1);
}

TEST(Diff, TheObjectThatWasMovedIsFoundWithItsWay) {
  const TemporaryFolder folder;
  const ProgramRun run = runSaccade({"diff", kBefore, kAfter, "--json", "--ply", folder / "d.ply"});
  ASSERT_EQ(run.exit_code, 0) << run.talk;
  const nlohmann::json difference = nlohmann::json::parse(run.output);
  bool moved = false;
  constexpr double kWay_m = 0.25, kTwoLeaves_m = 0.04;  // what was seen of it differs by the view
  for (const auto& change : difference["changes"]) {
    if (change["change"] != "moved") continue;
    moved |= std::abs(change["distance_m"].get<double>() - kWay_m) < kTwoLeaves_m;
  }
  EXPECT_TRUE(moved) << run.output;
  EXPECT_GT(std::filesystem::file_size(folder / "d.ply"), 10'000U);
}

TEST(Diff, ASessionHasNotChangedAgainstItself) {
  const ProgramRun run = runSaccade({"diff", kBefore, kBefore, "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.talk;
  const nlohmann::json difference = nlohmann::json::parse(run.output);
  EXPECT_TRUE(difference["changes"].empty());
  EXPECT_EQ(difference["attention"]["gained"], 0);
}

TEST(Merge, HoldsWhatBothSessionsHoldAndLiftsAttentionWhereTheyDisagree) {
  const TemporaryFolder folder;
  const std::string merged = folder / "m.saccade";
  const ProgramRun run = runSaccade({"merge", kBefore, kAfter, "-o", merged});
  ASSERT_EQ(run.exit_code, 0) << run.talk;
  const SessionReader a(kBefore), b(kAfter), c(merged);
  EXPECT_EQ(c.frames().size(), a.frames().size() + b.frames().size());
  EXPECT_EQ(c.candidateCount(), a.candidateCount() + b.candidateCount());
  EXPECT_EQ(c.metadata().tick, a.metadata().tick + b.metadata().tick);
  EXPECT_EQ(loadAttendLog(c).tickCount(), loadAttendLog(a).tickCount() + loadAttendLog(b).tickCount());
  EXPECT_EQ(c.runs().size(), 2U);
  const ProgramRun objects = runSaccade({"inspect", merged, "objects", "--json"});
  EXPECT_EQ(objects.exit_code, 0) << objects.talk;
  EXPECT_EQ(runSaccade({"merge", kBefore, kAfter, "-o", merged}).exit_code, 1);  // it exists
}

}  // namespace
}  // namespace saccade
