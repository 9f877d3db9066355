#include "saccade/discovery/candidate_outline.hpp"

#include <gtest/gtest.h>

#include "saccade/discovery/candidate_mask.hpp"
#include "saccade/discovery/coco_rle.hpp"
#include "support/random_scene.hpp"

namespace saccade {
namespace {

const cv::Size kSize(120, 90);
const PinholeCamera kCamera{kSize.width, kSize.height, 100.0, 100.0, 59.5, 44.5};

/// Segments, an open candidate of the first three of them and an inhibited one of others, of the other source.
struct Scene {
  Perception seen;
  Candidates open, inhibited;

  explicit Scene(unsigned seed) {
    std::mt19937 random(seed);
    seen.saliency = cv::Mat1f(kSize, 0.5F);
    seen.color = test::randomSegmentation(kSize, 40, random);
    seen.surface = test::randomSegmentation(kSize, 20, random);
    seen.has_depth = true;
    const bool color_first = seed % 2 == 0;
    open.push_back(ofSegments({0, 1, 2}, color_first ? CandidateSource::kColor : CandidateSource::kDepth));
    inhibited.push_back(ofSegments({2, 5}, color_first ? CandidateSource::kDepth : CandidateSource::kColor));
  }

 private:
  [[nodiscard]] Candidate ofSegments(const std::vector<std::int32_t>& segments, CandidateSource source) const {
    Candidate candidate;
    candidate.source = source;
    candidate.segments = SegmentIds(segments);
    cv::Mat1b mask(kSize, std::uint8_t{0});
    for (const std::int32_t segment : segments) mask |= seen.segmentation(source).labels == segment;
    candidate.box = cv::boundingRect(mask);
    return candidate;
  }
};

TEST(CandidateOutline, OfAnIdealInputIsTheCandidatesOwn) {
  const Scene scene(2);
  CandidateOutliner outliner{DistortedPixels(kCamera)};
  outliner.begin(scene.seen, scene.open, scene.inhibited);
  for (const Candidate& candidate : {scene.open[0], scene.inhibited[0]}) {
    const CandidateOutline outline = outliner.outline(candidate);
    cv::Mat1b mask;
    drawMask(candidate, scene.seen, mask);
    EXPECT_EQ(outline.box, candidate.box);
    EXPECT_EQ(outline.mask, encodeCocoRle(mask));
  }
}

TEST(CandidateOutline, OfADistortedInputIsTheDistortedMaskAndItsBox) {
  const DistortedPixels pixels(kCamera, {kCamera, LensDistortion{-0.25, 0.06, 0.0, 0.0, 0.0}});
  CandidateOutliner outliner(pixels);
  for (unsigned seed = 0; seed < 6; ++seed) {
    const Scene scene(seed);
    outliner.begin(scene.seen, scene.open);
    const CandidateOutline outline = outliner.outline(scene.open[0]);
    cv::Mat1b mask, distorted;
    drawMask(scene.open[0], scene.seen, mask);
    pixels.distort(mask, distorted, std::uint8_t{0});
    EXPECT_EQ(outline.mask, encodeCocoRle(distorted));
    EXPECT_EQ(outline.box, cv::boundingRect(distorted));
  }
}

TEST(CandidateOutline, OfImagesThatArePartsOfLargerOnesIsTheSame) {
  const DistortedPixels pixels(kCamera, {kCamera, LensDistortion{-0.25, 0.06, 0.0, 0.0, 0.0}});
  Scene scene(3);
  CandidateOutliner outliner(pixels);
  outliner.begin(scene.seen, scene.open);
  const CandidateOutline whole = outliner.outline(scene.open[0]);
  cv::Mat1i larger(kSize + cv::Size(7, 3), -1);
  cv::Mat1i part = larger(cv::Rect({4, 2}, kSize));
  scene.seen.surface.labels.copyTo(part);
  scene.seen.surface.labels = part;
  outliner.begin(scene.seen, scene.open);
  EXPECT_EQ(outliner.outline(scene.open[0]).mask, whole.mask);
}

}  // namespace
}  // namespace saccade
