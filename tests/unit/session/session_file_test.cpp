#include <SQLiteCpp/SQLiteCpp.h>
#include <csignal>
#include <fstream>
#include <functional>
#include <random>
#include <sys/resource.h>

#include <gtest/gtest.h>

#include "saccade/core/errors.hpp"
#include "saccade/session/session_reader.hpp"
#include "saccade/session/session_writer.hpp"
#include "session/blob_codec.hpp"
#include "session/keyframe_images.hpp"
#include "session/session_database.hpp"
#include "support/file_bytes.hpp"
#include "support/temporary_folder.hpp"

namespace saccade {
namespace {

using test::readFile;
using test::TemporaryFolder;

void writeFile(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

std::string randomBytes(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::string bytes(count, '\0');
  for (char& byte : bytes) byte = static_cast<char>(random());
  return bytes;
}

FrameRecord exampleFrame(std::int64_t index) {
  FrameRecord frame;
  frame.index = {index};
  frame.name = "frame-" + std::to_string(index);
  frame.stamp_s = static_cast<double>(index) / 30.0;
  frame.tracking = "tracked";
  frame.T_WC = Pose(Eigen::Translation3d(0.1, -0.2, 0.3 * static_cast<double>(index)) *
                    Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitY()));
  frame.inlier_share = 0.9;
  frame.rms_m = 0.004;
  frame.tick = static_cast<std::uint32_t>(index + 1);
  frame.open = 100;
  frame.inhibited = 7;
  frame.attended = 20;
  frame.processing_ms = 33.0;
  return frame;
}

CandidateRecord exampleCandidate(FrameOrdinal frame, int rank) {
  CandidateRecord candidate;
  candidate.frame = frame;
  candidate.rank = rank;
  candidate.score = 0.75;
  candidate.source = "depth";
  candidate.box = {10, 20, 30, 40};
  candidate.box3d_m = {-1.0, -0.5, 0.25, 1.0, 0.5, 0.75};
  candidate.mask_rle = "abc\\`123";
  candidate.features = {1.0, 2.5, -3.0};
  candidate.revisited_share = 0.25;
  return candidate;
}

RunRecord exampleRun() {
  RunRecord run;
  run.input = "sim:desk";
  run.input_kind = "simulated scene";
  run.started_utc = "2026-01-02T03:04:05Z";
  run.saccade_version = "0.1.0";
  return run;
}

KeyframeRecord exampleKeyframe() {
  KeyframeRecord keyframe;
  keyframe.ordinal = {1};
  // Of a rotation whose entries do not survive a quaternion bit by bit.
  keyframe.T_WC =
      Pose(Eigen::Translation3d(0.1, -0.2, 0.3) * Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.1, 0.9, -0.3).normalized()));
  keyframe.color.create(480, 640);
  keyframe.depth_m.create(480, 640);
  for (int v = 0; v < 480; ++v) {
    for (int u = 0; u < 640; ++u) {
      keyframe.color(v, u) = cv::Vec3b(static_cast<uchar>(u / 4), static_cast<uchar>(v / 4), 100);
      keyframe.depth_m(v, u) = u < 10 ? 0.0F : 0.5F + 0.01F * static_cast<float>(v);
    }
  }
  keyframe.features = randomBytes(10'000, 3);
  return keyframe;
}

SessionMetadata exampleMetadata() {
  SessionMetadata metadata;
  metadata.saccade_version = "0.1.0";
  metadata.created_utc = "2026-01-02T03:04:05Z";
  metadata.input = "a \"quoted\" folder";
  metadata.input_kind = "TUM folder";
  metadata.config_yaml = "map:\n  leaf_size: 0.01\n";
  metadata.camera = {640, 480, 525.5, 526.5, 319.25, 239.75};
  metadata.leaf_size_m = 0.01;
  metadata.tick = 2;
  metadata.leaves = 123456789012;
  metadata.frames_read = 2;
  metadata.frames_skipped = 1;
  metadata.state = SessionState::kInterrupted;
  return metadata;
}

void writeExample(const std::filesystem::path& path, WhenSessionExists when_exists = WhenSessionExists::kRefuse) {
  SessionWriter writer(path, when_exists);
  writer.addRun(exampleRun());
  writer.addKeyframe(exampleKeyframe());
  for (int i = 0; i < 2; ++i) {
    const FrameOrdinal ordinal = writer.addFrame(exampleFrame(i));
    writer.addMetrics({ordinal, {{"track", 5.5}, {"rank", 0.25}}});
    writer.addCandidate(exampleCandidate(ordinal, 0));
  }
  FrameRecord lost = exampleFrame(2);
  lost.tracking = "lost";
  lost.T_WC.reset();
  writer.addFrame(lost);
  writer.putBlob(BlobTable::kTiles, {7, 3, randomBytes(100'000, 1)});
  writer.putBlob(BlobTable::kTiles, {std::uint64_t{1} << 48, 0, ""});
  writer.finish(exampleMetadata());
}

TEST(SessionFile, GivesBackAllThatWasWritten) {
  const TemporaryFolder folder;
  writeExample(folder / "s.saccade");
  EXPECT_FALSE(std::filesystem::exists(folder / "s.saccade.partial"));

  const SessionReader reader(folder / "s.saccade");
  const SessionMetadata& metadata = reader.metadata();
  EXPECT_EQ(metadata.input, exampleMetadata().input);
  EXPECT_EQ(metadata.config_yaml, exampleMetadata().config_yaml);
  EXPECT_EQ(metadata.camera, exampleMetadata().camera);
  EXPECT_EQ(metadata.leaves, exampleMetadata().leaves);
  EXPECT_EQ(metadata.state, SessionState::kInterrupted);

  const std::vector<FrameRecord> frames = reader.frames();
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[1].name, "frame-1");
  ASSERT_TRUE(frames[1].T_WC.has_value());
  constexpr double kRoundOff = 1e-12;  // the quaternion is normalised again
  EXPECT_TRUE(frames[1].T_WC->isApprox(*exampleFrame(1).T_WC, kRoundOff));
  EXPECT_EQ(frames[1].inhibited, 7);
  EXPECT_EQ(frames[1].processing_ms, 33.0);
  EXPECT_EQ(frames[2].tracking, "lost");
  EXPECT_FALSE(frames[2].T_WC.has_value());

  EXPECT_EQ(reader.candidateCount(), 2);
  const std::vector<CandidateRecord> candidates = reader.candidates({1});
  ASSERT_EQ(candidates.size(), 1U);
  EXPECT_EQ(candidates[0].box, cv::Rect(10, 20, 30, 40));
  EXPECT_EQ(candidates[0].box3d_m, exampleCandidate({1}, 0).box3d_m);
  EXPECT_EQ(candidates[0].mask_rle, "abc\\`123");
  EXPECT_EQ(candidates[0].features, exampleCandidate({1}, 0).features);
  EXPECT_EQ(candidates[0].revisited_share, 0.25);

  const std::vector<RunRecord> runs = reader.runs();
  ASSERT_EQ(runs.size(), 1U);
  EXPECT_EQ(runs[0].input, "sim:desk");
  EXPECT_EQ(runs[0].started_utc, exampleRun().started_utc);
  EXPECT_EQ(runs[0].first, FrameOrdinal{0});
  const std::vector<MetricsRecord> metrics = reader.metrics();
  ASSERT_EQ(metrics.size(), 2U);
  EXPECT_EQ(metrics[1].ordinal, FrameOrdinal{1});
  EXPECT_EQ(metrics[1].stages_ms, (std::vector<std::pair<std::string, double>>{{"track", 5.5}, {"rank", 0.25}}));

  std::vector<BlobRecord> tiles;
  reader.visitBlobs(BlobTable::kTiles, [&](const BlobRecord& blob) { tiles.push_back(blob); });
  ASSERT_EQ(tiles.size(), 2U);
  EXPECT_EQ(tiles[0].bytes, randomBytes(100'000, 1));
  EXPECT_EQ(tiles[1].key, std::uint64_t{1} << 48);
  EXPECT_TRUE(tiles[1].bytes.empty());
}

TEST(SessionFile, AKeyframeKeepsItsPoseAndFeaturesExactlyAndItsImagesClosely) {
  const TemporaryFolder folder;
  writeExample(folder / "s.saccade");
  const SessionReader reader(folder / "s.saccade");
  const KeyframeRecord written = exampleKeyframe();
  const std::vector<KeyframeRecord> listed = reader.keyframes();
  ASSERT_EQ(listed.size(), 1U);
  EXPECT_EQ(listed[0].ordinal, written.ordinal);
  EXPECT_EQ(listed[0].T_WC.matrix(), written.T_WC.matrix());
  EXPECT_EQ(listed[0].features, written.features);
  EXPECT_TRUE(listed[0].color.empty());

  EXPECT_FALSE(reader.keyframe({0}).has_value());
  const std::optional<KeyframeRecord> whole = reader.keyframe({1});
  ASSERT_TRUE(whole.has_value());
  EXPECT_EQ(whole->T_WC.matrix(), written.T_WC.matrix());
  constexpr double kMeanJpegError = 2.0;  // grey levels, of a smooth image at quality 90
  EXPECT_LT(cv::norm(whole->color, written.color, cv::NORM_L1) / (3.0 * 640 * 480), kMeanJpegError);
  constexpr double kHalfStep_m = 0.000126;
  EXPECT_LT(cv::norm(whole->depth_m, written.depth_m, cv::NORM_INF), kHalfStep_m);
  EXPECT_EQ(whole->depth_m(0, 0), 0.0F);
}

TEST(SessionFile, FarDepthOfAKeyframeIsKeptInMillimetres) {
  cv::Mat1f depth_m(2, 2, 0.3333F);
  depth_m(1, 1) = 40.1234F;
  depth_m(0, 1) = 70.0F;  // beyond 16 bit
  const PackedDepth packed = packDepth(depth_m);
  EXPECT_EQ(packed.unit_m, 0.001);
  const cv::Mat1f back = unpackDepth(packed.bytes, packed.unit_m, {2, 2}, "memory");
  EXPECT_FLOAT_EQ(back(0, 0), 0.333F);
  EXPECT_FLOAT_EQ(back(1, 1), 40.123F);
  EXPECT_EQ(back(0, 1), 0.0F);
}

TEST(SessionFile, DamagedOrOversizedImagesOfAKeyframeAreRefused) {
  const TemporaryFolder folder;
  writeExample(folder / "s.saccade");
  const std::string jpeg = packColor(cv::Mat3b(100, 50, cv::Vec3b(1, 2, 3)));
  EXPECT_NO_THROW((void)unpackColor(jpeg, {50, 100}, "memory"));
  EXPECT_THROW((void)unpackColor(jpeg, {640, 480}, "memory"), IoError);
  EXPECT_THROW((void)unpackColor(jpeg.substr(0, 10), {50, 100}, "memory"), IoError);
  EXPECT_THROW((void)unpackDepth(jpeg, 0.001, {50, 100}, "memory"), IoError);
  SQLite::Database(folder / "s.saccade", SQLite::OPEN_READWRITE)
      .exec("UPDATE keyframes SET color = substr(color, 1, 500) || x'00' || substr(color, 502)");
  EXPECT_THROW((void)SessionReader(folder / "s.saccade").keyframe({1}), IoError);
}

constexpr SessionPart kExamplePart{"example", 2, "CREATE TABLE example (a INTEGER PRIMARY KEY, b TEXT)"};

TEST(SessionFile, APartIsMadeOnceAndRefusedAloneWhenItIsNewer) {
  const TemporaryFolder folder;
  writeExample(folder / "s.saccade");
  {
    SessionDatabase session(folder / "s.saccade", SessionDatabase::Access::kWrite);
    EXPECT_FALSE(session.hasPart(kExamplePart));
    session.requirePart(kExamplePart);
    session.requirePart(kExamplePart);
    session.sqlite().exec("INSERT INTO example VALUES (1, 'x')");
  }
  const SessionReader reader(folder / "s.saccade");
  EXPECT_TRUE(reader.database().hasPart(kExamplePart));
  EXPECT_EQ(reader.frames().size(), 3U);
  constexpr SessionPart kOlderProgram{"example", 1, ""};
  EXPECT_THROW((void)reader.database().hasPart(kOlderProgram), IoError);
}

TEST(SessionFile, ViewsAndTriggersAreRefused) {
  const TemporaryFolder folder;
  writeExample(folder / "s.saccade");
  SQLite::Database(folder / "s.saccade", SQLite::OPEN_READWRITE)
      .exec(
          "DROP TABLE frames; CREATE VIEW frames AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) "
          "SELECT i FROM n");
  EXPECT_THROW(SessionReader(folder / "s.saccade"), IoError);
}

TEST(SessionFile, AnExistingSessionIsRefusedUnlessItMayBeReplaced) {
  const TemporaryFolder folder;
  writeExample(folder / "s.saccade");
  const std::string before = readFile(folder / "s.saccade");
  EXPECT_THROW(SessionWriter(folder / "s.saccade", WhenSessionExists::kRefuse), IoError);
  EXPECT_EQ(readFile(folder / "s.saccade"), before);
  writeExample(folder / "s.saccade", WhenSessionExists::kReplace);
  EXPECT_EQ(SessionReader(folder / "s.saccade").frames().size(), 3U);
}

TEST(SessionFile, AWriterThatIsDroppedLeavesTheOldSessionAndNoRubbish) {
  const TemporaryFolder folder;
  writeExample(folder / "s.saccade");
  const std::string before = readFile(folder / "s.saccade");
  {
    SessionWriter writer(folder / "s.saccade", WhenSessionExists::kReplace);
    writer.addFrame(exampleFrame(0));
  }
  EXPECT_EQ(readFile(folder / "s.saccade"), before);
  EXPECT_FALSE(std::filesystem::exists(folder / "s.saccade.partial"));
}

TEST(SessionFile, PlacesThatCannotBeWrittenAreNamedAtTheStart) {
  const TemporaryFolder folder;
  EXPECT_THROW(SessionWriter(folder / "no-such-folder/s.saccade", WhenSessionExists::kRefuse), IoError);
  EXPECT_THROW(SessionWriter(folder.path(), WhenSessionExists::kReplace), IoError);
}

TEST(SessionFile, ADiskThatFillsUpIsAnErrorAndTheOldSessionStays) {
  const TemporaryFolder folder;
  writeExample(folder / "s.saccade");
  const std::string before = readFile(folder / "s.saccade");

  rlimit old_limit{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &old_limit), 0);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small_limit{1 << 20, old_limit.rlim_max};  // no file of this process may grow beyond 1 MiB
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small_limit), 0);
  EXPECT_THROW(
      {
        SessionWriter writer(folder / "s.saccade", WhenSessionExists::kReplace);
        for (unsigned i = 0; i < 64; ++i) writer.putBlob(BlobTable::kTiles, {i, 1, randomBytes(1 << 17, i)});
        writer.finish(exampleMetadata());
      },
      IoError);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &old_limit), 0);
  std::signal(SIGXFSZ, old_handler);
  EXPECT_EQ(readFile(folder / "s.saccade"), before);
  EXPECT_FALSE(std::filesystem::exists(folder / "s.saccade.partial"));
}

