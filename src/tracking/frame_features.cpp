#include "saccade/tracking/frame_features.hpp"

#include <algorithm>
#include <stdexcept>

#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

namespace saccade {

bool operator==(const FrameFeatures& a, const FrameFeatures& b) {
  return a.pixels == b.pixels && a.points_C == b.points_C && a.descriptors.rows == b.descriptors.rows &&
         std::equal(a.descriptors.begin(), a.descriptors.end(), b.descriptors.begin());
}

void FeatureExtractorConfig::describe(ConfigVisitor& visitor) {
  visitor.integer("features", features, {50, 10000}, "", "ORB features of a keyframe, at most");
  visitor.integer("levels", levels, {1, 16}, "", "of the features' image pyramid, each smaller by the factor 1.2");
  visitor.integer("corner_threshold", corner_threshold, {1, 255}, "", "smallest difference of grey values at a corner");
}

FeatureExtractor::FeatureExtractor(const Config& config) : config_(config) {
  requireValid(config_);
}

FrameFeatures FeatureExtractor::extract(const cv::Mat3b& color, const DepthMaps& depth) const {
  if (color.size() != depth.vertices.size()) {
    throw std::invalid_argument("FeatureExtractor: the colour image and the depth maps differ in size");
  }
  cv::Mat1b gray;
  cv::cvtColor(color, gray, cv::COLOR_BGR2GRAY);
  cv::Mat1b measured;
  cv::compare(depth.depth_m, 0.0, measured, cv::CMP_GT);
  constexpr float kScale = 1.2F;
  constexpr int kEdge_px = 31, kFirstLevel = 0, kBitsFromPairs = 2, kPatch_px = 31;
  const cv::Ptr<cv::ORB> orb =
      cv::ORB::create(config_.features, kScale, config_.levels, kEdge_px, kFirstLevel, kBitsFromPairs,
                      cv::ORB::HARRIS_SCORE, kPatch_px, config_.corner_threshold);
  std::vector<cv::KeyPoint> corners;
  cv::Mat descriptors;
  orb->detectAndCompute(gray, measured, corners, descriptors);

  FrameFeatures found;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const cv::Point2f& at = corners[i].pt;
    const cv::Vec3f& p_C = depth.vertices(cvRound(at.y), cvRound(at.x));
    if (!(p_C[2] > 0.0F)) continue;
    found.pixels.emplace_back(at.x, at.y);
    found.points_C.emplace_back(p_C[0], p_C[1], p_C[2]);
    found.descriptors.push_back(cv::Mat1b(descriptors.row(static_cast<int>(i))));
  }
  return found;
}

}  // namespace saccade
