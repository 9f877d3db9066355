#pragma once

#include <cstdint>
#include <immintrin.h>

namespace saccade::avx2 {

/// Eight floats that are worked on at once; processors with AVX2. See lanes_portable.hpp for what each does.
struct Lanes {
  __m256 lanes;

  static Lanes all(float value) { return {_mm256_set1_ps(value)}; }
  static Lanes load(const float* from) { return {_mm256_loadu_ps(from)}; }

  void storeWhole(std::int32_t* to) const {
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), _mm256_cvttps_epi32(lanes));
  }
  void storeWhere(unsigned bits, float* to, std::int32_t value, std::int32_t* beside) const {
    const __m256i bit = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
    const __m256i chosen = _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(static_cast<int>(bits)), bit), bit);
    _mm256_maskstore_ps(to, chosen, lanes);
    _mm256_maskstore_epi32(beside, chosen, _mm256_set1_epi32(value));
  }
};

inline Lanes operator+(Lanes a, Lanes b) {
  return {_mm256_add_ps(a.lanes, b.lanes)};
}
inline Lanes operator-(Lanes a, Lanes b) {
  return {_mm256_sub_ps(a.lanes, b.lanes)};
}
inline Lanes operator*(Lanes a, Lanes b) {
  return {_mm256_mul_ps(a.lanes, b.lanes)};
}
inline Lanes operator/(Lanes a, Lanes b) {
  return {_mm256_div_ps(a.lanes, b.lanes)};
}
inline Lanes min(Lanes a, Lanes b) {
  return {_mm256_min_ps(a.lanes, b.lanes)};
}
inline Lanes max(Lanes a, Lanes b) {
  return {_mm256_max_ps(a.lanes, b.lanes)};
}
inline Lanes truncated(Lanes a) {
  return {_mm256_round_ps(a.lanes, _MM_FROUND_TO_ZERO | _MM_FROUND_NO_EXC)};
}
inline Lanes abs(Lanes a) {
  return {_mm256_andnot_ps(_mm256_set1_ps(-0.0f), a.lanes)};
}
inline unsigned greater(Lanes a, Lanes b) {
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(a.lanes, b.lanes, _CMP_GT_OQ)));
}

}  // namespace saccade::avx2
