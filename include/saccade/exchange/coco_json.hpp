#pragma once

#include <iosfwd>

#include "saccade/session/session_reader.hpp"

namespace saccade {

/// Writes the attended candidates of a session as a COCO dataset: `images` are the frames that attended anything, with
/// their pose T_WC (row-major 4 x 4) and stamp; `annotations` the candidates with compressed run lengths, `bbox`,
/// `area`, and beyond COCO `score`, `rank`, `source` and `box3d` (min, max in W, metres). One category, "object".
/// pycocotools and whatever reads COCO masks take it.
void writeCocoJson(const SessionReader& session, std::ostream& out);

}  // namespace saccade
