#include <filesystem>
#include <fstream>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "saccade/session/session_map.hpp"
#include "saccade/session/session_reader.hpp"
#include "saccade/session/session_repair.hpp"
#include "support/file_bytes.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace saccade {
namespace {

using test::ProgramRun;
using test::readFile;
using test::runSaccade;
using test::TemporaryFolder;

std::map<std::uint64_t, std::string> blobsOf(const SessionReader& session, BlobTable table) {
  std::map<std::uint64_t, std::string> blobs;
  session.visitBlobs(table, [&](const BlobRecord& blob) { blobs[blob.key] = blob.bytes; });
  return blobs;
}

void expectSameExploration(const std::filesystem::path& a_path, const std::filesystem::path& b_path) {
  const SessionReader a(a_path), b(b_path);
  for (const BlobTable table : {BlobTable::kTiles, BlobTable::kBricks, BlobTable::kAttendLog}) {
    EXPECT_TRUE(blobsOf(a, table) == blobsOf(b, table)) << "table " << static_cast<int>(table);
  }
  EXPECT_EQ(a.state("motion"), b.state("motion"));
  EXPECT_TRUE(a.state("photometric_reference") == b.state("photometric_reference"));
  const std::vector<KeyframeRecord> keyframes_a = a.keyframes(), keyframes_b = b.keyframes();
  ASSERT_EQ(keyframes_a.size(), keyframes_b.size());
  EXPECT_GT(keyframes_a.size(), 0U);
  for (std::size_t i = 0; i < keyframes_a.size(); ++i) {
    EXPECT_EQ(keyframes_a[i].ordinal, keyframes_b[i].ordinal);
    EXPECT_EQ(keyframes_a[i].T_WC.matrix(), keyframes_b[i].T_WC.matrix());
    EXPECT_EQ(keyframes_a[i].features, keyframes_b[i].features);
  }
  EXPECT_EQ(a.metadata().leaves, b.metadata().leaves);
  EXPECT_EQ(a.metadata().tick, b.metadata().tick);
  const std::vector<FrameRecord> frames_a = a.frames(), frames_b = b.frames();
  ASSERT_EQ(frames_a.size(), frames_b.size());
  for (std::size_t i = 0; i < frames_a.size(); ++i) {
    EXPECT_EQ(frames_a[i].name, frames_b[i].name);
    ASSERT_EQ(frames_a[i].T_WC.has_value(), frames_b[i].T_WC.has_value());
    if (frames_a[i].T_WC) {
      EXPECT_EQ(frames_a[i].T_WC->matrix(), frames_b[i].T_WC->matrix()) << "frame " << i;
    }
    const std::vector<CandidateRecord> candidates_a = a.candidates(frames_a[i].ordinal);
    const std::vector<CandidateRecord> candidates_b = b.candidates(frames_b[i].ordinal);
    ASSERT_EQ(candidates_a.size(), candidates_b.size());
    for (std::size_t k = 0; k < candidates_a.size(); ++k) {
      EXPECT_EQ(candidates_a[k].mask_rle, candidates_b[k].mask_rle);
      EXPECT_EQ(candidates_a[k].score, candidates_b[k].score);
      EXPECT_EQ(candidates_a[k].revisited_share, candidates_b[k].revisited_share);
    }
  }
}

/// Explores `input` at once and with a stop at `stop`, at different numbers of threads, and compares.
void expectTheLaw(const std::string& input, int stop, int end, const std::string& step) {
  const TemporaryFolder folder;
  const auto explore = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "explore");
    const ProgramRun run = runSaccade(arguments);
    ASSERT_EQ(run.exit_code, 0) << run.talk;
  };
  const std::string first_range = ":" + std::to_string(stop) + ":" + step;
  explore({input, "--range", ":" + std::to_string(end) + ":" + step, "-o", folder / "whole.saccade", "--candidates",
           folder / "whole.jsonl", "--threads", "1"});
  // A checkpoint after every frame: what is written piece by piece is the same as what is written at the end.
  explore({input, "--range", first_range, "-o", folder / "parts.saccade", "--candidates", folder / "first.jsonl",
           "--threads", "2", "--checkpoint-interval", "0"});
  explore({"--continue", folder / "parts.saccade", input, "--range",
           std::to_string(stop) + ":" + std::to_string(end) + ":" + step, "--candidates", folder / "second.jsonl",
           "--threads", "2", "--checkpoint-interval", "0"});
  expectSameExploration(folder / "whole.saccade", folder / "parts.saccade");
  EXPECT_TRUE(SessionReader(folder / "whole.saccade").state("photometric_reference").has_value());
  EXPECT_EQ(readFile(folder / "first.jsonl") + readFile(folder / "second.jsonl"), readFile(folder / "whole.jsonl"));
  EXPECT_EQ(SessionReader(folder / "parts.saccade").runs().size(), 2U);
  for (const char* name : {"whole.saccade", "parts.saccade"}) {
    const SessionFindings findings = verifySession(folder / name);
    EXPECT_TRUE(findings.complaints.empty()) << findings.complaints.front();
  }
  // The sum of the tiles' counts, against a count of the whole tree.
  const SessionReader parts(folder / "parts.saccade");
  EXPECT_EQ(parts.metadata().leaves, static_cast<std::int64_t>(loadMap(parts).leafCount()));
}

