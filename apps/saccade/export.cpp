#include <algorithm>
#include <array>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "commands.hpp"
#include "saccade/core/errors.hpp"
#include "saccade/exchange/coco_json.hpp"
#include "saccade/exchange/map_points.hpp"
#include "saccade/exchange/mrpt_scene.hpp"
#include "saccade/exchange/occupancy_grid.hpp"
#include "saccade/exchange/octomap_files.hpp"
#include "saccade/exchange/output_file.hpp"
#include "saccade/inspection/up_direction.hpp"
#include "saccade/objects/object_memory.hpp"
#include "saccade/pipeline/trajectory_sink.hpp"
#include "saccade/session/session_map.hpp"

namespace saccade::app {
namespace {

struct Options {
  std::string session, output, kind, paint = "color";
  bool force = false;
  std::vector<double> up, band = {0.1, 1.8};
  double cell_m = 0.05;
};

struct Kind {
  const char* name;
  const char* extension;  ///< the file names that mean it without --to
  const char* what;
};

constexpr std::array<Kind, 10> kKinds = {{
    {"ot", ".ot", "octree with the attention memory (IorOcTree)"},
    {"color-ot", "", "painted octree (ColorOcTree)"},
    {"bt", ".bt", "octree of free and occupied"},
    {"ply", ".ply", "points"},
    {"pcd", ".pcd", "points"},
    {"3dscene", ".3Dscene", "MRPT scene"},
    {"tum", ".txt", "trajectory in TUM format"},
    {"coco", ".json", "candidates as a COCO dataset"},
    {"grid", ".pgm", "floor plan for map_server"},
    {"objects", "", "a folder of points, one PLY for each object"},
}};

std::string kindOf(const Options& options) {
  if (!options.kind.empty()) return options.kind;
  const std::string extension = std::filesystem::path(options.output).extension().string();
  const auto kind = std::find_if(kKinds.begin(), kKinds.end(),
                                 [&](const Kind& k) { return *k.extension != '\0' && extension == k.extension; });
  if (kind != kKinds.end()) return kind->name;
  std::string known;
  for (const Kind& k : kKinds) known += std::string(known.empty() ? "" : ", ") + k.name;
  throw std::invalid_argument("export: \"" + options.output + "\" does not say what to write; name it with --to (" +
                              known + ")");
}

/// A session with what its formats are made of, each loaded when it is first asked for.
class Exported {
 public:
  explicit Exported(const std::string& path) : session_(path) {}

  [[nodiscard]] const SessionReader& session() const { return session_; }
  const IorMap& map() {
    if (!map_) map_.emplace(loadMap(session_));
    return *map_;
  }

