#include "saccade/simulation/simulated_source.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "saccade/core/errors.hpp"
#include "saccade/simulation/scene_renderer.hpp"
#include "saccade/simulation/sensor_noise.hpp"
#include "simulation/exposure.hpp"
#include "simulation/random_hash.hpp"
#include "sources/stamp_units.hpp"

namespace saccade {
namespace {

constexpr std::string_view kPrefix = "sim:";
constexpr double kFramesPerSecond = 30.0;
constexpr std::int64_t kMostFrames = 1'000'000;
constexpr double kMostNoise = 10.0;
constexpr double kFarthestMove_m = 10.0;

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

/// Sensors differ in how near they see, from the near mode's 0.4 m to the 0.8 m of an ordinary Kinect, and in whether
/// the depth camera sees all that the colour camera beside it sees.
SensorNoiseConfig noiseOf(const SimulationRequest& request) {
  constexpr double kSmallestView = 0.88, kShift_px = 10.0, kApart_m = 0.03;
  SensorNoiseConfig config;
  config.strength = request.noise;
  RandomStream random(request.seed ^ 0x6e656172u);
  config.nearest_m = random.between(0.4, 0.8);
  if (random.chance(0.25)) return config;
  config.view_share = random.between(kSmallestView, 1.0);
  config.view_right_px = random.between(-kShift_px, kShift_px);
  config.view_down_px = random.between(-kShift_px, kShift_px);
  config.camera_left_m = random.between(-kApart_m, kApart_m);
  return config;
}

std::string knownScenes() {
  std::string names;
  for (const SceneKind& kind : sceneKinds()) names += (names.empty() ? "" : ", ") + std::string(kind.name);
  return names;
}

const SceneKind& requireKind(const std::string& input, const std::string& name) {
  const SceneKind* kind = findSceneKind(name);
  if (kind == nullptr) throw IoError(input, "a known scene (" + knownScenes() + ")", name);
  return *kind;
}

SourceDescription describe(const SimulationRequest& request, const FrameRange& range) {
  SourceDescription description;
  description.kind = "simulated scene";
  std::ostringstream location;
  location << kPrefix << request.scene << "?seed=" << request.seed << "&frames=" << request.frames
           << "&noise=" << request.noise;
  if (request.moved != 0) location << "&moved=" << request.moved << "&dx=" << request.dx_m << "&dy=" << request.dy_m;
  description.location = location.str();
  description.total_frames = request.frames;
  const std::int64_t end = std::min(range.end.value_or(request.frames), request.frames);
  description.frames = range.first < end ? (end - range.first + range.step - 1) / range.step : 0;
  if (description.frames == 0) {
    throw IoError(description.location, "frames in the selected range",
                  "none of " + std::to_string(request.frames) + " from " + std::to_string(range.first) + " on");
  }
  description.camera = simulatedCamera();
  description.color_camera = {description.camera, {}};
  description.intrinsics_origin = "the simulator";
  description.depth_units_per_metre = 1.0;
  description.depth_scale_origin = "the simulator measures in metres";
  description.has_depth = description.has_poses = description.has_labels = true;
  if (request.noise == 0) description.remarks.emplace_back("ideal images: no sensor noise");
  return description;
}

}  // namespace

struct SimulatedSource::Parts {
  Parts(const SimulationRequest& of, const FrameRange& range, SimulatedWorld&& world)
      : request(of),
        step(range.step),
        end(std::min(range.end.value_or(of.frames), of.frames)),
        next(range.first),
        cameraPose(std::move(world.cameraPose)),
        renderer(std::move(world.scene), simulatedCamera()),
        noise(of.seed, noiseOf(of)),
        exposure(of.seed, of.noise, simulatedCamera()) {}

