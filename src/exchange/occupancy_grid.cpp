#include "saccade/exchange/occupancy_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <ostream>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

namespace saccade {
namespace {

struct LeafCube {
  Eigen::Vector3d corner_W;
  double edge_m;
  bool occupied;
};

std::vector<LeafCube> listCubes(const IorMap& map) {
  std::vector<LeafCube> cubes;
  const MapTree tree = map.view();
  map.forEachLeaf([&](const MapLeaf& leaf) {
    const LeafKey& corner = leaf.key.corner;
    const Eigen::Vector3d steps(corner.x - MapTree::kCentreKey, corner.y - MapTree::kCentreKey,
                                corner.z - MapTree::kCentreKey);
    cubes.push_back({steps * tree.leaf_size_m, tree.nodeSize_m(leaf.key.depth), leaf.occupied});
  });
  return cubes;
}

/// Rotation to the frame G: z along `up`, x along what is horizontal of the first camera's view (of W's x axis if the
/// camera looks straight up or down).
Pose levelFrame(const Eigen::Vector3d& up_W) {
  Eigen::Vector3d forward = Eigen::Vector3d::UnitZ() - up_W * up_W.z();
  if (forward.norm() < 0.1) forward = Eigen::Vector3d::UnitX() - up_W * up_W.x();
  const Eigen::Vector3d x = forward.normalized();
  Pose T_GW = Pose::Identity();
  T_GW.linear().row(0) = x;
  T_GW.linear().row(1) = up_W.cross(x);
  T_GW.linear().row(2) = up_W;
  return T_GW;
}

/// Height under which the lowest hundredth of the occupied leaves lies: the floor, or the lowest thing seen. Single
/// leaves below it are noise.
double lowestHeight(const std::vector<LeafCube>& cubes, const Pose& T_GW) {
  std::vector<double> heights;
  for (const LeafCube& cube : cubes) {
    if (!cube.occupied) continue;
    heights.push_back((T_GW * (cube.corner_W + Eigen::Vector3d::Constant(cube.edge_m / 2))).z());
  }
  if (heights.empty()) return 0.0;
  const auto place = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 100);
  std::nth_element(heights.begin(), place, heights.end());
  return *place;
}

/// Calls `visit` with points in G that fill the cube so densely that no cell under it is passed over.
template <typename Visit>
void samplePoints(const LeafCube& cube, const Pose& T_GW, double cell_m, const Visit& visit) {
  const int steps = std::max(1, static_cast<int>(std::ceil(2.0 * cube.edge_m / cell_m)));
  const double step_m = cube.edge_m / steps;
  for (int i = 0; i < steps; ++i) {
    for (int j = 0; j < steps; ++j) {
      for (int k = 0; k < steps; ++k) {
        visit(T_GW * (cube.corner_W + Eigen::Vector3d(i + 0.5, j + 0.5, k + 0.5) * step_m));
      }
    }
  }
}

/// Whether any part of the cube can lie within the band.
bool reachesBand(const LeafCube& cube, const Pose& T_GW, double lowest_m, double highest_m) {
  const double radius = 0.5 * std::sqrt(3.0) * cube.edge_m;
  const double height = (T_GW * (cube.corner_W + Eigen::Vector3d::Constant(cube.edge_m / 2))).z();
  return height + radius >= lowest_m && height - radius <= highest_m;
}

void requireUsable(const OccupancyGridSettings& settings) {
  if (!(settings.lowest_m < settings.highest_m)) {
    throw std::invalid_argument(
        fmt::format("a height band from {} to {} m holds nothing", settings.lowest_m, settings.highest_m));
  }
  if (!(std::abs(settings.up_W.norm() - 1.0) < 1e-6)) {
    throw std::invalid_argument(fmt::format("the up vector has length {}, expected 1", settings.up_W.norm()));
  }
  if (!(settings.cell_m > 0.0)) throw std::invalid_argument(fmt::format("a cell of {} m", settings.cell_m));
}

}  // namespace

