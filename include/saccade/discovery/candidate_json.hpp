#pragma once

#include <string>
#include <string_view>

#include "saccade/core/frame.hpp"
#include "saccade/discovery/candidate.hpp"
#include "saccade/discovery/candidate_box.hpp"
#include "saccade/discovery/candidate_outline.hpp"

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
/// cues after them). Numbers have five digits after the point.
///
/// Box and mask are in pixels of the input's colour image. `outliner` and `boxes` have begun the frame.
[[nodiscard]] std::string candidateLine(const CandidateLineHeader& header, const Candidates& open, int attended_count,
                                        const Candidates& inhibited, const CandidateOutliner& outliner,
                                        const CandidateBoxes& boxes);

/// "colour" or "depth".
[[nodiscard]] std::string_view sourceName(CandidateSource source);

}  // namespace saccade
