#include "session_run.hpp"

#include <ctime>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "saccade/core/errors.hpp"
#include "saccade/version.hpp"

namespace saccade::app {

RunRecord runFrom(const std::string& input, const SourceDescription& description) {
  RunRecord run;
  run.input = input;
  run.input_kind = description.kind;
  run.started_utc = fmt::format("{:%FT%TZ}", fmt::gmtime(std::time(nullptr)));
  run.saccade_version = kVersion;
  return run;
}

void requireCamera(const SessionReader& session, const PinholeCamera& found) {
  const auto text = [](const PinholeCamera& c) {
    return fmt::format("{} x {} px, f {:.3f} {:.3f}, c {:.3f} {:.3f}", c.width, c.height, c.fx, c.fy, c.cx, c.cy);
  };
  const PinholeCamera& expected = session.metadata().camera;
  if (expected == found) return;
  throw IoError(session.path(), "an input of the session's camera (" + text(expected) + ")", text(found));
}

}  // namespace saccade::app
