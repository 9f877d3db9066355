#pragma once

#include <cmath>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "saccade/attention/saliency.hpp"

namespace saccade::test {

inline cv::Mat1f blurred(const cv::Mat1f& in, double sigma) {
  cv::Mat1f out;
  cv::GaussianBlur(in, out, cv::Size(), sigma, sigma, cv::BORDER_REPLICATE);
  return out;
}

inline cv::Mat1f everyOtherPixel(const cv::Mat1f& in) {
  cv::Mat1f out;
  cv::resize(in, out, cv::Size(), 0.5, 0.5, cv::INTER_NEAREST);
  return out;
}

/// The definition, step by step and slow (Frintrop et al. 2015): the oracle. It agrees with the reference program's
/// own maps to their 16 bits.
inline cv::Mat1f saliencyByDefinition(const cv::Mat3b& bgr, const SaliencyConfig& config) {
  cv::Mat3f colors;
  bgr.convertTo(colors, CV_32F, 1.0 / 255.0);
  std::vector<cv::Mat1f> c;
  cv::split(colors, c);
  const std::vector<cv::Mat1f> opponent{cv::Mat1f((c[0] + c[1] + c[2]) / 3.0), cv::Mat1f(c[2] - c[1]),
                                        cv::Mat1f(c[0] - (c[1] + c[2]) / 2.0)};
  const int scales = config.scales_per_octave;
  const double widening =
      std::sqrt(config.surround_sigma * config.surround_sigma - config.center_sigma * config.center_sigma);
  cv::Mat1f sum;
  for (cv::Mat1f level : opponent) {
    for (int layer = 0; layer < config.first_layer; ++layer) {
      level = everyOtherPixel(blurred(level, 2.0 * config.center_sigma));
    }
    for (int layer = config.first_layer; layer <= config.last_layer; ++layer) {
      cv::Mat1f center = layer == config.first_layer ? blurred(level, config.center_sigma) : level;
      double sigma = config.center_sigma;
      for (int s = 0; s < scales; ++s) {
        const cv::Mat1f surround = blurred(center, widening * std::exp2(static_cast<double>(s) / scales));
        const cv::Mat1f contrast(cv::abs(center - surround));
        if (sum.empty()) {
          sum = cv::Mat1f(contrast.size(), 0.0F);
        }
        cv::Mat1f enlarged;
        cv::resize(contrast, enlarged, sum.size(), 0, 0, cv::INTER_CUBIC);
        sum += enlarged;
        const double next = config.center_sigma * std::exp2(static_cast<double>(s + 1) / scales);
        center = blurred(center, std::sqrt(next * next - sigma * sigma));
        sigma = next;
      }
      level = everyOtherPixel(center);
    }
  }
  double low = 0.0, high = 0.0;
  cv::minMaxLoc(sum, &low, &high);
  sum = (sum - low) / (high - low);
  cv::Mat1f map;
  cv::resize(sum, map, bgr.size(), 0, 0, cv::INTER_CUBIC);
  return map;
}

}  // namespace saccade::test
