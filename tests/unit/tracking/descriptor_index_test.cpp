#include "tracking/descriptor_index.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "saccade/tracking/frame_features.hpp"

namespace saccade {
namespace {

cv::Mat1b randomDescriptors(int rows, std::uint64_t seed) {
  cv::Mat1b descriptors(rows, FrameFeatures::kDescriptorBytes);
  cv::RNG random(seed);
  random.fill(descriptors, cv::RNG::UNIFORM, 0, 256);
  return descriptors;
}

// The same points from another view: each bit flips with the probability of one in `odds`.
cv::Mat1b seenAgain(const cv::Mat1b& descriptors, int odds, std::uint64_t seed) {
  cv::Mat1b changed = descriptors.clone();
  cv::RNG random(seed);
  for (cv::Mat1b::iterator byte = changed.begin(); byte != changed.end(); ++byte) {
    for (int bit = 0; bit < 8; ++bit) {
      if (random.uniform(0, odds) == 0) *byte = static_cast<std::uint8_t>(*byte ^ (1 << bit));
    }
  }
  return changed;
}

TEST(DescriptorIndex, FindsTheImageWhoseDescriptorsReturnChanged) {
  DescriptorIndex index;
  for (std::uint64_t i = 0; i < 40; ++i) index.add(randomDescriptors(300, i + 1));
  // 256 / 7 = 37 flipped bits: an ordinary change of view.
  const std::vector<double> similarity = index.similarities(seenAgain(randomDescriptors(300, 18), 7, 99));
  ASSERT_EQ(similarity.size(), 40U);
  const auto best = std::max_element(similarity.begin(), similarity.end());
  EXPECT_EQ(best - similarity.begin(), 17);
  for (std::size_t i = 0; i < 40; ++i) {
    if (i == 17) continue;
    EXPECT_LT(similarity[i], 0.1 * *best) << i;
  }
}

TEST(DescriptorIndex, FindsNothingForAnEmptyImageOrInAnEmptyIndex) {
  DescriptorIndex index;
  EXPECT_TRUE(index.similarities(randomDescriptors(10, 1)).empty());
  index.add(cv::Mat1b());
  index.add(randomDescriptors(10, 1));
  EXPECT_EQ(index.similarities(cv::Mat1b()), (std::vector<double>{0.0, 0.0}));
  EXPECT_EQ(index.similarities(randomDescriptors(10, 1))[0], 0.0);
}

TEST(DescriptorIndex, ValuesDescriptorsThatManyImagesShareLess) {
  DescriptorIndex index;
  const cv::Mat1b common = randomDescriptors(50, 1), rare = randomDescriptors(50, 2);
  for (int i = 0; i < 10; ++i) index.add(common);
  index.add(rare);
  cv::Mat1b both = common.clone();
  both.push_back(rare);
  const std::vector<double> similarity = index.similarities(both);
  EXPECT_GT(similarity[10], 2.0 * similarity[0]);
}

}  // namespace
}  // namespace saccade
