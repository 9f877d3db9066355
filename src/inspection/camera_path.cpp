#include "saccade/inspection/camera_path.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace saccade {
namespace {

constexpr double kLookDown_rad = 30.0 * M_PI / 180.0;
constexpr double kMargin = 1.05;       ///< room around the scene, of the distance
constexpr std::size_t kSmoothing = 7;  ///< poses to either side that a calm film averages over
constexpr double kCoincide_m = 1e-9;

/// Any unit vector across `direction`, the nearest to `wished` where that is not along it.
Eigen::Vector3d across(const Eigen::Vector3d& direction, const Eigen::Vector3d& wished) {
  for (const Eigen::Vector3d& candidate :
       {wished, Eigen::Vector3d(Eigen::Vector3d::UnitX()), Eigen::Vector3d(Eigen::Vector3d::UnitZ())}) {
    const Eigen::Vector3d part = candidate - candidate.dot(direction) * direction;
    if (part.norm() > 1e-6) return part.normalized();
  }
  return direction.unitOrthogonal();
}

std::vector<Pose> smoothed(const std::vector<Pose>& path) {
  std::vector<Pose> calm = path;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const std::size_t reach = std::min({kSmoothing, i, path.size() - 1 - i});
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    const Eigen::Quaterniond middle(path[i].rotation());
    Eigen::Vector4d turn = Eigen::Vector4d::Zero();
    for (std::size_t k = i - reach; k <= i + reach; ++k) {
      position += path[k].translation();
      const Eigen::Vector4d q = Eigen::Quaterniond(path[k].rotation()).coeffs();
      turn += q.dot(middle.coeffs()) < 0.0 ? Eigen::Vector4d(-q) : q;  // q and -q are the same turn
    }
    calm[i].translation() = position / static_cast<double>(2 * reach + 1);
    calm[i].linear() = Eigen::Quaterniond(turn.normalized()).toRotationMatrix();
  }
  return calm;
}

Eigen::Vector3d catmullRom(const std::vector<Pose>& path, std::size_t i, double t) {
  const auto at = [&](std::ptrdiff_t k) -> Eigen::Vector3d {
    return path[static_cast<std::size_t>(
                    std::clamp<std::ptrdiff_t>(k, 0, static_cast<std::ptrdiff_t>(path.size()) - 1))]
        .translation();
  };
  const auto k = static_cast<std::ptrdiff_t>(i);
  const Eigen::Vector3d a = at(k - 1), b = at(k), c = at(k + 1), d = at(k + 2);
  return 0.5 *
         (2.0 * b + t * (c - a) + t * t * (2.0 * a - 5.0 * b + 4.0 * c - d) + t * t * t * (3.0 * (b - c) + d - a));
}

/// How far behind the middle of `box` a camera turned as `T_WC` must stand to see all of it.
double distanceToSeeAll(const Eigen::AlignedBox3d& box, const PinholeCamera& camera, const Pose& T_WC) {
  double distance = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d from_middle = box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)) - box.center();
    const Eigen::Vector3d p = T_WC.linear().transpose() * from_middle;
    const double sideways = std::max(std::abs(p.x()) * camera.fx / (0.5 * camera.width),
                                     std::abs(p.y()) * camera.fy / (0.5 * camera.height));
    distance = std::max(distance, sideways - p.z());
  }
  return distance;
}

}  // namespace

Pose lookAt(const Eigen::Vector3d& eye_W, const Eigen::Vector3d& target_W, const Eigen::Vector3d& up_W) {
  const Eigen::Vector3d view = target_W - eye_W;
  if (!(view.norm() > kCoincide_m)) throw std::invalid_argument("a camera cannot look at its own place");
  const Eigen::Vector3d forward = view.normalized();
  const Eigen::Vector3d down = -across(forward, up_W);
  Pose T_WC = Pose::Identity();
  T_WC.linear().col(0) = down.cross(forward);
  T_WC.linear().col(1) = down;
  T_WC.linear().col(2) = forward;
  T_WC.translation() = eye_W;
  return T_WC;
}

Pose parsePose(const std::string& text) {
  std::string spaced = text;
  std::replace(spaced.begin(), spaced.end(), ',', ' ');
  std::istringstream stream(spaced);
  std::vector<double> numbers;
  for (double number = 0.0; stream >> number;) numbers.push_back(number);
  const bool complete = stream.eof() && (numbers.size() == 3 || numbers.size() == 7);
  if (!complete || !std::all_of(numbers.begin(), numbers.end(), [](double n) { return std::isfinite(n); })) {
    throw std::invalid_argument("expected a pose \"x y z qx qy qz qw\" or \"x y z\" in metres, found \"" + text + "\"");
  }
  Pose T_WC(Eigen::Translation3d(numbers[0], numbers[1], numbers[2]));
  if (numbers.size() == 3) return T_WC;
  const Eigen::Quaterniond turn(numbers[6], numbers[3], numbers[4], numbers[5]);
  if (!(turn.norm() > kCoincide_m)) throw std::invalid_argument("the quaternion of the pose \"" + text + "\" is zero");
  T_WC.linear() = turn.normalized().toRotationMatrix();
  return T_WC;
}

PinholeCamera cameraWithFov(int width, int height, double horizontal_fov_rad) {
  const double focal = 0.5 * width / std::tan(0.5 * horizontal_fov_rad);
  return {width, height, focal, focal, 0.5 * (width - 1), 0.5 * (height - 1)};
}

std::vector<Pose> turntable(const SceneFrame& scene, const PinholeCamera& camera, int count) {
  if (scene.empty()) throw std::invalid_argument("a turntable needs a map with occupied leaves");
  const Eigen::Vector3d middle = scene.box.center();
  const Eigen::Vector3d back = -across(scene.up_W, Eigen::Vector3d::UnitZ());
  std::vector<Pose> poses;
  double distance = 0.0;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d level = Eigen::AngleAxisd(2.0 * M_PI * i / count, scene.up_W) * back;
    const Eigen::Vector3d from = std::cos(kLookDown_rad) * level + std::sin(kLookDown_rad) * scene.up_W;
    poses.push_back(lookAt(middle + from, middle, scene.up_W));
    distance = std::max(distance, distanceToSeeAll(scene.box, camera, poses.back()));
  }
  for (Pose& pose : poses) pose.translation() = middle - kMargin * distance * pose.linear().col(2);
  return poses;
}

std::vector<Pose> flyThrough(const std::vector<Pose>& path, int count) {
  if (path.empty()) throw std::invalid_argument("a fly-through needs at least one tracked frame");
  const std::vector<Pose> calm = smoothed(path);
  std::vector<Pose> poses;
  for (int i = 0; i < count; ++i) {
    const double along = count > 1 ? static_cast<double>(i) / (count - 1) * static_cast<double>(calm.size() - 1) : 0.0;
    const auto first = std::min(static_cast<std::size_t>(along), calm.size() - 1);
    const std::size_t second = std::min(first + 1, calm.size() - 1);
    const double share = along - static_cast<double>(first);
    Pose pose = Pose::Identity();
    pose.linear() = Eigen::Quaterniond(calm[first].rotation())
                        .slerp(share, Eigen::Quaterniond(calm[second].rotation()))
                        .toRotationMatrix();
    pose.translation() = catmullRom(calm, first, share);
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace saccade
