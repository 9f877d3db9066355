#include "saccade/simulation/scene_renderer.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "simulation/primitive_geometry.hpp"

namespace saccade {
namespace {

constexpr double kNearestCorner_m = 0.02;  // a corner nearer than this may project anywhere
constexpr double kShadowOffset_m = 1e-4;   // keeps a surface from shadowing itself by rounding
constexpr float kAmbient = 0.45f;
constexpr float kLampPower = 2.1f;  // at 1 m, square to the light

/// Distance of a point from the segment a-b.
double distanceToSegment(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d ab = b - a;
  const double share = std::clamp((p - a).dot(ab) / std::max(ab.squaredNorm(), 1e-12), 0.0, 1.0);
  return (a + share * ab - p).norm();
}

}  // namespace

SceneRenderer::SceneRenderer(const Scene& scene, const PinholeCamera& camera) : scene_(scene), camera_(camera) {
  if (camera.width <= 0 || camera.height <= 0 || !(camera.fx > 0) || !(camera.fy > 0)) {
    throw std::invalid_argument("SceneRenderer: expected a camera with a size and focal lengths, found " +
                                std::to_string(camera.width) + " x " + std::to_string(camera.height));
  }
  for (const Primitive& primitive : scene.primitives()) reach_m_.push_back(enclosingHalfSize(primitive).norm());
  views_.resize(scene.primitives().size());
  pixels_.resize(kTile * kTile);
}

void SceneRenderer::prepareViews(const Pose& T_WC) {
  const cv::Rect image(0, 0, camera_.width, camera_.height);
  for (std::size_t i = 0; i < views_.size(); ++i) {
    const Primitive& primitive = scene_.primitives()[i];
    const Pose T_CO = T_WC.inverse() * primitive.T_WO;
    View& view = views_[i];
    view.R_OC = T_CO.linear().transpose();
    view.origin_O = -(view.R_OC * T_CO.translation());
    const Eigen::Vector3d half = enclosingHalfSize(primitive);
    Eigen::Array2d low(1e9, 1e9), high(-1e9, -1e9);
    int behind = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d sign((corner & 1) * 2 - 1, (corner >> 1 & 1) * 2 - 1, (corner >> 2) * 2 - 1);
      const Eigen::Vector3d p_C = T_CO * sign.cwiseProduct(half);
      if (p_C.z() < kNearestCorner_m) {
        ++behind;
        continue;
      }
      const Eigen::Array2d pixel = camera_.project(p_C).array();
      low = low.min(pixel);
      high = high.max(pixel);
    }
    if (behind == 8) {
      view.outline = cv::Rect();
    } else if (behind > 0) {
      view.outline = image;
    } else {
      const Eigen::Array2d limit(camera_.width, camera_.height);
      const Eigen::Array2i first = low.max(-1).min(limit).floor().cast<int>();
      const Eigen::Array2i last = high.max(-1).min(limit).ceil().cast<int>();
      view.outline = cv::Rect(cv::Point(first.x(), first.y()), cv::Point(last.x() + 1, last.y() + 1)) & image;
    }
  }
}

void SceneRenderer::castTile(const cv::Rect& tile) {
  in_tile_.clear();
  for (std::size_t i = 0; i < views_.size(); ++i) {
    if ((views_[i].outline & tile).area() > 0) in_tile_.push_back(static_cast<std::uint32_t>(i));
  }
  for (int v = 0; v < tile.height; ++v) {
    for (int u = 0; u < tile.width; ++u) {
      const Eigen::Vector3d ray_C = camera_.unproject(tile.x + u, tile.y + v, 1.0);
      TilePixel nearest{kNoHit, 0};
      for (const std::uint32_t i : in_tile_) {
        const Primitive& primitive = scene_.primitives()[i];
        const double t = intersect(primitive.shape, primitive.half_size_m, views_[i].origin_O, views_[i].R_OC * ray_C);
        if (t < nearest.t) nearest = {t, i};
      }
      pixels_[static_cast<std::size_t>(v * kTile + u)] = nearest;
    }
  }
}

