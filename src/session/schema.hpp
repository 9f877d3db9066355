#pragma once

/// The tables of a session file.
///
/// Poses are T_WC (camera to world, metres, quaternion x y z w). Blobs with `size` are zstd with a CRC32C of the
/// compressed bytes and the unpacked size beside them; other blobs have a CRC32C of what is stored.
namespace saccade::schema {

constexpr int kApplicationId = 0x53414343;  ///< "SACC" in the SQLite header
constexpr int kFormatVersion = 2;           ///< `PRAGMA user_version`; readers refuse what is newer

/// The tables of format version 2. What is not needed by every reader is a part of its own, see session_part.hpp.
constexpr const char* kTables = R"sql(
CREATE TABLE meta (key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;

CREATE TABLE parts (             -- groups of tables beside these, each with a version of its own
  name TEXT PRIMARY KEY, version INTEGER NOT NULL) WITHOUT ROWID;

CREATE TABLE runs (              -- explorations that made the session, one after another
  run INTEGER PRIMARY KEY,       -- from 0
  first_ordinal INTEGER NOT NULL,
  input TEXT NOT NULL,           -- as given on the command line
  input_kind TEXT NOT NULL,
  started_utc TEXT NOT NULL,
  saccade_version TEXT NOT NULL);

CREATE TABLE frames (
  ordinal INTEGER PRIMARY KEY,   -- order of processing, from 0, over all runs
  frame INTEGER NOT NULL,        -- index in the run's input
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

CREATE TABLE metrics (           -- time of each stage of a frame
  ordinal INTEGER PRIMARY KEY,
  stages TEXT NOT NULL);         -- JSON object, stage: milliseconds

CREATE TABLE candidates (        -- the attended ones; box and mask in pixels of the input's colour image
  ordinal INTEGER NOT NULL,      -- of the frame
  rank INTEGER NOT NULL,
  score REAL NOT NULL,
  source TEXT NOT NULL,          -- colour | depth
  u INTEGER NOT NULL, v INTEGER NOT NULL, width INTEGER NOT NULL, height INTEGER NOT NULL,
  min_x REAL, min_y REAL, min_z REAL, max_x REAL, max_y REAL, max_z REAL,  -- in W, metres
  mask TEXT NOT NULL,            -- compressed COCO run lengths
  features TEXT NOT NULL,        -- JSON array
  revisited_share REAL NOT NULL, -- share of its leaves attended at any earlier tick
  PRIMARY KEY (ordinal, rank)) WITHOUT ROWID;

CREATE TABLE keyframes (         -- frames by which a place is known again; images without lens distortion
  ordinal INTEGER PRIMARY KEY,   -- of the frame
  T_WC BLOB NOT NULL,            -- exact: 3 x 4 float64, row by row
  color BLOB NOT NULL,           -- JPEG; empty where thinned to save room
  color_crc32c INTEGER NOT NULL,
  depth BLOB NOT NULL,           -- PNG, 16 bit, 0 = no measurement; empty where thinned
  depth_unit_m REAL NOT NULL,    -- metres a step
  depth_crc32c INTEGER NOT NULL,
  features BLOB NOT NULL,        -- of the relocaliser
  features_crc32c INTEGER NOT NULL);

CREATE TABLE tiles (             -- the octree, as subtrees
  key INTEGER PRIMARY KEY, items INTEGER NOT NULL, crc32c INTEGER NOT NULL, size INTEGER NOT NULL, data BLOB NOT NULL);
CREATE TABLE bricks (            -- the surface volume
  key INTEGER PRIMARY KEY, items INTEGER NOT NULL, crc32c INTEGER NOT NULL, size INTEGER NOT NULL, data BLOB NOT NULL);
CREATE TABLE attend_log (        -- one row a tick: the leaves of each attended candidate
  key INTEGER PRIMARY KEY, items INTEGER NOT NULL, crc32c INTEGER NOT NULL, size INTEGER NOT NULL, data BLOB NOT NULL);
)sql";

/// Also of format version 2, whose first files had none.
constexpr const char* kStateTable = R"sql(
CREATE TABLE state (             -- what going on needs besides map, surface volume, attend log and keyframes
  name TEXT PRIMARY KEY, crc32c INTEGER NOT NULL, data BLOB NOT NULL) WITHOUT ROWID;
)sql";

/// What stands before a file without that table for a reader.
constexpr const char* kViewOfNoState = R"sql(
CREATE TEMP VIEW state AS SELECT '' AS name, 0 AS crc32c, x'' AS data WHERE 0;
)sql";

/// Makes a file of format version 1 look like version 2 to a reader: temporary views stand before its tables. There
/// was one run, so a frame's index named it.
constexpr const char* kViewsOfVersion1 = R"sql(
CREATE TEMP VIEW parts AS SELECT NULL AS name, 0 AS version WHERE 0;
CREATE TEMP VIEW runs AS SELECT 0 AS run, 0 AS first_ordinal,
  (SELECT json_extract(value, '$') FROM main.meta WHERE key = 'input') AS input,
  (SELECT json_extract(value, '$') FROM main.meta WHERE key = 'input_kind') AS input_kind,
  (SELECT json_extract(value, '$') FROM main.meta WHERE key = 'created_utc') AS started_utc,
  (SELECT json_extract(value, '$') FROM main.meta WHERE key = 'saccade_version') AS saccade_version;
CREATE TEMP VIEW metrics AS SELECT 0 AS ordinal, '' AS stages WHERE 0;
CREATE TEMP VIEW candidates AS SELECT f.ordinal, c.* FROM main.candidates c JOIN main.frames f USING (frame);
CREATE TEMP VIEW keyframes AS SELECT 0 AS ordinal, x'' AS T_WC, x'' AS color, 0 AS color_crc32c, x'' AS depth,
  0.0 AS depth_unit_m, 0 AS depth_crc32c, x'' AS features, 0 AS features_crc32c WHERE 0;
)sql";

}  // namespace saccade::schema
