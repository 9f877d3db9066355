#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "saccade/core/camera.hpp"
#include "saccade/simulation/simulated_world.hpp"
#include "saccade/sources/frame_source.hpp"

namespace saccade {

/// What `sim:SCENE?key=value&...` asks for: `sim:desk`, `sim:coffee?seed=3&frames=200&noise=0`, or
/// `sim:desk?moved=7&dx=0.2` for the same scene after somebody moved an object.
struct SimulationRequest {
  std::string scene = "desk";
  std::uint64_t seed = 0;         ///< placement, looks, camera path and noise
  std::int64_t frames = 120;      ///< at 30 frames a second; a longer sequence begins with the shorter one
  double noise = 1.0;             ///< strength of the sensor's noise; 0 = ideal images
  int moved = 0;                  ///< an object that is not where it usually is; 0 = none
  double dx_m = 0.0, dy_m = 0.0;  ///< by how much that object is shifted, along the world's x and y

  /// True for a text that begins with "sim:".
  [[nodiscard]] static bool matches(const std::string& input);
  /// Throws IoError for an unknown scene or key and a bad value; it says which are known. Frames that are not given
  /// are those of the scene.
  [[nodiscard]] static SimulationRequest parse(const std::string& input);
};

/// The camera of all simulated scenes: 640 x 480, 525 px.
[[nodiscard]] PinholeCamera simulatedCamera();

/// A simulated sequence with exact poses (T_WC), object masks (label) and, unless noise is 0, a hand-held Kinect's
/// noise, blur and exposure. The same request gives the same bytes, frame by frame, whatever range is read and with
/// any number of threads.
class SimulatedSource final : public FrameSource {
 public:
  /// Makes and lights the scene. Throws IoError if the scene is unknown or the range holds no frame.
  explicit SimulatedSource(const SimulationRequest& request, const FrameRange& range = {});
  ~SimulatedSource() override;

  [[nodiscard]] const SourceDescription& description() const override;
  [[nodiscard]] ReadStatus read(RgbdFrame& frame) override;
  [[nodiscard]] const std::string& skipReason() const override;

  /// All objects of the scene, whether a frame shows them or not.
  [[nodiscard]] const std::vector<SceneObject>& objects() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace saccade
