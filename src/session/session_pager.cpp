#include "session/session_pager.hpp"

#include <algorithm>
#include <cstring>
#include <set>
#include <utility>

#include "saccade/core/errors.hpp"
#include "saccade/map/map_tiles.hpp"
#include "session/map_blobs.hpp"
#include "session/map_snapshot.hpp"

namespace saccade {
namespace {

/// After dropping, this share of the limit is left: to drop seldom.
constexpr double kShareLeft = 0.75;
constexpr int kBlockShift = 3;

BrickPosition blockOf(const BrickPosition& brick) {
  return {brick.x >> kBlockShift, brick.y >> kBlockShift, brick.z >> kBlockShift};
}

BlobRecord requireBlob(const SessionReader& session, BlobTable table, std::uint64_t key) {
  std::optional<BlobRecord> blob = session.blob(table, key);
  if (!blob) throw IoError(session.path(), "the part " + std::to_string(key) + " that was put away", "none");
  return *std::move(blob);
}

}  // namespace

/// Something that can be dropped: a tile, or the bricks of a block.
struct SessionPager::Candidate {
  double distance_m = 0.0;  ///< from the camera
  std::size_t bytes = 0;
  std::optional<NodeKey> tile;
  BrickBlock block;
};

SessionPager::SessionPager(Explorer& explorer, std::filesystem::path session, std::size_t limit_bytes)
    : explorer_(explorer), path_(std::move(session)), limit_bytes_(limit_bytes) {
  explorer_.pageBy(this);
}

SessionPager::~SessionPager() {
  explorer_.pageBy(nullptr);
}

const SessionReader& SessionPager::session() {
  if (reader_ == nullptr) reader_ = std::make_unique<SessionReader>(path_);
  return *reader_;
}

Eigen::AlignedBox3d SessionPager::boxOf(const BrickBlock& block) const {
  const double edge_m = (SurfaceBrick::kSide << kBlockShift) * explorer_.surface().config().cell_m;
  const Eigen::Vector3d low = Eigen::Vector3d(block.x, block.y, block.z) * edge_m;
  return {low, low + Eigen::Vector3d::Constant(edge_m)};
}

void SessionPager::addAway(const BrickPosition& brick) {
  blocks_[blockOf(brick)].push_back(brick);
}

void SessionPager::startFrom(const SessionReader& session) {
  const double leaf_m = explorer_.map().config().leaf_size_m;
  for (const BlobKey& tile : session.blobKeys(BlobTable::kTiles)) {
    tiles_.emplace(tile.key, saccade::boxOf(tileRoot(tile.key), leaf_m));
  }
  for (const BlobKey& brick : session.blobKeys(BlobTable::kBricks)) addAway(brickPosition(brick.key));
}

void SessionPager::bringBack(const ViewRegion& region) {
  last_ = region;
  for (auto tile = tiles_.begin(); tile != tiles_.end();) {
    if (!region.touches(tile->second)) {
      ++tile;
      continue;
    }
    const BlobRecord blob = requireBlob(session(), BlobTable::kTiles, tile->first);
    const auto* bytes = reinterpret_cast<const std::byte*>(blob.bytes.data());
    insertTile(explorer_.map(), {tileRoot(tile->first), {bytes, bytes + blob.bytes.size()}}, path_);
    tile = tiles_.erase(tile);
    ++statistics_.returned;
  }
  for (auto block = blocks_.begin(); block != blocks_.end();) {
    if (!region.touches(boxOf(block->first))) {
      ++block;
      continue;
    }
    for (const BrickPosition& brick : block->second) {
      const BlobRecord blob = requireBlob(session(), BlobTable::kBricks, brickKey(brick));
      explorer_.surface().returnBrick(brick, brickFromBytes(blob.bytes, path_));
      ++statistics_.returned;
    }
    block = blocks_.erase(block);
  }
}

std::size_t SessionPager::bytes() const {
  return explorer_.map().usedBytes() + std::as_const(explorer_).surface().usedBytes();
}

/// Everything unchanged outside the last look, farthest first. `unsaved`: whether there are changed things too.
std::vector<SessionPager::Candidate> SessionPager::listCandidates(const MapChanges& changes, bool& unsaved) const {
  std::vector<Candidate> candidates;
  const auto add = [&](const Eigen::AlignedBox3d& box, bool saved, Candidate candidate) {
    if (last_ && last_->touches(box)) return;
    if (!saved) {
      unsaved = true;
      return;
    }
    candidate.distance_m = last_ ? box.exteriorDistance(last_->eye_W()) : 0.0;
    candidates.push_back(candidate);
  };
  const IorMap& map = explorer_.map();
  for (const TileChange& tile : tileChanges(map)) {
    if (tile.node.isLeaf()) continue;
    const std::optional<std::size_t> leaves = changes.leavesOf(tileKey(tile.root));
    // Eight leaves are a family; inner families add a seventh.
    const std::size_t bytes = leaves.value_or(0) * NodeLayout::kFamilyBytes / 7;
    add(saccade::boxOf(tile.root, map.config().leaf_size_m), !tile.changed && leaves.has_value(),
        {0.0, bytes, tile.root, {}});
  }
  struct Block {
    std::size_t bricks = 0;
    bool saved = true;
  };
  std::map<BrickBlock, Block> blocks;
  const SurfaceVolume& surface = explorer_.surface();
  for (std::size_t i = 0; i < surface.bricks().size(); ++i) {
    Block& block = blocks[blockOf(surface.bricks()[i])];
    ++block.bricks;
    if (surface.lastChange(i) > changes.surfaceChanges()) block.saved = false;
  }
  for (const auto& [position, block] : blocks) {
    add(boxOf(position), block.saved, {0.0, block.bricks * sizeof(SurfaceBrick), std::nullopt, position});
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.distance_m > b.distance_m; });
  return candidates;
}

bool SessionPager::drop(const MapChanges& changes) {
  statistics_.most_bytes = std::max(statistics_.most_bytes, bytes());
  bool unsaved = false;
  const auto aim = static_cast<std::size_t>(kShareLeft * static_cast<double>(limit_bytes_));
  std::size_t left = bytes();
  std::set<BrickBlock> gone;
  for (const Candidate& candidate : listCandidates(changes, unsaved)) {
    if (left <= aim) break;
    left -= std::min(left, candidate.bytes);
    if (!candidate.tile) {
      gone.insert(candidate.block);
      continue;
    }
    tiles_.emplace(tileKey(*candidate.tile), saccade::boxOf(*candidate.tile, explorer_.map().config().leaf_size_m));
    removeTile(explorer_.map(), *candidate.tile);
    ++statistics_.dropped;
  }
  SurfaceVolume& surface = explorer_.surface();
  if (!gone.empty()) {
    surface.removeBricks([&](std::size_t i) {
      const BrickPosition& brick = surface.bricks()[i];
      if (!gone.contains(blockOf(brick))) return false;
      addAway(brick);
      ++statistics_.dropped;
      return true;
    });
  }
  return unsaved;
}

}  // namespace saccade
