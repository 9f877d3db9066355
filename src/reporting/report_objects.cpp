#include "reporting/report_objects.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace saccade {
namespace {

const cv::Size kCropSize(224, 168);

/// The box with a margin, widened to the crop's shape and moved into the image.
cv::Rect cropAround(const cv::Rect& box, const cv::Size& image) {
  constexpr double kMargin = 0.25;
  constexpr double kLeastWidth = 64.0;
  const double shape = static_cast<double>(kCropSize.width) / kCropSize.height;
  double width = std::max({kLeastWidth, box.width * (1.0 + 2.0 * kMargin), box.height * (1.0 + 2.0 * kMargin) * shape});
  width = std::min({width, static_cast<double>(image.width), image.height * shape});
  const cv::Size size(static_cast<int>(width), static_cast<int>(width / shape));
  const auto start = [](int middle, int length, int end) { return std::clamp(middle - length / 2, 0, end - length); };
  return {
      {start(box.x + box.width / 2, size.width, image.width), start(box.y + box.height / 2, size.height, image.height)},
      size};
}

cv::Mat3b cropOf(std::span<const LeafKey> leaves, const IorMap& map, const PinholeCamera& camera,
                 const std::vector<ReportView>& views) {
  const ReportView* best = nullptr;
  ProjectedLeaves shown;
  for (const ReportView& view : views) {
    const ProjectedLeaves projected = projectLeaves(leaves, map, camera, view);
    if (projected.visible <= shown.visible) continue;
    shown = projected;
    best = &view;
  }
  // A corner of it would show something else.
  if (best == nullptr || 2 * shown.visible < leaves.size()) return {};
  const cv::Rect area = cropAround(shown.box, best->color.size());
  cv::Mat3b crop;
  cv::resize(best->color(area), crop, kCropSize, 0.0, 0.0,
             area.width > kCropSize.width ? cv::INTER_AREA : cv::INTER_CUBIC);
  const double scale = static_cast<double>(kCropSize.width) / area.width;
  const auto scaled = [&](int v) { return static_cast<int>(std::lround(v * scale)); };
  const cv::Rect frame(scaled(shown.box.x - area.x), scaled(shown.box.y - area.y), scaled(shown.box.width),
                       scaled(shown.box.height));
  cv::rectangle(crop, frame, cv::Scalar(0, 0, 0), 3);
  cv::rectangle(crop, frame, cv::Scalar(255, 255, 255), 1);
  return crop;
}

}  // namespace

std::vector<ReportObject> describeObjects(const std::vector<AttendedObject>& objects, const AttendLog& log,
                                          const IorMap& map, const PinholeCamera& camera,
                                          const std::vector<ReportView>& views, std::size_t most) {
  std::vector<const AttendedObject*> order;
  for (const AttendedObject& object : objects) order.push_back(&object);
  std::stable_sort(order.begin(), order.end(),
                   [](const auto* a, const auto* b) { return a->looks.size() > b->looks.size(); });
  if (order.size() > most) order.resize(most);
  std::vector<ReportObject> described;
  for (const AttendedObject* object : order) {
    const std::vector<LeafKey> leaves = leavesOf(*object, map);
    described.push_back({*object, historyOf(*object, log, map), boxOf(leaves, map.config().leaf_size_m),
                         cropOf(leaves, map, camera, views)});
  }
  return described;
}

}  // namespace saccade
