#pragma once

#include <cstdint>
#include <filesystem>
#include <istream>
#include <string>

namespace saccade {

/// What the text at the head of an OctoMap file says.
struct OctomapHeader {
  bool binary = false;      ///< `.bt`: two bits a child
  std::string tree_type;    ///< "id"
  std::uint64_t nodes = 0;  ///< "size"
  double leaf_size_m = 0;   ///< "res"
  std::uint32_t tick = 0;   ///< of an IorOcTree of ours, from a comment
};

/// Reads the header up to and with its "data" line. Throws IoError naming `path` for anything that is not the header of
/// an OctoMap file, or the header of the other kind than the name says (`.ot`, `.bt`).
[[nodiscard]] OctomapHeader readOctomapHeader(std::istream& in, const std::filesystem::path& path);

}  // namespace saccade