TEST(Continue, AnExplorationOfTheDeskThatStoppedGoesOnAsIfItHadNot) {
  expectTheLaw("sim:desk", 8, 14, "1");
}

TEST(Continue, AnExplorationOfARealKitchenThatStoppedGoesOnAsIfItHadNot) {
  const std::filesystem::path kitchen = std::filesystem::path(SACCADE_TEST_DATA_DIR) / "kitchen";
  if (!std::filesystem::exists(kitchen)) GTEST_SKIP() << "needs " << kitchen;
  expectTheLaw(kitchen, 20, 40, "2");
}

TEST(MapMemory, AnExplorationThatPagesItsMapIsTheSameAsOneThatKeepsIt) {
  const TemporaryFolder folder;
  const auto explore = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"explore", "--poses", "dataset", "--checkpoint-interval", "0"});
    ProgramRun run = runSaccade(arguments);
    EXPECT_EQ(run.exit_code, 0) << run.talk;
    return run.talk;
  };
  // Steps of 400 frames walk through the flat's rooms and back; leaves of 3 cm keep the test short.
  const std::vector<std::string> walk = {"sim:flat", "--set", "map.leaf_size_m=0.03", "--set", "surface.cell_m=0.03"};
  std::vector<std::string> whole = walk, paged = walk;
  whole.insert(whole.end(), {"--range", "::400", "-o", folder / "whole.saccade"});
  paged.insert(paged.end(), {"--range", ":3200:400", "-o", folder / "paged.saccade", "--map-memory", "4"});
  explore(whole);
  const std::string first = explore(paged);
  const std::string second =
      explore({"--continue", folder / "paged.saccade", "sim:flat", "--range", "3200::400", "--map-memory", "4"});
  expectSameExploration(folder / "whole.saccade", folder / "paged.saccade");
  const SessionFindings findings = verifySession(folder / "paged.saccade");
  EXPECT_TRUE(findings.complaints.empty()) << findings.complaints.front();
  for (const std::string& talk : {first, second}) {
    const std::size_t at = talk.find("map paging:");
    ASSERT_NE(at, std::string::npos) << talk;
    EXPECT_EQ(talk.find(" 0 parts dropped", at), std::string::npos) << talk;
    EXPECT_EQ(talk.find(" 0 brought back", at), std::string::npos) << talk;
  }
}

