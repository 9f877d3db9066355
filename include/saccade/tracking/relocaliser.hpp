#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "saccade/core/config_fields.hpp"
#include "saccade/core/depth_maps.hpp"
#include "saccade/map/surface_volume.hpp"
#include "saccade/tracking/keyframe_set.hpp"
#include "saccade/tracking/place_verifier.hpp"

namespace saccade {

struct RelocaliserConfig {
  int compared_keyframes = 10;   ///< most similar ones that are matched in full
  double match_ratio = 0.85;     ///< a match is kept if the second best descriptor is that much farther away
  int match_bits = 70;           ///< Hamming distance beyond which descriptors do not match
  double reprojection_px = 4.0;  ///< largest distance between a matched point's projection and its feature
  int ransac_iterations = 500;   ///< at most
  int smallest_inliers = 12;     ///< with fewer matches that agree on a pose there is none
  double farthest_m = 5.0;       ///< a pose that far from the keyframe that it was found by is not believed
  int verified_hypotheses = 3;   ///< poses that are tried on the surface, best first

  void describe(ConfigVisitor& visitor);
};

/// A pose that point features speak for; not verified by any surface.
struct PlaceHypothesis {
  Pose T_WC = Pose::Identity();
  int inliers = 0;      ///< matches that agree on the pose
  FrameIndex keyframe;  ///< the one it was found by
};

/// Finds the camera in a scene that it has seen before, without any idea of where it is: the keyframes that share most
/// descriptors with the frame, PnP with RANSAC on their matches (Fischler and Bolles 1981), then the surface decides
/// (PlaceVerifier).
///
/// Knows keyframes as they are added; owns neither them nor the surface, and changes nothing. Same keyframes in the
/// same order, same frame: same answer. One object per thread.
class Relocaliser {
 public:
  using Config = RelocaliserConfig;

  /// Throws std::invalid_argument if a field of a config is out of range.
  explicit Relocaliser(const Config& config = {}, const PlaceVerifierConfig& verification = {},
                       const TrackerConfig& tracking = {});
  ~Relocaliser();
  Relocaliser(Relocaliser&&) noexcept;
  Relocaliser& operator=(Relocaliser&&) noexcept;

  void add(std::shared_ptr<const Keyframe> keyframe);
  [[nodiscard]] std::size_t keyframes() const;

  /// Poses for a frame with these features, best first; empty if no keyframe has enough in common with it. 10 to 100
  /// ms.
  [[nodiscard]] std::vector<PlaceHypothesis> propose(const FrameFeatures& features, const PinholeCamera& camera) const;

  /// The frame's place if one of the best hypotheses is verified against `surface`; none otherwise.
  [[nodiscard]] std::optional<VerifiedPlace> find(const FrameFeatures& features, const DepthMaps& depth,
                                                  const SurfaceVolume& surface);
  /// As PlaceVerifier::beforeEachLook().
  void beforeEachLook(std::function<void(const Pose& T_WC)> prepare) { verifier_.beforeEachLook(std::move(prepare)); }

 private:
  struct Memory;

  Config config_;
  PlaceVerifier verifier_;
  std::unique_ptr<Memory> memory_;
};

}  // namespace saccade
