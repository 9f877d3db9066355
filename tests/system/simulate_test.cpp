#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace saccade {
namespace {

using test::ProgramRun;
using test::runSaccade;
using test::TemporaryFolder;

std::string contentOf(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(Simulate, WritesASequenceThatExploreReads) {
  const TemporaryFolder folder;
  const ProgramRun run = runSaccade({"simulate", "desk", "-o", folder / "s", "--seed", "2", "--frames", "4"});
  ASSERT_EQ(run.exit_code, 0) << run.talk;
  const ProgramRun explored = runSaccade({"explore", folder / "s", "--poses", "dataset"});
  EXPECT_EQ(explored.exit_code, 0) << explored.talk;
  EXPECT_NE(explored.talk.find("4 tracked"), std::string::npos) << explored.talk;
}

TEST(Simulate, WritesTheSameBytesWithOneThread) {
  const TemporaryFolder folder;
  for (const char* threads : {"1", "4"}) {
    ASSERT_EQ(
        runSaccade({"simulate", "desk", "-o", folder / threads, "--range", "2:3", "--threads", threads}).exit_code, 0);
  }
  int files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder / "1")) {
    if (!entry.is_regular_file()) continue;
    const auto twin = folder / "4" / std::filesystem::relative(entry.path(), folder / "1");
    EXPECT_EQ(contentOf(entry.path()), contentOf(twin)) << twin;
    ++files;
  }
  EXPECT_EQ(files, 3 + 5);
}

TEST(Simulate, RefusesBadRequestsAndLeavesNothingBehind) {
  const TemporaryFolder folder;
  const std::string output = folder / "s";
  EXPECT_EQ(runSaccade({"simulate", "desk"}).exit_code, 2);
  EXPECT_EQ(runSaccade({"simulate", "desk", "-o", output, "--frames", "0"}).exit_code, 2);
  EXPECT_EQ(runSaccade({"simulate", "desk", "-o", output, "--range", "a"}).exit_code, 2);
  for (const char* scene : {"moon", "desk?x=1", ""}) {
    EXPECT_EQ(runSaccade({"simulate", scene, "-o", output}).exit_code, 1) << scene;
  }
  EXPECT_EQ(runSaccade({"simulate", "desk", "-o", output, "--noise", "-1"}).exit_code, 1);
  EXPECT_EQ(runSaccade({"simulate", "desk", "-o", output, "--frames", "3", "--range", "5:"}).exit_code, 1);
  EXPECT_FALSE(std::filesystem::exists(output));
}

TEST(Simulate, ReplacesAFolderOnlyWithForce) {
  const TemporaryFolder folder;
  std::ofstream(folder / "notes.txt") << "mine\n";
  const std::vector<std::string> command = {"simulate", "plain", "-o", folder.path(), "--frames", "1"};
  const ProgramRun refused = runSaccade(command);
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_NE(refused.talk.find("--force"), std::string::npos) << refused.talk;
  std::vector<std::string> forced = command;
  forced.emplace_back("--force");
  EXPECT_EQ(runSaccade(forced).exit_code, 0);
  EXPECT_EQ(contentOf(folder / "notes.txt"), "mine\n");
}

}  // namespace
}  // namespace saccade
