#include "saccade/tracking/place_verifier.hpp"

namespace saccade {
namespace {

constexpr int kViewReduction = 2;
constexpr int kPointStride_px = 2;

TrackerConfig withEigenvalue(TrackerConfig config, double weak_eigenvalue) {
  config.solved_eigenvalue = config.weak_eigenvalue = weak_eigenvalue;
  return config;
}

/// Share of the frame's points, of those that meet a surface of `view` at `T_WC`, that lie clearly behind it.
double contradictedShare(const DepthMaps& depth, const ModelView& view, const Pose& T_WC,
                         const PlaceVerifierConfig& config) {
  const Eigen::Isometry3f T_MC = (view.T_WM.inverse() * T_WC).cast<float>();
  std::int64_t met = 0, contradicted = 0;
  for (int v = 0; v < depth.camera.height; v += kPointStride_px) {
    for (int u = 0; u < depth.camera.width; u += kPointStride_px) {
      const cv::Vec3f& p = depth.vertices(v, u);
      if (!(p[2] > 0.0F)) continue;
      const Eigen::Vector3d p_M = (T_MC * Eigen::Vector3f(p[0], p[1], p[2])).cast<double>();
      if (p_M.z() < 0.1) continue;
      const Eigen::Vector2d pixel = view.camera.project(p_M);
      const cv::Point at(cvRound(pixel.x()), cvRound(pixel.y()));
      if (at.x < 0 || at.y < 0 || at.x >= view.camera.width || at.y >= view.camera.height) continue;
      const double expected_m = static_cast<double>(view.depth_m(at));
      if (!(expected_m > 0.0)) continue;
      ++met;
      const double margin_m = config.contradiction_m + config.contradiction_per_m * p_M.z() * p_M.z();
      if (p_M.z() - expected_m > margin_m) ++contradicted;
    }
  }
  return met > 0 ? static_cast<double>(contradicted) / static_cast<double>(met) : 0.0;
}

}  // namespace

void PlaceVerifierConfig::describe(ConfigVisitor& visitor) {
  visitor.number("smallest_covered_share", smallest_covered_share, {0.0, 1.0}, "",
                 "of the frame's points that must meet a surface of the model");
  visitor.number("smallest_inlier_share", smallest_inlier_share, {0.0, 1.0}, "",
                 "of the points that meet a surface, those that must lie on it");
  visitor.number("weak_eigenvalue", weak_eigenvalue, {0.0, 1.0}, "",
                 "a surface that leaves a direction more open than this verifies nothing");
  visitor.number("largest_rms_m", largest_rms_m, {0.0, 1.0}, "m", "distance of the points from the surface");
  visitor.number("largest_contradicted_share", largest_contradicted_share, {0.0, 1.0}, "",
                 "of the points that meet a surface, those that may lie behind it");
  visitor.number("contradiction_m", contradiction_m, {0.0, 10.0}, "m", "how far behind a surface contradicts it");
  visitor.number("contradiction_per_m", contradiction_per_m, {0.0, 1.0}, "1/m",
                 "and how much farther per square of the depth");
}

PlaceVerifier::PlaceVerifier(const Config& config, const TrackerConfig& tracking)
    : config_(config), tracker_(withEigenvalue(tracking, config.weak_eigenvalue)) {
  requireValid(config_);
}

VerifiedPlace PlaceVerifier::examine(const DepthMaps& depth, const SurfaceVolume& surface, const Pose& guess) {
  const PinholeCamera camera = depth.camera.reducedBy(kViewReduction);
  VerifiedPlace place;
  place.tracking.T_WC = guess;
  // The first alignment looks from the guess, which may hide what is seen from the place itself. Later ones do not, and
  // bring the last centimetres: a guess by features is off by several.
  constexpr int kPasses = 4;
  for (int pass = 0; pass < kPasses; ++pass) {
    if (prepare_) prepare_(place.tracking.T_WC);
    surface.rayCast(camera, place.tracking.T_WC, view_);
    place.tracking = tracker_.track(depth, view_, place.tracking.T_WC);
    if (place.tracking.status == TrackingStatus::kLost) return place;
  }
  place.contradicted_share = contradictedShare(depth, view_, place.tracking.T_WC, config_);
  return place;
}

bool PlaceVerifier::accepts(const VerifiedPlace& place) const {
  const Tracking& found = place.tracking;
  return found.status == TrackingStatus::kTracked && found.covered_share >= config_.smallest_covered_share &&
         found.inlier_share >= config_.smallest_inlier_share && found.rms_m <= config_.largest_rms_m &&
         place.contradicted_share <= config_.largest_contradicted_share;
}

std::optional<VerifiedPlace> PlaceVerifier::verify(const DepthMaps& depth, const SurfaceVolume& surface,
                                                   const Pose& guess) {
  const VerifiedPlace place = examine(depth, surface, guess);
  return accepts(place) ? std::optional(place) : std::nullopt;
}

}  // namespace saccade
