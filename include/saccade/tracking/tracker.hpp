#pragma once

#include <memory>

#include "saccade/core/config_fields.hpp"
#include "saccade/core/depth_maps.hpp"
#include "saccade/core/frame.hpp"
#include "saccade/map/model_view.hpp"
#include "saccade/tracking/intensity_pyramid.hpp"
#include "saccade/tracking/photometric_reference.hpp"

namespace saccade {

enum class TrackingStatus {
  kTracked,  ///< the pose is good: integrate and attend
  kWeak,     ///< the surface leaves a direction open or fits poorly: the pose is plausible, do not integrate
  kLost,     ///< no pose; write nothing
};

/// What tracking found, and how far it can be believed.
struct Tracking {
  Pose T_WC = Pose::Identity();  ///< the prediction if lost
  TrackingStatus status = TrackingStatus::kLost;
  int inliers = 0;             ///< live points that met the model within the gates, on the finest level
  double inlier_share = 0.0;   ///< of the live points that met the model at all
  double near_share = 0.0;     ///< of these, those within the distance gate, whatever their normals
  double covered_share = 0.0;  ///< of all live points: those that met the model at all
  double rms_m = 0.0;          ///< point-to-plane distance of the inliers, weighted
  /// Smallest eigenvalue of the normal matrix H per unit of weight, rotations scaled by the mean distance of the
  /// points, without what noise in the normals adds and with what colour adds: 0 means that some motion of the camera
  /// would go unnoticed.
  double smallest_eigenvalue = 0.0;
  double condition = 0.0;  ///< largest eigenvalue over the smallest, infinite if that is 0
  int iterations = 0;      ///< over all levels
};

struct TrackerConfig {
  int finest_stride_px = 2;   ///< of the live pixels that are used on the finest level; doubled on each coarser
  int coarse_iterations = 8;  ///< at most
  int middle_iterations = 6;
  int fine_iterations = 5;
  double coarse_gate_m = 0.10;  ///< distance between a live point and the model's beyond which they do not pair
  double middle_gate_m = 0.05;
  double fine_gate_m = 0.025;
  double smallest_normal_cosine = 0.8;
  double solved_eigenvalue = 2e-3;  ///< directions with less, noise and all, are not solved for
  /// A result with less, see Tracking::smallest_eigenvalue, is weak. Bare walls have up to 4e-4, cluttered scenes 4e-3.
  double weak_eigenvalue = 1e-3;
  /// A result with a smaller Tracking::near_share is weak. Normals are not asked: those of a far surface that few
  /// frames have shown are as coarse as the steps of its depth, and it would never be integrated.
  double weak_inlier_share = 0.5;
  double lost_inlier_share = 0.25;
  int lost_inliers = 1000;
  double lost_rms_m = 0.015;
  /// Difference of grey values that counts as much as 1 mm between points and surface; 0: colour does not count.
  double grey_levels_per_mm = 4.0;
  double largest_step_m = 0.30;  ///< a result farther from the prediction is not believed
  double largest_turn_rad = 0.5;

  void describe(ConfigVisitor& visitor);
};

/// The colour of the frame that is tracked and an earlier frame's to compare it with.
struct TrackedColor {
  const IntensityPyramid& live;
  const PhotometricReference& reference;
};

/// Aligns a frame to a view of the model: projective association, point-to-plane distances, coarse to fine over three
/// levels, robust weights, Gauss-Newton (Chen and Medioni 1992; Newcombe et al. 2011, "sensor pose estimation"). Where
/// colour is given too, differences of grey values to a reference frame are made small at the same time (Whelan et al.
/// 2013, "Robust real-time visual odometry for dense RGB-D mapping"): texture holds the camera where the surface does
/// not, along a wall, and is not bent as the depth of a structured-light camera is.
///
/// Owns its scratch only: it neither predicts (MotionPredictor does) nor remembers the last pose, so the result depends
/// on the arguments alone. Degenerate geometry is noticed, not hidden: see Tracking. One object per thread.
class Tracker {
 public:
  using Config = TrackerConfig;

  /// Throws std::invalid_argument if a field of `config` is out of range.
  explicit Tracker(const Config& config = {});
  ~Tracker();
  Tracker(Tracker&&) noexcept;
  Tracker& operator=(Tracker&&) noexcept;

  /// The pose of `depth`'s camera for which it agrees with `model`, searched from `prediction`. The model may have been
  /// rendered with any camera at any nearby pose; half of the frame's resolution is enough. A few ms.
  /// Without `color`, or with an empty reference, the surface alone counts.
  [[nodiscard]] Tracking track(const DepthMaps& depth, const ModelView& model, const Pose& prediction,
                               const TrackedColor* color = nullptr);

  [[nodiscard]] const Config& config() const { return config_; }

 private:
  struct Scratch;

  Config config_;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace saccade
