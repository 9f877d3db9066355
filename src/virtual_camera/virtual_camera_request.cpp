#include "virtual_camera/virtual_camera_request.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sources/text_numbers.hpp"
#include "virtual_camera/virtual_camera_protocol.hpp"

namespace saccade::virtual_camera {
namespace {

/// Two positive numbers "AxB".
std::optional<std::pair<double, double>> parseTwo(std::string_view text) {
  constexpr double kMost = 32768;
  const std::size_t by = text.find('x');
  if (by == std::string_view::npos) return std::nullopt;
  const auto first = parseNumber(text.substr(0, by)), second = parseNumber(text.substr(by + 1));
  if (!first || !second || !(*first >= 1 && *first <= kMost) || !(*second >= 1 && *second <= kMost))
    return std::nullopt;
  return std::pair(*first, *second);
}

/// Takes one key and its value; false if either is unknown or bad.
bool take(std::string_view key, std::string_view value, VirtualCameraRequest& request) {
  if (key == "unit") {
    request.depth_format = value == "100um" ? ONI_PIXEL_FORMAT_DEPTH_100_UM : ONI_PIXEL_FORMAT_DEPTH_1_MM;
    return value == "mm" || value == "100um";
  }
  if (key == "color" || key == "depth" || key == "color_focal" || key == "depth_focal") {
    const auto two = parseTwo(value);
    if (!two) return false;
    if (key == "color") request.color = {static_cast<int>(two->first), static_cast<int>(two->second)};
    if (key == "depth") request.depth = {static_cast<int>(two->first), static_cast<int>(two->second)};
    if (key == "color_focal") request.color_focal = {two->first, two->second};
    if (key == "depth_focal") request.depth_focal = {two->first, two->second};
    return true;
  }
  const std::optional<double> number = parseNumber(value);
  if (!number || !std::isfinite(*number) || *number < 0) return false;
  if (key == "speed") {
    request.speed = *number;
    return *number > 0;
  }
  if (key == "unplug_after") {
    request.unplug_after = static_cast<std::int64_t>(*number);
    return true;
  }
  if (key == "replug_after") {
    request.replug_after_s = *number;
    return true;
  }
  return false;
}

}  // namespace

bool VirtualCameraRequest::isFed() const {
  return input == kPushName;
}

std::optional<VirtualCameraRequest> VirtualCameraRequest::parse(const std::string& uri) {
  const std::string_view prefix = kUriPrefix;
  // OpenNI2 keeps URIs in arrays of this size.
  if (!uri.starts_with(prefix) || uri.size() >= ONI_MAX_STR) return std::nullopt;
  VirtualCameraRequest request;
  request.uri = uri;
  const std::size_t hash = std::min(uri.find('#'), uri.size());
  request.input = uri.substr(prefix.size(), hash - prefix.size());
  if (request.input.empty()) return std::nullopt;
  std::string_view rest = std::string_view(uri).substr(std::min(hash + 1, uri.size()));
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('&'), rest.size());
    const std::string_view word = rest.substr(0, end);
    const std::size_t equals = std::min(word.find('='), word.size());
    if (!take(word.substr(0, equals), word.substr(std::min(equals + 1, word.size())), request)) return std::nullopt;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  if (request.isFed() && (request.color.width == 0 || request.depth.width == 0)) return std::nullopt;
  return request;
}

}  // namespace saccade::virtual_camera
