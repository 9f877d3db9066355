#include "saccade/tracking/tracker.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include <Eigen/Dense>

#include "tracking/photometric.hpp"
#include "tracking/point_to_plane.hpp"
#include "tracking/rigid_motion.hpp"

namespace saccade {
namespace {

constexpr int kLevels = 3;
// Differences of grey values that are another surface, a highlight or a shadow. Finest level first: before the camera
// is in its place, the same surface differs too.
constexpr std::array<double, kLevels> kGreyGates = {15.0, 20.0, 40.0};
// A step below this moves no point at 4 m by more than a quarter of a millimetre.
constexpr double kSmallTurn_rad = 3e-5;
constexpr double kSmallShift_m = 1e-4;

struct Spectrum {
  Vector6 values;      // ascending, per unit of weight, rotations scaled by the mean range
  Matrix6 directions;  // columns, in scaled coordinates
};

Vector6 scaling(double mean_range_m) {
  Vector6 scale;
  scale << 1.0 / mean_range_m, 1.0 / mean_range_m, 1.0 / mean_range_m, 1.0, 1.0, 1.0;
  return scale;
}

Spectrum spectrumOf(const Matrix6& information, double mean_range_m) {
  const Vector6 scale = scaling(mean_range_m);
  const Matrix6 scaled = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(scaled);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

// Normal equations per unit of weight of the surface's distances, square metres.
struct Step {
  Matrix6 H;
  Vector6 b;
};

// What the colour of the live frame adds to the surface.
class ColorTerm {
 public:
  ColorTerm(const TrackedColor* color, const DepthMaps& depth, const ModelView& model, double grey_levels_per_mm)
      : factor_(grey_levels_per_mm > 0.0 ? 1e-6 / (grey_levels_per_mm * grey_levels_per_mm) : 0.0) {
    if (color == nullptr || color->reference.empty() || !(factor_ > 0.0)) return;
    const PhotometricReference::State& reference = color->reference.state();
    pair_.emplace(PhotometricPair{reference, color->live, depth, model.T_WM.inverse() * reference.T_WR});
  }

  // Adds the term linearized at `T_MC`; `level` is the tracker's.
  void addTo(Step& step, std::size_t level, const Pose& T_MC) {
    if (!pair_) return;
    // What a few points say must not weigh like what the whole image says.
    constexpr double kFewPoints = 500.0;
    const std::size_t of_pyramid = level == kLevels - 1 ? 1 : 0;
    const NormalEquations sums = linearizePhotometric(*pair_, of_pyramid, T_MC, brightness_, kGreyGates[level]);
    if (!(sums.weight > 0.0)) return;
    const double share = factor_ / std::max(sums.weight, kFewPoints);
    step.H += share * sums.H;
    step.b += share * sums.b;
    brightness_ += sums.weighted_residual / sums.weight;
  }

 private:
  double factor_;  // m^2 per square grey level
  std::optional<PhotometricPair> pair_;
  double brightness_ = 0.0;  // of the live frame over the reference
};

// The Gauss-Newton step, left out in directions that nothing fixes: there the prediction stays.
Vector6 solve(const Step& equations, double mean_range_m, double smallest_eigenvalue) {
  const Spectrum spectrum = spectrumOf(equations.H, mean_range_m);
  const Vector6 scale = scaling(mean_range_m);
  const Vector6 b = scale.asDiagonal() * equations.b;
  Vector6 step = Vector6::Zero();
  for (int k = 0; k < 6; ++k) {
    if (spectrum.values(k) < smallest_eigenvalue) continue;
    const Vector6 direction = spectrum.directions.col(k);
    step += direction * (direction.dot(b) / spectrum.values(k));
  }
  return scale.asDiagonal() * step;
}

}  // namespace

struct Tracker::Scratch {
  std::array<LivePoints, kLevels> levels;  // finest first
};

void TrackerConfig::describe(ConfigVisitor& visitor) {
  visitor.integer("finest_stride_px", finest_stride_px, {1, 16}, "px", "step between live pixels on the finest level");
  visitor.integer("coarse_iterations", coarse_iterations, {0, 100}, "", "at most, on the coarsest level");
  visitor.integer("middle_iterations", middle_iterations, {0, 100}, "", "at most, on the middle level");
  visitor.integer("fine_iterations", fine_iterations, {1, 100}, "", "at most, on the finest level");
  visitor.number("coarse_gate_m", coarse_gate_m, {0.001, 10.0}, "m", "largest distance of a pair, coarsest level");
  visitor.number("middle_gate_m", middle_gate_m, {0.001, 10.0}, "m", "largest distance of a pair, middle level");
  visitor.number("fine_gate_m", fine_gate_m, {0.001, 10.0}, "m", "largest distance of a pair, finest level");
  visitor.number("smallest_normal_cosine", smallest_normal_cosine, {-1.0, 1.0}, "",
                 "cosine of the largest angle between the normals of a pair");
  visitor.number("solved_eigenvalue", solved_eigenvalue, {0.0, 1.0}, "",
                 "directions of motion with a smaller eigenvalue are not solved for");
  visitor.number("weak_eigenvalue", weak_eigenvalue, {0.0, 1.0}, "",
                 "with a smaller eigenvalue, free of noise, the result is weak");
  visitor.number("weak_inlier_share", weak_inlier_share, {0.0, 1.0}, "", "with fewer points near the model it is weak");
  visitor.number("lost_inlier_share", lost_inlier_share, {0.0, 1.0}, "", "with fewer inliers the camera is lost");
  visitor.integer("lost_inliers", lost_inliers, {6, 1000000}, "points", "with fewer inliers the camera is lost");
  visitor.number("lost_rms_m", lost_rms_m, {0.0, 1.0}, "m", "with a larger distance the camera is lost");
  visitor.number("grey_levels_per_mm", grey_levels_per_mm, {0.0, 1000.0}, "1/mm",
                 "difference of grey values that counts as much as 1 mm of distance; 0: colour does not count");
  visitor.number("largest_step_m", largest_step_m, {0.0, 100.0}, "m", "farthest believable from the prediction");
  visitor.number("largest_turn_rad", largest_turn_rad, {0.0, 3.2}, "rad", "farthest believable from the prediction");
}

Tracker::Tracker(const Config& config) : config_(config), scratch_(std::make_unique<Scratch>()) {
  requireValid(config_);
}
Tracker::~Tracker() = default;
Tracker::Tracker(Tracker&&) noexcept = default;
Tracker& Tracker::operator=(Tracker&&) noexcept = default;

Tracking Tracker::track(const DepthMaps& depth, const ModelView& model, const Pose& prediction,
                        const TrackedColor* color) {
  if (!prediction.matrix().allFinite()) throw std::invalid_argument("the prediction is not finite");
  const std::array<double, kLevels> gates_m = {config_.fine_gate_m, config_.middle_gate_m, config_.coarse_gate_m};
  const std::array<int, kLevels> iterations = {config_.fine_iterations, config_.middle_iterations,
                                               config_.coarse_iterations};
  Tracking result;
  result.T_WC = prediction;
  const Pose T_MC_predicted = model.T_WM.inverse() * prediction;
  Pose T_MC = T_MC_predicted;
  ColorTerm color_term(color, depth, model, config_.grey_levels_per_mm);
  NormalEquations sums;
  for (std::size_t level = kLevels; level-- > 0;) {
    LivePoints& points = scratch_->levels[level];
    points.select(depth, config_.finest_stride_px << level);
    for (int i = 0; i < iterations[level]; ++i) {
      sums = linearize(points, model, T_MC, {gates_m[level], config_.smallest_normal_cosine});
      if (sums.inliers < 6.0 || !(sums.weight > 0.0)) break;
      Step equations{sums.H / sums.weight, sums.b / sums.weight};
      color_term.addTo(equations, level, T_MC);
      const Vector6 step = solve(equations, points.mean_range_m, config_.solved_eigenvalue);
      T_MC = orthonormalized(rigidMotion(step.head<3>(), step.tail<3>()) * T_MC);
      ++result.iterations;
      if (step.head<3>().norm() < kSmallTurn_rad && step.tail<3>().norm() < kSmallShift_m) break;
    }
  }

  const LivePoints& finest = scratch_->levels[0];
  result.inliers = static_cast<int>(sums.inliers);
  if (sums.inliers < config_.lost_inliers || !(sums.weight > 0.0)) return result;
  result.inlier_share = sums.inliers / sums.met;
  result.near_share = sums.near / sums.met;
  result.covered_share = sums.met / static_cast<double>(finest.count);
  result.rms_m = std::sqrt(sums.weighted_square / sums.weight);
  const PairingGates finest_gates{config_.fine_gate_m, config_.smallest_normal_cosine};
  Step information{noiseFreeInformation(finest, model, T_MC, finest_gates), Vector6::Zero()};
  color_term.addTo(information, 0, T_MC);
  const Vector6 spectrum = spectrumOf(information.H, finest.mean_range_m).values;
  result.smallest_eigenvalue = std::max(0.0, spectrum(0));
  result.condition = spectrum(0) > 0.0 ? spectrum(5) / spectrum(0) : std::numeric_limits<double>::infinity();
  const Pose correction = T_MC_predicted.inverse() * T_MC;
  if (result.inlier_share < config_.lost_inlier_share || result.rms_m > config_.lost_rms_m ||
      correction.translation().norm() > config_.largest_step_m ||
      rotationVector(correction.linear()).norm() > config_.largest_turn_rad) {
    return result;
  }
  const bool weak =
      result.smallest_eigenvalue < config_.weak_eigenvalue || result.near_share < config_.weak_inlier_share;
  result.status = weak ? TrackingStatus::kWeak : TrackingStatus::kTracked;
  result.T_WC = orthonormalized(model.T_WM * T_MC);
  return result;
}

}  // namespace saccade
