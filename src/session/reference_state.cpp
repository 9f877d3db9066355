#include "session/reference_state.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "saccade/core/errors.hpp"
#include "session/pose_bytes.hpp"

namespace saccade {
namespace {

using Points = PhotometricReference::Points;

constexpr std::size_t kHeadBytes = kPoseBytes + sizeof(std::uint64_t);

std::size_t arraysOf(const Points& points) {
  std::size_t arrays = 0;
  Points::forEachArray(points, [&](const std::vector<float>&) { ++arrays; });
  return arrays;
}

}  // namespace

std::string encodeReference(const PhotometricReference::State& state) {
  const std::uint64_t count = state.points.count;
  std::string bytes = poseBytes(state.T_WR);
  bytes.reserve(kHeadBytes + arraysOf(state.points) * count * sizeof(float));
  bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
  Points::forEachArray(state.points, [&](const std::vector<float>& array) {
    bytes.append(reinterpret_cast<const char*>(array.data()), count * sizeof(float));
  });
  return bytes;
}

PhotometricReference::State decodeReference(std::string_view bytes, const std::filesystem::path& path) {
  PhotometricReference::State state;
  const std::optional<Pose> T_WR = poseFromBytes(bytes.substr(0, kPoseBytes));
  std::uint64_t count = 0;
  bool sound = T_WR.has_value() && bytes.size() >= kHeadBytes;
  if (sound) std::memcpy(&count, bytes.data() + kPoseBytes, sizeof count);
  const std::size_t point_bytes = arraysOf(state.points) * sizeof(float);
  // By division, since a product with a number that is not sound may overflow.
  sound = sound && (bytes.size() - kHeadBytes) % point_bytes == 0 && (bytes.size() - kHeadBytes) / point_bytes == count;
  if (sound) {
    const std::size_t padded = (count + Points::kBlock - 1) / Points::kBlock * Points::kBlock;
    const char* from = bytes.data() + kHeadBytes;
    Points::forEachArray(state.points, [&](std::vector<float>& array) {
      array.resize(padded, 0.0F);
      if (count > 0) std::memcpy(array.data(), from, count * sizeof(float));
      from += count * sizeof(float);
      sound = sound && std::all_of(array.begin(), array.end(), [](float number) { return std::isfinite(number); });
    });
  }
  if (!sound) throw IoError(path, "the frame whose colour tracking compares with", "something else");
  state.points.count = count;
  state.T_WR = *T_WR;
  return state;
}

}  // namespace saccade
