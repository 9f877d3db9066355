#include "reporting/report_views.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <opencv2/imgproc.hpp>

#include "saccade/inspection/frame_picture.hpp"
#include "saccade/rendering/renderer.hpp"

namespace saccade {
namespace {

/// A leaf is behind what was measured there from this distance on, beyond its own size: noise and pose error.
constexpr double kBehind_m = 0.03;

std::vector<ReportView> viewsOfKeyframes(const SessionReader& session, std::size_t most) {
  std::vector<ReportView> views;
  const std::vector<KeyframeRecord> keyframes = session.keyframes();
  for (const std::size_t i : evenlyChosen(keyframes.size(), most)) {
    const std::optional<KeyframeRecord> keyframe = session.keyframe(keyframes[i].ordinal);
    const std::optional<FrameRecord> frame = session.frame(keyframes[i].ordinal);
    if (!keyframe || !frame || keyframe->color.empty()) continue;  // thinned to save room
    views.push_back({*frame, keyframe->T_WC, keyframe->color, keyframe->depth_m, false});
  }
  return views;
}

std::vector<ReportView> renderedViews(const std::vector<FrameRecord>& frames, const IorMap& map,
                                      const PinholeCamera& camera, std::size_t most) {
  std::vector<ReportView> views;
  if (camera.width <= 0) return views;  // an imported map
  std::vector<const FrameRecord*> posed;
  for (const FrameRecord& frame : frames) {
    if (frame.T_WC) posed.push_back(&frame);
  }
  Renderer renderer;
  for (const std::size_t i : evenlyChosen(posed.size(), most)) {
    const SurfaceView& seen = renderer.renderSurface(map.view(), camera, *posed[i]->T_WC);
    views.push_back({*posed[i], *posed[i]->T_WC, seen.color.clone(), seen.ior.depth_m.clone(), true});
  }
  return views;
}

/// Position in the log of the tick that the frame closed.
std::optional<std::size_t> tickOf(const FrameRecord& frame, const AttendLog& log) {
  for (std::size_t i = 0; i < log.tickCount(); ++i) {
    if (log.tick(i).tick.value + 1 == frame.tick) return i;
  }
  return std::nullopt;
}

}  // namespace

std::vector<std::size_t> evenlyChosen(std::size_t count, std::size_t most) {
  std::vector<std::size_t> chosen;
  const std::size_t wanted = std::min(count, most);
  for (std::size_t i = 0; i < wanted; ++i) chosen.push_back(i * count / wanted);
  return chosen;
}

std::vector<ReportView> chooseViews(const SessionReader& session, const std::vector<FrameRecord>& frames,
                                    const IorMap& map, std::size_t most) {
  std::vector<ReportView> views = viewsOfKeyframes(session, most);
  return views.empty() ? renderedViews(frames, map, session.metadata().camera, most) : views;
}

ProjectedLeaves projectLeaves(std::span<const LeafKey> leaves, const IorMap& map, const PinholeCamera& camera,
                              const ReportView& view, cv::Mat1b* mask) {
  ProjectedLeaves projected;
  const Pose T_CW = view.T_WC.inverse();
  const double leaf_m = map.config().leaf_size_m;
  const cv::Rect image(0, 0, view.color.cols, view.color.rows);
  for (const LeafKey& key : leaves) {
    const Eigen::Vector3d p_C = T_CW * map.centre(key);
    if (p_C.z() < leaf_m) continue;
    const Eigen::Vector2d pixel = camera.project(p_C);
    const int half = std::max(1, static_cast<int>(std::ceil(0.5 * camera.fx * leaf_m / p_C.z())));
    if (!(pixel.cwiseAbs().maxCoeff() < 1e6)) continue;
    const cv::Point centre(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
    if (!image.contains(centre)) continue;
    const float measured_m = view.depth_m(centre);
    if (measured_m > 0.0f && p_C.z() > measured_m + leaf_m + kBehind_m) continue;
    const cv::Rect square = cv::Rect(centre.x - half, centre.y - half, 2 * half + 1, 2 * half + 1) & image;
    projected.box = projected.visible == 0 ? square : projected.box | square;
    ++projected.visible;
    if (mask != nullptr) (*mask)(square).setTo(255);
  }
  return projected;
}

cv::Mat3b drawLooks(const ReportView& view, const AttendLog& log, const IorMap& map, const PinholeCamera& camera) {
  cv::Mat3b picture = view.color.clone();
  const std::optional<std::size_t> tick = tickOf(view.frame, log);
  if (!tick) return picture;
  const int count = static_cast<int>(log.candidateCount(*tick));
  std::vector<BoxMark> marks;
  cv::Mat1b mask(picture.size(), 0);
  for (std::size_t i = 0; i < log.candidateCount(*tick); ++i) {
    const ProjectedLeaves projected = projectLeaves(log.leaves(*tick, i), map, camera, view, &mask);
    if (projected.visible > 0) marks.push_back({projected.box, log.rank(*tick, i), false});
  }
  constexpr double kTint = 0.35;
  cv::Mat3b tinted;
  cv::addWeighted(picture, 1.0 - kTint, cv::Mat3b(picture.size(), cv::Vec3b(80, 200, 255)), kTint, 0.0, tinted);
  tinted.copyTo(picture, mask);
  std::sort(marks.begin(), marks.end(), [](const BoxMark& a, const BoxMark& b) { return a.rank > b.rank; });
  for (const BoxMark& mark : marks) {
    const cv::Scalar colour = rankColor(mark.rank, count);
    cv::rectangle(picture, mark.box, cv::Scalar(0, 0, 0), 3);
    cv::rectangle(picture, mark.box, colour, 2);
    const cv::Point corner(mark.box.x + 4, std::max(mark.box.y + 18, 18));
    const std::string text = std::to_string(mark.rank + 1);
    cv::putText(picture, text, corner, cv::FONT_HERSHEY_SIMPLEX, 0.55, cv::Scalar(0, 0, 0), 4, cv::LINE_AA);
    cv::putText(picture, text, corner, cv::FONT_HERSHEY_SIMPLEX, 0.55, colour, 1, cv::LINE_AA);
  }
  return picture;
}

}  // namespace saccade
