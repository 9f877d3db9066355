#pragma once

#include <vector>

#include "saccade/preflight/preflight.hpp"
#include "sources/frame_list.hpp"

namespace saccade {

/// What is wrong with the files of a folder's frames, judged by their presence and their heads: missing, unreadable,
/// colour and depth in each other's place, depth that is a picture, sizes that do not fit.
void checkFolderImages(const FrameList& list, std::vector<PreflightFinding>& findings);

}  // namespace saccade
