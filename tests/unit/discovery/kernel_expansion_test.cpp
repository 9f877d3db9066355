#include "saccade/discovery/kernel_expansion.hpp"

#include <cmath>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

namespace saccade {
namespace {

constexpr double kSumTolerance = 1e-12;  // sums of a few hundred doubles, in another order

std::vector<double> randomRows(std::size_t count, std::size_t dimension, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> rows(count * dimension);
  for (double& value : rows) value = normal(random);
  return rows;
}

TEST(KernelExpansion, ValuesAreTheSumsOfItsKernels) {
  const KernelExpansion expansion{2, 0.5, 0.25, {0.0, 0.0, 1.0, 2.0}, {2.0, -1.0}};
  const std::vector<double> values = expansion.values(std::vector<double>{1.0, 0.0});
  ASSERT_EQ(values.size(), 1U);
  EXPECT_NEAR(values[0], 2.0 * std::exp(-0.5) - std::exp(-2.0) - 0.25, kSumTolerance);
}

TEST(KernelExpansion, ReducedKeepsToItsNumberOfVectorsAndStaysCloseToTheWhole) {
  KernelExpansion whole{3, 0.1, 0.3, randomRows(600, 3, 1), {}};
  for (std::size_t i = 0; i < 600; ++i) whole.coefficients.push_back(whole.vectors[3 * i] > 0.0 ? 1.0 : -1.0);
  const std::vector<double> rows = randomRows(900, 3, 2), fresh = randomRows(200, 3, 3);
  const KernelExpansion small = reduced(whole, 60, rows, 7);
  ASSERT_EQ(small.size(), 60U);
  const std::vector<double> expected = whole.values(fresh), found = small.values(fresh);
  double squared = 0.0, error = 0.0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    squared += expected[i] * expected[i];
    error += (found[i] - expected[i]) * (found[i] - expected[i]);
  }
  // So wide a kernel in three dimensions has little room for what 60 vectors cannot say.
  EXPECT_LT(std::sqrt(error / squared), 0.01);
  EXPECT_EQ(reduced(whole, 60, rows, 7).coefficients, small.coefficients);
}

TEST(KernelExpansion, ReducedFindsTheFewVectorsThatManyCopiesStandFor) {
  // Five groups of vectors so close together that each acts as one.
  constexpr double kSpread = 1e-3, kError = 1e-2;
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  KernelExpansion whole{2, 0.5, -0.1, {}, {}};
  for (std::size_t i = 0; i < 100; ++i) {
    const auto group = static_cast<double>(i % 5);
    whole.vectors.push_back(2.0 * group + kSpread * normal(random));
    whole.vectors.push_back(group + kSpread * normal(random));
    whole.coefficients.push_back(i % 5 == 2 ? -0.05 : 0.05);
  }
  const std::vector<double> rows = randomRows(500, 2, 5);
  const KernelExpansion small = reduced(whole, 5, rows, 1);
  const std::vector<double> expected = whole.values(rows), found = small.values(rows);
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(found[i], expected[i], kError);
}

TEST(KernelExpansion, ReducedLeavesASmallOneAlone) {
  const KernelExpansion whole{1, 0.5, 0.0, {1.0, 2.0}, {1.0, -1.0}};
  EXPECT_EQ(reduced(whole, 2, std::vector<double>{0.0}, 1).vectors, whole.vectors);
}

TEST(KernelExpansion, RefusesRowsCutShort) {
  const KernelExpansion expansion{2, 0.5, 0.0, {0.0, 0.0}, {1.0}};
  EXPECT_THROW((void)expansion.values(std::vector<double>{1.0, 2.0, 3.0}), std::invalid_argument);
}

}  // namespace
}  // namespace saccade
