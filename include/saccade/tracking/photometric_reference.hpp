#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "saccade/core/config_fields.hpp"
#include "saccade/core/depth_maps.hpp"
#include "saccade/core/frame.hpp"
#include "saccade/tracking/intensity_pyramid.hpp"

namespace saccade {

struct PhotometricReferenceConfig {
  double shift_m = 0.15;           ///< a camera farther from the reference than this becomes the next one
  double turn_rad = 0.15;          ///< or turned by more
  double smallest_gradient = 4.0;  ///< grey levels per pixel of half the resolution; flatter pixels are mostly noise

  void describe(ConfigVisitor& visitor);
};

/// Textured surface points of one earlier frame with the grey values that they had: what the colour of the frames after
/// it is compared with (Steinbrücker, Sturm and Cremers 2011; Kerl, Sturm and Cremers 2013, keyframes).
///
/// Owns the points of one frame at a time and says when another is due. It stays for many frames, so that colour does
/// not add to drift while the camera looks at the same place. Which frames may become references is the caller's
/// decision.
class PhotometricReference {
 public:
  using Config = PhotometricReferenceConfig;

  /// Of all points, in the frame R of the reference's camera. Separate arrays, padded with points that weigh nothing:
  /// they lie in the camera's centre, which is nowhere in any image.
  struct Points {
    static constexpr std::size_t kBlock = 128;  ///< the arrays' length is a multiple of this

    struct Level {
      std::vector<float> grey;
      std::array<std::vector<float>, 3> slope;  ///< change of the grey value as the point moves, 1/m, along x, y, z
    };
    std::size_t count = 0;                       ///< real points
    std::array<std::vector<float>, 3> position;  ///< m
    std::array<Level, IntensityPyramid::kLevels> levels;

    /// Visits all arrays in a fixed order, to be saved and put back.
    template <typename Points, typename Visit>
    static void forEachArray(Points& points, const Visit& visit) {
      for (auto& axis : points.position) visit(axis);
      for (auto& level : points.levels) {
        visit(level.grey);
        for (auto& axis : level.slope) visit(axis);
      }
    }
  };

  /// Everything it knows, to be saved and put back.
  struct State {
    Pose T_WR = Pose::Identity();
    Points points;
  };

  /// Throws std::invalid_argument if a field of `config` is out of range.
  explicit PhotometricReference(const Config& config = {});

  /// Whether a frame seen from `T_WC` should replace the reference: always if there is none.
  [[nodiscard]] bool wants(const Pose& T_WC) const;
  /// Takes the frame as reference: of every second pixel of half its resolution those that have a normal and texture.
  void take(const DepthMaps& depth, const IntensityPyramid& intensity, const Pose& T_WC);

  /// No reference yet, or one without points.
  [[nodiscard]] bool empty() const { return state_.points.count == 0; }
  [[nodiscard]] const State& state() const { return state_; }
  void restore(State state);
  /// Number of take() and restore() calls so far: whether to save it again.
  [[nodiscard]] std::size_t changes() const { return changes_; }

 private:
  Config config_;
  State state_;
  bool taken_ = false;
  std::size_t changes_ = 0;
};

}  // namespace saccade