OccupancyGrid makeOccupancyGrid(const IorMap& map, const OccupancyGridSettings& settings) {
  requireUsable(settings);
  std::vector<LeafCube> cubes = listCubes(map);
  OccupancyGrid grid;
  grid.cell_m = settings.cell_m;
  grid.T_GW = levelFrame(settings.up_W);
  grid.T_GW.pretranslate(Eigen::Vector3d(0, 0, -lowestHeight(cubes, grid.T_GW)));
  std::erase_if(cubes, [&](const LeafCube& cube) {
    return !reachesBand(cube, grid.T_GW, settings.lowest_m, settings.highest_m);
  });

  Eigen::AlignedBox2d bounds;
  for (const LeafCube& cube : cubes) {
    const Eigen::Vector3d centre = grid.T_GW * (cube.corner_W + Eigen::Vector3d::Constant(cube.edge_m / 2));
    const Eigen::Vector2d reach = Eigen::Vector2d::Constant(0.5 * std::sqrt(3.0) * cube.edge_m);
    bounds.extend(centre.head<2>() - reach).extend(centre.head<2>() + reach);
  }
  if (bounds.isEmpty()) bounds = Eigen::AlignedBox2d(Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero());
  const Eigen::Vector2d lowest = (bounds.min() / settings.cell_m).array().floor();
  const Eigen::Vector2d cells = (bounds.max() / settings.cell_m).array().floor() - lowest.array() + 1.0;
  constexpr double kMostCells = 1 << 28;
  if (!(cells.x() * cells.y() <= kMostCells)) {
    throw std::invalid_argument(fmt::format("a grid of {:.0f} x {:.0f} cells of {} m; the cells must be larger",
                                            cells.x(), cells.y(), settings.cell_m));
  }
  grid.origin_G = lowest * settings.cell_m;
  grid.cells = cv::Mat1b(static_cast<int>(cells.y()), static_cast<int>(cells.x()), OccupancyGrid::kUnknown);
  for (const LeafCube& cube : cubes) {
    const std::uint8_t state = cube.occupied ? OccupancyGrid::kOccupied : OccupancyGrid::kFree;
    samplePoints(cube, grid.T_GW, settings.cell_m, [&](const Eigen::Vector3d& p_G) {
      if (p_G.z() < settings.lowest_m || p_G.z() > settings.highest_m) return;
      const int column = static_cast<int>(std::floor((p_G.x() - grid.origin_G.x()) / settings.cell_m));
      const int row =
          grid.cells.rows - 1 - static_cast<int>(std::floor((p_G.y() - grid.origin_G.y()) / settings.cell_m));
      std::uint8_t& cell = grid.cells(row, column);
      if (cell != OccupancyGrid::kOccupied) cell = state;
    });
  }
  return grid;
}

void writePgm(const OccupancyGrid& grid, std::ostream& out) {
  out << "P5\n" << grid.cells.cols << " " << grid.cells.rows << "\n255\n";
  for (int row = 0; row < grid.cells.rows; ++row) {
    out.write(reinterpret_cast<const char*>(grid.cells.ptr(row)), grid.cells.cols);
  }
}

void writeGridYaml(const OccupancyGrid& grid, const std::string& image, std::ostream& out) {
  out << "# Floor plan for map_server, written by saccade. Row by row, the 3 x 4 transform from the session's world "
         "frame:\n";
  for (int row = 0; row < 3; ++row) {
    const auto& m = grid.T_GW.matrix();
    out << fmt::format("#   {:.9f} {:.9f} {:.9f} {:.9f}\n", m(row, 0), m(row, 1), m(row, 2), m(row, 3));
  }
  out << fmt::format(
      "image: {}\nmode: trinary\nresolution: {}\norigin: [{}, {}, 0.0]\nnegate: 0\noccupied_thresh: 0.65\n"
      "free_thresh: 0.196\n",
      image, grid.cell_m, grid.origin_G.x(), grid.origin_G.y());
}

}  // namespace saccade