TEST(SessionFile, ForeignTruncatedAndFutureFilesAreRefusedWithOneError) {
  const TemporaryFolder folder;
  EXPECT_THROW(SessionReader(folder / "missing.saccade"), IoError);
  EXPECT_THROW(SessionReader(folder.path()), IoError);
  writeFile(folder / "empty.saccade", "");
  EXPECT_THROW(SessionReader(folder / "empty.saccade"), IoError);
  writeFile(folder / "text.saccade", std::string(5000, 'x'));
  EXPECT_THROW(SessionReader(folder / "text.saccade"), IoError);

  SQLite::Database(folder / "other.saccade", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE).exec("CREATE TABLE t(a)");
  EXPECT_THROW(SessionReader(folder / "other.saccade"), IoError);

  writeExample(folder / "future.saccade");
  SQLite::Database(folder / "future.saccade", SQLite::OPEN_READWRITE).exec("PRAGMA user_version = 3");
  EXPECT_THROW(SessionReader(folder / "future.saccade"), IoError);

  writeExample(folder / "keyless.saccade");
  SQLite::Database(folder / "keyless.saccade", SQLite::OPEN_READWRITE).exec("DELETE FROM meta WHERE key = 'tick'");
  EXPECT_THROW(SessionReader(folder / "keyless.saccade"), IoError);
}

