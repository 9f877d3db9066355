#pragma once

#include <cstddef>
#include <filesystem>
#include <iosfwd>
#include <string>

#include "saccade/exchange/ior_paint.hpp"
#include "saccade/map/ior_map.hpp"

/// OctoMap's own file formats, out of and into a map.
///
/// Writers give OctoMap's header with the leaf size in full precision, and after it the nodes as OctoMap's library
/// writes them. They do not check the stream: OctoMap itself reports success on a full disk, so OutputFile looks.
namespace saccade {

/// `.ot` of type IorOcTree: all that a leaf holds, and the tick as a comment. Opens with this library only.
void writeIorOctree(const IorMap& map, std::ostream& out);

/// `.ot` of type ColorOcTree, which stock octovis opens: log-odds and the painted colour of each leaf.
void writeColorOctree(const IorMap& map, LeafPaint paint, std::ostream& out);

/// `.bt`: free or occupied and nothing else, at the most likely state, pruned.
void writeBinaryOctree(const IorMap& map, std::ostream& out);

/// Bounds of readOctomap(): a file beyond them is refused before memory is taken.
struct OctomapLimits {
  std::size_t nodes = std::size_t{1} << 26;  ///< inner ones included: 1.6 GiB of map
};

/// A map that another program wrote.
struct ForeignMap {
  IorMap map;
  std::string tree_type;  ///< as the file names it: OcTree, ColorOcTree, IorOcTree
  bool binary = false;    ///< a `.bt`
};

/// Reads an `.ot` (OcTree, ColorOcTree or IorOcTree) or `.bt` file into a map with the file's leaf size and otherwise
/// the settings of `config`. Log-odds are clamped to them; coarse leaves stay coarse; colours become surfaces with one
/// observation; an IorOcTree of ours brings its attention memory and tick.
///
/// Unlike OctoMap's readers it does not recurse without limit, notices a file that ends early or late, and believes no
/// number of the file before it is checked. Throws IoError naming path, expected and found for everything that is not
/// one whole file of these kinds, a `.bt` named `.ot` included. Memory: the map, at most limits.nodes.
[[nodiscard]] ForeignMap readOctomap(const std::filesystem::path& path, const IorMapConfig& config = {},
                                     const OctomapLimits& limits = {});

}  // namespace saccade
