#include "rendering/octree_walk.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "saccade/core/multiversion.hpp"

// The walk is written once over eight lanes and compiled twice. Not SACCADE_MULTIVERSION: the walk calls itself, and
// its lanes need one type for each instruction set. Everything it uses from other headers is included above, so that
// nothing but the walk itself is compiled for the newer processors.
#include "rendering/lanes_portable.hpp"
namespace saccade::portable {
#include "rendering/octree_walk.inl"
}  // namespace saccade::portable

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define SACCADE_HAS_AVX2_WALK
#include <immintrin.h>
#pragma GCC push_options
#pragma GCC target("arch=x86-64-v3")
#include "rendering/lanes_avx2.hpp"
namespace saccade::avx2 {
#include "rendering/octree_walk.inl"
}  // namespace saccade::avx2
#pragma GCC pop_options
#endif

namespace saccade {

InstructionSet bestInstructionSet() {
#ifdef SACCADE_HAS_AVX2_WALK
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2")) {
    return InstructionSet::kAvx2;
  }
#endif
  return InstructionSet::kPortable;
}

void walkOctree(const MapTree& map, const RayGrid& rays, InstructionSet instructions, PixelCanvas& canvas,
                std::vector<VisibleLeaf>& leaves) {
  if (!map.root) return;
#ifdef SACCADE_HAS_AVX2_WALK
  if (instructions == InstructionSet::kAvx2) {
    avx2::OctreeWalk(map, rays, canvas, leaves).run();
    return;
  }
#endif
  static_cast<void>(instructions);
  portable::OctreeWalk(map, rays, canvas, leaves).run();
}

}  // namespace saccade
