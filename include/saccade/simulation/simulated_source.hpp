#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "saccade/simulation/scene.hpp"
#include "saccade/sources/frame_source.hpp"

namespace saccade {

/// What `sim:SCENE?key=value&...` asks for: `sim:desk`, `sim:desk?seed=3&frames=200&noise=0`.
struct SimulationRequest {
  std::string scene = "desk";
  std::uint64_t seed = 0;     ///< placement, looks, camera path and noise
  std::int64_t frames = 120;  ///< at 30 frames a second; a longer sequence begins with the shorter one
  double noise = 1.0;         ///< strength of the sensor's noise; 0 = ideal images

  /// True for a text that begins with "sim:".
  [[nodiscard]] static bool matches(const std::string& input);
  /// Throws IoError for an unknown scene or key and a bad value; it says which are known.
  [[nodiscard]] static SimulationRequest parse(const std::string& input);
};

/// A desk in the corner of a room: about a dozen objects of everyday sizes on it and a few on the shelf above,
/// furniture and posters around. World z is up, the floor is z = 0. Object ids count from 1; furniture, walls and
/// posters are 0.
[[nodiscard]] Scene makeDeskScene(std::uint64_t seed);

/// Pose of the hand-held camera in front of the desk at a frame: a smooth path with a little tremor, at most 2 cm and
/// 1.5 degrees a frame.
[[nodiscard]] Pose deskCameraPose(std::uint64_t seed, std::int64_t frame);

/// The camera of all simulated scenes: 640 x 480, 525 px.
[[nodiscard]] PinholeCamera simulatedCamera();

/// A simulated sequence with exact poses (T_WC), object masks (label) and, unless noise is 0, a Kinect's noise. The
/// same request gives the same bytes, frame by frame, whatever range is read.
[[nodiscard]] std::unique_ptr<FrameSource> openSimulation(const SimulationRequest& request,
                                                          const FrameRange& range = {});

}  // namespace saccade
