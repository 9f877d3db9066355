#include <cmath>
#include <cstdint>
#include <cstring>

#include "saccade/tracking/frame_features.hpp"

namespace saccade {
namespace {

// Little endian, as all machines that Saccade is built for: mark, count, then per feature u v x y z and 256 bits.
constexpr std::uint32_t kMark = 0x3142524F;  // "ORB1"
constexpr std::size_t kHeaderBytes = 2 * sizeof(std::uint32_t);
constexpr std::size_t kPlaceBytes = 5 * sizeof(float);
constexpr std::size_t kFeatureBytes = kPlaceBytes + FrameFeatures::kDescriptorBytes;
constexpr std::uint32_t kMostFeatures = 100000;

}  // namespace

std::string encodeFeatures(const FrameFeatures& features) {
  std::string bytes(kHeaderBytes + features.size() * kFeatureBytes, '\0');
  const std::uint32_t header[2] = {kMark, static_cast<std::uint32_t>(features.size())};
  std::memcpy(bytes.data(), header, kHeaderBytes);
  char* out = bytes.data() + kHeaderBytes;
  for (std::size_t i = 0; i < features.size(); ++i, out += kFeatureBytes) {
    const Eigen::Vector2f& pixel = features.pixels[i];
    const Eigen::Vector3f& p_C = features.points_C[i];
    const float place[5] = {pixel.x(), pixel.y(), p_C.x(), p_C.y(), p_C.z()};
    std::memcpy(out, place, kPlaceBytes);
    std::memcpy(out + kPlaceBytes, features.descriptors[static_cast<int>(i)], FrameFeatures::kDescriptorBytes);
  }
  return bytes;
}

std::optional<FrameFeatures> decodeFeatures(std::string_view bytes) {
  std::uint32_t header[2];
  if (bytes.size() < kHeaderBytes) return std::nullopt;
  std::memcpy(header, bytes.data(), kHeaderBytes);
  const std::uint32_t count = header[1];
  if (header[0] != kMark || count > kMostFeatures || bytes.size() != kHeaderBytes + count * kFeatureBytes) {
    return std::nullopt;
  }
  FrameFeatures features;
  features.pixels.reserve(count);
  features.points_C.reserve(count);
  if (count > 0) features.descriptors.create(static_cast<int>(count), FrameFeatures::kDescriptorBytes);
  const char* in = bytes.data() + kHeaderBytes;
  for (std::uint32_t i = 0; i < count; ++i, in += kFeatureBytes) {
    float place[5];
    std::memcpy(place, in, kPlaceBytes);
    for (const float value : place) {
      if (!std::isfinite(value)) return std::nullopt;
    }
    if (!(place[4] > 0.0F)) return std::nullopt;
    features.pixels.emplace_back(place[0], place[1]);
    features.points_C.emplace_back(place[2], place[3], place[4]);
    std::memcpy(features.descriptors[static_cast<int>(i)], in + kPlaceBytes, FrameFeatures::kDescriptorBytes);
  }
  return features;
}

}  // namespace saccade
