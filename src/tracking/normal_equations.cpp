#include "tracking/normal_equations.hpp"

#include "core/lanes.hpp"
#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

constexpr std::size_t kSums = RowSums::kSums;

SACCADE_MULTIVERSION
void sumBlock(const ResidualRows& rows, float (*sums)[kLanes]) {
  FloatLanes total[kSums] = {};
  for (std::size_t i = 0; i < ResidualRows::kBlock; i += kLanes) {
    const FloatLanes weight = loadLanes(rows.weight + i), residual = loadLanes(rows.residual + i);
    FloatLanes j[6];
    for (std::size_t a = 0; a < 6; ++a) j[a] = loadLanes(rows.j[a] + i);
    std::size_t k = 0;
    for (std::size_t a = 0; a < 6; ++a) {
      const FloatLanes weighted = j[a] * weight;
      for (std::size_t b = a; b < 6; ++b) total[k++] += weighted * j[b];
    }
    const FloatLanes weighted_residual = residual * weight;
    for (std::size_t a = 0; a < 6; ++a) total[k++] += weighted_residual * j[a];
    total[k] += weight;
    total[k + 1] += weighted_residual;
    total[k + 2] += weighted_residual * residual;
    total[k + 3] += loadLanes(rows.met + i);
    total[k + 4] += loadLanes(rows.near + i);
    total[k + 5] += loadLanes(rows.inlier + i);
  }
  for (std::size_t k = 0; k < kSums; ++k) storeLanes(total[k], sums[k]);
}

}  // namespace

void RowSums::add(const ResidualRows& rows) {
  alignas(32) float lanes[kSums][kLanes];
  sumBlock(rows, lanes);
  for (std::size_t k = 0; k < kSums; ++k) {
    for (const float lane : lanes[k]) total_[k] += static_cast<double>(lane);
  }
}

NormalEquations RowSums::sums() const {
  NormalEquations sums;
  std::size_t k = 0;
  for (int a = 0; a < 6; ++a) {
    for (int b = a; b < 6; ++b) sums.H(a, b) = sums.H(b, a) = total_[k++];
  }
  for (int a = 0; a < 6; ++a) sums.b(a) = total_[k++];
  sums.weight = total_[k];
  sums.weighted_residual = total_[k + 1];
  sums.weighted_square = total_[k + 2];
  sums.met = total_[k + 3];
  sums.near = total_[k + 4];
  sums.inliers = total_[k + 5];
  return sums;
}

}  // namespace saccade
