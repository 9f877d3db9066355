#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "saccade/pipeline/explorer.hpp"
#include "saccade/pipeline/map_pager.hpp"
#include "saccade/session/session_reader.hpp"

namespace saccade {

class MapChanges;

/// Keeps an exploration's octree and surface volume within a number of bytes: what its session holds unchanged and the
/// camera is far from is dropped from memory, and read from the session again when the camera comes back.
///
/// IOR needs nothing while it is away: its weights are ticks of expiry. Exactly what was dropped comes back, so that
/// the exploration is the same, byte for byte, as one that keeps everything in memory. Tiles that are one leaf are
/// never dropped.
class SessionPager final : public MapPager {
 public:
  /// `explorer` must outlive it; `session` is the file that its checkpoints go to.
  SessionPager(Explorer& explorer, std::filesystem::path session, std::size_t limit_bytes);
  ~SessionPager() override;

  void bringBack(const ViewRegion& region) override;
  [[nodiscard]] bool holdsNothing() const override { return tiles_.empty() && blocks_.empty(); }

  /// Everything in the session counts as dropped: for an explorer that goes on with it and holds no map yet.
  void startFrom(const SessionReader& session);
  /// Bytes that the map takes in memory.
  [[nodiscard]] std::size_t bytes() const;
  [[nodiscard]] bool crowded() const { return bytes() > limit_bytes_; }
  /// Drops what the session holds as it is in memory, farthest first, until a good part of the limit is free. Only
  /// when all that `changes` has found is durable. Whether something else could be dropped if it were in the session.
  bool drop(const MapChanges& changes);
  /// Whether the tile is in the session and not in memory.
  [[nodiscard]] bool isAway(std::uint64_t tile_key) const { return tiles_.contains(tile_key); }
  /// Closes the session, of which nothing can be brought back from then on.
  void close() { reader_.reset(); }

  struct Statistics {
    std::int64_t dropped = 0;  ///< tiles and bricks
    std::int64_t returned = 0;
    std::size_t most_bytes = 0;
  };
  [[nodiscard]] const Statistics& statistics() const { return statistics_; }

 private:
  /// 8 x 8 x 8 bricks: looked for together.
  using BrickBlock = BrickPosition;
  struct Candidate;

  [[nodiscard]] const SessionReader& session();
  [[nodiscard]] std::vector<Candidate> listCandidates(const MapChanges& changes, bool& unsaved) const;
  void addAway(const BrickPosition& brick);
  [[nodiscard]] Eigen::AlignedBox3d boxOf(const BrickBlock& block) const;

  Explorer& explorer_;
  std::filesystem::path path_;
  std::size_t limit_bytes_;
  std::unique_ptr<SessionReader> reader_;
  std::map<std::uint64_t, Eigen::AlignedBox3d> tiles_;       ///< away, by their keys
  std::map<BrickBlock, std::vector<BrickPosition>> blocks_;  ///< bricks that are away
  std::optional<ViewRegion> last_;                           ///< what was looked at last: never dropped
  Statistics statistics_;
};

}  // namespace saccade
