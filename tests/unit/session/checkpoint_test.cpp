#include <SQLiteCpp/SQLiteCpp.h>
#include <csignal>
#include <cstdlib>
#include <map>
#include <random>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include <gtest/gtest.h>

#include "saccade/core/errors.hpp"
#include "saccade/session/session_reader.hpp"
#include "saccade/session/session_repair.hpp"
#include "saccade/session/session_writer.hpp"
#include "support/temporary_folder.hpp"

namespace saccade {
namespace {

using test::TemporaryFolder;

SessionMetadata metadataAt(std::uint32_t tick) {
  SessionMetadata metadata;
  metadata.camera = {640, 480, 525.0, 525.0, 319.5, 239.5};
  metadata.leaf_size_m = 0.01;
  metadata.tick = tick;
  return metadata;
}

/// Adds frame and log row number `i`, and rewrites three blobs so that each says `i`.
void addStep(SessionWriter& writer, std::int64_t i) {
  FrameRecord frame;
  frame.index = {i};
  frame.tracking = "tracked";
  frame.tick = static_cast<std::uint32_t>(i + 1);
  writer.addFrame(frame);
  for (std::uint64_t key = 0; key < 3; ++key) {
    writer.putBlob(BlobTable::kBricks, {key, static_cast<std::uint64_t>(i), std::string(2048, static_cast<char>(i))});
  }
}

std::vector<std::uint64_t> itemsOfBricks(const SessionReader& reader) {
  std::vector<std::uint64_t> items;
  reader.visitBlobs(BlobTable::kBricks, [&](const BlobRecord& blob) { items.push_back(blob.items); });
  return items;
}

TEST(Checkpoint, ASessionIsThereFromTheFirstCommitOnAndSaysThatItIsBeingExplored) {
  const TemporaryFolder folder;
  SessionWriter writer(folder / "s.saccade", WhenSessionExists::kRefuse);
  addStep(writer, 0);
  EXPECT_FALSE(std::filesystem::exists(folder / "s.saccade"));
  writer.commit(metadataAt(1));
  EXPECT_FALSE(std::filesystem::exists(folder / "s.saccade.partial"));
  addStep(writer, 1);
  {
    const SessionReader reader(folder / "s.saccade");  // while the next step is not committed yet
    EXPECT_EQ(reader.metadata().state, SessionState::kExploring);
    EXPECT_EQ(reader.frames().size(), 1U);
    EXPECT_EQ(itemsOfBricks(reader), (std::vector<std::uint64_t>{0, 0, 0}));
  }
  writer.commit(metadataAt(2));
  EXPECT_EQ(itemsOfBricks(SessionReader(folder / "s.saccade")), (std::vector<std::uint64_t>{1, 1, 1}));
  writer.finish(metadataAt(2));
  EXPECT_EQ(SessionReader(folder / "s.saccade").metadata().state, SessionState::kComplete);
  EXPECT_FALSE(std::filesystem::exists(folder / "s.saccade-wal"));  // one plain file
}

TEST(Checkpoint, TheOldSessionStaysWholeUntilTheFirstCommitOfTheNewOne) {
  const TemporaryFolder folder;
  {
    SessionWriter old(folder / "s.saccade", WhenSessionExists::kRefuse);
    addStep(old, 0);
    old.commit(metadataAt(1));  // and not finished: it has a log beside it
  }
  SessionWriter writer(folder / "s.saccade", WhenSessionExists::kReplace);
  addStep(writer, 0);
  addStep(writer, 1);
  EXPECT_EQ(SessionReader(folder / "s.saccade").frames().size(), 1U);
  writer.commit(metadataAt(2));
  EXPECT_EQ(SessionReader(folder / "s.saccade").frames().size(), 2U);
}

TEST(Checkpoint, AWriterThatIsDroppedLeavesTheLastCommit) {
  const TemporaryFolder folder;
  {
    SessionWriter writer(folder / "s.saccade", WhenSessionExists::kRefuse);
    addStep(writer, 0);
    writer.commit(metadataAt(1));
    addStep(writer, 1);
  }
  EXPECT_EQ(SessionReader(folder / "s.saccade").frames().size(), 1U);
  const auto writer = SessionWriter::open(folder / "s.saccade");
  EXPECT_EQ(writer->nextOrdinal(), FrameOrdinal{1});
}

TEST(Checkpoint, ASecondWriterIsRefused) {
  const TemporaryFolder folder;
  SessionWriter writer(folder / "s.saccade", WhenSessionExists::kRefuse);
  EXPECT_THROW(SessionWriter(folder / "s.saccade", WhenSessionExists::kRefuse), IoError);
  addStep(writer, 0);
  writer.commit(metadataAt(1));
  EXPECT_THROW(SessionWriter(folder / "s.saccade", WhenSessionExists::kReplace), IoError);
  EXPECT_THROW((void)SessionWriter::open(folder / "s.saccade"), IoError);
  addStep(writer, 1);
  writer.finish(metadataAt(2));
  EXPECT_NO_THROW((void)SessionWriter::open(folder / "s.saccade"));
}

TEST(Checkpoint, ADiskThatFillsUpLeavesTheLastCommit) {
  const TemporaryFolder folder;
  SessionWriter writer(folder / "s.saccade", WhenSessionExists::kRefuse);
  addStep(writer, 0);
  writer.commit(metadataAt(1));

  rlimit old_limit{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &old_limit), 0);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small_limit{1 << 20, old_limit.rlim_max};  // no file of this process may grow beyond 1 MiB
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small_limit), 0);
  std::mt19937 random(1);
  std::string noise(1 << 17, '\0');
  EXPECT_THROW(
      {
        addStep(writer, 1);
        for (std::uint64_t key = 10; key < 74; ++key) {
          for (char& byte : noise) byte = static_cast<char>(random());
          writer.putBlob(BlobTable::kTiles, {key, 1, noise});
        }
        writer.commit(metadataAt(2));
      },
      IoError);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &old_limit), 0);
  std::signal(SIGXFSZ, old_handler);
  const SessionReader reader(folder / "s.saccade");
  EXPECT_EQ(reader.frames().size(), 1U);
  EXPECT_EQ(itemsOfBricks(reader), (std::vector<std::uint64_t>{0, 0, 0}));
}

