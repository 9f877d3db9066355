#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "saccade/core/config_fields.hpp"
#include "saccade/core/depth_maps.hpp"
#include "saccade/core/frame.hpp"
#include "saccade/map/model_view.hpp"

namespace saccade {

struct SurfaceVolumeConfig {
  double cell_m = 0.01;
  double band_cells = 4.0;     ///< truncation: distances are kept within this many cells of the surface
  double weight_cap = 200.0;   ///< observations after which old ones begin to fade
  double max_range_m = 4.0;    ///< neither measurements nor model views reach farther
  double near_weight_m = 1.0;  ///< a measurement up to this distance counts fully, beyond it by the inverse square

  void describe(ConfigVisitor& visitor);
};

/// Position of a brick in the volume's grid: it holds the samples 8 * (x, y, z) .. 8 * (x, y, z) + 7. A type of its own
/// so that it is never taken for the position of a sample.
struct BrickPosition {
  std::int32_t x = 0, y = 0, z = 0;
  friend auto operator<=>(const BrickPosition&, const BrickPosition&) = default;
};

/// 8 x 8 x 8 samples of the truncated signed distance, x fastest. Sample (i, j, k) of the grid lies at
/// cell_m * (i, j, k) in the world.
struct SurfaceBrick {
  static constexpr int kSide = 8;
  static constexpr int kSamples = kSide * kSide * kSide;
  static constexpr float kDistanceScale = 32767.0F;  ///< `distance` of a sample that is a whole band before a surface
  static constexpr float kWeightScale = 128.0F;      ///< `weight` of one full observation
  static constexpr std::int16_t kUnknownDistance = INT16_MIN;  ///< `distance` where the weight is 0, and only there

  std::array<std::int16_t, kSamples> distance;  ///< positive before the surface, in 1 / kDistanceScale of the band
  std::array<std::uint16_t, kSamples> weight;   ///< in 1 / kWeightScale observations; 0: unknown
};

/// The surface near the camera as a truncated signed distance, fused over a band around every measured surface (Curless
/// and Levoy 1996; Newcombe et al. 2011), in sparse bricks. It is what tracking aligns new frames to.
///
/// Owns the bricks, their directory and the scratch of its algorithms. It does not know the octree (occupancy and
/// attention live there), does not decide whether a frame is good enough to integrate (the pipeline does), and does not
/// store anything (session/ does, through bricks() and importBrick()).
/// Not thread-safe, not even for several const calls at once. Memory: 2 KiB a brick, in slabs that stay where they are.
class SurfaceVolume {
 public:
  using Config = SurfaceVolumeConfig;

  /// Throws std::invalid_argument if a field of `config` is out of range.
  explicit SurfaceVolume(const Config& config = {});
  ~SurfaceVolume();
  SurfaceVolume(SurfaceVolume&&) noexcept;
  SurfaceVolume& operator=(SurfaceVolume&&) noexcept;

  /// Fuses the measured depth of `depth`, seen from `T_WC`, into every sample that projects onto a measurement and lies
  /// not further than the band behind it; allocates bricks along the band. Cost ~ visible bricks.
  /// Throws std::invalid_argument if the pose is not finite or absurdly far away.
  void integrate(const DepthMaps& depth, const Pose& T_WC);

  /// Fills `view` with the surface that `camera` at `T_WM` sees: per pixel the first change from before to behind the
  /// surface, interpolated, with the gradient as normal. Buffers of `view` are reused. Cost ~ pixels of the camera:
  /// tracking wants half the resolution. `wanted`, if given, has the camera's size, and pixels where it is 0 become
  /// holes. Throws std::invalid_argument as integrate() does, and if `wanted` has another size.
  void rayCast(const PinholeCamera& camera, const Pose& T_WM, ModelView& view, const cv::Mat1b* wanted = nullptr) const;

  /// Signed distance in metres, trilinear, at a world point; empty where one of the eight samples around is unknown.
  [[nodiscard]] std::optional<double> distanceAt(const Eigen::Vector3d& p_W) const;

  [[nodiscard]] bool empty() const { return positions_.empty(); }
  [[nodiscard]] std::size_t memoryBytes() const;
  [[nodiscard]] const Config& config() const { return config_; }

  /// Positions of all bricks in the order in which they were allocated; brick(i) is the one at bricks()[i].
  [[nodiscard]] const std::vector<BrickPosition>& bricks() const { return positions_; }
  [[nodiscard]] const SurfaceBrick& brick(std::size_t index) const { return *bricks_[index]; }
  /// The value of changes() when brick `index` was last written: a saver stores what is newer than its last visit.
  [[nodiscard]] std::uint64_t lastChange(std::size_t index) const { return last_change_[index]; }
  /// Number of integrate() and importBrick() calls so far.
  [[nodiscard]] std::uint64_t changes() const { return changes_; }
  /// Puts a brick as it was saved; one that is at the position already is overwritten.
  void importBrick(const BrickPosition& position, const SurfaceBrick& brick);
  /// Takes the bricks for which `gone` says so out of the volume; their memory is used for the next ones. The others
  /// keep their order.
  void removeBricks(const std::function<bool(std::size_t index)>& gone);
  /// Puts a brick back that was removed; it counts as unchanged. Throws std::logic_error if there is one.
  void returnBrick(const BrickPosition& position, const SurfaceBrick& brick);
  /// Bytes that the bricks take, memory kept for new ones left out.
  [[nodiscard]] std::size_t usedBytes() const { return bricks_.size() * sizeof(SurfaceBrick); }

 private:
  struct Scratch;

  void allocateBand(const DepthMaps& depth, const Pose& T_WC);
  void findVisible(const PinholeCamera& camera, const Pose& T_WC) const;
  void buildDirectory() const;
  void boundRays(const PinholeCamera& camera, const Pose& T_WM, const cv::Mat1b* wanted) const;
  std::int32_t findOrAllocate(const BrickPosition& position);
  [[nodiscard]] std::int32_t find(const BrickPosition& position) const;
  [[nodiscard]] SurfaceBrick* takeRoom();
  void fill(std::size_t index, const SurfaceBrick& brick);
  void buildSlots(std::size_t count);

  Config config_;
  std::vector<BrickPosition> positions_;
  std::vector<SurfaceBrick*> bricks_;
  std::vector<std::uint64_t> last_change_;
  std::vector<std::uint64_t> behind_;  ///< blocks of a brick close behind a surface, see RayBounds
  std::uint64_t changes_ = 0;
  std::vector<std::unique_ptr<SurfaceBrick[]>> slabs_;
  std::vector<SurfaceBrick*> free_;  ///< room of removed bricks, and what is left of the last slab
  std::vector<std::int32_t> slots_;  ///< hash table with open addressing: index of a brick, or -1
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace saccade
