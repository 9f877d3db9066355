#include "saccade/tracking/relocaliser.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <utility>

#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <opencv2/features2d.hpp>

#include "tracking/descriptor_index.hpp"

namespace saccade {
namespace {

/// Pairs of a point in W and the pixel where the frame shows it.
struct Matches {
  std::vector<cv::Point3f> points_W;
  std::vector<cv::Point2f> pixels;
};

Matches match(const FrameFeatures& frame, const Keyframe& keyframe, const RelocaliserConfig& config) {
  Matches matches;
  const FrameFeatures& known = keyframe.features;
  if (frame.size() < 2 || known.size() < 2) return matches;
  std::vector<std::vector<cv::DMatch>> nearest;
  cv::BFMatcher(cv::NORM_HAMMING).knnMatch(frame.descriptors, known.descriptors, nearest, 2);
  for (const auto& pair : nearest) {
    const cv::DMatch& best = pair[0];
    if (best.distance > static_cast<float>(config.match_bits)) continue;
    if (best.distance > static_cast<float>(config.match_ratio) * pair[1].distance) continue;
    const Eigen::Vector3d p_W = keyframe.T_WC * known.points_C[static_cast<std::size_t>(best.trainIdx)].cast<double>();
    const Eigen::Vector2f& pixel = frame.pixels[static_cast<std::size_t>(best.queryIdx)];
    matches.points_W.emplace_back(static_cast<float>(p_W.x()), static_cast<float>(p_W.y()),
                                  static_cast<float>(p_W.z()));
    matches.pixels.emplace_back(pixel.x(), pixel.y());
  }
  return matches;
}

std::optional<PlaceHypothesis> solvePose(const Matches& matches, const Keyframe& keyframe, const PinholeCamera& camera,
                                         const RelocaliserConfig& config) {
  if (matches.pixels.size() < static_cast<std::size_t>(config.smallest_inliers)) return std::nullopt;
  const cv::Matx33d intrinsics(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  constexpr double kConfidence = 0.999;
  cv::Vec3d turn, shift;
  std::vector<int> inliers;
  // Its random numbers start from the same seed at every call.
  const bool found = cv::solvePnPRansac(matches.points_W, matches.pixels, intrinsics, cv::noArray(), turn, shift, false,
                                        config.ransac_iterations, static_cast<float>(config.reprojection_px),
                                        kConfidence, inliers, cv::SOLVEPNP_AP3P);
  if (!found || inliers.size() < static_cast<std::size_t>(config.smallest_inliers)) return std::nullopt;
  Matches agreeing;
  for (const int i : inliers) {
    agreeing.points_W.push_back(matches.points_W[static_cast<std::size_t>(i)]);
    agreeing.pixels.push_back(matches.pixels[static_cast<std::size_t>(i)]);
  }
  cv::solvePnPRefineLM(agreeing.points_W, agreeing.pixels, intrinsics, cv::noArray(), turn, shift);
  cv::Matx33d rotation;
  cv::Rodrigues(turn, rotation);
  Pose T_CW = Pose::Identity();
  Eigen::Matrix3d R;
  cv::cv2eigen(rotation, R);
  T_CW.linear() = R;
  T_CW.translation() = Eigen::Vector3d(shift[0], shift[1], shift[2]);
  // Points behind the camera or far off come of matches that agree by chance.
  const double jump_m = (T_CW * keyframe.T_WC).translation().norm();
  if (!(jump_m <= config.farthest_m)) return std::nullopt;
  PlaceHypothesis hypothesis;
  hypothesis.T_WC = T_CW.inverse();
  hypothesis.keyframe = keyframe.index;
  hypothesis.inliers = static_cast<int>(inliers.size());
  return hypothesis;
}

}  // namespace

void RelocaliserConfig::describe(ConfigVisitor& visitor) {
  visitor.integer("compared_keyframes", compared_keyframes, {1, 1000}, "", "most similar keyframes matched in full");
  visitor.number("match_ratio", match_ratio, {0.0, 1.0}, "", "of best to second best distance of descriptors");
  visitor.integer("match_bits", match_bits, {0, 256}, "", "largest distance of matching descriptors");
  visitor.number("reprojection_px", reprojection_px, {0.1, 100.0}, "px", "largest error of a match that agrees");
  visitor.integer("ransac_iterations", ransac_iterations, {1, 100000}, "", "at most, per keyframe");
  visitor.integer("smallest_inliers", smallest_inliers, {4, 10000}, "", "matches that must agree on a pose");
  visitor.number("farthest_m", farthest_m, {0.0, 1000.0}, "m", "a pose farther from its keyframe is not believed");
  visitor.integer("verified_hypotheses", verified_hypotheses, {1, 1000}, "", "poses tried on the surface, best first");
}

struct Relocaliser::Memory {
  std::vector<std::shared_ptr<const Keyframe>> keyframes;
  DescriptorIndex index;  ///< of the keyframes' descriptors
};

Relocaliser::Relocaliser(const Config& config, const PlaceVerifierConfig& verification, const TrackerConfig& tracking)
    : config_(config), verifier_(verification, tracking), memory_(std::make_unique<Memory>()) {
  requireValid(config_);
}
Relocaliser::~Relocaliser() = default;
Relocaliser::Relocaliser(Relocaliser&&) noexcept = default;
Relocaliser& Relocaliser::operator=(Relocaliser&&) noexcept = default;

void Relocaliser::add(std::shared_ptr<const Keyframe> keyframe) {
  if (!keyframe) throw std::invalid_argument("Relocaliser: no keyframe given");
  memory_->index.add(keyframe->features.descriptors);
  memory_->keyframes.push_back(std::move(keyframe));
}

std::size_t Relocaliser::keyframes() const {
  return memory_->keyframes.size();
}

std::vector<PlaceHypothesis> Relocaliser::propose(const FrameFeatures& features, const PinholeCamera& camera) const {
  const std::vector<double> similarity = memory_->index.similarities(features.descriptors);
  std::vector<std::size_t> order(similarity.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return similarity[a] > similarity[b]; });
  order.resize(std::min(order.size(), static_cast<std::size_t>(config_.compared_keyframes)));

  std::vector<PlaceHypothesis> hypotheses;
  for (const std::size_t i : order) {
    const Keyframe& keyframe = *memory_->keyframes[i];
    const std::optional<PlaceHypothesis> hypothesis =
        solvePose(match(features, keyframe, config_), keyframe, camera, config_);
    if (hypothesis) hypotheses.push_back(*hypothesis);
  }
  std::stable_sort(hypotheses.begin(), hypotheses.end(),
                   [](const PlaceHypothesis& a, const PlaceHypothesis& b) { return a.inliers > b.inliers; });
  return hypotheses;
}

std::optional<VerifiedPlace> Relocaliser::find(const FrameFeatures& features, const DepthMaps& depth,
                                               const SurfaceVolume& surface) {
  int tried = 0;
  for (const PlaceHypothesis& hypothesis : propose(features, depth.camera)) {
    if (tried++ == config_.verified_hypotheses) break;
    if (auto place = verifier_.verify(depth, surface, hypothesis.T_WC)) return place;
  }
  return std::nullopt;
}

}  // namespace saccade
