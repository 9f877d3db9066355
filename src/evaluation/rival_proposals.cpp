#include "saccade/evaluation/rival_proposals.hpp"

#include <array>
#include <cmath>

#include <opencv2/imgproc.hpp>
#include <opencv2/ximgproc/edgeboxes.hpp>
#include <opencv2/ximgproc/segmentation.hpp>

namespace saccade {
namespace {

constexpr double kEdgeSmoothing_px = 1.0;
constexpr int kMaxEdgeBoxes = 1000;

/// Strength (0..1) and direction (0..pi) of the strongest channel's gradient.
void computeGradient(const cv::Mat3b& bgr, cv::Mat1f& strength, cv::Mat1f& direction) {
  cv::Mat3b smooth;
  cv::GaussianBlur(bgr, smooth, {}, kEdgeSmoothing_px);
  cv::Mat du, dv;
  cv::Sobel(smooth, du, CV_32F, 1, 0);
  cv::Sobel(smooth, dv, CV_32F, 0, 1);
  strength.create(bgr.size());
  direction.create(bgr.size());
  for (int v = 0; v < bgr.rows; ++v) {
    for (int u = 0; u < bgr.cols; ++u) {
      const cv::Vec3f a = du.at<cv::Vec3f>(v, u), b = dv.at<cv::Vec3f>(v, u);
      int best = 0;
      for (int c = 1; c < 3; ++c) {
        if (std::hypot(a[c], b[c]) > std::hypot(a[best], b[best])) best = c;
      }
      strength(v, u) = std::hypot(a[best], b[best]);
      const float angle = std::atan2(b[best], a[best]);
      direction(v, u) = angle < 0.0F ? angle + static_cast<float>(CV_PI) : angle;
    }
  }
  double strongest = 0.0;
  cv::minMaxLoc(strength, nullptr, &strongest);
  if (strongest > 0.0) strength *= 1.0 / strongest;
}

/// Keeps the pixels that are strongest across their edge.
cv::Mat1f thinned(const cv::Mat1f& strength, const cv::Mat1f& direction) {
  cv::Mat1f thin(strength.size(), 0.0F);
  for (int v = 1; v + 1 < strength.rows; ++v) {
    for (int u = 1; u + 1 < strength.cols; ++u) {
      const int du = static_cast<int>(std::lround(std::cos(direction(v, u))));
      const int dv = static_cast<int>(std::lround(std::sin(direction(v, u))));
      const float here = strength(v, u);
      if (here >= strength(v + dv, u + du) && here >= strength(v - dv, u - du)) thin(v, u) = here;
    }
  }
  return thin;
}

}  // namespace

std::vector<cv::Rect> selectiveSearchBoxes(const cv::Mat3b& bgr) {
  const auto search = cv::ximgproc::segmentation::createSelectiveSearchSegmentation();
  search->setBaseImage(bgr);
  search->switchToSelectiveSearchFast();
  std::vector<cv::Rect> boxes;
  search->process(boxes);
  return boxes;
}

std::vector<cv::Rect> edgeBoxes(const cv::Mat3b& bgr) {
  cv::Mat1f strength, direction;
  computeGradient(bgr, strength, direction);
  const auto detector = cv::ximgproc::createEdgeBoxes();
  detector->setMaxBoxes(kMaxEdgeBoxes);
  std::vector<cv::Rect> boxes;
  detector->getBoundingBoxes(thinned(strength, direction), direction, boxes);
  return boxes;
}

}  // namespace saccade
