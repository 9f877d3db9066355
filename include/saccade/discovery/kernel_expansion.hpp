#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace saccade {

/// A decision function over RBF kernels: f(x) = Σ cᵢ exp(-γ |x - vᵢ|²) - ρ, what an SVM of two classes comes to.
struct KernelExpansion {
  std::size_t dimension = 0;
  double gamma = 0.0;
  double rho = 0.0;
  std::vector<double> vectors;  ///< row after row
  std::vector<double> coefficients;

  [[nodiscard]] std::size_t size() const { return coefficients.size(); }
  /// f of each of the rows. Throws std::invalid_argument if `rows` are not whole rows.
  [[nodiscard]] std::vector<double> values(std::span<const double> rows) const;
};

/// Returns an expansion of at most `count` vectors that is close to `whole` at `rows` (reduced set, Burges 1996): an
/// SVM trained on many examples at the cost of one with few vectors. The vectors start as the means of clusters of the
/// old ones (k-means, seeded), move down the gradient of the squared error and are rounded to 1/1000; coefficients and
/// ρ are the least squares fit. `whole` itself if it has no more than `count`. Deterministic.
[[nodiscard]] KernelExpansion reduced(const KernelExpansion& whole, std::size_t count, std::span<const double> rows,
                                      std::uint64_t seed);

}  // namespace saccade
