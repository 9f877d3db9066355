#include "reporting/html_text.hpp"

#include <array>
#include <vector>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace saccade {
namespace {

/// The text with bytes that are no UTF-8 replaced, by way of a JSON string.
std::string wellFormed(std::string_view text) {
  const nlohmann::json json = std::string(text);
  const std::string dumped = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  return nlohmann::json::parse(dumped).get<std::string>();
}

}  // namespace

std::string escapedHtml(std::string_view text) {
  std::string html;
  for (const char c : wellFormed(text)) {
    switch (c) {
      case '<':
        html += "&lt;";
        break;
      case '>':
        html += "&gt;";
        break;
      case '&':
        html += "&amp;";
        break;
      case '"':
        html += "&quot;";
        break;
      default:
        html += c;
    }
  }
  return html;
}

std::string base64(std::span<const std::uint8_t> bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    unsigned triple = 0;
    for (std::size_t j = 0; j < 3; ++j) triple = triple << 8 | (j < count ? bytes[i + j] : 0u);
    for (std::size_t j = 0; j < 4; ++j) text += j <= count ? kDigits[triple >> (18 - 6 * j) & 63u] : '=';
  }
  return text;
}

std::string jpegUri(const cv::Mat3b& bgr, std::size_t most_bytes) {
  constexpr std::array<int, 4> kQualities = {85, 70, 55, 40};
  cv::Mat3b picture = bgr;
  std::vector<std::uint8_t> jpeg;
  while (true) {
    for (const int quality : kQualities) {
      cv::imencode(".jpg", picture, jpeg, {cv::IMWRITE_JPEG_QUALITY, quality});
      if (jpeg.size() <= most_bytes) return "data:image/jpeg;base64," + base64(jpeg);
    }
    cv::Mat3b smaller;
    cv::resize(picture, smaller, {}, 0.5, 0.5, cv::INTER_AREA);
    picture = smaller;
  }
}

std::string jsonForScript(const nlohmann::ordered_json& json) {
  const std::string dumped = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  std::string text;
  for (const char c : dumped) text += c == '<' ? std::string("\\u003c") : std::string(1, c);
  return text;
}

}  // namespace saccade