 private:
  SessionReader session_;
  std::optional<IorMap> map_;
};

void writeTrajectory(const SessionReader& session, std::ostream& out) {
  out << kTumHeading;
  for (const FrameRecord& frame : session.frames()) {
    if (frame.tracking == "tracked" && frame.T_WC) writeTumPose(out, frame.stamp_s, *frame.T_WC);
  }
}

SceneContent sceneOf(Exported& from, std::span<const MapPoint> points) {
  SceneContent content;
  content.leaves = points;
  for (const FrameRecord& frame : from.session().frames()) {
    if (frame.T_WC) content.path.push_back(*frame.T_WC);
  }
  constexpr int kOften = 5;  // looks; boxes of all objects would hide the map
  for (const AttendedObject& object : findObjects(from.session(), kOften)) {
    const Eigen::AlignedBox3d box = boxOf(leavesOf(object, from.map()), from.map().config().leaf_size_m);
    if (!box.isEmpty()) content.object_boxes.push_back(box);
  }
  return content;
}

/// The picture and, beside it, the YAML file; neither is there without the other being whole.
void writeGrid(const Options& options, Exported& from, WhenFileExists when_exists, OutputFile& picture) {
  OccupancyGridSettings settings;
  settings.lowest_m = options.band[0];
  settings.highest_m = options.band[1];
  settings.cell_m = options.cell_m;
  if (options.up.empty()) {
    settings.up_W = estimateUp(from.map().view(), from.session().frames());
  } else {
    settings.up_W = Eigen::Vector3d(options.up[0], options.up[1], options.up[2]);
    if (!(settings.up_W.norm() > 0.0)) throw std::invalid_argument("export: --up 0 0 0 is no direction");
    settings.up_W.normalize();
  }
  const OccupancyGrid grid = makeOccupancyGrid(from.map(), settings);
  OutputFile yaml(std::filesystem::path(options.output).replace_extension(".yaml"), when_exists);
  writePgm(grid, picture.stream());
  writeGridYaml(grid, std::filesystem::path(options.output).filename().string(), yaml.stream());
  picture.finish();
  yaml.finish();
  std::cerr << fmt::format("floor plan of {} x {} cells, up is {:.3f} {:.3f} {:.3f} in the world frame\n",
                           grid.cells.cols, grid.cells.rows, settings.up_W.x(), settings.up_W.y(), settings.up_W.z());
}

/// A PLY for each object with leaves: object-0007.ply.
void writeObjects(const Options& options, Exported& from, LeafPaint paint, WhenFileExists when_exists) {
  const std::filesystem::path folder = options.output;
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure) throw IoError(folder, "a folder that can be made", failure.message());
  int written = 0;
  for (const AttendedObject& object : findObjects(from.session())) {
    const auto within = [&](const MapLeaf& leaf) {
      return std::binary_search(object.blocks.begin(), object.blocks.end(), blockOf(leaf.key.corner));
    };
    const std::vector<MapPoint> points = occupiedPoints(from.map(), paint, within);
    if (points.empty()) continue;  // it is gone
    OutputFile file(folder / fmt::format("object-{:04}.ply", object.id.value), when_exists);
    writePly(points, file.stream());
    file.finish();
    ++written;
  }
  std::cerr << written << " objects\n";
}

void run(const Options& options) {
  const std::string kind = kindOf(options);
  const LeafPaint paint = options.paint == "ior" ? LeafPaint::kIor : LeafPaint::kColor;
  const auto when_exists = options.force ? WhenFileExists::kReplace : WhenFileExists::kRefuse;
  Exported from(options.session);
  if (kind == "objects") {
    writeObjects(options, from, paint, when_exists);
    return;
  }
  OutputFile file(options.output, when_exists);
  if (kind == "grid") {
    writeGrid(options, from, when_exists, file);
  } else {
    std::ostream& out = file.stream();
    if (kind == "ot") writeIorOctree(from.map(), out);
    if (kind == "color-ot") writeColorOctree(from.map(), paint, out);
    if (kind == "bt") writeBinaryOctree(from.map(), out);
    if (kind == "ply") writePly(occupiedPoints(from.map(), paint), out);
    if (kind == "pcd") writePcd(occupiedPoints(from.map(), paint), out);
    if (kind == "tum") writeTrajectory(from.session(), out);
    if (kind == "coco") writeCocoJson(from.session(), out);
    if (kind == "3dscene") {
      const std::vector<MapPoint> points = occupiedPoints(from.map(), paint);
      writeMrptScene(sceneOf(from, points), file.partialPath());
    }
    file.finish();
  }
  std::cerr << "written: " << std::filesystem::absolute(options.output).lexically_normal().string() << "\n";
}

std::string kindsHelp() {
  std::string text = "what to write, where the name does not say it:";
  for (const Kind& kind : kKinds) text += std::string(" ") + kind.name + " (" + kind.what + ")";
  return text;
}

}  // namespace

void addExport(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("export", "Write a session's map, poses or candidates in other formats");
  command->add_option("SESSION", options->session, "a session (*.saccade)")->required();
  command
      ->add_option("OUT", options->output,
                   "the file to write; .ot .bt .ply .pcd .3Dscene .txt .json and .pgm (with a .yaml) say what it is")
      ->required();
  std::vector<std::string> names;
  for (const Kind& kind : kKinds) names.emplace_back(kind.name);
  command->add_option("--to", options->kind, kindsHelp())->check(CLI::IsMember(names));
  command->add_option("--paint", options->paint, "colour of leaves: as seen (color), or their attention memory (ior)")
      ->check(CLI::IsMember({"color", "ior"}));
  command->add_option("--up", options->up, "grid: which way is up in the world frame (default: estimated)")
      ->expected(3);
  command->add_option("--height-band", options->band, "grid: heights above the floor that count, metres")->expected(2);
  command->add_option("--cell", options->cell_m, "grid: edge of a cell, metres")->check(CLI::PositiveNumber);
  command->add_flag("--force", options->force, "replace a file that exists");
  command->callback([options] { run(*options); });
}

}  // namespace saccade::app
