#include "saccade/discovery/kernel_expansion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace saccade {
namespace {

using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using ConstRows = Eigen::Map<const Rows>;

constexpr int kRounds = 12;
constexpr int kMoves = 400;
constexpr double kRoundTo = 1000.0;
// Keeps the fit from large coefficients of opposite sign on vectors close to each other; per row.
constexpr double kRidge = 1e-6;
constexpr Eigen::Index kBlock = 1024;  // rows whose kernels are in memory at a time

ConstRows asRows(std::span<const double> values, std::size_t dimension) {
  if (dimension == 0 || values.size() % dimension != 0) {
    throw std::invalid_argument("KernelExpansion: expected rows of " + std::to_string(dimension) + " values, found " +
                                std::to_string(values.size()) + " values");
  }
  return {values.data(), static_cast<Eigen::Index>(values.size() / dimension), static_cast<Eigen::Index>(dimension)};
}

// Squared distances of each of the rows (down) from each of the vectors (across).
Rows squaredDistances(const Eigen::Ref<const Rows>& rows, const Eigen::Ref<const Rows>& vectors) {
  Rows distances = -2.0 * rows * vectors.transpose();
  distances.colwise() += rows.rowwise().squaredNorm();
  distances.rowwise() += vectors.rowwise().squaredNorm().transpose();
  return distances.cwiseMax(0.0);
}

// k-means++ (Arthur & Vassilvitskii 2007) and Lloyd's rounds.
Rows clusterMeans(const ConstRows& points, Eigen::Index count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&random] { return static_cast<double>(random() >> 11) * 0x1.0p-53; };
  Rows means(count, points.cols());
  Eigen::VectorXd nearest = Eigen::VectorXd::Constant(points.rows(), std::numeric_limits<double>::infinity());
  auto chosen = static_cast<Eigen::Index>(random() % static_cast<std::uint64_t>(points.rows()));
  for (Eigen::Index k = 0; k < count; ++k) {
    means.row(k) = points.row(chosen);
    nearest = nearest.cwiseMin((points.rowwise() - points.row(chosen)).rowwise().squaredNorm());
    double left = uniform() * nearest.sum();
    for (chosen = 0; chosen + 1 < points.rows() && left >= nearest[chosen]; ++chosen) left -= nearest[chosen];
  }
  for (int round = 0; round < kRounds; ++round) {
    const Rows distances = squaredDistances(points, means);
    Rows sums = Rows::Zero(count, points.cols());
    Eigen::VectorXd members = Eigen::VectorXd::Zero(count);
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
      Eigen::Index closest = 0;
      distances.row(i).minCoeff(&closest);
      sums.row(closest) += points.row(i);
      members[closest] += 1.0;
    }
    for (Eigen::Index k = 0; k < count; ++k) {
      if (members[k] > 0.0) means.row(k) = sums.row(k) / members[k];
    }
  }
  return means;
}

// The function to come close to: its values at some rows.
struct Target {
  ConstRows rows;
  Eigen::Map<const Eigen::VectorXd> values;
  double gamma;
};

// The kernels of each of the rows with each of the vectors, and a column of ones.
Rows kernelsAndOne(const Eigen::Ref<const Rows>& rows, const Rows& vectors, double gamma) {
  Rows kernels = Rows::Ones(rows.rows(), vectors.rows() + 1);
  kernels.leftCols(vectors.rows()) = (-gamma * squaredDistances(rows, vectors)).array().exp();
  return kernels;
}

// Coefficients of the vectors, and last the constant, by the normal equations.
Eigen::VectorXd leastSquares(const Target& target, const Rows& vectors) {
  const Eigen::Index n = target.rows.rows(), m = vectors.rows() + 1;
  Eigen::MatrixXd normal = Eigen::MatrixXd::Identity(m, m) * (kRidge * static_cast<double>(n));
  Eigen::VectorXd right = Eigen::VectorXd::Zero(m);
  for (Eigen::Index begin = 0; begin < n; begin += kBlock) {
    const Eigen::Index block = std::min(kBlock, n - begin);
    const Rows kernels = kernelsAndOne(target.rows.middleRows(begin, block), vectors, target.gamma);
    normal += kernels.transpose() * kernels;
    right += kernels.transpose() * target.values.segment(begin, block);
  }
  return normal.ldlt().solve(right);
}

// Adam (Kingma & Ba 2015) with a step that falls to nothing.
class Adam {
 public:
  explicit Adam(Eigen::Index rows, Eigen::Index columns)
      : mean_(Rows::Zero(rows, columns)), squared_(Rows::Zero(rows, columns)) {}

