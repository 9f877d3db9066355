#include "saccade/evaluation/ranker_training.hpp"

#include <gtest/gtest.h>

namespace saccade {
namespace {

RankerTrainingConfig quickTraining() {
  RankerTrainingConfig config;
  config.usePaperOnly();  // the pool of blobs alone is small
  config.discovery.perception.max_maxima = 24;
  config.svm.c_values = {1.0};
  config.svm.gamma_values = {0.05};
  config.svm.max_vectors = 60;
  return config;
}

// Views from along the way: two neighbouring frames of a desk show too few objects to judge by.
const std::vector<std::string> kDesks{"sim:desk?seed=1&frames=120@::40", "sim:desk?seed=2&frames=120@::40"};

TEST(RankerTraining, LearnsToTellObjectsOnHeldOutFramesAndIsDeterministic) {
  const RankerTraining training = trainRanker(kDesks, quickTraining());
  EXPECT_EQ(training.frames, 6);
  ASSERT_EQ(training.trials.size(), 1U);
  EXPECT_GT(training.chosen.auc, 0.7);  // 0.5 is chance
  EXPECT_LE(training.chosen.auc, 1.0);
  EXPECT_TRUE(training.ablation.empty());
  EXPECT_EQ(trainRanker(kDesks, quickTraining()).model.text(), training.model.text());
}

TEST(RankerTraining, SaysWhatEachFeatureIsWorthIfAsked) {
  RankerTrainingConfig config = quickTraining();
  config.ablation = true;
  const RankerTraining training = trainRanker(kDesks, config);
  ASSERT_EQ(training.ablation.size(), static_cast<std::size_t>(kFeatureCount));
  EXPECT_EQ(training.ablation[kFeatureArea].name, "area");
  EXPECT_TRUE(std::any_of(training.ablation.begin(), training.ablation.end(),
                          [](const FeatureValue& value) { return value.auc_lost != 0.0; }));
}

}  // namespace
}  // namespace saccade
