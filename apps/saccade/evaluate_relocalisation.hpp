#pragma once

#include <string>

namespace saccade::app {

/// Looks for every frame of `input` in the session's scene, each by itself, and prints how many were located, refused
/// and placed wrongly. `truth`: TUM trajectory with the frames of the session's own input and of `input`; empty:
/// `input` shows another place, and every frame must be refused.
void evaluateRelocalisation(const std::string& session, const std::string& input, const std::string& range,
                            const std::string& truth, bool json);

}  // namespace saccade::app
