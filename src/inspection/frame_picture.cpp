#include "saccade/inspection/frame_picture.hpp"

#include <algorithm>
#include <cstdint>

#include <opencv2/imgproc.hpp>

namespace saccade {
namespace {

constexpr int kCaptionHeight = 28;
constexpr int kTextThickness = 1;

/// Text with a dark outline, readable on any background.
void putReadableText(cv::Mat3b& image, const std::string& text, cv::Point origin, double scale, cv::Scalar color) {
  cv::putText(image, text, origin, cv::FONT_HERSHEY_SIMPLEX, scale, {0, 0, 0}, kTextThickness + 2, cv::LINE_AA);
  cv::putText(image, text, origin, cv::FONT_HERSHEY_SIMPLEX, scale, color, kTextThickness, cv::LINE_AA);
}

void placePanel(cv::Mat3b& picture, const cv::Mat& panel, cv::Rect place, const std::string& title, int interpolation) {
  if (!panel.empty()) {
    cv::Mat target = picture(place);
    cv::resize(panel, target, place.size(), 0.0, 0.0, interpolation);
  }
  putReadableText(picture, title, place.tl() + cv::Point(6, 16), 0.45, {255, 255, 255});
}

cv::Mat grayToColor(const cv::Mat1b& gray) {
  cv::Mat color;
  if (!gray.empty()) cv::cvtColor(gray, color, cv::COLOR_GRAY2BGR);
  return color;
}

cv::Mat paintSaliency(const cv::Mat1f& saliency) {
  cv::Mat1b gray;
  saliency.convertTo(gray, CV_8U, 255.0);
  return grayToColor(gray);
}

/// White where inhibited (the paper's 2D IOR map); elsewhere the weight that grows towards the limit, as dark grey.
cv::Mat paintIor(const cv::Mat1b& inhibited, const cv::Mat1i& weight) {
  if (inhibited.empty()) return {};
  constexpr double kGreyPerTick = 10.0;
  constexpr double kMostGrey = 130.0;
  cv::Mat1b gray(inhibited.size(), static_cast<uchar>(0));
  if (!weight.empty()) {
    weight.convertTo(gray, CV_8U, kGreyPerTick);
    gray = cv::min(gray, kMostGrey);
  }
  gray.setTo(255, inhibited);
  return grayToColor(gray);
}

void drawBoxes(cv::Mat3b& image, const std::vector<BoxMark>& boxes) {
  for (const BoxMark& mark : boxes)
    if (mark.inhibited) cv::rectangle(image, mark.box, {40, 30, 140}, 1);
  const auto open = static_cast<int>(std::count_if(boxes.begin(), boxes.end(), [](auto& b) { return !b.inhibited; }));
  for (auto mark = boxes.rbegin(); mark != boxes.rend(); ++mark) {  // the best last, on top
    if (mark->inhibited) continue;
    const cv::Scalar color = rankColor(mark->rank, open);
    cv::rectangle(image, mark->box, color, 2);
    putReadableText(image, std::to_string(mark->rank + 1), mark->box.tl() + cv::Point(3, 13), 0.42, color);
  }
}

}  // namespace

cv::Scalar rankColor(int rank, int count) {
  const double share = count > 1 ? static_cast<double>(rank) / (count - 1) : 0.0;
  // Hue 30 (yellow) to 110 (blue) on OpenCV's scale of 180.
  const cv::Mat3b hsv(1, 1, cv::Vec3b(cv::saturate_cast<uchar>(30.0 + 80.0 * share), 230, 255));
  cv::Mat3b bgr;
  cv::cvtColor(hsv, bgr, cv::COLOR_HSV2BGR);
  return cv::Scalar(bgr(0, 0));
}

cv::Mat3b paintLabels(const cv::Mat1i& labels) {
  cv::Mat3b painted(labels.size());
  for (int v = 0; v < labels.rows; ++v) {
    const int* label = labels[v];
    cv::Vec3b* pixel = painted[v];
    for (int u = 0; u < labels.cols; ++u) {
      if (label[u] < 0) {
        pixel[u] = {0, 0, 0};
        continue;
      }
      // Multiplicative hash (Knuth): neighbouring labels get unrelated colours.
      const std::uint32_t hash = (static_cast<std::uint32_t>(label[u]) + 1U) * 2654435761U;
      pixel[u] = {static_cast<uchar>(64 + (hash >> 8) % 192), static_cast<uchar>(64 + (hash >> 16) % 192),
                  static_cast<uchar>(64 + (hash >> 24) % 192)};
    }
  }
  return painted;
}

cv::Mat3b drawFramePicture(const FramePanels& panels) {
  const int width = panels.color.cols / 2 * 2;
  const int height = panels.color.rows / 2 * 2;
  cv::Mat3b picture(height + kCaptionHeight, 2 * width, cv::Vec3b(0, 0, 0));

  cv::Mat3b color = panels.color.clone();
  drawBoxes(color, panels.boxes);
  placePanel(picture, color, {0, 0, width, height}, "candidates", cv::INTER_AREA);

  const cv::Size half(width / 2, height / 2);
  const auto place = [&](int column, int row) {
    return cv::Rect(width + column * half.width, row * half.height, half.width, half.height);
  };
  placePanel(picture, paintSaliency(panels.saliency), place(0, 0), "saliency", cv::INTER_AREA);
  placePanel(picture, paintIor(panels.inhibited, panels.ior_weight), place(1, 0), "2D IOR map", cv::INTER_AREA);
  placePanel(picture, paintLabels(panels.color_segments), place(0, 1), "colour segments", cv::INTER_NEAREST);
  placePanel(picture, paintLabels(panels.surface_segments), place(1, 1), "surface segments", cv::INTER_NEAREST);
  putReadableText(picture, panels.caption, {8, height + 19}, 0.5, {230, 230, 230});
  return picture;
}

}  // namespace saccade
