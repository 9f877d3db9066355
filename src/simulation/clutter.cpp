#include "simulation/clutter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

#include "simulation/upright_pose.hpp"

namespace saccade {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kGap_m = 0.004;
constexpr double kRim_m = 0.008;  // from the support's edge
constexpr int kTries = 60;
const Vector3d kOrigin = Vector3d::Zero();

/// Whether a line along one of a's edges parts the two convex outlines by the gap.
bool partedByAnEdge(const std::vector<Vector2d>& a, const std::vector<Vector2d>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Vector2d edge = a[(i + 1) % a.size()] - a[i];
    if (edge.squaredNorm() < 1e-14) continue;
    const Vector2d outward = Vector2d(edge.y(), -edge.x()).normalized();
    double nearest = std::numeric_limits<double>::infinity();
    for (const Vector2d& p : b) nearest = std::min(nearest, outward.dot(p - a[i]));
    if (nearest >= kGap_m) return true;
  }
  return false;
}

double groundArea(const ObjectModel& model) {
  Eigen::AlignedBox2f box;
  for (const ObjectModel::Part& part : model.parts) {
    for (const Eigen::Vector3f& p : part.mesh.vertices) box.extend(p.head<2>());
  }
  return static_cast<double>(box.volume());
}

}  // namespace

Clutter::Outline Clutter::outlineOf(const ObjectModel& model) {
  std::vector<cv::Point2f> points, hull;
  float z_low = std::numeric_limits<float>::infinity(), z_high = -z_low;
  for (const ObjectModel::Part& part : model.parts) {
    for (const Eigen::Vector3f& p : part.mesh.vertices) {
      points.emplace_back(p.x(), p.y());
      z_low = std::min(z_low, p.z());
      z_high = std::max(z_high, p.z());
    }
  }
  cv::convexHull(points, hull);
  Outline outline;
  double doubled_area = 0.0;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const cv::Point2f &a = hull[i], &b = hull[(i + 1) % hull.size()];
    outline.corners.emplace_back(a.x, a.y);
    doubled_area += static_cast<double>(a.x * b.y - a.y * b.x);
  }
  if (doubled_area < 0) std::reverse(outline.corners.begin(), outline.corners.end());
  outline.low = outline.high = outline.corners.front();
  for (const Vector2d& p : outline.corners) {
    outline.low = outline.low.cwiseMin(p);
    outline.high = outline.high.cwiseMax(p);
  }
  outline.z_low = static_cast<double>(z_low);
  outline.z_high = static_cast<double>(z_high);
  return outline;
}

bool Clutter::collide(const Outline& a, const Outline& b) {
  constexpr double kTouch_m = 5e-4;  // what stands on something shares its height
  if (a.z_low > b.z_high - kTouch_m || b.z_low > a.z_high - kTouch_m) return false;
  if (((a.low - b.high).array() > kGap_m).any() || ((b.low - a.high).array() > kGap_m).any()) return false;
  return !partedByAnEdge(a.corners, b.corners) && !partedByAnEdge(b.corners, a.corners);
}

bool Clutter::isFree(const Outline& outline) const {
  return std::none_of(taken_.begin(), taken_.end(), [&](const Outline& other) { return collide(outline, other); });
}

void Clutter::block(const Vector2d& low, const Vector2d& high, double z_low, double z_high) {
  taken_.push_back({{low, {high.x(), low.y()}, high, {low.x(), high.y()}}, low, high, z_low, z_high});
}

void Clutter::commit(ObjectModel model, const Outline& outline) {
  const int id = scene_.addObject(model.kind);
  for (ObjectModel::Part& part : model.parts) {
    const int texture = scene_.addTexture(part.texture);
    scene_.add({std::move(part.mesh), {texture, part.gloss}, id});
  }
  taken_.push_back(outline);
}

std::optional<Pose> Clutter::placeModel(const ObjectModel& model, const Support& support, double spread, int allowed) {
  const Vector2d half = support.half_size_m - Vector2d::Constant(kRim_m);
  for (int attempt = 0; attempt < kTries; ++attempt) {
    const double yaw = random_.between(-spread, spread);
    ObjectModel turned = model;
    turned.transform(uprightPose(kOrigin, yaw));
    const Outline at_origin = outlineOf(turned);
    const Vector2d least = -half - at_origin.low, most = half - at_origin.high;
    if (least.x() > most.x() || least.y() > most.y() || at_origin.z_high > support.headroom_m) continue;
    const double x = random_.between(least.x(), most.x());
    const double y = random_.between(least.y(), most.y());
    const Pose at_place = uprightPose(support.middle_W, support.yaw) * Eigen::Translation3d(x, y, 0);
    turned.transform(at_place);
    const Outline outline = outlineOf(turned);
    if (!isFree(outline)) continue;
    const bool book = model.kind == "book";
    commit(std::move(turned), outline);
    if (book && random_.chance(0.6)) pileBooks(outline, support, allowed - 1);
    return at_place * uprightPose(kOrigin, yaw);
  }
  return std::nullopt;
}

