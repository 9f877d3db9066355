#include "saccade/discovery/candidate_outline.hpp"

#include <gtest/gtest.h>

#include "saccade/discovery/candidate_mask.hpp"
#include "saccade/discovery/coco_rle.hpp"
#include "support/random_scene.hpp"

namespace saccade {
namespace {

const cv::Size kSize(120, 90);
const PinholeCamera kCamera{kSize.width, kSize.height, 100.0, 100.0, 59.5, 44.5};

/// Segments and a candidate of the first three of them.
struct Scene {
  Perception seen;
  Candidate candidate;

  explicit Scene(unsigned seed) {
    std::mt19937 random(seed);
    seen.saliency = cv::Mat1f(kSize, 0.5F);
    seen.color = test::randomSegmentation(kSize, 40, random);
    seen.surface = test::randomSegmentation(kSize, 20, random);
    seen.has_depth = true;
    candidate.source = seed % 2 == 0 ? CandidateSource::kColor : CandidateSource::kDepth;
    candidate.segments = {0, 1, 2};
    const cv::Mat1i& labels = seen.segmentation(candidate.source).labels;
    candidate.box = cv::boundingRect((labels >= 0) & (labels <= 2));
  }
};

TEST(CandidateOutline, OfAnIdealInputIsTheCandidatesOwn) {
  const Scene scene(2);
  CandidateOutliner outliner{DistortedPixels(kCamera)};
  outliner.begin(scene.seen);
  const CandidateOutline outline = outliner.outline(scene.candidate);
  cv::Mat1b mask;
  drawMask(scene.candidate, scene.seen, mask);
  EXPECT_EQ(outline.box, scene.candidate.box);
  EXPECT_EQ(outline.mask, encodeCocoRle(mask));
}

TEST(CandidateOutline, OfADistortedInputIsTheDistortedMaskAndItsBox) {
  const DistortedPixels pixels(kCamera, {kCamera, LensDistortion{-0.25, 0.06, 0.0, 0.0, 0.0}});
  CandidateOutliner outliner(pixels);
  for (unsigned seed = 0; seed < 6; ++seed) {
    const Scene scene(seed);
    outliner.begin(scene.seen);
    const CandidateOutline outline = outliner.outline(scene.candidate);
    cv::Mat1b mask, distorted;
    drawMask(scene.candidate, scene.seen, mask);
    pixels.distort(mask, distorted, std::uint8_t{0});
    EXPECT_EQ(outline.mask, encodeCocoRle(distorted));
    EXPECT_EQ(outline.box, cv::boundingRect(distorted));
  }
}

}  // namespace
}  // namespace saccade
