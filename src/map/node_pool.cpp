#include "map/node_pool.hpp"

#include <cstdlib>
#include <new>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace saccade {

NodePool::~NodePool() {
  for (std::byte* chunk : chunks_) std::free(chunk);
}

void NodePool::reset() {
  free_ = nullptr;
  used_ = 0;
  chunks_used_ = 0;
  next_ = end_ = nullptr;
}

void NodePool::addChunk() {
  if (chunks_used_ == chunks_.size()) {
    chunks_.reserve(chunks_.size() + 1);
    auto* chunk = static_cast<std::byte*>(std::aligned_alloc(kChunkBytes, kChunkBytes));
    if (chunk == nullptr) throw std::bad_alloc();
#if defined(__linux__)
    madvise(chunk, kChunkBytes, MADV_HUGEPAGE);  // only advice: without it everything works, slower
#endif
    chunks_.push_back(chunk);
  }
  next_ = chunks_[chunks_used_++];
  end_ = next_ + kChunkBytes;
}

}  // namespace saccade
