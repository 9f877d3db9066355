#include "exchange/octomap_header.hpp"

#include <charconv>
#include <optional>
#include <string_view>

#include "saccade/core/errors.hpp"

namespace saccade {
namespace {

constexpr std::size_t kLongestLine = 4096;
constexpr int kMostLines = 1000;

/// The next line without its end; none at the end of the file or when a line is too long to be a header's.
std::optional<std::string> readLine(std::istream& in) {
  std::string line;
  for (int c = in.get(); c != std::istream::traits_type::eof(); c = in.get()) {
    if (c == '\n') return line;
    if (line.size() == kLongestLine) return std::nullopt;
    line.push_back(static_cast<char>(c));
  }
  return std::nullopt;
}

template <typename Number>
Number numberOf(std::string_view text, const char* field, const std::filesystem::path& path) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) {
    throw IoError(path, std::string("a number for \"") + field + "\" in the header", "\"" + std::string(text) + "\"");
  }
  return number;
}

bool readFirstLine(std::istream& in, const std::filesystem::path& path) {
  const std::optional<std::string> line = readLine(in);
  const bool binary = line && line->starts_with("# Octomap OcTree binary file");
  if (!binary && !(line && line->starts_with("# Octomap OcTree file"))) {
    throw IoError(path, "an OctoMap file (first line \"# Octomap OcTree file\" or \"# Octomap OcTree binary file\")",
                  "something else");
  }
  const std::string extension = path.extension().string();
  if (binary && extension == ".ot") throw IoError(path, "an .ot file", "a .bt file by that name: rename it to .bt");
  if (!binary && extension == ".bt") throw IoError(path, "a .bt file", "an .ot file by that name: rename it to .ot");
  return binary;
}

}  // namespace

OctomapHeader readOctomapHeader(std::istream& in, const std::filesystem::path& path) {
  constexpr std::string_view kTickComment = "# saccade tick ";
  OctomapHeader header;
  header.binary = readFirstLine(in, path);
  bool has_nodes = false, has_leaf_size = false;
  for (int count = 0; count < kMostLines; ++count) {
    const std::optional<std::string> line = readLine(in);
    if (!line) throw IoError(path, "a header that ends with a line \"data\"", "none");
    const std::string_view text = *line;
    const std::size_t space = text.find(' ');
    const std::string_view key = text.substr(0, space);
    const std::string_view value = space == std::string_view::npos ? "" : text.substr(space + 1);
    if (key == "data") {
      if (header.tree_type.empty() || !has_nodes || !has_leaf_size) {
        throw IoError(path, "a header with \"id\", \"size\" and \"res\"", "one without");
      }
      return header;
    }
    if (text.starts_with(kTickComment)) {
      header.tick = numberOf<std::uint32_t>(text.substr(kTickComment.size()), "saccade tick", path);
    } else if (key == "id") {
      header.tree_type = value;
    } else if (key == "size") {
      header.nodes = numberOf<std::uint64_t>(value, "size", path);
      has_nodes = true;
    } else if (key == "res") {
      header.leaf_size_m = numberOf<double>(value, "res", path);
      has_leaf_size = true;
    }  // other keywords are skipped, as OctoMap does
  }
  throw IoError(path, "a header of at most " + std::to_string(kMostLines) + " lines", "a longer one");
}

}  // namespace saccade