/// Opens and reads everything; true if that went well, false if it was refused with an IoError.
bool readsWhole(const std::filesystem::path& path) {
  try {
    const SessionReader reader(path);
    for (const FrameRecord& frame : reader.frames()) (void)reader.candidates(frame.ordinal);
    for (const KeyframeRecord& keyframe : reader.keyframes()) (void)reader.keyframe(keyframe.ordinal);
    for (const BlobTable table : {BlobTable::kTiles, BlobTable::kBricks, BlobTable::kAttendLog}) {
      reader.visitBlobs(table, [](const BlobRecord&) {});
    }
    return true;
  } catch (const IoError&) {
    return false;
  }
}

TEST(SessionFile, EveryTruncationIsRefused) {
  const TemporaryFolder folder;
  writeExample(folder / "s.saccade");
  const std::string whole = readFile(folder / "s.saccade");
  ASSERT_TRUE(readsWhole(folder / "s.saccade"));
  for (std::size_t size = 0; size < whole.size(); size += 1024) {
    writeFile(folder / "cut.saccade", whole.substr(0, size));
    EXPECT_FALSE(readsWhole(folder / "cut.saccade")) << "cut to " << size << " of " << whole.size() << " bytes";
  }
}

TEST(SessionFile, AFlippedBitInTheMapIsNoticed) {
  const TemporaryFolder folder;
  writeExample(folder / "s.saccade");
  {
    SQLite::Database db(folder / "s.saccade", SQLite::OPEN_READWRITE);
    db.exec("UPDATE tiles SET data = substr(data, 1, 5000) || x'5a' || substr(data, 5002) WHERE key = 7");
  }
  EXPECT_FALSE(readsWhole(folder / "s.saccade"));
}

