#include "saccade/discovery/boosted_trees.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "saccade/discovery/boosted_trees_training.hpp"

namespace saccade {
namespace {

constexpr std::size_t kDimension = 5;
// Sums of some hundred leaves in single precision, and the sigmoid is flatter than its argument.
constexpr double kSumTolerance = 1e-5;

// Worth more the nearer to the centre: no single value tells.
BoostingExamples ballExamples(std::size_t count) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(-1.0F, 1.0F);
  BoostingExamples examples;
  examples.dimension = kDimension;
  for (std::size_t i = 0; i < count; ++i) {
    float squared = 0.0F;
    for (std::size_t d = 0; d < kDimension; ++d) {
      examples.rows.push_back(uniform(random));
      squared += examples.rows.back() * examples.rows.back();
    }
    examples.targets.push_back(squared < 1.5F ? 1.0F : 0.0F);
    examples.weights.push_back(1.0F);
  }
  return examples;
}

std::vector<double> predictionsOf(const BoostedTrees& trees, const BoostingExamples& examples) {
  std::vector<double> probability(examples.size());
  trees.predict(examples.rows, examples.size(), probability);
  return probability;
}

TEST(BoostedTrees, PredictsWhatIsFoundByFollowingEachTreeByHand) {
  const BoostingExamples examples = ballExamples(301);  // no multiple of the rows taken together
  const BoostedTrees trees = trainBoostedTrees(examples, {.trees = 40, .questions = 5});
  const std::vector<double> probability = predictionsOf(trees, examples);
  const BoostedTrees empty = BoostedTrees(kDimension, std::log(3.0F), {});
  EXPECT_NEAR(predictionsOf(empty, examples)[300], 0.75, kSumTolerance);
  const double base = std::stod(trees.text().substr(trees.text().find(' ', 14) + 1));
  for (std::size_t i = 0; i < examples.size(); ++i) {
    double sum = base;
    for (const ObliviousTree& tree : trees.trees()) {
      std::size_t leaf = 0;
      for (std::size_t q = tree.columns.size(); q-- > 0;) {
        const float value = examples.rows[i * kDimension + static_cast<std::size_t>(tree.columns[q])];
        leaf = 2 * leaf + (value > tree.thresholds[q] ? 1 : 0);
      }
      sum += static_cast<double>(tree.leaves[leaf]);
    }
    EXPECT_NEAR(probability[i], 1.0 / (1.0 + std::exp(-sum)), kSumTolerance) << "row " << i;
  }
}

TEST(BoostedTrees, TellWhatTheyWereTaughtOnRowsNeverSeen) {
  BoostingExamples all = ballExamples(4000), seen = all;
  seen.rows.resize(2000 * kDimension);
  seen.targets.resize(2000);
  seen.weights.resize(2000);
  const std::vector<double> probability = predictionsOf(trainBoostedTrees(seen, {.trees = 100}), all);
  int right = 0;
  for (std::size_t i = 2000; i < 4000; ++i) right += (probability[i] > 0.5) == (all.targets[i] > 0.5F) ? 1 : 0;
  EXPECT_GT(right, 1700);  // of 2000; the larger class alone is about 1150
}

TEST(BoostedTrees, SayTheMeanOfTheTargetsWhereNothingTellsThemApart) {
  BoostingExamples examples = ballExamples(1000);
  std::fill(examples.rows.begin(), examples.rows.end(), 1.0F);
  for (std::size_t i = 0; i < examples.size(); ++i) examples.targets[i] = i % 4 == 0 ? 0.8F : 0.0F;
  EXPECT_NEAR(predictionsOf(trainBoostedTrees(examples, {.trees = 5, .row_share = 1.0}), examples)[0], 0.2,
              kSumTolerance);
}

TEST(BoostedTreesTraining, ComesToTheSameAtAnyNumberOfThreads) {
  const BoostingExamples examples = ballExamples(500);
  const std::string text = trainBoostedTrees(examples, {.trees = 20}).text();
  const tbb::global_control alone(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(trainBoostedTrees(examples, {.trees = 20}).text(), text);
  EXPECT_NE(trainBoostedTrees(examples, {.trees = 20, .seed = 2}).text(), text);
}

TEST(BoostedTreesTraining, RefusesExamplesOfWhichSomethingIsMissing) {
  BoostingExamples examples = ballExamples(10);
  examples.weights.pop_back();
  EXPECT_THROW((void)trainBoostedTrees(examples, {}), std::invalid_argument);
  EXPECT_THROW((void)trainBoostedTrees({.dimension = 3, .rows = {}, .targets = {}, .weights = {}}, {}),
               std::invalid_argument);
}

TEST(BoostedTrees, AreReadFromTheirTextAsTheyWere) {
  const BoostingExamples examples = ballExamples(200);
  const BoostedTrees trees = trainBoostedTrees(examples, {.trees = 30});
  const BoostedTrees read = BoostedTrees::parse(trees.text());
  EXPECT_EQ(read.text(), trees.text());
  EXPECT_EQ(predictionsOf(read, examples), predictionsOf(trees, examples));
}

TEST(BoostedTrees, RefuseATextThatIsCutShortOrAsksForAValueThatThereIsNot) {
  const std::string text = trainBoostedTrees(ballExamples(200), {.trees = 10}).text();
  EXPECT_THROW((void)BoostedTrees::parse(text.substr(0, text.size() / 2)), std::invalid_argument);
  EXPECT_THROW((void)BoostedTrees::parse(""), std::invalid_argument);
  EXPECT_THROW((void)BoostedTrees::parse("boosted-trees 2 0 1\n1 2 0.5 0 1\n"), std::invalid_argument);
  EXPECT_THROW((void)BoostedTrees::parse("boosted-trees 2 0 1\n40 1\n"), std::invalid_argument);
  EXPECT_NO_THROW((void)BoostedTrees::parse("boosted-trees 2 0 1\n1 1 0.5 0 1\n"));
}

}  // namespace
}  // namespace saccade
