#include "sources/oni_first_stamps.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "saccade/core/errors.hpp"

namespace saccade {
namespace {

constexpr const char* kKey = "first_stamp_us";

}  // namespace

std::string oniFirstStampsYaml(const OniFirstStamps& stamps) {
  return fmt::format("{}: {{color: {}, depth: {}}}   # .oni files count from the first frame of each stream\n", kKey,
                     stamps.color_us, stamps.depth_us);
}

OniFirstStamps findOniFirstStamps(const std::filesystem::path& recording) {
  std::filesystem::path side = recording;
  side += ".yaml";
  if (!std::filesystem::exists(side)) return {};
  try {
    const YAML::Node stamps = YAML::LoadFile(side.string())[kKey];
    if (!stamps) return {};
    return {stamps["color"].as<std::int64_t>(), stamps["depth"].as<std::int64_t>()};
  } catch (const YAML::Exception& error) {
    throw IoError(side, std::string(kKey) + ": {color: N, depth: N}", error.what());
  }
}

}  // namespace saccade
