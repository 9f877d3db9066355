#pragma once

#include <cstddef>
#include <vector>

#include "saccade/map/map_cursor.hpp"

namespace saccade {

/// Blocks for the families of one octree: 256 bytes each, aligned to 64, cut from chunks of 2 MiB in huge pages where
/// the system gives them (first touch of small pages costs 50 times more). Freed blocks are used again, last first.
///
/// Not for several threads at once: it belongs to one tree, and a tree has one writer.
class NodePool {
 public:
  NodePool() = default;
  ~NodePool();
  NodePool(const NodePool&) = delete;
  NodePool& operator=(const NodePool&) = delete;

  /// A block of NodeLayout::kFamilyBytes with undefined content.
  [[nodiscard]] void* allocate() {
    ++used_;
    if (free_ != nullptr) {
      FreeBlock* block = free_;
      free_ = block->next;
      return block;
    }
    if (next_ == end_) addChunk();
    void* block = next_;
    next_ += NodeLayout::kFamilyBytes;
    return block;
  }
  void release(void* block) {
    --used_;
    free_ = ::new (block) FreeBlock{free_};
  }
  /// Forgets all blocks but keeps the chunks for new ones.
  void reset();
  /// What the system gave.
  [[nodiscard]] std::size_t bytes() const { return chunks_.size() * kChunkBytes; }
  /// What blocks in use take of it.
  [[nodiscard]] std::size_t usedBytes() const { return used_ * NodeLayout::kFamilyBytes; }

 private:
  struct FreeBlock {
    FreeBlock* next;
  };
  static constexpr std::size_t kChunkBytes = std::size_t{2} << 20;

  void addChunk();

  std::vector<std::byte*> chunks_;
  std::size_t chunks_used_ = 0;
  std::byte* next_ = nullptr;
  std::byte* end_ = nullptr;
  FreeBlock* free_ = nullptr;
  std::size_t used_ = 0;
};

}  // namespace saccade
