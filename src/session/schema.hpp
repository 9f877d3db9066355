#pragma once

namespace saccade::schema {

constexpr int kApplicationId = 0x53414343;  ///< "SACC" in the SQLite header
constexpr int kFormatVersion = 1;           ///< `PRAGMA user_version`; readers refuse what is newer

/// The tables of format version 1. Poses are T_WC (camera to world, metres, quaternion x y z w); blobs are zstd with a
/// CRC32C of the compressed bytes and the unpacked size beside them.
constexpr const char* kTables = R"sql(
CREATE TABLE meta (key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;

CREATE TABLE frames (
  ordinal INTEGER PRIMARY KEY,   -- order of processing, from 0
  frame INTEGER NOT NULL,        -- index in the input
  name TEXT NOT NULL,
  stamp_s REAL NOT NULL,
  tracking TEXT NOT NULL,        -- tracked | weak | lost
  tx REAL, ty REAL, tz REAL, qx REAL, qy REAL, qz REAL, qw REAL,  -- NULL when lost
  inlier_share REAL NOT NULL,
  rms_m REAL NOT NULL,
  tick INTEGER NOT NULL,         -- the map's tick after this frame
  open INTEGER NOT NULL,
  inhibited INTEGER NOT NULL,
  attended INTEGER NOT NULL,
  processing_ms REAL NOT NULL);

CREATE TABLE candidates (        -- the attended ones; box and mask in pixels of the input's colour image
  frame INTEGER NOT NULL,
  rank INTEGER NOT NULL,
  score REAL NOT NULL,
  source TEXT NOT NULL,          -- colour | depth
  u INTEGER NOT NULL, v INTEGER NOT NULL, width INTEGER NOT NULL, height INTEGER NOT NULL,
  min_x REAL, min_y REAL, min_z REAL, max_x REAL, max_y REAL, max_z REAL,  -- in W, metres
  mask TEXT NOT NULL,            -- compressed COCO run lengths
  features TEXT NOT NULL,        -- JSON array
  revisited_share REAL NOT NULL, -- share of its leaves attended at any earlier tick
  PRIMARY KEY (frame, rank)) WITHOUT ROWID;

CREATE TABLE tiles (             -- the octree, as subtrees
  key INTEGER PRIMARY KEY, items INTEGER NOT NULL, crc32c INTEGER NOT NULL, size INTEGER NOT NULL, data BLOB NOT NULL);
CREATE TABLE bricks (            -- the surface volume
  key INTEGER PRIMARY KEY, items INTEGER NOT NULL, crc32c INTEGER NOT NULL, size INTEGER NOT NULL, data BLOB NOT NULL);
CREATE TABLE attend_log (        -- one row a tick: the leaves of each attended candidate
  key INTEGER PRIMARY KEY, items INTEGER NOT NULL, crc32c INTEGER NOT NULL, size INTEGER NOT NULL, data BLOB NOT NULL);
)sql";

}  // namespace saccade::schema
