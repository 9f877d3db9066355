#include "sources/image_names.hpp"

#include <charconv>
#include <string_view>

#include "sources/text_numbers.hpp"

namespace saccade {
namespace {

constexpr std::string_view kDigits = "0123456789";

}  // namespace

std::map<std::string, std::filesystem::path> imagesByName(const std::filesystem::path& folder) {
  std::map<std::string, std::filesystem::path> images;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension == ".png" || extension == ".jpg" || extension == ".jpeg" || extension == ".depth") {
      images[entry.path().stem().string()] = entry.path();
    }
  }
  return images;
}

std::map<std::int64_t, std::filesystem::path> imagesByNumber(const std::filesystem::path& folder) {
  std::map<std::int64_t, std::filesystem::path> images;
  for (const auto& [name, path] : imagesByName(folder)) {
    if (const std::optional<std::int64_t> number = firstNumber(name)) images.emplace(*number, path);
  }
  return images;
}

std::optional<std::int64_t> firstNumber(const std::string& name) {
  const std::size_t first = name.find_first_of(kDigits);
  if (first == std::string::npos) return std::nullopt;
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(name.data() + first, name.data() + name.size(), number);
  if (error != std::errc()) return std::nullopt;
  return number;
}

std::optional<double> trailingNumber(const std::string& name) {
  const std::size_t last = name.find_last_not_of(kDigits);
  return parseNumber(std::string_view(name).substr(last == std::string::npos ? 0 : last + 1));
}

}  // namespace saccade
