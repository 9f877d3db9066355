#include "saccade/session/session_map.hpp"

#include <utility>

#include "saccade/core/config_file.hpp"
#include "saccade/core/errors.hpp"
#include "saccade/map/map_tiles.hpp"
#include "session/map_blobs.hpp"

namespace saccade {
namespace {

/// From the first sample of a brick to the next brick's first: the last samples' cells reach so far.
Eigen::AlignedBox3d boxOf(const BrickPosition& brick, double cell_m) {
  const double edge_m = SurfaceBrick::kSide * cell_m;
  const Eigen::Vector3d low = Eigen::Vector3d(brick.x, brick.y, brick.z) * edge_m;
  return {low, low + Eigen::Vector3d::Constant(edge_m)};
}

void record(const BlobRecord& blob, const std::filesystem::path& path, AttendLog& log) {
  const LoggedTick tick = decodeTick(blob.bytes, Tick{static_cast<std::uint32_t>(blob.key)}, path);
  std::vector<CandidateLeaves> candidates;
  for (std::size_t i = 0; i < tick.ranks.size(); ++i) candidates.push_back({tick.ranks[i], tick.leaves[i]});
  log.record(tick.events, candidates);
}

}  // namespace

MapRegion MapRegion::everything() {
  return MapRegion([](const Eigen::AlignedBox3d&) { return true; });
}

MapRegion MapRegion::nothing() {
  return MapRegion([](const Eigen::AlignedBox3d&) { return false; });
}

MapRegion MapRegion::box(const Eigen::AlignedBox3d& box_W) {
  return MapRegion([box_W](const Eigen::AlignedBox3d& part) { return part.intersects(box_W); });
}

MapRegion MapRegion::ball(const Eigen::Vector3d& centre_W, double radius_m) {
  return MapRegion(
      [centre_W, radius_m](const Eigen::AlignedBox3d& part) { return part.exteriorDistance(centre_W) <= radius_m; });
}

ExplorerConfig loadConfig(const SessionReader& session) {
  ExplorerConfig config;
  applyConfigText(session.metadata().config_yaml, session.path(), describing(config));
  return config;
}

IorMap loadMap(const SessionReader& session, const MapRegion& region) {
  const ExplorerConfig config = loadConfig(session);
  std::vector<MapTile> tiles;
  session.visitBlobs(
      BlobTable::kTiles,
      [&](std::uint64_t key) {
        const NodeKey root = tileRoot(key);
        // A place that cannot be is not judged here: restoreMap() refuses it.
        return root.depth > MapTree::kDepth || region.touches(boxOf(root, config.map.leaf_size_m));
      },
      [&](const BlobRecord& blob) {
        const auto* bytes = reinterpret_cast<const std::byte*>(blob.bytes.data());
        tiles.push_back({tileRoot(blob.key), {bytes, bytes + blob.bytes.size()}});
      });
  return restoreMap(config.map, tiles, Tick{session.metadata().tick}, session.path());
}

void visitMapTiles(const SessionReader& session,
                   const std::function<void(const NodeKey& root, const IorMap& tile)>& visit) {
  const ExplorerConfig config = loadConfig(session);
  const Tick now{session.metadata().tick};
  session.visitBlobs(BlobTable::kTiles, [&](const BlobRecord& blob) {
    const auto* bytes = reinterpret_cast<const std::byte*>(blob.bytes.data());
    const MapTile tile{tileRoot(blob.key), {bytes, bytes + blob.bytes.size()}};
    visit(tile.root, restoreMap(config.map, {&tile, 1}, now, session.path()));
  });
}

SurfaceVolume loadSurface(const SessionReader& session, const MapRegion& region) {
  const ExplorerConfig config = loadConfig(session);
  SurfaceVolume surface(config.surface);
  session.visitBlobs(
      BlobTable::kBricks,
      [&](std::uint64_t key) { return region.touches(boxOf(brickPosition(key), config.surface.cell_m)); },
      [&](const BlobRecord& blob) {
        surface.importBrick(brickPosition(blob.key), brickFromBytes(blob.bytes, session.path()));
      });
  return surface;
}

AttendLog loadAttendLog(const SessionReader& session) {
  AttendLog log;
  session.visitBlobs(BlobTable::kAttendLog, [&](const BlobRecord& blob) { record(blob, session.path(), log); });
  return log;
}

AttendLog loadAttendedLeaves(const SessionReader& session) {
  return visitAttendLog(session, [](const AttendLog&, std::size_t) {});
}

AttendLog visitAttendLog(const SessionReader& session,
                         const std::function<void(const AttendLog& log, std::size_t tick)>& visit) {
  AttendLog log;
  session.visitBlobs(BlobTable::kAttendLog, [&](const BlobRecord& blob) {
    record(blob, session.path(), log);
    visit(log, log.firstAtHand());
    log.letGo(log.tickCount());
  });
  return log;
}

std::vector<std::shared_ptr<const Keyframe>> loadKeyframes(const SessionReader& session) {
  std::vector<std::shared_ptr<const Keyframe>> keyframes;
  for (const KeyframeRecord& record : session.keyframes()) {
    const std::string name = "keyframe " + std::to_string(record.ordinal.value);
    const std::optional<FrameRecord> frame = session.frame(record.ordinal);
    if (!frame) throw IoError(session.path(), "the frame of " + name, "none");
    std::optional<FrameFeatures> features = decodeFeatures(record.features);
    if (!features) throw IoError(session.path(), "the features of " + name, "something else");
    keyframes.push_back(
        std::make_shared<const Keyframe>(Keyframe{frame->index, frame->stamp_s, record.T_WC, *std::move(features)}));
  }
  return keyframes;
}

}  // namespace saccade
