#include "preflight/rigid_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "preflight/depth_scale.hpp"
#include "saccade/core/depth_maps.hpp"
#include "saccade/tracking/tracker.hpp"

namespace saccade {
namespace {

constexpr double kUsualDepth_m = 1.5;  // to which the median is brought; the tracker's gates are made for that
constexpr std::size_t kLongestSegment = 12;
constexpr double kEnoughTurn_deg = 8.0;
constexpr double kEnoughOverlap = 0.7;    // share of the last frame that the first has seen
constexpr double kTellingTurn_deg = 1.5;  // on average; with less, any focal length fits
constexpr double kTellingWay_m = 0.03;    // at the scale of the input's poses
constexpr std::array kFocalFactors = {0.64, 0.8, 0.9, 1.0, 1.1, 1.25, 1.56};
constexpr double kDegrees = 180.0 / 3.14159265358979323846;

struct Alignment {
  Pose T_first_last = Pose::Identity();
  double residual_m = 0.0;  ///< over the share of inliers: fewer and closer are no better fit
  double mean_square_depth = 0.0;
  double covered_share = 0.0;
};

double meanSquareDepth(const DepthMaps& maps) {
  constexpr int kStep = 4;
  double sum = 0.0;
  std::int64_t count = 0;
  for (int v = 0; v < maps.camera.height; v += kStep) {
    for (int u = 0; u < maps.camera.width; u += kStep) {
      const double depth_m = static_cast<double>(maps.vertices(v, u)[2]);
      if (depth_m <= 0.0) continue;
      sum += depth_m * depth_m;
      ++count;
    }
  }
  return count > 0 ? sum / static_cast<double>(count) : 0.0;
}

/// Aligns frames to the first of a segment, one after the other.
class Aligner {
 public:
  Aligner(const cv::Mat1f& first_depth_m, const PinholeCamera& camera) : camera_(camera) {
    DepthMaps first;
    preparation_.prepare(first_depth_m, camera_, first);
    view_.camera = camera_;
    view_.normals = first.normals;
    view_.depth_m.create(first.vertices.size());
    std::transform(first.vertices.begin(), first.vertices.end(), view_.depth_m.begin(),
                   [](const cv::Vec3f& vertex) { return vertex[2]; });
  }

  /// None if the frame cannot be aligned.
  std::optional<Alignment> align(const cv::Mat1f& depth_m) {
    preparation_.prepare(depth_m, camera_, live_);
    const Tracking tracking = tracker_.track(live_, view_, T_first_last_);
    if (tracking.status == TrackingStatus::kLost || tracking.inlier_share <= 0.0) return std::nullopt;
    T_first_last_ = tracking.T_WC;
    return Alignment{T_first_last_, tracking.rms_m / tracking.inlier_share, meanSquareDepth(live_),
                     tracking.covered_share};
  }

