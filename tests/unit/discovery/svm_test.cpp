#include "saccade/discovery/svm.hpp"

#include <cmath>
#include <fstream>
#include <random>

#include <gtest/gtest.h>
#include <libsvm/svm.h>

#include "saccade/discovery/svm_training.hpp"
#include "support/temporary_folder.hpp"

namespace saccade {
namespace {

// Promised by Svm: what differs from LIBSVM is the order of sums in double precision.
constexpr double kPredictionTolerance = 1e-6;
constexpr std::size_t kDimension = 9;

// Objects inside a shell, the rest around it: only a kernel tells them apart.
SvmExamples shellExamples(std::size_t count) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(-1.5F, 1.5F);
  SvmExamples examples;
  examples.dimension = kDimension;
  for (std::size_t i = 0; i < count; ++i) {
    float squared = 0.0F;
    for (std::size_t d = 0; d < kDimension; ++d) {
      examples.rows.push_back(uniform(random));
      squared += examples.rows.back() * examples.rows.back();
    }
    examples.labels.push_back(squared < 6.5F ? 1 : -1);
    examples.groups.push_back(static_cast<int>(i / 10));
  }
  return examples;
}

TEST(Svm, PredictsWhatLibsvmPredictsFromTheSameText) {
  const SvmExamples examples = shellExamples(301);  // no multiple of the rows or vectors taken together
  const Svm svm = trainSvm(examples, {.c = 4.0, .gamma = 0.2});
  std::vector<double> probability(examples.size());
  svm.predict(examples.rows, examples.size(), probability);

  const test::TemporaryFolder folder;
  const std::string path = (folder.path() / "model").string();
  std::ofstream(path) << svm.text();
  svm_model* model = svm_load_model(path.c_str());
  ASSERT_NE(model, nullptr);
  ASSERT_EQ(model->label[0], 1);
  for (std::size_t i = 0; i < examples.size(); ++i) {
    std::vector<svm_node> row;
    for (std::size_t d = 0; d < kDimension; ++d) {
      row.push_back({static_cast<int>(d) + 1, static_cast<double>(examples.rows[i * kDimension + d])});
    }
    row.push_back({-1, 0.0});
    double expected[2] = {};
    svm_predict_probability(model, row.data(), expected);
    EXPECT_NEAR(probability[i], expected[0], kPredictionTolerance) << "row " << i;
  }
  svm_free_and_destroy_model(&model);
}

TEST(Svm, SeparatesWhatItWasTrainedOn) {
  const SvmExamples examples = shellExamples(400);
  const Svm svm = trainSvm(examples, {.c = 10.0, .gamma = 0.2});
  std::vector<double> probability(examples.size());
  svm.predict(examples.rows, examples.size(), probability);
  std::size_t right = 0;
  for (std::size_t i = 0; i < examples.size(); ++i) right += (probability[i] > 0.5) == (examples.labels[i] > 0) ? 1 : 0;
  EXPECT_GT(right, examples.size() * 9 / 10);
}

TEST(SvmTraining, KeepsToItsNumberOfSupportVectorsAndToItsSeed) {
  const SvmExamples examples = shellExamples(500);
  const SvmTrainingConfig config{.c = 1.0, .gamma = 0.2, .max_vectors = 80, .seed = 3};
  const Svm svm = trainSvm(examples, config);
  EXPECT_LE(svm.supportVectors(), 80U);
  EXPECT_EQ(trainSvm(examples, config).text(), svm.text());
}

TEST(SvmTraining, NeverTurnsTheOrderOfDecisionsRoundWhereGroupsContradictEachOther) {
  // Nearly all objects are in one group, nearly all others in the second: what each teaches is wrong for the other.
  SvmExamples examples = shellExamples(200);
  for (std::size_t i = 0; i < examples.size(); ++i) {
    examples.groups[i] = examples.labels[i] > 0 ? 0 : 1;
    if (i % 10 == 0) examples.groups[i] = 1 - examples.groups[i];
  }
  const Svm svm = trainSvm(examples, {.c = 10.0, .gamma = 0.2, .folds = 2});
  std::vector<double> probability(examples.size());
  svm.predict(examples.rows, examples.size(), probability);
  std::size_t right = 0;
  for (std::size_t i = 0; i < examples.size(); ++i) right += (probability[i] > 0.5) == (examples.labels[i] > 0) ? 1 : 0;
  EXPECT_GT(right, examples.size() * 9 / 10);
}

TEST(SvmTraining, KnowsTheLengthOfARowWhoseLastValueIsAlwaysZero) {
  SvmExamples examples = shellExamples(200);
  for (std::size_t i = kDimension - 1; i < examples.rows.size(); i += kDimension) examples.rows[i] = 0.0F;
  EXPECT_EQ(trainSvm(examples, {.gamma = 0.2}).dimension(), kDimension);
}

TEST(SvmTraining, RefusesExamplesOfOneClassOnly) {
  SvmExamples examples = shellExamples(40);
  std::fill(examples.labels.begin(), examples.labels.end(), std::int8_t{-1});
  EXPECT_THROW((void)trainSvm(examples, {}), std::invalid_argument);
}

TEST(Svm, RefusesATextCutShort) {
  const std::string text = trainSvm(shellExamples(100), {}).text();
  EXPECT_THROW((void)Svm::parse(text.substr(0, text.size() / 2)), std::invalid_argument);
  EXPECT_THROW((void)Svm::parse(""), std::invalid_argument);
}

}  // namespace
}  // namespace saccade
