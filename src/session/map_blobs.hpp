#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "saccade/map/attend_log.hpp"
#include "saccade/map/map_tiles.hpp"
#include "saccade/map/surface_volume.hpp"

/// How the parts of the map become keys and bytes of a session's blob tables.
namespace saccade {

/// A tile's key: its depth above the 48 bits of its lowest corner.
[[nodiscard]] std::uint64_t tileKey(const NodeKey& root);
/// Inverse of tileKey().
[[nodiscard]] NodeKey tileRoot(std::uint64_t key);

/// A brick's key: x, y, z with 21 bits each, offset so that none is negative.
[[nodiscard]] std::uint64_t brickKey(const BrickPosition& position);
/// Inverse of brickKey().
[[nodiscard]] BrickPosition brickPosition(std::uint64_t key);

[[nodiscard]] std::string bytesOf(const std::vector<std::byte>& data);
/// Distances, then weights, little-endian.
[[nodiscard]] std::string bytesOf(const SurfaceBrick& brick);

/// One tick of the log: frame, then per candidate rank, number of leaves and their keys, then the leaves whose flag
/// came on and those that were forgotten. Numbers are LEB128; keys are packed keys in rising order, as
/// differences.
[[nodiscard]] std::string encodeTick(const AttendLog& log, std::size_t i);

/// Inverse of bytesOf(brick). Throws IoError naming `path` for bytes of another size.
[[nodiscard]] SurfaceBrick brickFromBytes(std::string_view bytes, const std::filesystem::path& path);

/// One tick of the log as it was recorded.
struct LoggedTick {
  TickEvents events;
  std::vector<int> ranks;
  std::vector<std::vector<LeafKey>> leaves;  ///< of each candidate, in rising order
};

/// Inverse of encodeTick(). Throws IoError naming `path` for bytes that it cannot have written.
[[nodiscard]] LoggedTick decodeTick(std::string_view bytes, Tick tick, const std::filesystem::path& path);

}  // namespace saccade