TEST(MapMemory, AResumedExplorationThatPagesItsMapIsTheSameAsOneThatKeepsIt) {
  const TemporaryFolder folder;
  const auto succeed = [](const std::vector<std::string>& arguments) {
    const ProgramRun run = runSaccade(arguments);
    EXPECT_EQ(run.exit_code, 0) << run.talk;
    return run.talk;
  };
  // Rooms of the flat, of which the camera is in one when it comes back.
  succeed({"explore", "sim:flat", "--poses", "dataset", "--set", "map.leaf_size_m=0.03", "--set", "surface.cell_m=0.03",
           "--range", ":3300:400", "-o", folder / "whole.saccade"});
  std::filesystem::copy_file(folder / "whole.saccade", folder / "paged.saccade");
  succeed({"resume", folder / "whole.saccade", "sim:flat", "--range", "3202:3208"});
  const std::string talk =
      succeed({"resume", folder / "paged.saccade", "sim:flat", "--range", "3202:3208", "--map-memory", "4"});
  expectSameExploration(folder / "whole.saccade", folder / "paged.saccade");
  const SessionFindings findings = verifySession(folder / "paged.saccade");
  EXPECT_TRUE(findings.complaints.empty()) << findings.complaints.front();
  const std::size_t at = talk.find("map paging:");
  ASSERT_NE(at, std::string::npos) << talk;
  EXPECT_EQ(talk.find(" 0 parts dropped", at), std::string::npos) << talk;
}

TEST(MaxSessionSize, ThinsKeyframeImagesThenEndsWithAllThatWasExplored) {
  const TemporaryFolder folder;
  constexpr double kLimit_MiB = 6.0;
  const ProgramRun run =
      runSaccade({"explore", "sim:desk?frames=100", "-o", folder / "s.saccade", "--poses", "dataset",
                  "--checkpoint-interval", "0", "--set", "keyframes.spacing_m=0.02", "--max-session-size", "6"});
  EXPECT_EQ(run.exit_code, 0) << run.talk;
  EXPECT_NE(run.talk.find("grown to --max-session-size"), std::string::npos) << run.talk;
  EXPECT_LE(static_cast<double>(std::filesystem::file_size(folder / "s.saccade")), kLimit_MiB * 1048576.0);
  const SessionFindings findings = verifySession(folder / "s.saccade");
  EXPECT_TRUE(findings.complaints.empty()) << findings.complaints.front();
  const SessionReader session(folder / "s.saccade");
  EXPECT_EQ(session.metadata().state, SessionState::kInterrupted);
  EXPECT_LT(session.frames().size(), 100U);
  EXPECT_EQ(session.frames().back().tick, session.metadata().tick);
  int with_images = 0;
  const std::vector<KeyframeRecord> keyframes = session.keyframes();
  for (const KeyframeRecord& keyframe : keyframes) {
    EXPECT_FALSE(keyframe.features.empty());
    if (!session.keyframe(keyframe.ordinal)->color.empty()) ++with_images;
  }
  EXPECT_LT(with_images, static_cast<int>(keyframes.size()));
}

TEST(MaxSessionSize, CountsOnlyWhatIsAddedToASessionThatIsGoneOnWith) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "s.saccade";
  ASSERT_EQ(runSaccade({"explore", "sim:desk", "--range", ":10", "-o", path}).exit_code, 0);
  const double held_MiB = static_cast<double>(std::filesystem::file_size(path)) / 1048576.0;
  // Half as much again as it holds: room for a few frames more, but not for all of it twice over.
  const ProgramRun run =
      runSaccade({"explore", "--continue", path, "sim:desk", "--range", "10:14", "--checkpoint-interval", "0",
                  "--max-session-size", std::to_string(1.5 * held_MiB + 2.0)});
  EXPECT_EQ(run.exit_code, 0) << run.talk;
  EXPECT_EQ(SessionReader(path).frames().size(), 14U) << run.talk;
  EXPECT_EQ(SessionReader(path).metadata().state, SessionState::kComplete);
}

