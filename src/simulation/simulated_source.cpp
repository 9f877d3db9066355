#include "saccade/simulation/simulated_source.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <string_view>

#include "saccade/core/errors.hpp"
#include "saccade/simulation/scene_renderer.hpp"
#include "saccade/simulation/sensor_noise.hpp"

namespace saccade {
namespace {

constexpr std::string_view kPrefix = "sim:";
constexpr double kFramesPerSecond = 30.0;
constexpr std::int64_t kMostFrames = 1'000'000;
constexpr double kMostNoise = 10.0;

template <typename Number>
Number parseValue(const std::string& input, std::string_view key, std::string_view text, Number low, Number high) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !(value >= low && value <= high)) {
    throw IoError(input, std::string(key) + " of " + std::to_string(low) + " to " + std::to_string(high),
                  std::string(text));
  }
  return value;
}

class SimulatedSource final : public FrameSource {
 public:
  SimulatedSource(const SimulationRequest& request, const FrameRange& range);

  [[nodiscard]] const SourceDescription& description() const override { return description_; }
  [[nodiscard]] ReadStatus read(RgbdFrame& frame) override;
  [[nodiscard]] const std::string& skipReason() const override { return skip_reason_; }

 private:
  SimulationRequest request_;
  FrameRange range_;
  std::int64_t end_ = 0;
  std::int64_t next_ = 0;
  Scene scene_;
  SceneRenderer renderer_;
  SensorNoise noise_;
  SceneImages images_;
  SourceDescription description_;
  std::string skip_reason_;  // stays empty: nothing is ever skipped
};

SensorNoiseConfig noiseOfStrength(double strength) {
  SensorNoiseConfig config;
  config.strength = strength;
  return config;
}

SimulatedSource::SimulatedSource(const SimulationRequest& request, const FrameRange& range)
    : request_(request),
      range_(range),
      end_(std::min(range.end.value_or(request.frames), request.frames)),
      next_(range.first),
      scene_(makeDeskScene(request.seed)),
      renderer_(scene_, simulatedCamera()),
      noise_(request.seed, noiseOfStrength(request.noise)) {
  if (range.first < 0 || range.step < 1) {
    throw std::invalid_argument("frame range: expected first >= 0 and step >= 1, found " + std::to_string(range.first) +
                                " and " + std::to_string(range.step));
  }
  description_.kind = "simulated scene";
  description_.location = "sim:" + request.scene + "?seed=" + std::to_string(request.seed) +
                          "&frames=" + std::to_string(request.frames) + "&noise=" + std::to_string(request.noise);
  description_.total_frames = request.frames;
  description_.frames = next_ < end_ ? (end_ - next_ + range.step - 1) / range.step : 0;
  if (description_.frames == 0) {
    throw IoError(description_.location, "frames in the selected range",
                  "none of " + std::to_string(request.frames) + " from " + std::to_string(range.first) + " on");
  }
  description_.camera = simulatedCamera();
  description_.intrinsics_origin = "the simulator";
  description_.depth_units_per_metre = 1.0;
  description_.depth_scale_origin = "the simulator measures in metres";
  description_.has_depth = description_.has_poses = description_.has_labels = true;
  if (request.noise == 0) description_.remarks.emplace_back("ideal images: no sensor noise");
}

ReadStatus SimulatedSource::read(RgbdFrame& frame) {
  if (next_ >= end_) return ReadStatus::kEnd;
  const std::int64_t index = next_;
  next_ += range_.step;

  char name[32];
  std::snprintf(name, sizeof name, "-%06lld", static_cast<long long>(index));
  frame.index.value = index;
  frame.name = request_.scene + name;
  frame.stamp_s = static_cast<double>(index) / kFramesPerSecond;
  frame.T_WC = deskCameraPose(request_.seed, index);

  // The frame lends its buffers to the renderer.
  images_.color = frame.color;
  images_.depth_m = frame.depth_m;
  images_.label = frame.label;
  renderer_.render(*frame.T_WC, images_);
  noise_.apply(index, images_);
  frame.color = images_.color;
  frame.depth_m = images_.depth_m;
  frame.label = images_.label;
  images_.color.release();
  images_.depth_m.release();
  images_.label.release();
  return ReadStatus::kFrame;
}

}  // namespace

bool SimulationRequest::matches(const std::string& input) {
  return input.starts_with(kPrefix);
}

SimulationRequest SimulationRequest::parse(const std::string& input) {
  SimulationRequest request;
  if (!matches(input)) throw IoError(input, "sim:SCENE?key=value&...", "something else");
  std::string_view rest = std::string_view(input).substr(kPrefix.size());
  const std::size_t question = std::min(rest.find('?'), rest.size());
  request.scene = rest.substr(0, question);
  if (request.scene != "desk") throw IoError(input, "a known scene (desk)", request.scene);
  rest.remove_prefix(std::min(question + 1, rest.size()));
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('&'), rest.size());
    const std::string_view word = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    const std::size_t equals = std::min(word.find('='), word.size());
    const std::string_view key = word.substr(0, equals), value = word.substr(std::min(equals + 1, word.size()));
    if (key == "seed") {
      request.seed = parseValue<std::uint64_t>(input, key, value, 0, std::numeric_limits<std::uint64_t>::max());
    } else if (key == "frames") {
      request.frames = parseValue<std::int64_t>(input, key, value, 1, kMostFrames);
    } else if (key == "noise") {
      request.noise = parseValue<double>(input, key, value, 0.0, kMostNoise);
    } else {
      throw IoError(input, "the keys seed, frames and noise", std::string(word));
    }
  }
  return request;
}

PinholeCamera simulatedCamera() {
  return {640, 480, 525.0, 525.0, 319.5, 239.5};
}

std::unique_ptr<FrameSource> openSimulation(const SimulationRequest& request, const FrameRange& range) {
  return std::make_unique<SimulatedSource>(request, range);
}

}  // namespace saccade
