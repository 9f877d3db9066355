#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "saccade/core/frame.hpp"
#include "saccade/map/ior_map.hpp"

namespace saccade {

/// What part of a map becomes a floor plan.
struct OccupancyGridSettings {
  Eigen::Vector3d up_W = Eigen::Vector3d::UnitZ();  ///< unit length
  double lowest_m = 0.1;                            ///< of the height band, above the lowest occupied leaves
  double highest_m = 1.8;
  double cell_m = 0.05;
};

/// A floor plan in the frame G: z up, the origin on the lowest occupied leaves under the origin of W, x along the
/// horizontal part of the first camera's view.
struct OccupancyGrid {
  enum Cell : std::uint8_t { kOccupied = 0, kUnknown = 205, kFree = 254 };  ///< grey values of map_server
  cv::Mat1b cells;  ///< row 0 is the far end along y, as in the picture
  double cell_m = 0.0;
  Eigen::Vector2d origin_G;  ///< lower left corner of the lower left cell, metres
  Pose T_GW = Pose::Identity();
};

/// The floor plan of a map: a cell is occupied if an occupied leaf lies over it within the height band, else free if a
/// free one does, else unknown. Cost: the known volume within the band over the cell's size cubed.
/// Throws std::invalid_argument for an empty band, an up vector that is not of unit length, a cell that is not
/// positive, and for a grid of more than 2^28 cells.
[[nodiscard]] OccupancyGrid makeOccupancyGrid(const IorMap& map, const OccupancyGridSettings& settings);

/// The cells as a binary PGM.
void writePgm(const OccupancyGrid& grid, std::ostream& out);
/// What map_server needs beside the picture named `image`; T_GW stands in it as a comment.
void writeGridYaml(const OccupancyGrid& grid, const std::string& image, std::ostream& out);

}  // namespace saccade
