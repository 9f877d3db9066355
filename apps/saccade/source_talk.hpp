#pragma once

#include "saccade/sources/frame_source.hpp"

namespace saccade::app {

/// Tells the user on stderr what a source understood about its input.
void sayWhatWasUnderstood(const SourceDescription& description);

/// Tells the user on stderr what was dropped and why the input ended, if there is anything to tell.
void sayHowItEnded(const SourceProgress& progress);

}  // namespace saccade::app
