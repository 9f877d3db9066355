#pragma once

#include "saccade/sources/frame_source.hpp"

namespace saccade::app {

/// Tells the user on stderr what a source understood about its input.
void sayWhatWasUnderstood(const SourceDescription& description);

}  // namespace saccade::app
