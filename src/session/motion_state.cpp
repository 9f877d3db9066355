#include "session/motion_state.hpp"

#include <array>
#include <cmath>
#include <cstring>

#include "saccade/core/errors.hpp"
#include "session/pose_bytes.hpp"

namespace saccade {
namespace {

constexpr std::size_t kNumbers = 8;  // known, stamp, linear and angular velocity

}  // namespace

std::string encodeMotion(const MotionPredictor::State& state) {
  const std::array<double, kNumbers> numbers = {state.known ? 1.0 : 0.0, state.stamp_s,      state.linear_C.x(),
                                                state.linear_C.y(),      state.linear_C.z(), state.angular_C.x(),
                                                state.angular_C.y(),     state.angular_C.z()};
  return poseBytes(state.T_WC) + std::string(reinterpret_cast<const char*>(numbers.data()), sizeof numbers);
}

MotionPredictor::State decodeMotion(std::string_view bytes, const std::filesystem::path& path) {
  std::array<double, kNumbers> numbers{};
  const std::optional<Pose> T_WC = poseFromBytes(bytes.substr(0, kPoseBytes));
  bool sound = T_WC.has_value() && bytes.size() == kPoseBytes + sizeof numbers;
  if (sound) {
    std::memcpy(numbers.data(), bytes.data() + kPoseBytes, sizeof numbers);
    for (const double number : numbers) sound = sound && std::isfinite(number);
  }
  if (!sound) throw IoError(path, "the camera's last motion", "something else");
  MotionPredictor::State state;
  state.known = numbers[0] != 0.0;
  state.stamp_s = numbers[1];
  state.T_WC = *T_WC;
  state.linear_C = {numbers[2], numbers[3], numbers[4]};
  state.angular_C = {numbers[5], numbers[6], numbers[7]};
  return state;
}

}  // namespace saccade