  // The step against `gradient` in round 1, 2, ... of `rounds`.
  [[nodiscard]] Rows step(const Rows& gradient, int round, int rounds) {
    mean_ = kMeanDecay * mean_ + (1.0 - kMeanDecay) * gradient;
    squared_ = kSquareDecay * squared_ + (1.0 - kSquareDecay) * gradient.cwiseAbs2();
    const double length = kStep * (1.0 - static_cast<double>(round) / (rounds + 1));
    const double mean_bias = 1.0 - std::pow(kMeanDecay, round), square_bias = 1.0 - std::pow(kSquareDecay, round);
    return -length / mean_bias * mean_.array() / ((squared_ / square_bias).array().sqrt() + 1e-8);
  }

 private:
  static constexpr double kMeanDecay = 0.9, kSquareDecay = 0.99, kStep = 0.03;
  Rows mean_, squared_;
};

// Moves the vectors down the gradient of the squared error at rows drawn anew in each round; `fit` moves with them.
void moveVectors(const Target& target, Eigen::VectorXd fit, std::uint64_t seed, Rows& vectors) {
  std::mt19937_64 random(seed);
  const Eigen::Index m = vectors.rows(), n = target.rows.rows(), drawn = std::min(kBlock, n);
  Adam vector_steps(m, vectors.cols()), fit_steps(m + 1, 1);
  Rows rows(drawn, vectors.cols());
  Eigen::VectorXd wanted(drawn);
  for (int round = 1; round <= kMoves; ++round) {
    for (Eigen::Index i = 0; i < drawn; ++i) {
      const auto row = static_cast<Eigen::Index>(random() % static_cast<std::uint64_t>(n));
      rows.row(i) = target.rows.row(row);
      wanted[i] = target.values[row];
    }
    const Rows kernels = kernelsAndOne(rows, vectors, target.gamma);
    const Eigen::VectorXd error = (kernels * fit - wanted) / static_cast<double>(drawn);
    const Rows fit_gradient = kernels.transpose() * error;
    // d/dv of c exp(-γ |x - v|²) is 2 γ c exp(...) (x - v).
    const Rows pull =
        (kernels.leftCols(m).array().colwise() * error.array()).rowwise() * fit.head(m).transpose().array();
    Rows vector_gradient = pull.transpose() * rows;
    vector_gradient -= (vectors.array().colwise() * pull.colwise().sum().transpose().array()).matrix();
    vectors += vector_steps.step(2.0 * target.gamma * vector_gradient, round, kMoves);
    fit += fit_steps.step(fit_gradient, round, kMoves);
  }
}

}  // namespace

std::vector<double> KernelExpansion::values(std::span<const double> rows) const {
  const ConstRows points = asRows(rows, dimension), own = asRows(vectors, dimension);
  const Eigen::Map<const Eigen::VectorXd> weights(coefficients.data(), own.rows());
  std::vector<double> result(static_cast<std::size_t>(points.rows()));
  Eigen::Map<Eigen::VectorXd> out(result.data(), points.rows());
  for (Eigen::Index begin = 0; begin < points.rows(); begin += kBlock) {
    const Eigen::Index n = std::min(kBlock, points.rows() - begin);
    const Rows kernel = (-gamma * squaredDistances(points.middleRows(begin, n), own)).array().exp();
    out.segment(begin, n) = (kernel * weights).array() - rho;
  }
  return result;
}

KernelExpansion reduced(const KernelExpansion& whole, std::size_t count, std::span<const double> rows,
                        std::uint64_t seed) {
  if (whole.size() <= count) return whole;
  const std::vector<double> values = whole.values(rows);
  const Target target{
      asRows(rows, whole.dimension), {values.data(), static_cast<Eigen::Index>(values.size())}, whole.gamma};
  Rows vectors = clusterMeans(asRows(whole.vectors, whole.dimension), static_cast<Eigen::Index>(count), seed);
  moveVectors(target, leastSquares(target, vectors), seed, vectors);
  vectors = (vectors * kRoundTo).array().round() / kRoundTo;
  const Eigen::VectorXd fit = leastSquares(target, vectors);

  KernelExpansion small{whole.dimension, whole.gamma, -fit[vectors.rows()], {}, {}};
  small.vectors.assign(vectors.data(), vectors.data() + vectors.size());
  small.coefficients.assign(fit.data(), fit.data() + vectors.rows());
  return small;
}

}  // namespace saccade