// An occluder of any of the tile's points touches the capsule from the lamp to the sphere around those points.
void SceneRenderer::findOccluders(const cv::Rect& tile, const Pose& T_WC) {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(kNoHit), high = Eigen::Vector3d::Constant(-kNoHit);
  for (int v = 0; v < tile.height; ++v) {
    for (int u = 0; u < tile.width; ++u) {
      const TilePixel& pixel = pixels_[static_cast<std::size_t>(v * kTile + u)];
      if (pixel.t == kNoHit) continue;
      const Eigen::Vector3d p_W = T_WC * camera_.unproject(tile.x + u, tile.y + v, pixel.t);
      low = low.cwiseMin(p_W);
      high = high.cwiseMax(p_W);
    }
  }
  occluders_.clear();
  if (low.x() > high.x()) return;
  const Eigen::Vector3d middle = 0.5 * (low + high);
  const double radius = 0.5 * (high - low).norm();
  for (std::size_t i = 0; i < views_.size(); ++i) {
    const Primitive& primitive = scene_.primitives()[i];
    if (primitive.shape == Shape::kRectangle) continue;  // walls enclose the lamp, they shade nothing
    if (distanceToSegment(primitive.T_WO.translation(), scene_.lamp(), middle) < reach_m_[i] + radius) {
      occluders_.push_back(static_cast<std::uint32_t>(i));
    }
  }
}

bool SceneRenderer::isLit(const Eigen::Vector3d& p_W) const {
  const Eigen::Vector3d to_lamp = scene_.lamp() - p_W;
  for (const std::uint32_t i : occluders_) {
    const Primitive& primitive = scene_.primitives()[i];
    const Eigen::Matrix3d R_OW = primitive.T_WO.linear().transpose();
    const Eigen::Vector3d origin_O = R_OW * (p_W - primitive.T_WO.translation());
    if (intersect(primitive.shape, primitive.half_size_m, origin_O, R_OW * to_lamp) < 1.0) return false;
  }
  return true;
}

void SceneRenderer::shadeTile(const cv::Rect& tile, const Pose& T_WC, SceneImages& images) const {
  for (int v = 0; v < tile.height; ++v) {
    for (int u = 0; u < tile.width; ++u) {
      const TilePixel& pixel = pixels_[static_cast<std::size_t>(v * kTile + u)];
      const int row = tile.y + v, column = tile.x + u;
      if (pixel.t == kNoHit) {
        images.color(row, column) = cv::Vec3b(0, 0, 0);
        images.depth_m(row, column) = 0.0f;
        images.cosine(row, column) = 0.0f;
        images.label(row, column) = 0;
        continue;
      }
      const Primitive& primitive = scene_.primitives()[pixel.primitive];
      const View& view = views_[pixel.primitive];
      const Eigen::Vector3d ray_C = camera_.unproject(column, row, 1.0);
      const Eigen::Vector3d ray_O = view.R_OC * ray_C;
      const Eigen::Vector3d p_O = view.origin_O + pixel.t * ray_O;
      const Eigen::Vector3d outward_O = outwardNormal(primitive.shape, primitive.half_size_m, p_O);
      const double towards = -outward_O.dot(ray_O) / ray_C.norm();
      const Eigen::Vector3d normal_W = primitive.T_WO.linear() * (towards >= 0 ? outward_O : -outward_O);
      const Eigen::Vector3d p_W = T_WC * (pixel.t * ray_C) + kShadowOffset_m * normal_W;

      const Eigen::Vector3d to_lamp = scene_.lamp() - p_W;
      const double distance = to_lamp.norm();
      float light = kAmbient;
      if (const double facing = normal_W.dot(to_lamp) / distance; facing > 0 && isLit(p_W)) {
        light += kLampPower * static_cast<float>(facing / (1.0 + distance * distance));
      }
      const Eigen::Vector3f bgr = 255.0f * light * albedoAt(primitive, p_O, outward_O);
      images.color(row, column) = cv::Vec3b(cv::saturate_cast<uchar>(bgr.x()), cv::saturate_cast<uchar>(bgr.y()),
                                            cv::saturate_cast<uchar>(bgr.z()));
      images.depth_m(row, column) = static_cast<float>(pixel.t);
      images.cosine(row, column) = static_cast<float>(std::abs(towards));
      images.label(row, column) = static_cast<ushort>(primitive.object_id);
    }
  }
}

void SceneRenderer::render(const Pose& T_WC, SceneImages& images) {
  const cv::Size size(camera_.width, camera_.height);
  images.color.create(size);
  images.depth_m.create(size);
  images.cosine.create(size);
  images.label.create(size);
  prepareViews(T_WC);
  const cv::Rect image(cv::Point(0, 0), size);
  for (int v = 0; v < size.height; v += kTile) {
    for (int u = 0; u < size.width; u += kTile) {
      const cv::Rect tile = cv::Rect(u, v, kTile, kTile) & image;
      castTile(tile);
      findOccluders(tile, T_WC);
      shadeTile(tile, T_WC, images);
    }
  }
}

}  // namespace saccade
