#include "saccade/discovery/boosted_trees_training.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>

#include <tbb/parallel_for.h>

namespace saccade {
namespace {

constexpr std::size_t kMostCuts = 127;
constexpr double kLeastProbability = 1e-4;  // of the bias: targets may be all alike

// Each column as numbers of bins: bin i holds the values above cut i - 1 and up to cut i.
struct BinnedColumns {
  std::vector<std::vector<float>> cuts;
  std::vector<std::vector<std::uint8_t>> bins;
};

std::vector<float> quantileCuts(std::vector<float> values) {
  std::sort(values.begin(), values.end());
  std::vector<float> cuts;
  for (std::size_t i = 1; i <= kMostCuts; ++i) {
    const float cut = values[i * values.size() / (kMostCuts + 1)];
    if (cut < values.back() && (cuts.empty() || cut > cuts.back())) cuts.push_back(cut);
  }
  return cuts;
}

BinnedColumns binColumns(const BoostingExamples& examples) {
  BinnedColumns columns;
  columns.cuts.resize(examples.dimension);
  columns.bins.resize(examples.dimension);
  tbb::parallel_for(std::size_t{0}, examples.dimension, [&](std::size_t column) {
    std::vector<float> values(examples.size());
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = examples.rows[i * examples.dimension + column];
    const std::vector<float>& cuts = columns.cuts[column] = quantileCuts(values);
    for (const float value : values) {
      const auto bin = std::lower_bound(cuts.begin(), cuts.end(), value) - cuts.begin();
      columns.bins[column].push_back(static_cast<std::uint8_t>(bin));
    }
  });
  return columns;
}

// First and second derivative of the loss, summed.
struct Derivatives {
  double first = 0.0, second = 0.0;

  void operator+=(const Derivatives& other) { first += other.first, second += other.second; }
  [[nodiscard]] Derivatives without(const Derivatives& other) const {
    return {first - other.first, second - other.second};
  }
  // What a Newton step lowers the loss by, twice.
  [[nodiscard]] double gain(double ridge) const { return first * first / (second + ridge); }
};

struct Question {
  double gain = -1.0;
  std::size_t column = 0, cut = 0;
};

// Grows one tree on the rows drawn for it.
class TreeGrower {
 public:
  TreeGrower(const BinnedColumns& columns, const std::vector<std::uint32_t>& rows,
             const std::vector<Derivatives>& derivatives, const BoostingConfig& config)
      : columns_(columns), rows_(rows), derivatives_(derivatives), config_(config), leaf_(rows.size(), 0) {}

  ObliviousTree grow(const std::vector<std::size_t>& allowed) {
    ObliviousTree tree;
    for (std::uint32_t level = 0; level < static_cast<std::uint32_t>(config_.questions); ++level) {
      const Question best = bestQuestion(allowed, std::size_t{1} << level);
      if (best.gain < 0.0) break;
      tree.columns.push_back(static_cast<std::int32_t>(best.column));
      tree.thresholds.push_back(columns_.cuts[best.column][best.cut]);
      const std::vector<std::uint8_t>& bins = columns_.bins[best.column];
      for (std::size_t i = 0; i < rows_.size(); ++i) leaf_[i] |= (bins[rows_[i]] > best.cut ? 1U : 0U) << level;
    }
    std::vector<Derivatives> sums(std::size_t{1} << tree.columns.size());
    for (std::size_t i = 0; i < rows_.size(); ++i) sums[leaf_[i]] += derivatives_[rows_[i]];
    for (const Derivatives& sum : sums) {
      tree.leaves.push_back(static_cast<float>(-config_.rate * sum.first / (sum.second + config_.ridge)));
    }
    return tree;
  }

 private:
  [[nodiscard]] Question bestQuestion(const std::vector<std::size_t>& allowed, std::size_t leaves) const {
    std::vector<Question> questions(allowed.size());
    tbb::parallel_for(std::size_t{0}, allowed.size(),
                      [&](std::size_t i) { questions[i] = bestOfColumn(allowed[i], leaves); });
    Question best;
    for (const Question& question : questions) {
      if (question.gain > best.gain) best = question;
    }
    return best;
  }