void Clutter::pileBooks(const Outline& base, const Support& support, int most) {
  Outline below = base;
  const int more = std::min(1 + random_.below(3), most);
  for (int i = 0; i < more; ++i) {
    ObjectModel book = makeLyingBook(random_);
    const double dx = random_.between(-0.012, 0.012), dy = random_.between(-0.012, 0.012);
    const double yaw = support.yaw + random_.between(-0.35, 0.35);
    const Vector2d middle = 0.5 * (below.low + below.high) + Vector2d(dx, dy);
    book.transform(uprightPose(Vector3d(middle.x(), middle.y(), below.z_high + 2e-4), yaw));
    const Outline outline = outlineOf(book);
    if (!isFree(outline) || outline.z_high > support.middle_W.z() + support.headroom_m) return;
    commit(std::move(book), outline);
    below = outline;
  }
}

bool Clutter::place(ObjectMaker make, const Support& support, double spread) {
  return placeModel(make(random_), support, spread, 1).has_value();
}

bool Clutter::layOver(const ObjectModel& model, const Support& support, const Vector2d& about, double reach_m,
                      double spread) {
  constexpr double kFlat_m = 0.04;  // what is higher carries no paper
  const Vector2d half = support.half_size_m - Vector2d::Constant(kRim_m);
  for (int attempt = 0; attempt < kTries; ++attempt) {
    const double yaw = random_.between(-spread, spread);
    const double dx = random_.between(-reach_m, reach_m), dy = random_.between(-reach_m, reach_m);
    ObjectModel turned = model;
    turned.transform(uprightPose(kOrigin, yaw));
    const Outline at_origin = outlineOf(turned);
    const Vector2d place = about + Vector2d(dx, dy);
    if ((place + at_origin.low + half).minCoeff() < 0 || (half - place - at_origin.high).minCoeff() < 0) continue;
    turned.transform(uprightPose(support.middle_W, support.yaw) * Eigen::Translation3d(place.x(), place.y(), 0));
    Outline outline = outlineOf(turned);
    // It rests on the highest of what lies below it.
    double ground = support.middle_W.z();
    for (const Outline& other : taken_) {
      if (other.z_high < ground || other.z_high > support.middle_W.z() + kFlat_m) continue;
      if (partedByAnEdge(outline.corners, other.corners) || partedByAnEdge(other.corners, outline.corners)) continue;
      ground = other.z_high + 2e-4;
    }
    turned.transform(Pose(Eigen::Translation3d(0, 0, ground - support.middle_W.z())));
    outline = outlineOf(turned);
    if (!isFree(outline)) continue;
    commit(std::move(turned), outline);
    return true;
  }
  return false;
}

int Clutter::scatter(int count, const std::vector<ObjectMaker>& makers, const Support& support, double spread) {
  constexpr double kHeap_m = 0.14;
  int placed = 0;
  while (count > 0) {
    const int heap = std::min(count, 1 + random_.below(4));
    const double x = random_.between(-0.8, 0.8) * support.half_size_m.x();
    const double y = random_.between(-0.7, 0.7) * support.half_size_m.y();
    for (int i = 0; i < heap; ++i) {
      const ObjectModel model =
          makers[static_cast<std::size_t>(random_.below(static_cast<int>(makers.size())))](random_);
      placed += layOver(model, support, {x, y}, kHeap_m, spread) ? 1 : 0;
    }
    count -= heap;
  }
  return placed;
}

int Clutter::placeLoaded(ObjectMaker base, int count, const std::vector<ObjectMaker>& makers, const Support& support,
                         double spread) {
  const ObjectModel model = base(random_);
  const Outline outline = outlineOf(model);
  const std::optional<Pose> T_WO = placeModel(model, support, spread, 1);
  if (!T_WO) return 0;
  const Vector2d middle = 0.5 * (outline.low + outline.high);
  const double yaw = std::atan2((*T_WO)(1, 0), (*T_WO)(0, 0));
  const Support top{*T_WO * Vector3d(middle.x(), middle.y(), outline.z_high), 0.5 * (outline.high - outline.low), yaw,
                    support.headroom_m - outline.z_high};
  return 1 + fill(count, makers, top, spread);
}

