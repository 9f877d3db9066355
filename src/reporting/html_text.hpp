#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>
#include <opencv2/core.hpp>

/// What a page is made of.
namespace saccade {

/// `text` as HTML shows it, between tags and in quoted attributes; bytes that are no UTF-8 become U+FFFD.
[[nodiscard]] std::string escapedHtml(std::string_view text);

[[nodiscard]] std::string base64(std::span<const std::uint8_t> bytes);

/// The picture as the value of an `src`, a JPEG of at most `most_bytes`: the quality falls until it is so small, and
/// where that is not enough, the picture shrinks.
[[nodiscard]] std::string jpegUri(const cv::Mat3b& bgr, std::size_t most_bytes);

/// JSON for a `<script type="application/json">`, which nothing inside can end.
[[nodiscard]] std::string jsonForScript(const nlohmann::ordered_json& json);

}  // namespace saccade
