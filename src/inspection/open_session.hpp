#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "saccade/map/map_tiles.hpp"
#include "saccade/pipeline/explorer_config.hpp"
#include "saccade/session/session_map.hpp"
#include "saccade/session/session_reader.hpp"

namespace saccade {

/// A session at one of its checkpoints: its file with what every question needs of it. Not thread-safe.
struct OpenSession {
  explicit OpenSession(const std::filesystem::path& path);

  /// The tile at `root`, alone, as a map at the session's tick; empty where the session has no such tile.
  [[nodiscard]] IorMap loadTile(const NodeKey& root) const;
  /// A number for each tile that changes with its content, in the order of `roots`.
  [[nodiscard]] std::vector<std::uint32_t> tileChecksums() const;
  /// For each frame the share of its attended candidates that returned to what was attended before.
  [[nodiscard]] std::vector<double> revisitRates() const;
  /// Whether another connection has committed since the last call.
  [[nodiscard]] bool changed();

  SessionReader reader;
  ExplorerConfig config;
  std::vector<FrameRecord> frames;
  std::vector<NodeKey> roots;                   ///< of the tiles
  std::vector<std::int64_t> keyframe_ordinals;  ///< of those with images

 private:
  [[nodiscard]] std::int64_t dataVersion() const;
  std::int64_t data_version_;
};

}  // namespace saccade