  SimulationRequest request;
  std::int64_t step, end, next;
  std::function<Pose(std::int64_t)> cameraPose;
  SceneRenderer renderer;
  SensorNoise noise;
  Exposure exposure;
  SceneImages images;
  SourceDescription description;
  std::string skip_reason;  // stays empty: nothing is ever skipped
};

SimulatedSource::SimulatedSource(const SimulationRequest& request, const FrameRange& range) {
  if (range.first < 0 || range.step < 1) {
    throw std::invalid_argument("frame range: expected first >= 0 and step >= 1, found " + std::to_string(range.first) +
                                " and " + std::to_string(range.step));
  }
  const SceneKind& kind = requireKind("sim:" + request.scene, request.scene);
  SourceDescription description = describe(request, range);
  SimulatedWorld world = makeWorld(kind, request.seed);
  if (request.moved != 0) {
    const std::size_t objects = world.scene.objects().size();
    if (request.moved > static_cast<int>(objects)) {
      throw IoError(description.location, "an object of 1 to " + std::to_string(objects),
                    "moved=" + std::to_string(request.moved));
    }
    world.scene.moveObject(request.moved, {request.dx_m, request.dy_m, 0.0});
  }
  parts_ = std::make_unique<Parts>(request, range, std::move(world));
  parts_->description = std::move(description);
}

SimulatedSource::~SimulatedSource() = default;

const SourceDescription& SimulatedSource::description() const {
  return parts_->description;
}

const std::string& SimulatedSource::skipReason() const {
  return parts_->skip_reason;
}

const std::vector<SceneObject>& SimulatedSource::objects() const {
  return parts_->renderer.scene().objects();
}

ReadStatus SimulatedSource::read(RgbdFrame& frame) {
  Parts& p = *parts_;
  if (p.next >= p.end) return ReadStatus::kEnd;
  const std::int64_t index = p.next;
  p.next += p.step;

  char name[32];
  std::snprintf(name, sizeof name, "-%06lld", static_cast<long long>(index));
  frame.index.value = index;
  frame.name = p.request.scene + name;
  frame.stamp_s = inWholeMicroseconds(static_cast<double>(index) / kFramesPerSecond);
  frame.T_WC = p.cameraPose(index);

  // The frame lends its buffers to the renderer.
  p.images.color = frame.color;
  p.images.depth_m = frame.depth_m;
  p.images.label = frame.label;
  p.renderer.render(*frame.T_WC, p.images);
  p.exposure.apply(index, p.images.depth_m, p.cameraPose(index + 1).inverse() * *frame.T_WC, p.images.color);
  p.noise.apply(index, p.images);
  frame.color = p.images.color;
  frame.depth_m = p.images.depth_m;
  frame.label = p.images.label;
  p.images.color.release();
  p.images.depth_m.release();
  p.images.label.release();
  return ReadStatus::kFrame;
}

bool SimulationRequest::matches(const std::string& input) {
  return input.starts_with(kPrefix);
}

SimulationRequest SimulationRequest::parse(const std::string& input) {
  SimulationRequest request;
  if (!matches(input)) throw IoError(input, "sim:SCENE?key=value&...", "something else");
  std::string_view rest = std::string_view(input).substr(kPrefix.size());
  const std::size_t question = std::min(rest.find('?'), rest.size());
  request.scene = rest.substr(0, question);
  request.frames = requireKind(input, request.scene).default_frames;
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
    } else if (key == "moved") {
      request.moved = parseValue<int>(input, key, value, 1, std::numeric_limits<int>::max());
    } else if (key == "dx" || key == "dy") {
      (key == "dx" ? request.dx_m : request.dy_m) =
          parseValue<double>(input, key, value, -kFarthestMove_m, kFarthestMove_m);
    } else {
      throw IoError(input, "the keys seed, frames, noise, moved, dx and dy", std::string(word));
    }
  }
  return request;
}

PinholeCamera simulatedCamera() {
  return {640, 480, 525.0, 525.0, 319.5, 239.5};
}

}  // namespace saccade
