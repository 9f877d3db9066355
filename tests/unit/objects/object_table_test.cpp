#include "saccade/objects/object_table.hpp"

#include <SQLiteCpp/SQLiteCpp.h>
#include <filesystem>

#include <gtest/gtest.h>

#include "saccade/objects/object_memory.hpp"
#include "saccade/session/session_map.hpp"
#include "support/temporary_folder.hpp"

namespace saccade {
namespace {

/// The table is filled tile by tile; here all is asked of the whole map.
TEST(ObjectTable, HoldsWhatTheWholeMapSaysOfEachObject) {
  const test::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "desk.saccade";
  std::filesystem::copy_file(SACCADE_SOURCE_DIR "/maps/desk_before.saccade", path);
  ASSERT_GT(storeObjects(path), 5);

  const SessionReader session(path);
  const IorMap map = loadMap(session);
  SQLite::Database database(path.string());
  SQLite::Statement row(database,
                        "SELECT id, leaves, min_x, min_y, min_z, max_x, max_y, max_z FROM objects ORDER BY id");
  int gone = 0;
  for (const AttendedObject& object : findObjects(session)) {
    ASSERT_TRUE(row.executeStep());
    const std::vector<LeafKey> leaves = leavesOf(object, map);
    EXPECT_EQ(row.getColumn(0).getInt(), object.id.value);
    EXPECT_EQ(row.getColumn(1).getInt64(), static_cast<std::int64_t>(leaves.size()));
    gone += leaves.empty() ? 1 : 0;
    EXPECT_EQ(row.getColumn(2).isNull(), leaves.empty());
    if (leaves.empty()) continue;
    const Eigen::AlignedBox3d box = boxOf(leaves, map.config().leaf_size_m);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(row.getColumn(2 + axis).getDouble(), box.min()[axis]);
      EXPECT_EQ(row.getColumn(5 + axis).getDouble(), box.max()[axis]);
    }
  }
  EXPECT_FALSE(row.executeStep());
  EXPECT_LT(gone, 5);
}

}  // namespace
}  // namespace saccade
