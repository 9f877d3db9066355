#include "saccade/simulation/scene_renderer.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/Geometry>
#include <tbb/parallel_for.h>

#include "simulation/embree_scene.hpp"
#include "simulation/light_baking.hpp"
#include "simulation/mipmap.hpp"

namespace saccade {
namespace {

constexpr int kHighlightDoublings = 6;      // the cosine's 64th power: how tight a highlight is
constexpr double kHighlightCosine = 0.9;    // beyond, the power is nothing
constexpr float kHighlightGrey = 190.0f;    // grey levels that full gloss adds
constexpr float kMirrorCosine = 0.93f;      // glossy surfaces this square to the sensor dazzle it
constexpr float kGrazingLoss = 3.0f;        // at full gloss, of polished surfaces seen from their edge
constexpr float kDarkestEcho_grey = 14.0f;  // surfaces darker than this give no depth at all
constexpr float kFullEcho_grey = 60.0f;
constexpr double kLeastCosine = 0.25;  // bounds how far a slanted surface blurs its texture

/// What a triangle needs for shading, ready for use.
struct TriangleData {
  Eigen::Vector3d corner, edge1, edge2, normal;  ///< normal = edge1 x edge2 / |.|^2: barycentrics by two products
  float texels_per_metre = 0.0f;
};

TriangleData prepareTriangle(const Mesh& mesh, const std::array<std::uint32_t, 3>& corners, const cv::Size& texture) {
  TriangleData data;
  data.corner = mesh.vertices[corners[0]].cast<double>();
  data.edge1 = mesh.vertices[corners[1]].cast<double>() - data.corner;
  data.edge2 = mesh.vertices[corners[2]].cast<double>() - data.corner;
  const Eigen::Vector3d cross = data.edge1.cross(data.edge2);
  const Eigen::Vector2f a = mesh.uv[corners[1]] - mesh.uv[corners[0]], b = mesh.uv[corners[2]] - mesh.uv[corners[0]];
  const double texels = std::abs(static_cast<double>(a.x() * b.y() - a.y() * b.x())) * texture.area();
  const double area = cross.norm();
  data.normal = area > 0 ? Eigen::Vector3d(cross / cross.squaredNorm()) : Eigen::Vector3d(0, 0, 0);
  data.texels_per_metre = area > 0 ? static_cast<float>(std::sqrt(texels / area)) : 0.0f;
  return data;
}

}  // namespace

struct SceneRenderer::Parts {
  Parts(Scene&& taken, const PinholeCamera& of)
      : scene(std::move(taken)), camera(of), rays(scene), light(bakeLight(scene, rays)) {
    for (const cv::Mat3b& image : scene.textures()) textures.emplace_back(image);
    for (const Surface& surface : scene.surfaces()) {
      std::vector<TriangleData>& data = triangles.emplace_back();
      const cv::Size size = textures[static_cast<std::size_t>(surface.material.texture)].size();
      for (const auto& corners : surface.mesh.triangles) data.push_back(prepareTriangle(surface.mesh, corners, size));
    }
  }

  void renderRow(int row, const Pose& T_WC, SceneImages& images) const;
  void shade(int row, int column, const TriangleHit& hit, const Eigen::Vector3d& origin_W, const Eigen::Vector3d& ray_W,
             SceneImages& images) const;
  [[nodiscard]] float highlight(const Eigen::Vector3d& p_W, const Eigen::Vector3d& normal_W,
                                const Eigen::Vector3d& to_eye) const;

