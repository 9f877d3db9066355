#pragma once

#include <cstdint>
#include <cstring>
#include <string>

#include "saccade/inspection/attention_replay.hpp"

namespace saccade {

/// Bytes that say something of single leaves, tile by tile, as AttentionReplay::encode() describes them: for each tile
/// (depth 10) its corner as 3 × uint16, 2 bytes of 0, the number of entries as uint32, then the entries, whose bits
/// 0-17 are a Morton code in the tile.
class TileEntries {
 public:
  static constexpr int kTileBits = 18;  ///< of a Morton code inside a tile of 64 leaves a side

  /// Adds an entry for the leaf with `morton_code`, with `rest` above its bits 0-17. Codes must not fall.
  void add(std::uint64_t morton_code, std::uint32_t rest) {
    if (count_ == 0 || morton_code >> kTileBits != tile_) beginTile(morton_code >> kTileBits);
    const std::uint32_t entry = static_cast<std::uint32_t>(morton_code & ((1u << kTileBits) - 1)) | rest << kTileBits;
    put(&entry, sizeof entry);
    ++count_;
    std::memcpy(bytes_.data() + count_at_, &count_, sizeof count_);
  }
  [[nodiscard]] std::string take() { return std::move(bytes_); }

 private:
  void beginTile(std::uint64_t tile) {
    tile_ = tile;
    count_ = 0;
    const LeafKey corner = leafKeyOf(tile << kTileBits);
    const std::uint16_t head[4] = {corner.x, corner.y, corner.z, 0};
    put(head, sizeof head);
    count_at_ = bytes_.size();
    put(&count_, sizeof count_);
  }
  void put(const void* data, std::size_t size) { bytes_.append(static_cast<const char*>(data), size); }

  std::string bytes_;
  std::uint64_t tile_ = 0;
  std::uint32_t count_ = 0;
  std::size_t count_at_ = 0;
};

}  // namespace saccade
