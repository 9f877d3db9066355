#include <cmath>
#include <numbers>

#include "saccade/simulation/simulated_source.hpp"
#include "simulation/random_hash.hpp"

namespace saccade {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kPi = std::numbers::pi;
constexpr double kRoom_m = 4.0, kRoomHeight_m = 2.6;
const Vector3d kDeskTop(1.05, 0.405, 0.75);  // middle of the table top's upper side
constexpr double kShelfTop_m = 1.15;

Pose poseAt(const Vector3d& p_W, double yaw = 0.0, double tilt = 0.0) {
  Pose pose = Pose::Identity();
  pose.translate(p_W);
  pose.rotate(Eigen::AngleAxisd(yaw, Vector3d::UnitZ()));
  pose.rotate(Eigen::AngleAxisd(tilt, Vector3d::UnitX()));
  return pose;
}

/// Puts things into the scene; objects get their ids in order.
class DeskBuilder {
 public:
  explicit DeskBuilder(std::uint64_t seed) : random_(seed) {}

  [[nodiscard]] Scene build() {
    addRoom();
    addFurniture();
    addDeskObjects();
    addShelfObjects();
    scene_.setLamp(Vector3d(1.7, 1.9, 2.4));
    return std::move(scene_);
  }

 private:
  Material material(Pattern pattern, const Vector3f& color, const Vector3f& second, double scale_m) {
    return {pattern, color, second, scale_m, random_.bits()};
  }

  /// Saturated enough to tell things apart, different for each seed.
  Vector3f vividColor() {
    const double hue = random_.between(0, 6);
    Vector3f color;
    for (int channel = 0; channel < 3; ++channel) {
      const double wave = 0.5 + 0.5 * std::cos(kPi / 3 * (hue - 2 * channel));
      color[channel] = static_cast<float>(0.12 + 0.75 * wave);
    }
    return color * static_cast<float>(random_.between(0.6, 1.0));
  }

  static Material plain(const Vector3f& color) { return {Pattern::kPlain, color, color, 1.0, 0}; }

  Material vivid(Pattern pattern, double scale_m) {
    const Vector3f first = vividColor(), second = vividColor();
    return material(pattern, first, second, scale_m);
  }

  void put(Shape shape, const Pose& T_WO, const Vector3d& half_size_m, const Material& looks) {
    scene_.add({shape, T_WO, half_size_m, looks, id_});
  }

  void addRoom() {
    const double r = kRoom_m / 2, h = kRoomHeight_m / 2;
    const Material floor = material(Pattern::kWood, {0.25f, 0.36f, 0.50f}, {0.14f, 0.22f, 0.34f}, 0.12);
    const Material wall = material(Pattern::kSpeckle, {0.66f, 0.74f, 0.76f}, {0.56f, 0.65f, 0.68f}, 0.25);
    put(Shape::kRectangle, poseAt({r, r, 0}), {r, r, 0}, floor);
    put(Shape::kRectangle, poseAt({r, r, kRoomHeight_m}), {r, r, 0}, wall);
    for (const double y : {0.0, kRoom_m}) put(Shape::kRectangle, poseAt({r, y, h}, 0, kPi / 2), {r, h, 0}, wall);
    for (const double x : {0.0, kRoom_m}) put(Shape::kRectangle, poseAt({x, r, h}, kPi / 2, kPi / 2), {r, h, 0}, wall);
    // Posters and a notice board: thin boxes, so that they cast an edge of shadow like the real ones.
    const auto poster = [&](const Vector3d& p, double yaw, double half_width, double half_height) {
      const double scale_m = random_.between(0.05, 0.09);
      put(Shape::kBox, poseAt(p, yaw), {half_width, 0.006, half_height}, vivid(Pattern::kPicture, scale_m));
    };
    poster({1.55, 0.006, 1.57}, 0, 0.21, 0.16);
    poster({0.62, 0.006, 0.97}, 0, 0.13, 0.11);
    poster({0.006, 0.75, 1.15}, kPi / 2, 0.28, 0.20);
    poster({0.006, 1.45, 1.25}, kPi / 2, 0.20, 0.28);
    put(Shape::kBox, poseAt({2.0, 0.008, 0.05}), {2.0, 0.008, 0.05}, plain({0.8f, 0.85f, 0.87f}));
  }