int Clutter::stagger(int count, const std::vector<ObjectMaker>& makers, const Support& support, double spread) {
  const auto draw = [&] {
    return makers[static_cast<std::size_t>(random_.below(static_cast<int>(makers.size())))](random_);
  };
  ObjectModel model = draw();
  const Outline first = outlineOf(model);
  const std::optional<Pose> T_WO = placeModel(model, support, spread, 1);
  if (!T_WO) return 0;
  const double ceiling = support.middle_W.z() + support.headroom_m;
  const Vector2d half = support.half_size_m - Vector2d::Constant(kRim_m);
  const Pose T_SW = uprightPose(support.middle_W, support.yaw).inverse();
  Eigen::AlignedBox2d front_O(first.low, first.high);  // of what stands in front of the next
  int placed = 1;
  for (int attempt = 0; placed < count && attempt < kTries; ++attempt) {
    model = draw();
    const Outline own = outlineOf(model);
    const double aside = (random_.chance(0.5) ? 1 : -1) * random_.between(0.25, 0.7) * front_O.sizes().x();
    const double behind = random_.between(2 * kGap_m, 0.03);
    const Vector2d place_O(front_O.center().x() + aside - 0.5 * (own.low.x() + own.high.x()),
                           front_O.min().y() - behind - own.high.y());
    model.transform(*T_WO * Eigen::Translation3d(place_O.x(), place_O.y(), 0));
    const Outline outline = outlineOf(model);
    const bool fits = std::all_of(outline.corners.begin(), outline.corners.end(), [&](const Vector2d& p_W) {
      const Vector3d p_S = T_SW * Vector3d(p_W.x(), p_W.y(), support.middle_W.z());
      return (half - p_S.head<2>().cwiseAbs()).minCoeff() >= 0;
    });
    if (!fits || outline.z_high > ceiling || !isFree(outline)) continue;
    commit(std::move(model), outline);
    front_O = {own.low + place_O, own.high + place_O};
    ++placed;
  }
  return placed;
}

int Clutter::fill(int count, const std::vector<ObjectMaker>& makers, const Support& support, double spread) {
  const std::size_t before = scene_.objects().size();
  const auto placed = [&] { return static_cast<int>(scene_.objects().size() - before); };
  std::vector<ObjectModel> models;
  for (int i = 0; i < count; ++i) {
    // Each kind once before any comes again.
    const auto index = i < static_cast<int>(makers.size()) ? i : random_.below(static_cast<int>(makers.size()));
    models.push_back(makers[static_cast<std::size_t>(index)](random_));
  }
  std::stable_sort(models.begin(), models.end(),
                   [](const ObjectModel& a, const ObjectModel& b) { return groundArea(a) > groundArea(b); });
  for (const ObjectModel& model : models) {
    if (placed() < count) placeModel(model, support, spread, count - placed());
  }
  // What found no place is replaced by other draws, of which some are small.
  for (int attempt = 0; placed() < count && attempt < 8 * count; ++attempt) {
    place(makers[static_cast<std::size_t>(random_.below(static_cast<int>(makers.size())))], support, spread);
  }
  return placed();
}

int Clutter::fillWithBooks(int count, const Support& support) {
  double x = random_.between(-0.9, 0.1) * support.half_size_m.x();
  int placed = 0;
  while (placed < count) {
    ObjectModel book = makeStandingBook(random_);
    const Outline at_origin = outlineOf(book);
    const double width = at_origin.high.x() - at_origin.low.x(), depth = at_origin.high.y() - at_origin.low.y();
    if (x + width > support.half_size_m.x() - kRim_m) break;
    const double y = std::min(0.0, support.half_size_m.y() - kRim_m - depth / 2);
    book.transform(uprightPose(support.middle_W, support.yaw) * Eigen::Translation3d(x + width / 2, y, 0));
    const Outline outline = outlineOf(book);
    x += width + kGap_m + 5e-4;
    if (outline.z_high > support.middle_W.z() + support.headroom_m || !isFree(outline)) continue;
    commit(std::move(book), outline);
    ++placed;
  }
  return placed;
}

}  // namespace saccade
