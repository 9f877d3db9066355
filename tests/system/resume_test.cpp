#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "saccade/map/ior_law.hpp"
#include "saccade/session/session_map.hpp"
#include "saccade/session/session_reader.hpp"
#include "saccade/sources/stamped_poses.hpp"
#include "support/file_bytes.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace saccade {
namespace {

using test::ProgramRun;
using test::readFile;
using test::runSaccade;
using test::TemporaryFolder;

bool says(const ProgramRun& run, const std::string& text) {
  return run.talk.find(text) != std::string::npos;
}

void explore(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "explore");
  const ProgramRun run = runSaccade(arguments);
  ASSERT_EQ(run.exit_code, 0) << run.talk;
}

TEST(Resume, FindsItsPlaceAndGoesOnInTheSessionsWorld) {
  // Two runs of noisy depth against surfaces that were built differently.
  constexpr double kSamePlace_m = 0.01;
  const TemporaryFolder folder;
  explore({"sim:desk", "--range", ":12", "-o", folder / "desk.saccade"});
  explore({"sim:desk", "--range", ":24", "--trajectory", folder / "whole.txt"});
  const std::uint32_t saved_tick = SessionReader(folder / "desk.saccade").metadata().tick;
  const ProgramRun run = runSaccade(
      {"resume", folder / "desk.saccade", "sim:desk", "--range", "16:24", "--trajectory", folder / "resumed.txt"});
  ASSERT_EQ(run.exit_code, 0) << run.talk;
  EXPECT_TRUE(says(run, "unlocalised"));
  EXPECT_TRUE(says(run, "tentative at frame 16"));
  EXPECT_TRUE(says(run, "verified at frame 18"));

  const SessionReader session(folder / "desk.saccade");
  ASSERT_EQ(session.runs().size(), 2U);
  const std::vector<FrameRecord> frames = session.frames();
  ASSERT_EQ(frames.size(), 12U + 6U);
  EXPECT_EQ(frames[12].index.value, 18);
  EXPECT_EQ(frames[12].tick, saved_tick + 1) << "ticks pass while the place is looked for";

  const StampedPoses whole = StampedPoses::loadStrictly(folder / "whole.txt");
  const StampedPoses resumed = StampedPoses::loadStrictly(folder / "resumed.txt");
  ASSERT_EQ(resumed.size(), 6U);
  for (std::size_t i = 0; i < resumed.size(); ++i) {
    const auto there = whole.nearest(resumed.stamp(i), 0.001);
    ASSERT_TRUE(there);
    EXPECT_LT((there->translation() - resumed.pose(i).translation()).norm(), kSamePlace_m);
  }
}

TEST(Resume, AttentionCarriesOverToTheFirstVerifiedFrame) {
  const TemporaryFolder folder;
  explore({"sim:desk", "--range", ":12", "-o", folder / "desk.saccade"});
  const IorMap saved = loadMap(SessionReader(folder / "desk.saccade"));
  ASSERT_EQ(runSaccade({"resume", folder / "desk.saccade", "sim:desk", "--range", "16:19"}).exit_code, 0);
  const IorMap after = loadMap(SessionReader(folder / "desk.saccade"));
  ASSERT_EQ(after.now().value, saved.now().value + 1) << "one frame, one tick";
  int remembered = 0, freed = 0;
  saved.forEachLeaf([&](const MapLeaf& leaf) {
    if (!inhibited(leaf.ior, saved.now())) return;
    const std::optional<MapLeaf> now = after.findLeaf(leaf.key.corner);
    ASSERT_TRUE(now);
    if (!now->occupied) {
      ++freed;  // by what the frame saw
      return;
    }
    ++remembered;
    EXPECT_TRUE(inhibited(now->ior, saved.now()));
  });
  EXPECT_GT(remembered, 1000);
  EXPECT_LT(freed, remembered / 100);
}

