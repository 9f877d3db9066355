#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "saccade/core/config_fields.hpp"
#include "saccade/core/depth_maps.hpp"
#include "saccade/core/frame.hpp"
#include "saccade/map/model_view.hpp"
#include "saccade/map/surface_volume.hpp"

namespace saccade {

struct DepthCompletionConfig {
  bool enabled = true;

  void describe(ConfigVisitor& visitor) {
    visitor.flag("enabled", enabled, "candidates see the map's surface where the depth camera's view ends");
  }
};

/// Continues the depth of a frame into the strips along the image's border that the depth camera does not see: there
/// the surface stands in that earlier frames have shown. A depth image registered to colour ends before the colour
/// image does, often on all four sides, and things in the strips are otherwise judged by their colour alone.
///
/// A strip is what lies between the border and the first measurement along a row or a column. Gaps further inside are
/// left: mostly something is there that gives no echo, and the surface behind it is not its depth.
///
/// Owns its scratch, which it recycles. Not thread-safe; looks at the surface, which is no more so.
class DepthCompletion {
 public:
  using Config = DepthCompletionConfig;

  explicit DepthCompletion(const Config& config = {}) : config_(config) {}

  /// Whether `surface`, seen from `T_WC`, shows something in a strip of `measured`. Then `completed` is `measured` with
  /// depth, vertices and normals of that; otherwise it is not touched. Buffers of `completed` are reused. The surface
  /// is looked at with a quarter of the resolution: the depth of a pixel is that of the plane through what the ray
  /// beside it meets. Throws std::invalid_argument if the pose is not finite or absurdly far away.
  bool complete(const DepthMaps& measured, const SurfaceVolume& surface, const Pose& T_WC, DepthMaps& completed);

 private:
  void findStrips(const cv::Mat1f& depth_m);
  bool findWanted();
  void fillRow(int v, DepthMaps& completed) const;

  Config config_;
  std::vector<int> first_, last_;  ///< measured row of each column
  cv::Mat1b strips_;               ///< not 0: in a strip
  cv::Mat1b wanted_;               ///< the same for the model's pixels
  ModelView view_;
};

}  // namespace saccade
