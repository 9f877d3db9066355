#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "saccade/core/depth_maps.hpp"

namespace saccade {

/// Point features of one frame, each with the place it was measured at: `pixels[i]`, `points_C[i]` and row i of
/// `descriptors` belong together.
struct FrameFeatures {
  static constexpr int kDescriptorBytes = 32;

  std::vector<Eigen::Vector2f> pixels;
  std::vector<Eigen::Vector3f> points_C;  ///< metres, frame C, z > 0
  cv::Mat1b descriptors;                  ///< ORB: 256 bits a row, to be compared by Hamming distance

  [[nodiscard]] std::size_t size() const { return points_C.size(); }
  friend bool operator==(const FrameFeatures& a, const FrameFeatures& b);
};

/// The features as bytes, for a session: exact, and the same bytes for the same features.
[[nodiscard]] std::string encodeFeatures(const FrameFeatures& features);
/// The features again; none if `bytes` are not what encodeFeatures() writes (wrong kind, size or an impossible value).
[[nodiscard]] std::optional<FrameFeatures> decodeFeatures(std::string_view bytes);

struct FeatureExtractorConfig {
  int features = 800;  ///< at most, the strongest corners where depth was measured
  int levels = 8;      ///< of the image pyramid, each smaller by the factor 1.2
  int corner_threshold = 12;

  void describe(ConfigVisitor& visitor);
};

/// Finds ORB features (Rublee et al. 2011) where the depth image has a measurement. Keeps nothing between frames; about
/// 10 ms at 640x480, one thread.
class FeatureExtractor {
 public:
  using Config = FeatureExtractorConfig;

  /// Throws std::invalid_argument if a field of `config` is out of range.
  explicit FeatureExtractor(const Config& config = {});

  /// The features of a colour image (BGR) with the depth maps of the same frame. Same images: same features. Throws
  /// std::invalid_argument if the sizes differ.
  [[nodiscard]] FrameFeatures extract(const cv::Mat3b& color, const DepthMaps& depth) const;

 private:
  Config config_;
};

}  // namespace saccade
