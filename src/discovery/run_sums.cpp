#include "saccade/discovery/run_sums.hpp"

#include <bit>
#include <cstring>

#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

using FourBytes = std::uint8_t __attribute__((vector_size(4)));
using FourFloats = float __attribute__((vector_size(16)));
using FourInts = std::int32_t __attribute__((vector_size(16)));
using FourDoubles = double __attribute__((vector_size(32)));

constexpr std::size_t kQuads = kRunSums / 4;

// Squared colours are summed as 32-bit numbers: a run must not be longer than 33 000 pixels.
SACCADE_MULTIVERSION void add(const PixelRow& row, const CommonRun* runs, std::size_t count, double* first,
                              double* second) {
  int u = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const int begin = u, end = runs[i].end_u;
    FourDoubles vertex = {}, normal = {}, scatter = {}, rest = {};
    FourInts color = {}, squares = {};
    double saliency = 0.0;
    int measured = 0, with_normal = 0;
    for (; u < end; ++u) {
      FourFloats p, n;  // the fourth lanes are the next pixel's, and nothing is made of them
      FourBytes bytes;
      std::memcpy(&p, static_cast<const void*>(row.vertices + u), sizeof p);
      std::memcpy(&n, static_cast<const void*>(row.normals + u), sizeof n);
      std::memcpy(&bytes, static_cast<const void*>(row.color + u), sizeof bytes);
      const FourInts bgr = __builtin_convertvector(bytes, FourInts);
      color += bgr;
      squares += bgr * bgr;
      vertex += __builtin_convertvector(p, FourDoubles);
      normal += __builtin_convertvector(n, FourDoubles);
      const FourFloats xxxy = __builtin_shufflevector(p, p, 0, 0, 0, 1);
      const FourFloats xyzy = __builtin_shufflevector(p, p, 0, 1, 2, 1);
      const FourFloats yzzz = __builtin_shufflevector(p, p, 1, 2, 2, 2);
      const FourFloats zzzz = __builtin_shufflevector(p, p, 2, 2, 2, 2);
      scatter += __builtin_convertvector(xxxy * xyzy, FourDoubles);
      rest += __builtin_convertvector(yzzz * zzzz, FourDoubles);
      saliency += static_cast<double>(row.saliency[u]);
      measured += row.vertices[u][2] > 0.0F ? 1 : 0;
      const cv::Vec3f& own = row.normals[u];
      const std::uint32_t bits = std::bit_cast<std::uint32_t>(own[0]) | std::bit_cast<std::uint32_t>(own[1]) |
                                 std::bit_cast<std::uint32_t>(own[2]);
      with_normal += bits << 1 != 0 ? 1 : 0;  // without the sign: -0 is no normal
    }
    vertex[3] = measured;
    normal[3] = with_normal;
    rest[2] = saliency;
    rest[3] = 0.0;
    color[3] = squares[0] + squares[1] + squares[2];
    FourDoubles powers_begin, powers;
    std::memcpy(&powers_begin, row.column_powers + 4 * begin, sizeof powers_begin);
    std::memcpy(&powers, row.column_powers + 4 * end, sizeof powers);
    powers -= powers_begin;
    const FourDoubles by_v = powers * row.v, by_v2 = by_v * row.v, by_v3 = by_v2 * row.v;
    const FourDoubles sums[kQuads] = {vertex, normal, scatter, rest, __builtin_convertvector(color, FourDoubles),
                                      powers, by_v,   by_v2,   by_v3};
    double* const owners[2] = {first + static_cast<std::size_t>(runs[i].first) * kRunSums,
                               second + static_cast<std::size_t>(runs[i].second) * kRunSums};
    for (double* const owner : owners) {
      for (std::size_t q = 0; q < kQuads; ++q) {
        FourDoubles sum;
        std::memcpy(&sum, owner + 4 * q, sizeof sum);
        sum += sums[q];
        std::memcpy(owner + 4 * q, &sum, sizeof sum);
      }
    }
  }
}

}  // namespace

void addRuns(const PixelRow& row, std::span<const CommonRun> runs, double* first, double* second) {
  add(row, runs.data(), runs.size(), first, second);
}

}  // namespace saccade
