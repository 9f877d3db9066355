#include "saccade/exchange/output_file.hpp"

#include <csignal>
#include <string>
#include <sys/resource.h>

#include <gtest/gtest.h>

#include "saccade/core/errors.hpp"
#include "support/file_bytes.hpp"
#include "support/temporary_folder.hpp"

namespace saccade {
namespace {

using test::readFile;
using test::TemporaryFolder;

TEST(OutputFile, AppearsWholeAndOnlyWhenItIsFinished) {
  const TemporaryFolder folder;
  OutputFile file(folder / "x.ply", WhenFileExists::kRefuse);
  file.stream() << "whole";
  EXPECT_FALSE(std::filesystem::exists(folder / "x.ply"));
  file.finish();
  EXPECT_EQ(readFile(folder / "x.ply"), "whole");
  EXPECT_FALSE(std::filesystem::exists(file.partialPath()));
}

TEST(OutputFile, WhatIsNotFinishedLeavesTheOldFileAndNothingElse) {
  const TemporaryFolder folder;
  std::ofstream(folder / "x.ply") << "old";
  { OutputFile(folder / "x.ply", WhenFileExists::kReplace).stream() << "half"; }
  EXPECT_EQ(readFile(folder / "x.ply"), "old");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(OutputFile, RefusesAFileThatExistsAFolderAndAPlaceThatIsNotThere) {
  const TemporaryFolder folder;
  std::ofstream(folder / "x.ply") << "old";
  EXPECT_THROW(OutputFile(folder / "x.ply", WhenFileExists::kRefuse), IoError);
  EXPECT_THROW(OutputFile(folder.path(), WhenFileExists::kReplace), IoError);
  EXPECT_THROW(OutputFile(folder / "absent/x.ply", WhenFileExists::kReplace), IoError);
}

TEST(OutputFile, AFullDiskIsAnErrorThatLeavesTheOldFile) {
  const TemporaryFolder folder;
  std::ofstream(folder / "x.ply") << "old";
  const auto before = std::signal(SIGXFSZ, SIG_IGN);
  rlimit limit{};
  getrlimit(RLIMIT_FSIZE, &limit);
  const rlimit small{100'000, limit.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);  // writes beyond it fail as on a full disk
  {
    OutputFile file(folder / "x.ply", WhenFileExists::kReplace);
    file.stream() << std::string(1'000'000, 'x');
    EXPECT_THROW(file.finish(), IoError);
  }
  setrlimit(RLIMIT_FSIZE, &limit);
  std::signal(SIGXFSZ, before);
  EXPECT_EQ(readFile(folder / "x.ply"), "old");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

}  // namespace
}  // namespace saccade