/// Runs `body` in a process of its own that is not allowed to write where only root is; its exit code.
template <typename Body>
int runWithoutRights(const Body& body) {
  const pid_t child = ::fork();
  if (child == 0) {
    constexpr uid_t kNobody = 65534;
    if (::getuid() == 0 && ::setuid(kNobody) != 0) ::_exit(99);
    ::_exit(body());
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(Checkpoint, AFolderThatCannotBeWrittenIsOneError) {
  const TemporaryFolder folder;
  ::chmod(folder.path().c_str(), 0555);
  const int code = runWithoutRights([&] {
    try {
      SessionWriter writer(folder / "s.saccade", WhenSessionExists::kRefuse);
      return 0;
    } catch (const IoError& error) {
      return std::string(error.what()).find("s.saccade") != std::string::npos ? 1 : 2;
    }
  });
  ::chmod(folder.path().c_str(), 0755);
  EXPECT_EQ(code, 1);
}

TEST(Checkpoint, AFinishedSessionCanBeReadWhereNothingCanBeWritten) {
  const TemporaryFolder folder;
  {
    SessionWriter writer(folder / "s.saccade", WhenSessionExists::kRefuse);
    addStep(writer, 0);
    writer.finish(metadataAt(1));
  }
  ::chmod(folder.path().c_str(), 0555);
  const int code =
      runWithoutRights([&] { return static_cast<int>(SessionReader(folder / "s.saccade").frames().size()); });
  ::chmod(folder.path().c_str(), 0755);
  EXPECT_EQ(code, 1);
}

/// A process that writes step after step until it is killed, and reports each durable one through `report`.
[[noreturn]] void writeUntilKilled(const std::filesystem::path& path, int report) {
  try {
    SessionWriter writer(path, WhenSessionExists::kReplace);
    for (std::int64_t i = 0;; ++i) {
      addStep(writer, i);
      writer.commit(metadataAt(static_cast<std::uint32_t>(i + 1)));
      if (::write(report, &i, sizeof i) != sizeof i) ::_exit(1);
    }
  } catch (...) {
    ::_exit(2);
  }
}

TEST(Checkpoint, KillingTheWriterAtAHundredRandomMomentsLosesNothingThatWasDurable) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "s.saccade";
  std::mt19937 random(7);
  int seen = 0;
  for (int kill = 0; kill < 100; ++kill) {
    std::filesystem::remove(path);  // and what the last writer left beside it stays: it must do no harm
    int pipe[2];
    ASSERT_EQ(::pipe(pipe), 0);
    const pid_t child = ::fork();
    if (child == 0) writeUntilKilled(path, pipe[1]);
    ::close(pipe[1]);
    // Some moments before the first commit, most between two or in the middle of one.
    std::int64_t durable = -1, step = 0;
    for (unsigned wait = random() % 4; wait > 0 && ::read(pipe[0], &step, sizeof step) == sizeof step; --wait) {
      durable = step;
    }
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 30'000));
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status)) << "the writer ended by itself with " << WEXITSTATUS(status);
    while (::read(pipe[0], &step, sizeof step) == sizeof step) durable = step;
    ::close(pipe[0]);
    if (!std::filesystem::exists(path)) {
      EXPECT_EQ(durable, -1) << "kill " << kill;
      continue;
    }
    ++seen;
    const SessionReader reader(path);
    const auto frames = static_cast<std::int64_t>(reader.frames().size());
    EXPECT_GE(frames, durable + 1) << "kill " << kill;
    EXPECT_EQ(reader.metadata().tick, frames) << "kill " << kill;  // all of a commit or nothing of it
    const auto last = static_cast<std::uint64_t>(frames - 1);
    EXPECT_EQ(itemsOfBricks(reader), (std::vector<std::uint64_t>{last, last, last})) << "kill " << kill;
    EXPECT_TRUE(verifySession(path).complaints.empty()) << "kill " << kill;
  }
  EXPECT_GT(seen, 50);  // three of four kills wait for the first commit
}

}  // namespace
}  // namespace saccade
