#include "saccade/session/session_repair.hpp"

#include <SQLiteCpp/SQLiteCpp.h>
#include <fstream>
#include <iterator>
#include <random>

#include <gtest/gtest.h>

#include "saccade/core/errors.hpp"
#include "saccade/map/ior_octree.hpp"
#include "saccade/map/map_tiles.hpp"
#include "saccade/session/session_map.hpp"
#include "session/map_blobs.hpp"
#include "support/temporary_folder.hpp"

namespace saccade {
namespace {

using test::TemporaryFolder;

/// A session of format version 1 as it was once shipped.
std::filesystem::path shippedSession() {
  return std::filesystem::path(SACCADE_SOURCE_DIR) / "maps" / "coffee.saccade";
}

std::int64_t wholeIn(const SessionFindings& findings, const std::string& table) {
  for (const TableFindings& found : findings.tables) {
    if (found.table == table) return found.whole;
  }
  return -1;
}

std::int64_t damagedIn(const SessionFindings& findings) {
  std::int64_t damaged = 0;
  for (const TableFindings& found : findings.tables) damaged += found.damaged;
  return damaged;
}

void change(const std::filesystem::path& path, const std::string& sql) {
  SQLite::Database(path, SQLite::OPEN_READWRITE).exec(sql);
}

/// The shipped session in today's format.
std::filesystem::path updatedSession(const TemporaryFolder& folder) {
  const std::filesystem::path path = folder / "whole.saccade";
  (void)repairSession(shippedSession(), path);
  return path;
}

TEST(SessionRepair, AShippedSessionOfVersion1IsWhole) {
  const SessionFindings findings = verifySession(shippedSession());
  EXPECT_TRUE(findings.complaints.empty()) << findings.complaints.front();
  EXPECT_EQ(wholeIn(findings, "frames"), 10);
  EXPECT_EQ(wholeIn(findings, "candidates"), 200);
  EXPECT_GT(wholeIn(findings, "tiles"), 10);
}

TEST(SessionRepair, RepairingAWholeSessionCopiesEverythingIntoTodaysFormat) {
  const TemporaryFolder folder;
  const std::filesystem::path path = updatedSession(folder);
  EXPECT_TRUE(verifySession(path).complaints.empty());
  const SessionReader before(shippedSession()), after(path);
  EXPECT_TRUE(loadMap(before).tree() == loadMap(after).tree());
  EXPECT_EQ(after.metadata().leaves, before.metadata().leaves);
  ASSERT_EQ(after.frames().size(), before.frames().size());
  constexpr double kRoundOff = 1e-12;  // the quaternion is normalised again
  EXPECT_TRUE(after.frames()[4].T_WC->isApprox(*before.frames()[4].T_WC, kRoundOff));
  EXPECT_EQ(after.runs().size(), 1U);
  for (const BlobTable table : {BlobTable::kBricks, BlobTable::kAttendLog}) {
    std::vector<std::string> blobs_before, blobs_after;
    before.visitBlobs(table, [&](const BlobRecord& blob) { blobs_before.push_back(blob.bytes); });
    after.visitBlobs(table, [&](const BlobRecord& blob) { blobs_after.push_back(blob.bytes); });
    EXPECT_EQ(blobs_before, blobs_after);
  }
}

TEST(SessionRepair, ADamagedTileIsNamedAndLeftOutAndTheRestKept) {
  const TemporaryFolder folder;
  const std::filesystem::path path = updatedSession(folder);
  change(path,
         "UPDATE tiles SET data = substr(data, 1, 20) || x'5a5b' || substr(data, 23) WHERE key = "
         "(SELECT key FROM tiles ORDER BY length(data) DESC LIMIT 1)");
  const SessionFindings found = verifySession(path);
  ASSERT_EQ(found.complaints.size(), 1U);
  EXPECT_NE(found.complaints[0].find("table tiles"), std::string::npos) << found.complaints[0];
  const SessionFindings repaired = repairSession(path, folder / "repaired.saccade");
  EXPECT_EQ(damagedIn(repaired), 1);
  const SessionFindings again = verifySession(folder / "repaired.saccade");
  EXPECT_TRUE(again.complaints.empty());
  EXPECT_EQ(wholeIn(again, "tiles"), wholeIn(verifySession(shippedSession()), "tiles") - 1);
  EXPECT_EQ(SessionReader(folder / "repaired.saccade").metadata().leaves,
            static_cast<std::int64_t>(loadMap(SessionReader(folder / "repaired.saccade")).leafCount()));
}

TEST(SessionRepair, PartsThatDoNotFitTogetherAreComplainedOf) {
  const TemporaryFolder folder;
  for (const char* damage :
       {"DELETE FROM frames WHERE ordinal = 3", "UPDATE attend_log SET key = 1000000 WHERE key = 2",
        "UPDATE tiles SET key = key | (1 << 48) WHERE key = (SELECT min(key) FROM tiles)",
        "UPDATE frames SET tick = 0 WHERE ordinal = 9",
        "UPDATE bricks SET size = 1 << 40 WHERE key = "
        "(SELECT min(key) FROM bricks)",
        "UPDATE meta SET value = '\"map: 5\"' WHERE key = 'config'"}) {
    const std::filesystem::path path = updatedSession(folder);
    change(path, damage);
    EXPECT_FALSE(verifySession(path).complaints.empty()) << damage;
    std::filesystem::remove(path);
  }
}

TEST(SessionRepair, PagesOfNoiseCostOnlyWhatLiesOnThem) {
  const TemporaryFolder folder;
  const std::filesystem::path path = updatedSession(folder);
  const auto size = std::filesystem::file_size(path);
  {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    std::mt19937 random(3);
    for (int page = 0; page < 3; ++page) {
      file.seekp(static_cast<std::streamoff>(size / 2 + static_cast<unsigned>(page) * 65536));
      for (int i = 0; i < 4096; ++i) file.put(static_cast<char>(random()));
    }
  }
  EXPECT_FALSE(verifySession(path).complaints.empty());
  (void)repairSession(path, folder / "repaired.saccade");
  const SessionFindings again = verifySession(folder / "repaired.saccade");
  EXPECT_TRUE(again.complaints.empty());
  EXPECT_GT(wholeIn(again, "bricks") + wholeIn(again, "tiles"), 100);
}

TEST(SessionRepair, TablesOfPartsAreCopied) {
  const TemporaryFolder folder;
  const std::filesystem::path path = updatedSession(folder);
  change(path,
         "CREATE TABLE extra (a INTEGER PRIMARY KEY, b, c BLOB); INSERT INTO extra VALUES (7, 'x', x'00ff'), "
         "(8, NULL, 2.5); INSERT INTO parts VALUES ('extra', 3)");
  (void)repairSession(path, folder / "repaired.saccade");
  SQLite::Database db(folder / "repaired.saccade");
  EXPECT_EQ(db.execAndGet("SELECT count(*) FROM extra WHERE (a = 7 AND b = 'x' AND c = x'00ff') OR "
                          "(a = 8 AND b IS NULL AND c = 2.5)")
                .getInt(),
            2);
  EXPECT_EQ(db.execAndGet("SELECT version FROM parts WHERE name = 'extra'").getInt(), 3);
}

TEST(SessionRepair, AnExistingTargetIsRefused) {
  const TemporaryFolder folder;
  const std::filesystem::path path = updatedSession(folder);
  EXPECT_THROW((void)repairSession(shippedSession(), path), IoError);
}

TEST(SessionRepair, RandomDamageIsNeverWorseThanComplaintsOrOneError) {
  const TemporaryFolder folder;
  std::ifstream file(shippedSession(), std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(file), {}};
  std::mt19937 random(11);
  int complained = 0;
  for (int i = 0; i < 12; ++i) {
    std::string damaged = whole;
    for (int k = 0; k < 30; ++k) damaged[random() % damaged.size()] = static_cast<char>(random());
    if (i % 4 == 0) damaged.resize(random() % damaged.size());
    std::ofstream(folder / "damaged.saccade", std::ios::binary) << damaged;
    try {
      complained += verifySession(folder / "damaged.saccade").complaints.empty() ? 0 : 1;
      std::filesystem::remove(folder / "repaired.saccade");
      (void)repairSession(folder / "damaged.saccade", folder / "repaired.saccade");
      EXPECT_TRUE(verifySession(folder / "repaired.saccade").complaints.size() <= 2);  // lost settings, lost last frame
    } catch (const IoError&) {
      ++complained;
    }
  }
  EXPECT_GT(complained, 9);  // thirty bytes rarely all fall into unused pages
}

}  // namespace
}  // namespace saccade
