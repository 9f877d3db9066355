#include <algorithm>
#include <filesystem>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/file_bytes.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace saccade {
namespace {

using test::ProgramRun;
using test::readFile;
using test::runSaccade;
using test::TemporaryFolder;

std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> all;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) all.push_back(line);
  return all;
}

TEST(Explore, TheDeskGivesASessionATrajectoryCandidatesPicturesAndAVideo) {
  const TemporaryFolder folder;
  const ProgramRun run =
      runSaccade({"explore", "sim:desk", "--range", ":12", "-o", folder / "s.saccade", "--trajectory", folder / "t.txt",
                  "--candidates", folder / "c.jsonl", "--frames-dir", folder / "frames", "--video", folder / "v.mp4"});
  ASSERT_EQ(run.exit_code, 0) << run.talk;
  EXPECT_EQ(run.output, "");  // data only on stdout, and none was asked for

  EXPECT_EQ(lines(readFile(folder / "t.txt")).size(), 13U);  // a heading and twelve poses
  const std::vector<std::string> candidates = lines(readFile(folder / "c.jsonl"));
  ASSERT_EQ(candidates.size(), 12U);
  for (const std::string& line : candidates) {
    const nlohmann::json frame = nlohmann::json::parse(line);
    EXPECT_EQ(frame["tracking"], "tracked");
    ASSERT_FALSE(frame["candidates"].empty());
    double last_score = 1.0;
    int expected_rank = 0;
    for (const auto& candidate : frame["candidates"]) {
      if (candidate["inhibited"].get<bool>()) {
        EXPECT_TRUE(candidate["rank"].is_null());
        continue;
      }
      EXPECT_EQ(candidate["rank"], expected_rank);
      EXPECT_EQ(candidate["attended"].get<bool>(), expected_rank < 20);
      EXPECT_LE(candidate["score"].get<double>(), last_score);
      last_score = candidate["score"];
      ++expected_rank;
      EXPECT_EQ(candidate["box"].size(), 4U);
      EXPECT_TRUE(candidate["box3d"].is_null() || candidate["box3d"].size() == 6U);
    }
    EXPECT_LE(expected_rank, 255);
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder / "frames"), {}), 12);
  EXPECT_GT(std::filesystem::file_size(folder / "v.mp4"), 10'000U);

  const ProgramRun inspect = runSaccade({"inspect", folder / "s.saccade", "--json"});
  ASSERT_EQ(inspect.exit_code, 0) << inspect.talk;
  const nlohmann::json summary = nlohmann::json::parse(inspect.output);
  EXPECT_EQ(summary["frames"]["tracked"], 12);
  EXPECT_EQ(summary["map"]["tick"], 12);
  EXPECT_GT(summary["map"]["leaves"].get<int>(), 10'000);
  EXPECT_GT(summary["attention"]["attended_candidates"].get<int>(), 12);
}

TEST(Explore, GivesTheSameBytesAtOneAndTwoThreads) {
  const TemporaryFolder folder;
  for (const std::string threads : {"1", "2"}) {
    const ProgramRun run = runSaccade({"explore", "sim:desk", "--range", ":8", "--threads", threads, "--trajectory",
                                       folder / ("t" + threads), "--candidates", folder / ("c" + threads)});
    ASSERT_EQ(run.exit_code, 0) << run.talk;
  }
  EXPECT_EQ(readFile(folder / "t1"), readFile(folder / "t2"));
  EXPECT_EQ(readFile(folder / "c1"), readFile(folder / "c2"));
  EXPECT_GT(readFile(folder / "c1").size(), 10'000U);
}

TEST(Explore, CtrlCSavesWhatThereIsAndEndsCleanly) {
  const TemporaryFolder folder;
  const ProgramRun run = runSaccade({"explore", "sim:desk?frames=100000", "-o", folder / "s.saccade"}, 3.0);
  EXPECT_EQ(run.exit_code, 0) << run.talk;
  const ProgramRun inspect = runSaccade({"inspect", folder / "s.saccade", "--json"});
  ASSERT_EQ(inspect.exit_code, 0) << inspect.talk;
  const nlohmann::json summary = nlohmann::json::parse(inspect.output);
  EXPECT_EQ(summary["state"], "interrupted");
  EXPECT_GT(summary["frames"]["processed"].get<int>(), 0);
}

TEST(Explore, AnExistingSessionIsRefusedByNameAndStaysAsItIs) {
  const TemporaryFolder folder;
  const std::vector<std::string> command = {"explore", "sim:desk", "--range", ":2", "-o", folder / "s.saccade"};
  ASSERT_EQ(runSaccade(command).exit_code, 0);
  const std::string before = readFile(folder / "s.saccade");
  const ProgramRun refused = runSaccade(command);
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_NE(refused.talk.find("s.saccade"), std::string::npos) << refused.talk;
  EXPECT_NE(refused.talk.find("--force"), std::string::npos) << refused.talk;
  EXPECT_EQ(readFile(folder / "s.saccade"), before);
  std::vector<std::string> forced = command;
  forced.push_back("--force");
  EXPECT_EQ(runSaccade(forced).exit_code, 0);
}

TEST(Explore, WithoutInhibitionNothingIsInhibited) {
  const TemporaryFolder folder;
  const auto inhibitedIn = [&](const std::vector<std::string>& more) {
    std::vector<std::string> command = {"explore", "sim:desk", "--range", ":20", "--candidates", folder / "c"};
    command.insert(command.end(), more.begin(), more.end());
    const ProgramRun run = runSaccade(command);
    EXPECT_EQ(run.exit_code, 0) << run.talk;
    int inhibited = 0;
    for (const std::string& line : lines(readFile(folder / "c"))) {
      const nlohmann::json frame = nlohmann::json::parse(line);
      for (const auto& candidate : frame["candidates"]) inhibited += candidate["inhibited"].get<bool>() ? 1 : 0;
    }
    return inhibited;
  };
  EXPECT_GT(inhibitedIn({}), 0);
  EXPECT_EQ(inhibitedIn({"--no-ior"}), 0);
}

TEST(Inspect, OpensEverySessionOfTheMapsFolder) {
  int sessions = 0;
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(SACCADE_SOURCE_DIR) / "maps")) {
    if (entry.path().extension() != ".saccade") continue;
    ++sessions;
    const ProgramRun inspect = runSaccade({"inspect", entry.path(), "--json"});
    ASSERT_EQ(inspect.exit_code, 0) << inspect.talk;
    const nlohmann::json summary = nlohmann::json::parse(inspect.output);
    EXPECT_GT(summary["map"]["leaves"].get<int>(), 0) << entry.path();
    EXPECT_GT(summary["attention"]["attended_candidates"].get<int>(), 0) << entry.path();
  }
  EXPECT_GE(sessions, 1);
}

TEST(Explore, GivenPosesAreBelieved) {
  const TemporaryFolder folder;
  ASSERT_EQ(runSaccade({"explore", "sim:desk", "--range", ":6", "--poses", "dataset", "--trajectory", folder / "t"})
                .exit_code,
            0);
  const ProgramRun again =
      runSaccade({"explore", "sim:desk", "--range", ":6", "--poses", folder / "t", "--trajectory", folder / "t2"});
  ASSERT_EQ(again.exit_code, 0) << again.talk;
  // Written with seven decimals, read, normalised and written again: equal to the last decimal or next to it.
  std::istringstream first(readFile(folder / "t")), second(readFile(folder / "t2"));
  std::string heading;
  std::getline(first, heading);
  std::getline(second, heading);
  double a = 0.0, b = 0.0;
  int values = 0;
  while (first >> a && second >> b) {
    EXPECT_NEAR(a, b, 2e-7);
    ++values;
  }
  EXPECT_EQ(values, 6 * 8);
}

}  // namespace
}  // namespace saccade