  void addFurniture() {
    const Material oak = material(Pattern::kWood, {0.42f, 0.58f, 0.74f}, {0.28f, 0.43f, 0.60f}, 0.09);
    const Material white = material(Pattern::kSpeckle, {0.82f, 0.84f, 0.85f}, {0.74f, 0.77f, 0.78f}, 0.15);
    const Material dark = material(Pattern::kSpeckle, {0.20f, 0.20f, 0.22f}, {0.30f, 0.28f, 0.28f}, 0.08);
    put(Shape::kBox, poseAt(kDeskTop - Vector3d(0, 0, 0.015)), {0.75, 0.375, 0.015}, oak);
    for (const double x : {-0.70, 0.70}) {
      for (const double y : {-0.33, 0.33}) {
        put(Shape::kBox, poseAt({kDeskTop.x() + x, kDeskTop.y() + y, 0.36}), {0.025, 0.025, 0.36}, oak);
      }
    }
    put(Shape::kBox, poseAt({1.50, 0.36, 0.29}), {0.17, 0.27, 0.29}, white);  // drawers below
    for (const double z : {0.15, 0.30, 0.45}) put(Shape::kBox, poseAt({1.50, 0.635, z}), {0.06, 0.012, 0.01}, dark);
    put(Shape::kBox, poseAt({2.30, 0.28, 0.95}), {0.32, 0.28, 0.95}, white);                              // wardrobe
    put(Shape::kBox, poseAt({1.05, 0.11, kShelfTop_m - 0.0125}), {0.60, 0.11, 0.0125}, oak);              // shelf
    put(Shape::kBox, poseAt({0.21, 1.55, 0.40}), {0.20, 0.42, 0.40}, oak);                                // chest
    put(Shape::kCylinder, poseAt({0.22, 0.95, 0.17}), {0.13, 0, 0.17}, dark);                             // bin
    put(Shape::kCylinder, poseAt({1.10, 1.00, 0.45}), {0.17, 0, 0.025}, vivid(Pattern::kChecker, 0.05));  // stool
    put(Shape::kCylinder, poseAt({1.10, 1.00, 0.21}), {0.03, 0, 0.21}, dark);
  }

  /// A place on the table top with a little scatter; z is that of the top.
  Vector3d onDesk(double x, double y) {
    const double dx = random_.between(-0.015, 0.015), dy = random_.between(-0.015, 0.015);
    return kDeskTop + Vector3d(x + dx, y + dy, 0);
  }

  void addBox(const Vector3d& foot, double yaw, const Vector3d& size_m, const Material& looks) {
    put(Shape::kBox, poseAt(foot + Vector3d(0, 0, size_m.z() / 2), yaw), size_m / 2, looks);
  }

  void addCylinder(const Vector3d& foot, double radius_m, double height_m, const Material& looks) {
    put(Shape::kCylinder, poseAt(foot + Vector3d(0, 0, height_m / 2), random_.between(0, 6)),
        {radius_m, 0, height_m / 2}, looks);
  }

  void addBall(const Vector3d& foot, double radius_m, const Material& looks) {
    const double yaw = random_.between(0, 6), tilt = random_.between(0, 3);
    put(Shape::kSphere, poseAt(foot + Vector3d(0, 0, radius_m), yaw, tilt), Vector3d::Constant(radius_m), looks);
  }

  // Every function below draws its random numbers one statement at a time: the order of arguments is the compiler's.

  void boxOnDesk(double x, double y, double max_yaw, const Vector3d& size_m, Pattern pattern, double scale_m) {
    ++id_;
    const Vector3d foot = onDesk(x, y);
    const double yaw = random_.between(-max_yaw, max_yaw);
    addBox(foot, yaw, size_m, vivid(pattern, scale_m));
  }

  void cylinderOnDesk(double x, double y, double radius_m, double height_m, Pattern pattern, double scale_m) {
    ++id_;
    const Vector3d foot = onDesk(x, y);
    addCylinder(foot, radius_m, height_m, vivid(pattern, scale_m));
  }

  void ballOnDesk(double x, double y, double radius_m, const Material& looks) {
    ++id_;
    addBall(onDesk(x, y), radius_m, looks);
  }

  void addLaptop() {
    ++id_;
    const Vector3d foot = onDesk(0.0, -0.02);
    const double yaw = random_.between(-0.25, 0.25);
    const Material grey = plain({0.55f, 0.55f, 0.54f});
    addBox(foot, yaw, {0.33, 0.23, 0.02}, grey);
    const Pose base = poseAt(foot + Vector3d(0, 0, 0.02), yaw);
    const Pose keys = base * Eigen::Translation3d(0, -0.02, 0.001);
    put(Shape::kBox, keys, {0.14, 0.06, 0.0015},
        material(Pattern::kChecker, {0.1f, 0.1f, 0.1f}, {0.2f, 0.2f, 0.2f}, 0.018));
    const Pose screen = base * Eigen::Translation3d(0, -0.115, 0) * Eigen::AngleAxisd(0.3, Vector3d::UnitX()) *
                        Eigen::Translation3d(0, 0, 0.105);
    put(Shape::kBox, screen, {0.165, 0.005, 0.105},
        material(Pattern::kPicture, {0.75f, 0.45f, 0.20f}, {0.25f, 0.20f, 0.15f}, 0.05));
  }