TEST(MapMemory, NeedsASessionToPageTo) {
  const ProgramRun run = runSaccade({"explore", "sim:desk", "--range", ":1", "--map-memory", "100"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.talk.find("-o S"), std::string::npos) << run.talk;
}

TEST(Continue, GoesOnBehindTheLastFrameWithTheStepOfBefore) {
  const TemporaryFolder folder;
  ASSERT_EQ(runSaccade({"explore", "sim:desk?frames=12", "--range", ":6:2", "-o", folder / "s.saccade"}).exit_code, 0);
  const ProgramRun run = runSaccade({"explore", "--continue", folder / "s.saccade"});
  ASSERT_EQ(run.exit_code, 0) << run.talk;
  std::vector<std::int64_t> indices;
  for (const FrameRecord& frame : SessionReader(folder / "s.saccade").frames()) indices.push_back(frame.index.value);
  EXPECT_EQ(indices, (std::vector<std::int64_t>{0, 2, 4, 6, 8, 10}));
}

TEST(Continue, SettingsOfItsOwnAreRefusedAndTheSessionStays) {
  const TemporaryFolder folder;
  ASSERT_EQ(runSaccade({"explore", "sim:desk", "--range", ":2", "-o", folder / "s.saccade"}).exit_code, 0);
  const std::string before = readFile(folder / "s.saccade");
  EXPECT_EQ(runSaccade({"explore", "--continue", folder / "s.saccade", "--no-ior"}).exit_code, 2);
  EXPECT_EQ(runSaccade({"explore", "--continue", folder / "nothing.saccade", "sim:desk"}).exit_code, 1);
  EXPECT_EQ(readFile(folder / "s.saccade"), before);
}

TEST(Continue, VerifyAndRepairSayWhatTheyFound) {
  const TemporaryFolder folder;
  const std::filesystem::path shipped = std::filesystem::path(SACCADE_SOURCE_DIR) / "maps" / "coffee.saccade";
  const ProgramRun whole = runSaccade({"verify", shipped});
  EXPECT_EQ(whole.exit_code, 0) << whole.talk;
  EXPECT_NE(whole.output.find("is whole"), std::string::npos);
  std::string bytes = readFile(shipped);
  for (std::size_t i = bytes.size() / 2; i < bytes.size() / 2 + 8192; ++i) bytes[i] = 'x';
  std::ofstream(folder / "damaged.saccade", std::ios::binary) << bytes;
  const ProgramRun damaged = runSaccade({"verify", folder / "damaged.saccade"});
  EXPECT_EQ(damaged.exit_code, 1);
  EXPECT_NE(damaged.talk.find("saccade repair"), std::string::npos) << damaged.talk;
  const ProgramRun repair = runSaccade({"repair", folder / "damaged.saccade", "-o", folder / "repaired.saccade"});
  EXPECT_EQ(repair.exit_code, 0) << repair.talk;
  EXPECT_NE(repair.talk.find("kept what is whole"), std::string::npos) << repair.talk;
  EXPECT_EQ(runSaccade({"verify", folder / "repaired.saccade"}).exit_code, 0);
  EXPECT_EQ(runSaccade({"inspect", folder / "repaired.saccade"}).exit_code, 0);
}

TEST(SlowContinue, KillingTheProgramAtAHundredRandomMomentsNeverLeavesADamagedSession) {
  std::mt19937 random(5);
  int seen = 0;
  for (int kill = 0; kill < 100; ++kill) {
    const TemporaryFolder folder;
    const std::filesystem::path session = folder / "s.saccade";
    const bool before_the_first = kill % 10 == 9;
    const double after_s = static_cast<double>(random() % 1000) / 1000.0;
    const ProgramRun run =
        test::killSaccade({"explore", "sim:desk?frames=100000", "-o", session, "--checkpoint-interval", "0.05"},
                          before_the_first ? std::filesystem::path() : session, after_s);
    EXPECT_EQ(run.exit_code, 128 + 9) << run.talk;
    if (!std::filesystem::exists(session)) continue;
    ++seen;
    const SessionFindings findings = verifySession(session);
    EXPECT_TRUE(findings.complaints.empty()) << "kill " << kill << ": " << findings.complaints.front();
    EXPECT_EQ(SessionReader(folder / "s.saccade").metadata().state, SessionState::kExploring);
    if (kill % 10 != 0) continue;
    const ProgramRun on =
        runSaccade({"explore", "--continue", folder / "s.saccade", "sim:desk?frames=100000", "--range", "5000:5001"});
    EXPECT_EQ(on.exit_code, 0) << on.talk;
    EXPECT_EQ(SessionReader(folder / "s.saccade").metadata().state, SessionState::kComplete);
  }
  EXPECT_GE(seen, 90);
}

}  // namespace
}  // namespace saccade
