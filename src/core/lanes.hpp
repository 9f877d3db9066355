#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

namespace saccade {

/// Eight numbers that are worked on at once. GCC and clang make of them what the processor has: one AVX register, or
/// two of SSE or NEON. Not to be passed by value to functions that are not inlined: without AVX that has another ABI.
using FloatLanes = float __attribute__((vector_size(32)));
using IntLanes = std::int32_t __attribute__((vector_size(32)));
inline constexpr int kLanes = 8;

#define SACCADE_INLINE __attribute__((always_inline)) inline

SACCADE_INLINE FloatLanes allLanes(float value) {
  return FloatLanes{} + value;
}
SACCADE_INLINE FloatLanes loadLanes(const float* from) {
  FloatLanes lanes;
  std::memcpy(&lanes, from, sizeof lanes);
  return lanes;
}
SACCADE_INLINE IntLanes loadLanes(const std::int32_t* from) {
  IntLanes lanes;
  std::memcpy(&lanes, from, sizeof lanes);
  return lanes;
}
SACCADE_INLINE void storeLanes(const FloatLanes& lanes, float* to) {
  std::memcpy(to, &lanes, sizeof lanes);
}
SACCADE_INLINE void storeLanes(const IntLanes& lanes, std::int32_t* to) {
  std::memcpy(to, &lanes, sizeof lanes);
}
SACCADE_INLINE FloatLanes least(const FloatLanes& a, const FloatLanes& b) {
  return a < b ? a : b;
}
SACCADE_INLINE FloatLanes most(const FloatLanes& a, const FloatLanes& b) {
  return a > b ? a : b;
}
SACCADE_INLINE FloatLanes magnitude(const FloatLanes& a) {
  return a < 0.0F ? -a : a;
}
/// Towards 0; the lanes must fit.
SACCADE_INLINE IntLanes truncated(const FloatLanes& a) {
  return __builtin_convertvector(a, IntLanes);
}
SACCADE_INLINE FloatLanes toFloat(const IntLanes& a) {
  return __builtin_convertvector(a, FloatLanes);
}
/// Replaces each lane by its square root.
SACCADE_INLINE void squareRoots(FloatLanes& lanes) {
  alignas(32) float values[kLanes];
  storeLanes(lanes, values);
  for (float& value : values) value = std::sqrt(value);
  lanes = loadLanes(values);
}
/// All lanes or-ed together, in pairs: lane i of the lower and of the upper half of the result.
SACCADE_INLINE std::uint64_t orOfPairs(const IntLanes& lanes) {
  using Half = std::int64_t __attribute__((vector_size(16)));
  Half halves[2];
  std::memcpy(halves, &lanes, sizeof halves);
  const Half both = halves[0] | halves[1];  // one operation on a register before anything moves to scalars
  return static_cast<std::uint64_t>(both[0] | both[1]);
}
/// All lanes or-ed together.
SACCADE_INLINE std::uint32_t orOf(const IntLanes& lanes) {
  const std::uint64_t pairs = orOfPairs(lanes);
  return static_cast<std::uint32_t>(pairs | pairs >> 32);
}
/// A comparison as bits, lane 0 the lowest.
SACCADE_INLINE unsigned bitsOf(const IntLanes& mask) {
  return orOf(mask & IntLanes{1, 2, 4, 8, 16, 32, 64, 128});
}
/// Whether a lane of a comparison holds.
SACCADE_INLINE bool any(const IntLanes& mask) {
  return orOfPairs(mask) != 0;
}

}  // namespace saccade