  Scene scene;
  PinholeCamera camera;
  EmbreeScene rays;
  std::vector<VertexLight> light;
  std::vector<Mipmap> textures;
  std::vector<std::vector<TriangleData>> triangles;  // by surface
};

float SceneRenderer::Parts::highlight(const Eigen::Vector3d& p_W, const Eigen::Vector3d& normal_W,
                                      const Eigen::Vector3d& to_eye) const {
  float sum = 0.0f;
  for (const Lamp& lamp : scene.lamps()) {
    const Eigen::Vector3d to_lamp = lamp.p_W - p_W;
    if (to_lamp.squaredNorm() > lamp.reach_m * lamp.reach_m) continue;
    const double along = normal_W.dot((to_lamp.normalized() + to_eye).normalized());
    if (along < kHighlightCosine) continue;
    double power = along;
    for (int doubling = 0; doubling < kHighlightDoublings; ++doubling) power *= power;
    sum += static_cast<float>(power);
  }
  return sum;
}

void SceneRenderer::Parts::shade(int row, int column, const TriangleHit& hit, const Eigen::Vector3d& origin_W,
                                 const Eigen::Vector3d& ray_W, SceneImages& images) const {
  const Surface& surface = scene.surfaces()[hit.surface];
  const TriangleData& data = triangles[hit.surface][hit.triangle];
  const auto& corners = surface.mesh.triangles[hit.triangle];
  // The ray reaches z = 1 in the camera's frame at t = 1, so t is the depth along the axis.
  const double t = data.normal.dot(data.corner - origin_W) / data.normal.dot(ray_W);
  const Eigen::Vector3d p_W = origin_W + t * ray_W, offset = p_W - data.corner;
  const float b1 = std::clamp(static_cast<float>(data.normal.dot(offset.cross(data.edge2))), 0.0f, 1.0f);
  const float b2 = std::clamp(static_cast<float>(data.normal.dot(data.edge1.cross(offset))), 0.0f, 1.0f - b1);
  const float b0 = 1.0f - b1 - b2;
  const auto mixed = [&](const auto& values) {
    return b0 * values[corners[0]] + b1 * values[corners[1]] + b2 * values[corners[2]];
  };
  const Eigen::Vector3d to_eye = -ray_W.normalized();
  const auto cosine = static_cast<float>(std::abs(data.normal.normalized().dot(to_eye)));
  const Eigen::Vector2f uv = mixed(surface.mesh.uv);
  const double pixel_m = t / (camera.fx * std::sqrt(std::max<double>(cosine, kLeastCosine)));
  Eigen::Array3f bgr = textures[static_cast<std::size_t>(surface.material.texture)].sample(
      uv, data.texels_per_metre * static_cast<float>(pixel_m));

  const float grey = bgr.mean();
  float echo = std::clamp((grey - kDarkestEcho_grey) / (kFullEcho_grey - kDarkestEcho_grey), 0.0f, 1.0f);
  const float lit = mixed(light[hit.surface]);
  bgr *= lit;
  if (const float gloss = surface.material.gloss; gloss > 0) {
    const Eigen::Vector3f smooth = mixed(surface.mesh.normals);
    const Eigen::Vector3d normal_W = smooth.cast<double>().normalized();
    bgr += gloss * lit * kHighlightGrey * highlight(p_W, normal_W, to_eye);
    const auto square = static_cast<float>(std::abs(normal_W.dot(to_eye)));
    // What is polished throws the projector's light away from the sensor, the more the flatter it is seen.
    echo *= std::max(0.0f, 1.0f - kGrazingLoss * gloss * (1.0f - square) * (1.0f - square));
    if (square > kMirrorCosine) echo *= 1.0f - gloss * (square - kMirrorCosine) / (1.0f - kMirrorCosine);
  }
  images.color(row, column) =
      cv::Vec3b(cv::saturate_cast<uchar>(bgr[0]), cv::saturate_cast<uchar>(bgr[1]), cv::saturate_cast<uchar>(bgr[2]));
  images.depth_m(row, column) = static_cast<float>(t);
  images.cosine(row, column) = cosine;
  images.echo(row, column) = echo;
  images.label(row, column) = static_cast<ushort>(surface.object_id);
}

void SceneRenderer::Parts::renderRow(int row, const Pose& T_WC, SceneImages& images) const {
  const Eigen::Vector3d origin_W = T_WC.translation();
  for (int first = 0; first < camera.width; first += EmbreeScene::kPacket) {
    Eigen::Vector3f directions[EmbreeScene::kPacket];
    TriangleHit hits[EmbreeScene::kPacket];
    for (int i = 0; i < EmbreeScene::kPacket; ++i) {
      directions[i] = (T_WC.linear() * camera.unproject(first + i, row, 1.0)).cast<float>();
    }
    rays.castPacket(origin_W.cast<float>(), directions, hits);
    for (int i = 0; i < EmbreeScene::kPacket && first + i < camera.width; ++i) {
      const int column = first + i;
      if (hits[i].surface == kNoSurface) {
        images.color(row, column) = cv::Vec3b(0, 0, 0);
        images.depth_m(row, column) = images.cosine(row, column) = images.echo(row, column) = 0.0f;
        images.label(row, column) = 0;
        continue;
      }
      shade(row, column, hits[i], origin_W, T_WC.linear() * camera.unproject(column, row, 1.0), images);
    }
  }
}

SceneRenderer::SceneRenderer(Scene scene, const PinholeCamera& camera) {
  if (camera.width <= 0 || camera.height <= 0 || !(camera.fx > 0) || !(camera.fy > 0)) {
    throw std::invalid_argument("SceneRenderer: expected a camera with a size and focal lengths, found " +
                                std::to_string(camera.width) + " x " + std::to_string(camera.height));
  }
  parts_ = std::make_unique<Parts>(std::move(scene), camera);
}

SceneRenderer::~SceneRenderer() = default;
SceneRenderer::SceneRenderer(SceneRenderer&&) noexcept = default;

const Scene& SceneRenderer::scene() const {
  return parts_->scene;
}

void SceneRenderer::render(const Pose& T_WC, SceneImages& images) const {
  const cv::Size size(parts_->camera.width, parts_->camera.height);
  images.color.create(size);
  images.depth_m.create(size);
  images.cosine.create(size);
  images.echo.create(size);
  images.label.create(size);
  tbb::parallel_for(0, size.height, [&](int row) { parts_->renderRow(row, T_WC, images); });
}

}  // namespace saccade
