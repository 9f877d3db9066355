#include "saccade/discovery/boosted_trees.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "core/lanes.hpp"
#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

constexpr std::size_t kGroups = 4;  // of lanes, judged together: trees are read once for all of them
constexpr std::size_t kRows = kGroups * kLanes;

// Adds what `tree` says of kRows rows, given value by value, to `sums`.
SACCADE_INLINE void addTree(const ObliviousTree& tree, const float* columns, float* sums) {
  IntLanes leaf[kGroups] = {};
  for (std::size_t level = 0; level < tree.columns.size(); ++level) {
    const float* values = columns + static_cast<std::size_t>(tree.columns[level]) * kRows;
    const FloatLanes threshold = allLanes(tree.thresholds[level]);
    const IntLanes bit = IntLanes{} + (1 << level);
    for (std::size_t g = 0; g < kGroups; ++g) leaf[g] |= (loadLanes(values + g * kLanes) > threshold) & bit;
  }
  for (std::size_t g = 0; g < kGroups; ++g) {
    alignas(32) std::int32_t number[kLanes];
    storeLanes(leaf[g], number);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      sums[g * kLanes + lane] += tree.leaves[static_cast<std::size_t>(number[lane])];
    }
  }
}

SACCADE_MULTIVERSION void addTrees(const ObliviousTree* trees, std::size_t count, const float* columns, float* sums) {
  for (std::size_t i = 0; i < count; ++i) addTree(trees[i], columns, sums);
}

template <typename Number>
std::vector<Number> takeNumbers(std::istringstream& line, std::size_t count, const char* what) {
  std::vector<Number> numbers;
  for (Number number{}; numbers.size() < count && line >> number;) numbers.push_back(number);
  if (numbers.size() != count) {
    throw std::invalid_argument("expected a line with " + std::to_string(count) + " " + what + ", found \"" +
                                line.str().substr(0, 60) + "\"");
  }
  return numbers;
}

std::istringstream takeLine(std::istringstream& in, const std::string& expected) {
  std::string line;
  if (!std::getline(in, line)) throw std::invalid_argument("expected " + expected + ", found the end");
  return std::istringstream(line);
}

}  // namespace

BoostedTrees::BoostedTrees(std::size_t dimension, float bias, std::vector<ObliviousTree> trees)
    : dimension_(dimension), bias_(bias), trees_(std::move(trees)) {
  for (const ObliviousTree& tree : trees_) {
    const std::size_t questions = tree.columns.size();
    if (questions > kMostQuestions || tree.thresholds.size() != questions ||
        tree.leaves.size() != std::size_t{1} << questions) {
      throw std::invalid_argument("expected a tree of at most " + std::to_string(kMostQuestions) +
                                  " questions with a threshold each and a leaf for all their answers, found " +
                                  std::to_string(questions) + ", " + std::to_string(tree.thresholds.size()) + " and " +
                                  std::to_string(tree.leaves.size()));
    }
    for (const std::int32_t column : tree.columns) {
      if (column < 0 || static_cast<std::size_t>(column) >= dimension_) {
        throw std::invalid_argument("expected a tree that asks for values 0 to " + std::to_string(dimension_) +
                                    ", the last excluded, found " + std::to_string(column));
      }
    }
  }
}

BoostedTrees BoostedTrees::parse(std::string_view text) {
  std::istringstream in{std::string(text)};
  std::istringstream head = takeLine(in, "a line \"boosted-trees DIMENSION BIAS COUNT\"");
  std::string word;
  std::size_t dimension = 0, count = 0;
  float bias = 0.0F;
  if (!(head >> word >> dimension >> bias >> count) || word != "boosted-trees") {
    throw std::invalid_argument("expected a line \"boosted-trees DIMENSION BIAS COUNT\", found \"" +
                                head.str().substr(0, 60) + "\"");
  }
  std::vector<ObliviousTree> trees;
  for (std::size_t i = 0; i < count; ++i) {
    std::istringstream line = takeLine(in, std::to_string(count) + " trees");
    const auto questions = takeNumbers<std::size_t>(line, 1, "number of questions").front();
    if (questions > kMostQuestions) {
      throw std::invalid_argument("expected a tree of at most " + std::to_string(kMostQuestions) +
                                  " questions, found " + std::to_string(questions));
    }
    ObliviousTree tree;
    tree.columns = takeNumbers<std::int32_t>(line, questions, "columns");
    tree.thresholds = takeNumbers<float>(line, questions, "thresholds");
    tree.leaves = takeNumbers<float>(line, std::size_t{1} << questions, "leaves");
    trees.push_back(std::move(tree));
  }
  return {dimension, bias, std::move(trees)};
}

std::string BoostedTrees::text() const {
  std::ostringstream out;
  out.precision(9);  // enough for every float to be read as it was
  out << "boosted-trees " << dimension_ << ' ' << bias_ << ' ' << trees_.size() << '\n';
  for (const ObliviousTree& tree : trees_) {
    out << tree.columns.size();
    for (const std::int32_t column : tree.columns) out << ' ' << column;
    for (const float threshold : tree.thresholds) out << ' ' << threshold;
    for (const float leaf : tree.leaves) out << ' ' << leaf;
    out << '\n';
  }
  return out.str();
}

void BoostedTrees::predict(std::span<const float> rows, std::size_t count, std::span<double> probability) const {
  if (rows.size() < count * dimension_ || probability.size() < count) {
    throw std::invalid_argument("BoostedTrees::predict: " + std::to_string(count) + " rows of " +
                                std::to_string(dimension_) + " values announced, " + std::to_string(rows.size()) +
                                " values given");
  }
  std::vector<float> columns(dimension_ * kRows, 0.0F);
  std::array<float, kRows> sums{};
  for (std::size_t first = 0; first < count; first += kRows) {
    const std::size_t rows_here = std::min(kRows, count - first);
    for (std::size_t i = 0; i < rows_here; ++i) {
      for (std::size_t d = 0; d < dimension_; ++d) columns[d * kRows + i] = rows[(first + i) * dimension_ + d];
    }
    sums.fill(bias_);
    addTrees(trees_.data(), trees_.size(), columns.data(), sums.data());
    for (std::size_t i = 0; i < rows_here; ++i) {
      probability[first + i] = 1.0 / (1.0 + std::exp(-static_cast<double>(sums[i])));
    }
  }
}

}  // namespace saccade