 private:
  PinholeCamera camera_;
  DepthPreparation preparation_;
  Tracker tracker_;
  ModelView view_;
  DepthMaps live_;
  Pose T_first_last_ = Pose::Identity();
};

struct Segment {
  std::size_t first = 0, last = 0;
  std::optional<Alignment> alignment;  ///< with the declared focal length
};

double turnOf(const Pose& pose) {
  return kDegrees * Eigen::AngleAxisd(pose.linear()).angle();
}

/// Cuts the frames into segments, each as long as its frames overlap well.
std::vector<Segment> segmentsOf(const std::vector<cv::Mat1f>& depth_m, const PinholeCamera& camera) {
  std::vector<Segment> segments;
  for (std::size_t first = 0; first + 1 < depth_m.size();) {
    Aligner aligner(depth_m[first], camera);
    Segment segment{first, first + 1, std::nullopt};
    for (std::size_t last = first + 1; last < depth_m.size() && last - first <= kLongestSegment; ++last) {
      const std::optional<Alignment> alignment = aligner.align(depth_m[last]);
      if (!alignment) break;
      segment.last = last;
      segment.alignment = alignment;
      if (turnOf(alignment->T_first_last) > kEnoughTurn_deg || alignment->covered_share < kEnoughOverlap) break;
    }
    segments.push_back(segment);
    first = segment.last;
  }
  return segments;
}

/// Median residual over the segments with the focal length times `factor`, over that with the declared one.
double residualRatio(const std::vector<cv::Mat1f>& depth_m, const PinholeCamera& camera,
                     const std::vector<Segment>& segments, double factor) {
  PinholeCamera changed = camera;
  changed.fx *= factor;
  changed.fy *= factor;
  std::vector<double> ratios;
  for (const Segment& segment : segments) {
    if (!segment.alignment) continue;
    Aligner aligner(depth_m[segment.first], changed);
    std::optional<Alignment> alignment;
    for (std::size_t i = segment.first + 1; i <= segment.last; ++i) {
      alignment = aligner.align(depth_m[i]);
      if (!alignment) break;
    }
    constexpr double kLost = 10.0;
    ratios.push_back(alignment ? alignment->residual_m / segment.alignment->residual_m : kLost);
  }
  return medianOf(ratios);
}

/// The lowest point of the parabola through the lowest residual and its neighbours, by the logarithm of the factor.
/// None where the residual falls up to the last factor: then the camera hardly turned, and any long focal length fits.
void findBestFocal(const std::array<double, kFocalFactors.size()>& residuals, RigidFit& fit) {
  const auto lowest =
      static_cast<std::size_t>(std::distance(residuals.begin(), std::min_element(residuals.begin(), residuals.end())));
  if (lowest == 0 || lowest + 1 == residuals.size()) return;
  Eigen::Matrix3d powers;
  Eigen::Vector3d values;
  for (int i = 0; i < 3; ++i) {
    const std::size_t at = lowest + static_cast<std::size_t>(i) - 1;
    const double x = std::log(kFocalFactors[at]);
    powers.row(i) << 1.0, x, x * x;
    values[i] = residuals[at];
  }
  const Eigen::Vector3d parabola = powers.colPivHouseholderQr().solve(values);
  const double best = -0.5 * parabola[1] / parabola[2];
  fit.focal_factor = std::exp(best);
  fit.focal_penalty = 1.0 / std::min(residuals[lowest], parabola[0] + best * (parabola[1] + best * parabola[2]));
}

}  // namespace

std::optional<RigidFit> fitFrames(const std::vector<RgbdFrame>& frames, const PinholeCamera& camera) {
  std::vector<double> medians;
  for (const RgbdFrame& frame : frames) {
    if (const double median = medianDepth(frame.depth_m); median > 0) medians.push_back(median);
  }
  constexpr std::size_t kFewest = 4;
  if (medians.size() < kFewest || medians.size() < frames.size()) return std::nullopt;
  const double scale = kUsualDepth_m / medianOf(medians);
  std::vector<cv::Mat1f> depth_m;
  for (const RgbdFrame& frame : frames) depth_m.emplace_back(frame.depth_m * scale);

  const std::vector<Segment> segments = segmentsOf(depth_m, camera);
  RigidFit fit;
  std::vector<double> noises, ways;
  for (const Segment& segment : segments) {
    ++fit.segments;
    if (!segment.alignment) {
      ++fit.lost_segments;
      continue;
    }
    const Alignment& alignment = *segment.alignment;
    fit.turn_deg += turnOf(alignment.T_first_last);
    noises.push_back(alignment.residual_m / alignment.mean_square_depth * scale);
    const auto &from = frames[segment.first].T_WC, &to = frames[segment.last].T_WC;
    if (!from || !to) continue;
    const double way_m = (from->inverse() * *to).translation().norm();
    if (way_m >= kTellingWay_m) ways.push_back(alignment.T_first_last.translation().norm() / scale / way_m);
  }
  const auto aligned = static_cast<double>(fit.segments - fit.lost_segments);
  if (aligned == 0) return fit;
  fit.turn_deg /= aligned;
  fit.noise_per_m = medianOf(noises);
  if (!ways.empty()) fit.way_ratio = medianOf(ways);
  if (fit.turn_deg < kTellingTurn_deg) return fit;
  std::array<double, kFocalFactors.size()> residuals{};
  std::transform(kFocalFactors.begin(), kFocalFactors.end(), residuals.begin(),
                 [&](double factor) { return factor == 1.0 ? 1.0 : residualRatio(depth_m, camera, segments, factor); });
  findBestFocal(residuals, fit);
  return fit;
}

}  // namespace saccade
