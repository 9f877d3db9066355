#include "sources/range_image_text.hpp"

#include <charconv>
#include <fstream>
#include <sstream>

#include "saccade/core/errors.hpp"

namespace saccade {

void readRangeImageText(const std::filesystem::path& path, const cv::Size& size, cv::Mat1f& range_m) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw IoError(path, "a range image", "nothing that can be read");
  std::stringstream content;
  content << file.rdbuf();
  const std::string text = std::move(content).str();
  range_m.create(size);
  const auto expected = static_cast<std::size_t>(size.area());
  const std::string expectation = std::to_string(expected) + " distances in metres (" + std::to_string(size.width) +
                                  " x " + std::to_string(size.height) + ")";
  const char* at = text.data();
  const char* const end = at + text.size();
  const auto skipBlanks = [&] {
    while (at != end && (*at == ' ' || *at == '\t' || *at == '\n' || *at == '\r')) ++at;
  };
  float* out = range_m[0];
  for (std::size_t i = 0; i < expected; ++i) {
    skipBlanks();
    const auto [stop, error] = std::from_chars(at, end, out[i]);
    if (error != std::errc()) {
      throw IoError(path, expectation, std::to_string(i) + (at == end ? "" : " and something that is no number"));
    }
    at = stop;
  }
  skipBlanks();
  if (at != end) throw IoError(path, expectation, "more than that");
}

}  // namespace saccade
