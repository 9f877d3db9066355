#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <Eigen/Geometry>

#include "saccade/core/depth_maps.hpp"
#include "saccade/core/frame.hpp"
#include "saccade/discovery/candidate.hpp"
#include "saccade/discovery/candidate_outline.hpp"
#include "saccade/discovery/perception.hpp"

namespace saccade {

/// What a line of the candidate file says of its frame.
struct CandidateLineHeader {
  FrameIndex frame;
  std::string name;
  double stamp_s = 0.0;
  std::string tracking;  ///< "tracked", "weak", "lost"
};

/// Returns one JSON line (without the line's end) with the frame's candidates: those of `open` in their order (falling
/// score), `attended` for the first `attended_count`, then those of `inhibited` with rank null.
///
/// Keys: frame, name, stamp_s, tracking, candidates; of a candidate: rank, score, attended, inhibited, box [u, v,
/// width, height], source ("colour" or "depth"), mask (compressed COCO RLE: {"size": [height, width], "counts": ...}),
/// box3d ([min x, y, z, max x, y, z] in W; null where there is no depth or no pose), features (twelve, or with our
/// cues after them).
///
/// Box and mask are in pixels of the input's colour image: `outliner` has begun `seen`. `depth` and `T_WC` may be
/// missing (colour only; lost).
[[nodiscard]] std::string candidateLine(const CandidateLineHeader& header, const Candidates& open, int attended_count,
                                        const Candidates& inhibited, const Perception& seen,
                                        const CandidateOutliner& outliner, const DepthMaps* depth,
                                        const std::optional<Pose>& T_WC);

/// The axis-parallel box in W around the measured points of a candidate's mask; none if there are none.
[[nodiscard]] std::optional<Eigen::AlignedBox3d> candidateBox(const Candidate& candidate, const Perception& seen,
                                                              const DepthMaps& depth, const Pose& T_WC);

/// "colour" or "depth".
[[nodiscard]] std::string_view sourceName(CandidateSource source);

}  // namespace saccade
