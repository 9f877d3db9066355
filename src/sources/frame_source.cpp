#include "saccade/sources/frame_source.hpp"

#include <charconv>
#include <stdexcept>

#include "saccade/core/errors.hpp"
#include "saccade/simulation/simulated_source.hpp"
#include "saccade/sources/sensor_source.hpp"
#include "sources/ideal_frames.hpp"

namespace saccade {

FrameRange FrameRange::parse(const std::string& text) {
  const auto fail = [&]() -> FrameRange {
    throw std::invalid_argument("frame range: expected A:B:STEP with 0 <= A < B and STEP >= 1, found \"" + text + "\"");
  };
  FrameRange range;
  std::size_t begin = 0;
  int part = 0;
  for (; begin <= text.size(); ++part) {
    const std::size_t end = std::min(text.find(':', begin), text.size());
    if (end > begin) {
      std::int64_t value = 0;
      const auto [stop, error] = std::from_chars(text.data() + begin, text.data() + end, value);
      if (error != std::errc() || stop != text.data() + end || value < 0 || part > 2) return fail();
      if (part == 0) range.first = value;
      if (part == 1) range.end = value;
      if (part == 2) range.step = value;
    }
    begin = end + 1;
  }
  // A single number has no colon: "5" could mean a frame or a count, so it is refused.
  if (part < 2 || part > 3 || range.step < 1 || (range.end && *range.end <= range.first)) return fail();
  return range;
}

std::unique_ptr<FrameSource> openSource(const std::string& input, const FrameRange& range,
                                        const std::filesystem::path& labels) {
  if (SimulationRequest::matches(input)) {
    if (!labels.empty()) throw IoError(labels, "no label folder beside a simulated scene, which has its own", "one");
    return std::make_unique<SimulatedSource>(SimulationRequest::parse(input), range);
  }
  return std::make_unique<IdealFrames>(openSensorSource(input, range, labels));
}

}  // namespace saccade
