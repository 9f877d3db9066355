#pragma once

#include <memory>

#include <opencv2/core.hpp>

#include "saccade/core/config_fields.hpp"

namespace saccade {

/// Settings of the saliency map. The defaults are those of the paper's coffee machine scene.
struct SaliencyConfig {
  int first_layer = 0;        ///< finest pyramid layer used: 0 = the input's resolution, each further one halves it
  int last_layer = 4;         ///< coarsest pyramid layer used
  int scales_per_octave = 2;  ///< scales between one layer and the next
  double center_sigma = 2.0;  ///< px of the layer, first scale; scale s of S has 2^(s/S) times that
  double surround_sigma = 6.0;

  void describe(ConfigVisitor& visitor);
};

/// Computes the VOCUS2 saliency map of colour images (Frintrop et al. 2015; paper, "Saliency computation").
///
/// Centre-surround contrast |C - S| of intensity, red/green and blue/yellow (opponent colours) on twin pyramids, fused
/// by the mean over scales, layers and channels. No orientation channel, no centre bias. Owns the pyramids; what is
/// salient in the map is found by salient_blobs.hpp.
///
/// Agrees with the reference program on its own maps (see the tests).
/// One object serves one thread; images of a new size reallocate.
class SaliencyModel {
 public:
  /// Throws std::invalid_argument if a setting is out of range, last_layer < first_layer or the surround is not wider
  /// than the centre.
  explicit SaliencyModel(SaliencyConfig config = {});
  ~SaliencyModel();
  SaliencyModel(SaliencyModel&&) noexcept;
  SaliencyModel& operator=(SaliencyModel&&) noexcept;

  /// The saliency map of a BGR image: same size, values stretched to [0, 1]; zero everywhere if the image shows no
  /// contrast. The map is overwritten by the next call. Throws std::invalid_argument on an empty image.
  const cv::Mat1f& compute(const cv::Mat3b& bgr);
  /// The same, written to `map`, whose buffer is reused.
  void compute(const cv::Mat3b& bgr, cv::Mat1f& map);

  [[nodiscard]] const SaliencyConfig& config() const { return config_; }

 private:
  struct Pyramid;

  SaliencyConfig config_;
  std::unique_ptr<Pyramid> pyramid_;
  cv::Mat1f map_;
};

}  // namespace saccade
