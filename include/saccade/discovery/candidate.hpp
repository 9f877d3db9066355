#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "saccade/discovery/segment_ids.hpp"

namespace saccade {

/// The segmentation whose segments make up a candidate. The order is the tie-break of the ranking.
enum class CandidateSource : std::uint8_t { kColor, kDepth };

/// The paper's twelve features, in its order ("Ranking of the candidates").
enum CandidateFeature : int {
  kFeatureHu1 = 0,         ///< the seven Hu moments, each as signedLog()
  kFeatureConvexity = 7,   ///< κ, metres; 0 without depth
  kFeatureArea = 8,        ///< mask area / image area
  kFeatureSaliency = 9,    ///< mean saliency, 0..1
  kFeaturePerimeter = 10,  ///< crack length of the mask's outline in pixels / image area
  kFeatureDepth = 11,      ///< mean depth / maximal range; 0 without depth
  kFeatureCount = 12,
};

/// What we measure beyond the paper; every cue comes from sums over segments and over the cracks between them.
enum CandidateCue : int {
  kCueExtent = 0,        ///< mask area / box area
  kCueImageBorder,       ///< share of the outline that is the image's border
  kCueNearer,            ///< share of the outline where the candidate stands before what is outside
  kCueFarther,           ///< share of the outline where something outside stands before the candidate
  kCueUnknownDepth,      ///< share of the outline with no depth on one side
  kCueColorContrast,     ///< mean colour step across the outline, 0..1
  kCueSaliencyContrast,  ///< mean saliency inside less that of the neighbours, weighted by shared outline
  kCueMetricSize,        ///< square root of the mask's area at the mean depth, metres
  kCueAspect,            ///< ln(box width / box height)
  kCueBoxSize,           ///< square root of (box area / image area)
  kCueCompactness,       ///< 4 π area / perimeter²
  kCueColorSpread,       ///< standard deviation of the colour inside, 0..1
  kCueLength,            ///< standard deviation of the points along their 1st principal axis, metres
  kCueBreadth,           ///< along the 2nd
  kCueThickness,         ///< along the 3rd
  kCueHeight,            ///< mean distance of the points from the supporting plane, metres, towards the camera
  kCueStructure,         ///< share of the mask that lies on large planes
  kCueSegments,          ///< ln(number of segments)
  kCueColorNeighbours,   ///< mean difference of mean colours to the neighbours, weighted by shared outline, 0..1
  kCueSupport,           ///< share of the outline behind which lies a large plane
  kCueInnerContrast,     ///< mean colour step across the cracks between its own segments, 0..1
  kCueInnerSteps,        ///< share of those cracks (where depth is known) that are depth steps: several things at once
  kCueOpenOutline,       ///< share of the outline to neighbours that differ in neither colour nor depth: a part of more
  kCueWeakestNeighbor,   ///< contrast to the most alike neighbour of some length, see candidate_features.cpp
  kCueAgreement,         ///< ln(1 + unions proposed with nearly this box), see box_agreement.hpp
  kCueStraddling,        ///< share of the mask by which the other segmentation's segments stick out (or in) over it
  kCueCount,
};

/// A hypothesis that some segments of one segmentation together show an object (paper, "Saliency-based object
/// discovery"). A candidate holds no mask: its pixels are those of its segments, see candidate_mask.hpp.
struct Candidate {
  CandidateSource source = CandidateSource::kColor;
  SegmentIds segments;  ///< ids in the source's segmentation, rising
  cv::Rect box;         ///< width = max u - min u + 1
  int area = 0;         ///< pixels
  int unions = 1;       ///< unions proposed with nearly this box, itself included: box_agreement.hpp

  std::array<float, kFeatureCount> features{};
  std::array<float, kCueCount> cues{};
  bool has_depth = false;      ///< enough of the mask has depth for κ and the depth features to mean something
  bool has_convexity = false;  ///< κ is measured

  double score = 0.0;            ///< the ranker's probability of being an object
  double inhibited_share = 0.0;  ///< share of the mask that is white in the 2D IOR map
  double familiar_share = 0.0;   ///< share of the mask that was attended and is forgotten; 0 without inhibition
  bool inhibited = false;        ///< inhibited_share ≥ θ
};

using Candidates = std::vector<Candidate>;

}  // namespace saccade
