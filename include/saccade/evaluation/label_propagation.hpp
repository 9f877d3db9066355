#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "saccade/core/distorted_pixels.hpp"
#include "saccade/evaluation/label_frames.hpp"
#include "saccade/map/ior_map.hpp"

namespace saccade {

/// A frame of a finished run, to which labels shall come.
struct PosedFrame {
  std::string name;
  Pose T_WC = Pose::Identity();
};

/// Carries the labels of a few frames of a sequence to all others through its map (paper, "Propagation of ground truth
/// annotations"): the masks are projected onto the leaves that each labelled frame sees, most pixels decide; every
/// other frame is rendered, and each leaf takes the id that the labelled frame nearest in time gave it, or, where that
/// one did not see the leaf, the nearest on the other side.
///
/// `map` is the whole run's; `frames` are all frames with a pose, in order; `given` are labels of some of them, in the
/// pixels of the input (`pixels`). Returns labels for every frame of `frames`, the given ones unchanged; a pixel
/// whose leaf no labelled frame saw, or that sees no leaf, is 0. Throws std::invalid_argument if no frame has a label.
[[nodiscard]] LabelFrames propagateLabels(const IorMap& map, const PinholeCamera& camera, const DistortedPixels& pixels,
                                          const std::vector<PosedFrame>& frames, const LabelFrames& given);

/// Mean over objects and frames of the overlap (IoU) of masks with the true ones, for objects of at least `min_area`
/// true pixels; frames that `skip` names are left out. 0 if nothing was compared.
struct LabelAgreement {
  int objects = 0;
  double mean_iou = 0.0;
};
[[nodiscard]] LabelAgreement compareLabels(const LabelFrames& labels, const LabelFrames& truth, const LabelFrames& skip,
                                           const std::vector<PosedFrame>& frames, int min_area);

}  // namespace saccade
