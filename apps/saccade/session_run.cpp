#include "session_run.hpp"

#include <cstddef>
#include <ctime>
#include <iostream>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "saccade/core/errors.hpp"
#include "saccade/version.hpp"
#include "terminal.hpp"

namespace saccade::app {
namespace {

constexpr double kMiB = 1048576.0;

}  // namespace

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

void addMapMemory(CLI::App& command, double& limit_MiB, const std::string& from_when) {
  command
      .add_option("--map-memory", limit_MiB,
                  "MiB that map and surface volume may take" + from_when +
                      ": parts far from the camera wait in the session meanwhile (0: no limit)")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
}

void limitMapMemory(SessionSink& session, double limit_MiB) {
  if (limit_MiB > 0.0) session.limitMemory(static_cast<std::size_t>(limit_MiB * kMiB));
}

void sayPaging(const PagingReport& paging) {
  std::cerr << fmt::format("map paging: at most {:.0f} MiB in memory, {} parts dropped, {} brought back\n",
                           static_cast<double>(paging.most_bytes) / kMiB, grouped(paging.dropped),
                           grouped(paging.returned));
}

}  // namespace saccade::app
