#include "simulation/embree_scene.hpp"

#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>

namespace saccade {

EmbreeScene::EmbreeScene(const Scene& scene) : device_(rtcNewDevice("threads=1,set_affinity=0")) {
  if (device_ == nullptr) {
    throw std::runtime_error("Embree: expected a device, found error " +
                             std::to_string(static_cast<int>(rtcGetDeviceError(nullptr))));
  }
  scene_ = rtcNewScene(device_);
  rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
  for (std::size_t i = 0; i < scene.surfaces().size(); ++i) {
    const Mesh& mesh = scene.surfaces()[i].mesh;
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                             mesh.vertices.size());
    void* triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                              3 * sizeof(std::uint32_t), mesh.triangles.size());
    static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float));
    if (!mesh.vertices.empty()) std::memcpy(vertices, mesh.vertices.data(), mesh.vertices.size() * 3 * sizeof(float));
    if (!mesh.triangles.empty()) {
      std::memcpy(triangles, mesh.triangles.data(), mesh.triangles.size() * 3 * sizeof(std::uint32_t));
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene_, geometry, static_cast<unsigned>(i));
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(scene_);
  if (const RTCError error = rtcGetDeviceError(device_); error != RTC_ERROR_NONE) {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
    throw std::runtime_error("Embree: expected a scene, found error " + std::to_string(static_cast<int>(error)));
  }
}

EmbreeScene::~EmbreeScene() {
  rtcReleaseScene(scene_);
  rtcReleaseDevice(device_);
}

void EmbreeScene::castPacket(const Eigen::Vector3f& origin_W, const Eigen::Vector3f (&directions)[kPacket],
                             TriangleHit (&hits)[kPacket]) const {
  alignas(32) static constexpr int kAllValid[kPacket] = {-1, -1, -1, -1, -1, -1, -1, -1};
  RTCRayHit8 rays;
  for (int i = 0; i < kPacket; ++i) {
    rays.ray.org_x[i] = origin_W.x();
    rays.ray.org_y[i] = origin_W.y();
    rays.ray.org_z[i] = origin_W.z();
    rays.ray.dir_x[i] = directions[i].x();
    rays.ray.dir_y[i] = directions[i].y();
    rays.ray.dir_z[i] = directions[i].z();
    rays.ray.tnear[i] = 0.0f;
    rays.ray.tfar[i] = std::numeric_limits<float>::infinity();
    rays.ray.time[i] = 0.0f;
    rays.ray.mask[i] = ~0u;
    rays.ray.id[i] = 0;
    rays.ray.flags[i] = 0;
    rays.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    rays.hit.primID[i] = RTC_INVALID_GEOMETRY_ID;
    rays.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  }
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect8(kAllValid, scene_, &context, &rays);
  for (int i = 0; i < kPacket; ++i) hits[i] = {rays.hit.geomID[i], rays.hit.primID[i]};
}

bool EmbreeScene::isBlocked(const Eigen::Vector3f& origin_W, const Eigen::Vector3f& direction_W, float length_m) const {
  RTCRay ray;
  ray.org_x = origin_W.x();
  ray.org_y = origin_W.y();
  ray.org_z = origin_W.z();
  ray.dir_x = direction_W.x();
  ray.dir_y = direction_W.y();
  ray.dir_z = direction_W.z();
  ray.tnear = 0.0f;
  ray.tfar = length_m;
  ray.time = 0.0f;
  ray.mask = ~0u;
  ray.id = 0;
  ray.flags = 0;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene_, &context, &ray);
  return ray.tfar < 0.0f;
}

}  // namespace saccade