  void addDeskObjects() {
    addLaptop();

    ++id_;  // mug
    const Material glaze = vivid(Pattern::kStripes, 0.019);
    const Vector3d mug = onDesk(0.34, 0.16);
    addCylinder(mug, 0.042, 0.095, glaze);
    const double handle = random_.between(0.3, 2.8);
    put(Shape::kBox, poseAt(mug + Vector3d(0.055 * std::cos(handle), 0.055 * std::sin(handle), 0.05), handle),
        {0.018, 0.006, 0.028}, glaze);

    boxOnDesk(0.50, -0.22, 0.5, {0.19, 0.06, 0.29}, Pattern::kPicture, 0.045);  // cereals

    ++id_;  // bottle
    const Vector3d bottle = onDesk(-0.42, -0.20);
    const Material plastic = vivid(Pattern::kStripes, 0.05);
    addCylinder(bottle, 0.036, 0.20, plastic);
    addCylinder(bottle + Vector3d(0, 0, 0.20), 0.014, 0.06, plastic);

    const Vector3d books = onDesk(-0.50, 0.06);
    const double yaw = random_.between(-0.6, 0.6);
    ++id_;  // the lower book
    addBox(books, yaw, {0.24, 0.17, 0.035}, vivid(Pattern::kPicture, 0.06));
    ++id_;  // the upper book
    const double turn = random_.between(-0.4, 0.4);
    addBox(books + Vector3d(0.01, 0, 0.035), yaw + turn, {0.21, 0.15, 0.028}, vivid(Pattern::kPicture, 0.05));

    cylinderOnDesk(0.21, 0.24, 0.033, 0.115, Pattern::kPicture, 0.03);  // can
    const Material felt = vivid(Pattern::kSpeckle, 0.05);
    ballOnDesk(-0.27, 0.22, 0.05, felt);                                      // ball
    boxOnDesk(0.56, 0.12, 0.5, {0.23, 0.12, 0.09}, Pattern::kSpeckle, 0.04);  // tissues

    ++id_;  // plant
    const Vector3d plant = onDesk(-0.63, -0.22);
    addCylinder(plant, 0.06, 0.11, plain({0.22f, 0.36f, 0.62f}));
    addBall(plant + Vector3d(0, 0, 0.10), 0.085,
            material(Pattern::kSpeckle, {0.10f, 0.35f, 0.12f}, {0.25f, 0.65f, 0.35f}, 0.02));

    ++id_;  // telephone
    const Vector3d telephone = onDesk(-0.10, 0.27);
    const double telephone_yaw = random_.between(-1, 1);
    addBox(telephone, telephone_yaw, {0.075, 0.15, 0.012}, plain({0.08f, 0.08f, 0.09f}));
    ballOnDesk(0.08, 0.25, 0.038,
               material(Pattern::kSpeckle, {0.05f, 0.45f, 0.95f}, {0.08f, 0.55f, 0.98f}, 0.01));  // orange
  }

  void addShelfObjects() {
    const auto onShelf = [](double x) { return Vector3d(1.05 + x, 0.11, kShelfTop_m); };
    ++id_;  // a box of files
    const double yaw = random_.between(-0.1, 0.1);
    addBox(onShelf(0.40), yaw, {0.24, 0.16, 0.20}, vivid(Pattern::kPicture, 0.06));
    ++id_;  // vase
    addCylinder(onShelf(0.02), 0.05, 0.17, vivid(Pattern::kStripes, 0.03));
    ++id_;  // small box
    const double turn = random_.between(-0.3, 0.3);
    addBox(onShelf(-0.38), turn, {0.20, 0.13, 0.11}, vivid(Pattern::kSpeckle, 0.05));
  }

  RandomStream random_;
  Scene scene_;
  int id_ = 0;
};

Pose lookingAt(const Vector3d& eye_W, const Vector3d& target_W) {
  const Vector3d forward = (target_W - eye_W).normalized();
  const Vector3d right = forward.cross(Vector3d::UnitZ()).normalized();
  Pose T_WC = Pose::Identity();
  T_WC.linear() << right, forward.cross(right), forward;
  T_WC.translation() = eye_W;
  return T_WC;
}

}  // namespace

Scene makeDeskScene(std::uint64_t seed) {
  return DeskBuilder(seed).build();
}

Pose deskCameraPose(std::uint64_t seed, std::int64_t frame) {
  RandomStream random(seed ^ 0x7061746800000000u);
  const auto wave = [frame](double period_frames, double phase) {
    return std::sin(2 * kPi * static_cast<double>(frame) / period_frames + phase);
  };
  const auto phase = [&random] { return random.between(0, 2 * kPi); };
  // Amplitudes and periods keep the sum of all speeds below 2 cm and 1.5 degrees a frame.
  const double azimuth = 0.45 * wave(300, phase());
  const double radius_m = 1.25 + 0.08 * wave(210, phase());
  const double height_m = 0.55 + 0.08 * wave(170, phase());
  Vector3d target = kDeskTop + Vector3d(0, 0, 0.10);
  target.x() += 0.06 * wave(230, phase());
  target.z() += 0.03 * wave(130, phase());
  Vector3d eye = kDeskTop + Vector3d(radius_m * std::sin(azimuth), radius_m * std::cos(azimuth), height_m);
  for (int axis = 0; axis < 3; ++axis) eye[axis] += 0.0012 * wave(11.3 + 3.1 * axis, phase());
  for (int axis = 0; axis < 3; ++axis) target[axis] += 0.0020 * wave(13.7 + 2.3 * axis, phase());
  return lookingAt(eye, target);
}

}  // namespace saccade
