#include "simulation/camera_path.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace saccade {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kTwoPi = 2 * std::numbers::pi;
constexpr double kLargestStep_m = 0.02;
constexpr double kLargestTurn = 1.5 / 360 * kTwoPi;
// The spline itself goes no faster than this share of the largest step; tremor takes part of the rest.
constexpr double kPace = 0.8;
constexpr int kSamplesPerTurn = 400;
constexpr double kTremor_m = 0.0011, kTremorAtTarget_m = 0.0022;

Pose lookingAt(const Viewpoint& view) {
  const Vector3d forward = (view.target_W - view.eye_W).normalized();
  const Vector3d right = forward.cross(Vector3d::UnitZ()).normalized();
  Pose T_WC = Pose::Identity();
  T_WC.linear() << right, forward.cross(right), forward;
  T_WC.translation() = view.eye_W;
  return T_WC;
}

}  // namespace

CameraPath::CameraPath(std::vector<Viewpoint> turns, std::int64_t loop_frames, std::uint64_t seed)
    : turns_(std::move(turns)), loop_frames_(loop_frames) {
  if (turns_.size() < 4) {
    throw std::invalid_argument("CameraPath: expected 4 viewpoints or more, found " + std::to_string(turns_.size()));
  }
  RandomStream random(seed);
  for (double& phase : phase_) phase = random.between(0, kTwoPi);
  const auto samples = static_cast<int>(turns_.size()) * kSamplesPerTurn;
  effort_.push_back(0.0);
  Pose last = lookingAt(onSpline(0));
  for (int i = 1; i <= samples; ++i) {
    const Pose next = lookingAt(onSpline(static_cast<double>(i) / kSamplesPerTurn));
    const Pose step = last.inverse() * next;
    effort_.push_back(effort_.back() + std::max(step.translation().norm() / kLargestStep_m,
                                                Eigen::AngleAxisd(step.linear()).angle() / kLargestTurn));
    last = next;
  }
  loop_frames_ = std::max(loop_frames_, static_cast<std::int64_t>(std::ceil(effort_.back() / kPace)));
}

Viewpoint CameraPath::onSpline(double place) const {
  const double whole = std::floor(place), t = place - whole;
  const std::size_t count = turns_.size(), first = static_cast<std::size_t>(whole) + count - 1;
  const double weights[4] = {(1 - t) * (1 - t) * (1 - t) / 6, (3 * t * t * t - 6 * t * t + 4) / 6,
                             (-3 * t * t * t + 3 * t * t + 3 * t + 1) / 6, t * t * t / 6};
  Viewpoint view{Vector3d::Zero(), Vector3d::Zero()};
  for (std::size_t i = 0; i < 4; ++i) {
    view.eye_W += weights[i] * turns_[(first + i) % count].eye_W;
    view.target_W += weights[i] * turns_[(first + i) % count].target_W;
  }
  return view;
}

Pose CameraPath::at(std::int64_t frame) const {
  const std::int64_t in_loop = frame % loop_frames_;
  const double effort = effort_.back() * static_cast<double>(in_loop) / static_cast<double>(loop_frames_);
  const auto after = std::upper_bound(effort_.begin(), effort_.end(), effort);
  const auto index =
      std::clamp<std::ptrdiff_t>(after - effort_.begin() - 1, 0, static_cast<std::ptrdiff_t>(effort_.size()) - 2);
  const double low = effort_[static_cast<std::size_t>(index)], high = effort_[static_cast<std::size_t>(index) + 1];
  const double share = high > low ? (effort - low) / (high - low) : 0.0;
  Viewpoint view = onSpline((static_cast<double>(index) + share) / kSamplesPerTurn);
  for (int axis = 0; axis < 3; ++axis) {
    const auto wave = [&](double period_frames, double phase) {
      return std::sin(kTwoPi * static_cast<double>(frame) / period_frames + phase);
    };
    view.eye_W[axis] += kTremor_m * wave(11.3 + 3.1 * axis, phase_[axis]);
    view.target_W[axis] += kTremorAtTarget_m * wave(13.7 + 2.3 * axis, phase_[3 + axis]);
  }
  return lookingAt(view);
}

std::vector<Viewpoint> orbit(const Vector3d& middle_W, double radius_m, double height_m, double azimuth, double reach,
                             RandomStream& random) {
  constexpr int kCount = 12;
  const double phase = random.between(0, kTwoPi);
  std::vector<Viewpoint> views;
  for (int i = 0; i < kCount; ++i) {
    const double angle = azimuth + reach * std::sin(kTwoPi * i / kCount + phase);
    const double radius = radius_m + random.between(-0.12, 0.12), height = height_m + random.between(-0.1, 0.1);
    const double dx = random.between(-0.12, 0.12), dy = random.between(-0.06, 0.06), dz = random.between(-0.06, 0.06);
    views.push_back({middle_W + Vector3d(radius * std::cos(angle), radius * std::sin(angle), height),
                     middle_W + Vector3d(dx, dy, dz)});
  }
  return views;
}

std::vector<Viewpoint> wander(const Eigen::AlignedBox3d& eyes_W, const Eigen::AlignedBox3d& targets_W, int count,
                              RandomStream& random) {
  const auto within = [&](const Eigen::AlignedBox3d& box) {
    Vector3d p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = random.between(box.min()[axis], box.max()[axis]);
    return p;
  };
  std::vector<Viewpoint> views;
  for (int i = 0; i < count; ++i) {
    const Vector3d eye = within(eyes_W), target = within(targets_W);
    views.push_back({eye, target});
  }
  return views;
}

std::vector<Viewpoint> sweep(const Vector2d& a_W, const Vector2d& b_W, double distance_m, double eye_height_m,
                             double target_height_m, RandomStream& random) {
  constexpr int kCount = 12;
  const Vector2d along = (b_W - a_W).normalized(), left(-along.y(), along.x());
  std::vector<Viewpoint> views;
  for (int i = 0; i < kCount; ++i) {
    const double share = 0.5 - 0.5 * std::cos(kTwoPi * i / kCount);
    const double distance = distance_m + random.between(-0.15, 0.15),
                 eye_height = eye_height_m + random.between(-0.1, 0.1);
    const double ahead = random.between(-0.2, 0.2), target_height = target_height_m + random.between(-0.1, 0.1);
    const Vector2d target = a_W + share * (b_W - a_W);
    const Vector2d eye = target + distance * left + ahead * along;
    views.push_back({{eye.x(), eye.y(), eye_height}, {target.x(), target.y(), target_height}});
  }
  return views;
}

}  // namespace saccade