TEST(Resume, LeavesTheSessionAsItIsAndKeepsTheNewPartApartIfItFindsNoPlace) {
  const TemporaryFolder folder;
  explore({"sim:desk", "--range", ":6", "-o", folder / "desk.saccade"});
  const std::string before = readFile(folder / "desk.saccade");
  const ProgramRun run = runSaccade({"resume", folder / "desk.saccade", "sim:coffee", "--range", ":6", "--limit", "3"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_TRUE(says(run, "no place in")) << run.talk;
  EXPECT_TRUE(says(run, "desk-apart.saccade")) << run.talk;
  EXPECT_TRUE(readFile(folder / "desk.saccade") == before);
  EXPECT_EQ(SessionReader(folder / "desk-apart.saccade").frames().size(), 6U);

  const ProgramRun again = runSaccade({"resume", folder / "desk.saccade", "sim:coffee", "--range", ":6"});
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_TRUE(says(again, "desk-apart.saccade: expected no file yet")) << again.talk;
}

TEST(Resume, RefusesAnInputOfAnotherCameraAndAPoseThatIsNone) {
  const TemporaryFolder folder;
  explore({"sim:desk", "--range", ":2", "-o", folder / "desk.saccade"});
  const ProgramRun pose = runSaccade(
      {"resume", folder / "desk.saccade", "sim:desk", "--range", ":2", "--pose", "0", "0", "0", "0", "0", "0", "3"});
  EXPECT_EQ(pose.exit_code, 2);
  EXPECT_TRUE(says(pose, "--pose expects")) << pose.talk;
  const ProgramRun missing = runSaccade({"resume", folder / "none.saccade", "sim:desk"});
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_TRUE(says(missing, "none.saccade")) << missing.talk;
}

TEST(EvaluateRelocalisation, LocatesFramesBetweenThoseOfTheSessionAndRefusesAnotherScene) {
  const TemporaryFolder folder;
  ASSERT_EQ(runSaccade({"simulate", "desk", "--frames", "30", "-o", folder / "desk"}).exit_code, 0);
  explore({folder / "desk", "--range", "::5", "-o", folder / "desk.saccade"});
  const ProgramRun same = runSaccade({"evaluate", "--relocalisation", folder / "desk.saccade", folder / "desk",
                                      "--range", "2::10", "--truth", folder / "desk/groundtruth.txt", "--json"});
  ASSERT_EQ(same.exit_code, 0) << same.talk;
  const auto score = nlohmann::json::parse(same.output);
  EXPECT_EQ(score["known"], 3);
  EXPECT_EQ(score["known_located"], 3);
  EXPECT_EQ(score["false_accepts"], 0);
  const ProgramRun other =
      runSaccade({"evaluate", "--relocalisation", folder / "desk.saccade", "sim:coffee", "--range", "::100", "--json"});
  ASSERT_EQ(other.exit_code, 0) << other.talk;
  EXPECT_EQ(nlohmann::json::parse(other.output)["accepted"], 0);
}

TEST(SlowRelocalisation, FindsTheKitchenAgain) {
  const std::filesystem::path data = SACCADE_TEST_DATA_DIR;
  const std::filesystem::path kitchen = data / "kitchen";
  if (!std::filesystem::exists(kitchen)) GTEST_SKIP() << kitchen << " is not there";
  const TemporaryFolder folder;
  explore({kitchen, "--range", ":250", "-o", folder / "kitchen.saccade"});
  const ProgramRun later = runSaccade({"evaluate", "--relocalisation", folder / "kitchen.saccade", kitchen, "--range",
                                       "250::10", "--truth", kitchen / "groundtruth_refined.txt", "--json"});
  ASSERT_EQ(later.exit_code, 0) << later.talk;
  const auto score = nlohmann::json::parse(later.output);
  std::cout << later.output;
  EXPECT_GE(score["known_located"].get<double>(), 0.9 * score["known"].get<double>());
  EXPECT_EQ(score["false_accepts"], 0);
  for (const char* elsewhere : {"mosd/test", "ycbv/0000", "apc/shelf4"}) {
    const ProgramRun other =
        runSaccade({"evaluate", "--relocalisation", folder / "kitchen.saccade", data / elsewhere, "--json"});
    ASSERT_EQ(other.exit_code, 0) << other.talk;
    EXPECT_EQ(nlohmann::json::parse(other.output)["accepted"], 0) << elsewhere;
  }
}

}  // namespace
}  // namespace saccade
