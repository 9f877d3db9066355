#pragma once

#include <memory>

#include "saccade/core/config_fields.hpp"
#include "saccade/discovery/candidate.hpp"
#include "saccade/discovery/perception.hpp"

namespace saccade {

/// How candidates are made of segments. `paper` leaves only what the paper does: blobs select segments.
struct ProposalConfig {
  bool paper = false;
  double overlap = 0.3;
  bool single_segments = true;
  bool adjacent_pairs = true;
  bool merging = true;
  bool plane_removal = true;
  bool cross_selection = true;
  double cross_share = 0.5;
  bool distinct_boxes = true;
  int min_area = 100;
  double max_area_share = 0.35;

  void describe(ConfigVisitor& v) {
    v.flag("paper", paper, "only salient blobs select segments, and no candidate is left out");
    v.number("overlap", overlap, {0.0, 1.0}, "", "share of a segment that a salient blob must cover to select it");
    v.flag("single_segments", single_segments, "each segment is a candidate too");
    v.flag("adjacent_pairs", adjacent_pairs, "neighbouring segments of like colour or without a depth step are too");
    v.flag("merging", merging, "unions met while the most alike neighbours are merged are too");
    v.flag("plane_removal", plane_removal, "what is connected once the supporting planes are taken away is too");
    v.flag("cross_selection", cross_selection, "depth candidates select colour segments too");
    v.number("cross_share", cross_share, {0.0, 1.0}, "", "share of a colour segment a depth candidate must cover");
    v.flag("distinct_boxes", distinct_boxes, "of candidates of nearly one box and area only the first met is kept");
    v.integer("min_area", min_area, {1, 1000000}, "px", "smaller candidates are left out");
    v.number("max_area_share", max_area_share, {0.0, 1.0}, "", "candidates over this share of the image are left out");
  }
};

/// Makes the pool of object candidates of one frame after the other; its buffers are recycled. One object serves one
/// thread at a time.
class Proposer {
 public:
  explicit Proposer(ProposalConfig config = {});
  ~Proposer();
  Proposer(Proposer&&) noexcept;
  Proposer& operator=(Proposer&&) noexcept;

  /// Returns the pool of object candidates of both segmentations (paper, "Saliency-based object discovery"), colour
  /// before depth, each with segments, box and area; features and score are not set. No two have the same segments,
  /// nor, with `distinct_boxes`, nearly the same box and area: whatever the source, they would be measured, ranked and
  /// left out as duplicates. In paper mode each blob that selects anything adds its own.
  ///
  /// Deterministic: the order follows that of blobs and segments. About 2.5 ms for 640×480.
  [[nodiscard]] Candidates propose(const Perception& seen);

  class Pool;

 private:
  struct Scratch;

  ProposalConfig config_;
  std::unique_ptr<Scratch> scratch_;
};

/// The same for a single frame.
[[nodiscard]] Candidates proposeCandidates(const Perception& seen, const ProposalConfig& config = {});

}  // namespace saccade
