#include "saccade/sources/frame_source.hpp"

#include <array>
#include <charconv>
#include <stdexcept>

#include "saccade/core/errors.hpp"
#include "saccade/simulation/simulated_source.hpp"
#include "sources/frame_list.hpp"

namespace saccade {
namespace {

struct Layout {
  const char* files;
  bool (*matches)(const std::filesystem::path&);
  FrameList (*list)(const std::filesystem::path&);
};

constexpr std::array kLayouts = {
    Layout{"frame-NNNNNN.color.png (7-Scenes)", looksLikeSevenScenes, listSevenScenes},
    Layout{"rgb.txt and depth.txt (TUM)", looksLikeTum, listTum},
    Layout{"color/, depth/ and camera.txt (labelled frames)", looksLikeLabelledFrames, listLabelledFrames},
};

std::string contents(const std::filesystem::path& folder) {
  constexpr int kShown = 6;
  std::string names;
  std::int64_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (++count <= kShown) names += (names.empty() ? "" : ", ") + entry.path().filename().string();
  }
  if (count == 0) return "an empty folder";
  return counted(count, "entry") + ": " + names + (count > kShown ? ", ..." : "");
}

std::unique_ptr<FrameSource> openFolder(const std::filesystem::path& folder, const FrameRange& range,
                                        const std::filesystem::path& labels) {
  std::string looked_for;
  for (const Layout& layout : kLayouts) {
    looked_for += (looked_for.empty() ? "" : "; or ") + std::string(layout.files);
    if (!layout.matches(folder)) continue;
    FrameList list = layout.list(folder);
    list.description.location = folder.string();
    return openFrameList(std::move(list), range, labels);
  }
  throw IoError(folder, looked_for, contents(folder));
}

}  // namespace

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
  if (range.first < 0 || range.step < 1) {
    throw std::invalid_argument("frame range: expected first >= 0 and step >= 1, found " + std::to_string(range.first) +
                                " and " + std::to_string(range.step));
  }
  if (SimulationRequest::matches(input)) {
    if (!labels.empty()) throw IoError(labels, "no label folder beside a simulated scene, which has its own", "one");
    return std::make_unique<SimulatedSource>(SimulationRequest::parse(input), range);
  }
  const std::filesystem::path folder(input);
  std::error_code error;
  if (!std::filesystem::exists(folder, error)) {
    throw IoError(folder, "a folder of RGB-D frames or sim:SCENE", "nothing of that name");
  }
  if (!std::filesystem::is_directory(folder, error)) {
    throw IoError(folder, "a folder of RGB-D frames or sim:SCENE", "a file");
  }
  return openFolder(folder, range, labels);
}

}  // namespace saccade
