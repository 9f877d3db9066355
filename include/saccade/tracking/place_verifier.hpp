#pragma once

#include <functional>
#include <optional>
#include <utility>

#include "saccade/core/config_fields.hpp"
#include "saccade/core/depth_maps.hpp"
#include "saccade/map/surface_volume.hpp"
#include "saccade/tracking/tracker.hpp"

namespace saccade {

struct PlaceVerifierConfig {
  double smallest_covered_share = 0.55;  ///< of the frame's points that meet a surface of the model
  double smallest_inlier_share = 0.5;    ///< of those, the share that lies on it
  /// As TrackerConfig::weak_eigenvalue, but less: of a guess by many points the open direction is known fairly well.
  double weak_eigenvalue = 5e-4;
  double largest_rms_m = 0.01;  ///< of the inliers' point-to-plane distances
  /// Share of the covered points that are seen through a surface of the model, which nothing but a change of the scene
  /// explains if the pose is right.
  double largest_contradicted_share = 0.08;
  double contradiction_m = 0.05;      ///< how far behind the model's surface a point contradicts it, at 1 m
  double contradiction_per_m = 0.02;  ///< and that much farther per square metre of depth (the sensor's error)

  void describe(ConfigVisitor& visitor);
};

/// A pose that the surface confirms, and how firmly.
struct VerifiedPlace {
  Tracking tracking;  ///< status kTracked, the pose after ICP
  double contradicted_share = 0.0;
};

/// Decides whether a frame was taken from a pose, by aligning it to the surface (ICP) and looking for contradictions.
///
/// Refuses in doubt: a place that looks alike but is not has surfaces where the frame sees free space. Edits nothing.
class PlaceVerifier {
 public:
  using Config = PlaceVerifierConfig;

  /// Throws std::invalid_argument if a field of a config is out of range.
  explicit PlaceVerifier(const Config& config = {}, const TrackerConfig& tracking = {});

  /// The place near `guess` where `depth` agrees with `surface`; none if there is none.
  [[nodiscard]] std::optional<VerifiedPlace> verify(const DepthMaps& depth, const SurfaceVolume& surface,
                                                    const Pose& guess);
  /// The same without the verdict: what verify() judges by.
  [[nodiscard]] VerifiedPlace examine(const DepthMaps& depth, const SurfaceVolume& surface, const Pose& guess);
  [[nodiscard]] bool accepts(const VerifiedPlace& place) const;
  /// `prepare` is called with each pose before the surface is looked at from there.
  void beforeEachLook(std::function<void(const Pose& T_WC)> prepare) { prepare_ = std::move(prepare); }

 private:
  Config config_;
  Tracker tracker_;
  ModelView view_;
  std::function<void(const Pose& T_WC)> prepare_;
};

}  // namespace saccade