  [[nodiscard]] Question bestOfColumn(std::size_t column, std::size_t leaves) const {
    const std::size_t cuts = columns_.cuts[column].size(), bins = cuts + 1;
    const std::vector<std::uint8_t>& bin = columns_.bins[column];
    std::vector<Derivatives> histogram(leaves * bins);
    for (std::size_t i = 0; i < rows_.size(); ++i) histogram[leaf_[i] * bins + bin[rows_[i]]] += derivatives_[rows_[i]];
    std::vector<double> gains(cuts, 0.0);
    for (std::size_t leaf = 0; leaf < leaves; ++leaf) {
      const Derivatives* own = histogram.data() + leaf * bins;
      Derivatives whole, below;
      for (std::size_t b = 0; b < bins; ++b) whole += own[b];
      for (std::size_t cut = 0; cut < cuts; ++cut) {
        below += own[cut];
        gains[cut] += below.gain(config_.ridge) + whole.without(below).gain(config_.ridge);
      }
    }
    Question best;
    for (std::size_t cut = 0; cut < cuts; ++cut) {
      if (gains[cut] > best.gain) best = {gains[cut], column, cut};
    }
    return best;
  }

  const BinnedColumns& columns_;
  const std::vector<std::uint32_t>& rows_;
  const std::vector<Derivatives>& derivatives_;
  const BoostingConfig& config_;
  std::vector<std::uint32_t> leaf_;
};

// A share of 0 .. count - 1, at least one, rising.
template <typename Index>
std::vector<Index> drawn(std::size_t count, double share, std::mt19937_64& random) {
  std::vector<Index> all(count);
  std::iota(all.begin(), all.end(), Index{0});
  const auto kept = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(share * static_cast<double>(count))));
  for (std::size_t i = 0; i < kept; ++i) std::swap(all[i], all[i + random() % (count - i)]);
  all.resize(kept);
  std::sort(all.begin(), all.end());
  return all;
}

void requireSizes(const BoostingExamples& examples) {
  const std::size_t n = examples.size();
  if (n == 0 || examples.dimension == 0 || examples.weights.size() != n ||
      examples.rows.size() != n * examples.dimension) {
    throw std::invalid_argument("trainBoostedTrees: " + std::to_string(n) + " targets, " +
                                std::to_string(examples.weights.size()) + " weights, " +
                                std::to_string(examples.rows.size()) + " values of " +
                                std::to_string(examples.dimension) + " a row");
  }
}

double logOddsOfMean(const BoostingExamples& examples) {
  double sum = 0.0, weights = 0.0;
  for (std::size_t i = 0; i < examples.size(); ++i) {
    sum += static_cast<double>(examples.weights[i]) * static_cast<double>(examples.targets[i]);
    weights += static_cast<double>(examples.weights[i]);
  }
  const double mean = std::clamp(sum / weights, kLeastProbability, 1.0 - kLeastProbability);
  return std::log(mean / (1.0 - mean));
}

}  // namespace

BoostedTrees trainBoostedTrees(const BoostingExamples& examples, const BoostingConfig& config) {
  requireSizes(examples);
  const BinnedColumns columns = binColumns(examples);
  const double bias = logOddsOfMean(examples);
  std::mt19937_64 random(config.seed);
  std::vector<double> sums(examples.size(), bias);
  std::vector<Derivatives> derivatives(examples.size());
  std::vector<ObliviousTree> trees;
  for (int round = 0; round < config.trees; ++round) {
    for (std::size_t i = 0; i < examples.size(); ++i) {
      const double p = 1.0 / (1.0 + std::exp(-sums[i])), weight = static_cast<double>(examples.weights[i]);
      derivatives[i] = {weight * (p - static_cast<double>(examples.targets[i])), weight * p * (1.0 - p)};
    }
    const auto rows = drawn<std::uint32_t>(examples.size(), config.row_share, random);
    const auto allowed = drawn<std::size_t>(examples.dimension, config.column_share, random);
    const ObliviousTree tree = TreeGrower(columns, rows, derivatives, config).grow(allowed);
    for (std::size_t i = 0; i < examples.size(); ++i) {
      std::size_t leaf = 0;
      for (std::size_t level = 0; level < tree.columns.size(); ++level) {
        const auto column = static_cast<std::size_t>(tree.columns[level]);
        const float value = examples.rows[i * examples.dimension + column];
        leaf |= static_cast<std::size_t>(value > tree.thresholds[level]) << level;
      }
      sums[i] += static_cast<double>(tree.leaves[leaf]);
    }
    trees.push_back(tree);
  }
  return {examples.dimension, static_cast<float>(bias), std::move(trees)};
}

}  // namespace saccade