TEST(SessionFile, AForgedSizeCannotExhaustTheMemory) {
  const TemporaryFolder folder;
  writeExample(folder / "s.saccade");
  SQLite::Database(folder / "s.saccade", SQLite::OPEN_READWRITE).exec("UPDATE tiles SET size = 1 << 60");
  EXPECT_FALSE(readsWhole(folder / "s.saccade"));
}

TEST(SessionFile, RandomDamageNeverDoesWorseThanAnError) {
  const TemporaryFolder folder;
  writeExample(folder / "s.saccade");
  const std::string whole = readFile(folder / "s.saccade");
  std::mt19937 random(5);
  int refused = 0;
  for (int i = 0; i < 100; ++i) {
    std::string damaged = whole;
    for (int k = 0; k < 20; ++k) damaged[random() % damaged.size()] = static_cast<char>(random());
    writeFile(folder / "damaged.saccade", damaged);
    refused += readsWhole(folder / "damaged.saccade") ? 0 : 1;
  }
  EXPECT_GT(refused, 50);  // twenty bytes rarely all fall into unused pages
}

// RFC 3720, B.4, and every length and alignment around the words that the processor takes at once.
TEST(BlobCodec, ChecksumIsTheCastagnoliCrc) {
  EXPECT_EQ(crc32c("123456789"), 0xE3069283U);
  EXPECT_EQ(crc32cByTable("123456789"), 0xE3069283U);
  std::string bytes;
  for (int i = 0; i < 64; ++i) bytes += static_cast<char>(i * 89 + 7);
  for (std::size_t first = 0; first < 9; ++first) {
    for (std::size_t size = 0; size + first <= bytes.size(); ++size) {
      const std::string_view part = std::string_view(bytes).substr(first, size);
      ASSERT_EQ(crc32c(part), crc32cByTable(part)) << first << " " << size;
    }
  }
}

}  // namespace
}  // namespace saccade
