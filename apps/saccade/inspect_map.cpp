#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "inspect.hpp"
#include "saccade/exchange/output_file.hpp"
#include "saccade/inspection/leaf_histogram.hpp"
#include "saccade/inspection/map_slice.hpp"
#include "saccade/objects/object_memory.hpp"
#include "saccade/session/session_map.hpp"
#include "saccade/session/session_snapshot.hpp"
#include "terminal.hpp"

namespace saccade::app {
namespace {

using Json = nlohmann::ordered_json;

/// What is known of one point.
struct PointAnswer {
  Eigen::Vector3d p_W;
  LeafKey key;
  Eigen::Vector3d centre;
  std::optional<MapLeaf> leaf;
  double leaf_size_m = 0.0;
  Tick now;
  std::vector<AttendedBy> attentions;
  std::optional<ObjectId> object;

  [[nodiscard]] const char* state() const { return !leaf ? "unknown" : leaf->occupied ? "occupied" : "free"; }
  [[nodiscard]] double edge_m() const {
    return leaf ? leaf_size_m * static_cast<double>(1 << (MapTree::kDepth - leaf->key.depth)) : leaf_size_m;
  }
  [[nodiscard]] double probability() const { return 1.0 / (1.0 + std::exp(-static_cast<double>(leaf->log_odds))); }
};

/// The attentions of the leaf at `key`, oldest first; where blocks are attended whole, those of its block.
std::vector<AttendedBy> attentionsAt(LeafKey key, const AttendLog& log, const IorMap& map) {
  if (!map.config().attend_blocks) return log.attentionsOf(key);
  std::vector<AttendedBy> all;
  for (int i = 0; i < 8; ++i) {
    const auto part = [&](std::uint16_t low, int bit) {
      return static_cast<std::uint16_t>((low & 0xFFFEu) + (static_cast<unsigned>(i) >> bit & 1u));
    };
    const std::vector<AttendedBy> some = log.attentionsOf({part(key.x, 0), part(key.y, 1), part(key.z, 2)});
    all.insert(all.end(), some.begin(), some.end());
  }
  const auto order = [](const AttendedBy& by) { return std::pair(by.tick, by.rank); };
  std::sort(all.begin(), all.end(), [&](const auto& a, const auto& b) { return order(a) < order(b); });
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

PointAnswer ask(const std::string& path, const std::vector<double>& point) {
  PointAnswer answer;
  answer.p_W = Eigen::Vector3d(point[0], point[1], point[2]);
  const SessionReader session(path);
  const SessionSnapshot still(session);
  const IorMap map = loadMap(session);
  answer.leaf_size_m = map.config().leaf_size_m;
  const std::optional<LeafKey> key = answer.p_W.allFinite() ? map.keyAt(answer.p_W) : std::nullopt;
  if (!key) {
    throw std::invalid_argument(
        fmt::format("inspect query: expected a point within {:g} m of the origin, found {} {} {}",
                    MapTree::kCentreKey * answer.leaf_size_m, point[0], point[1], point[2]));
  }
  answer.key = *key;
  answer.centre = map.centre(*key);
  answer.leaf = map.findLeaf(*key);
  answer.now = map.now();
  const AttendLog log = loadAttendLog(session);
  answer.attentions = attentionsAt(*key, log, map);
  for (const AttendedObject& object : findObjects(log)) {
    if (std::binary_search(object.blocks.begin(), object.blocks.end(), blockOf(*key))) answer.object = object.id;
  }
  return answer;
}

Json jsonOf(const Eigen::Vector3d& v) {
  return Json::array({v.x(), v.y(), v.z()});
}

Json jsonOf(const MapLeaf& leaf, const PointAnswer& answer) {
  const Eigen::Vector3f normal = leaf.surface.normal();
  const std::uint32_t left = weight(leaf.ior, answer.now);
  return {{"edge_m", answer.edge_m()},
          {"log_odds", leaf.log_odds},
          {"probability", answer.probability()},
          {"color_rgb", {leaf.surface.red, leaf.surface.green, leaf.surface.blue}},
          {"normal", normal.isZero() ? Json(nullptr) : jsonOf(normal.cast<double>())},
          {"observations", leaf.surface.observations},
          {"ior_weight", left},
          {"inhibited", inhibited(leaf.ior, answer.now)},
          {"familiar", isFamiliar(leaf.ior, answer.now)},
          {"forgotten_at_tick", left > 0 ? Json(leaf.ior.expiry()) : Json(nullptr)}};
}

void printJson(const PointAnswer& answer) {
  Json attentions = Json::array();
  for (const AttendedBy& by : answer.attentions) {
    attentions.push_back({{"tick", by.tick.value}, {"frame", by.frame.value}, {"rank", by.rank}});
  }
  const Json json = {{"schema", kInspectSchema},
                     {"point", jsonOf(answer.p_W)},
                     {"tick", answer.now.value},
                     {"state", answer.state()},
                     {"key", {answer.key.x, answer.key.y, answer.key.z}},
                     {"centre", jsonOf(answer.centre)},
                     {"leaf", answer.leaf ? jsonOf(*answer.leaf, answer) : Json(nullptr)},
                     {"object", answer.object ? Json(answer.object->value) : Json(nullptr)},
                     {"attentions", attentions}};
  std::cout << json.dump(2) << "\n";
}

std::string attentionText(IorState ior, Tick now) {
  if (!wasAttended(ior)) return "never attended";
  if (isFamiliar(ior, now)) return "forgotten, but familiar";
  return fmt::format("{}, forgotten at tick {}, in {} ticks", inhibited(ior, now) ? "inhibited" : "remembered",
                     ior.expiry(), weight(ior, now));
}

void printText(const PointAnswer& answer) {
  std::vector<std::vector<std::string>> rows = {
      {"point", fmt::format("{:g} {:g} {:g} m in W", answer.p_W.x(), answer.p_W.y(), answer.p_W.z())},
      {"leaf", fmt::format("{}, edge {:g} cm", answer.state(), answer.edge_m() * 100.0)}};
  if (answer.leaf) rows.push_back({"occupancy", fixed(answer.probability(), 3)});
  if (answer.leaf && answer.leaf->occupied) {
    const LeafSurface& surface = answer.leaf->surface;
    const Eigen::Vector3f n = surface.normal();
    rows.push_back({"colour", fmt::format("#{:02x}{:02x}{:02x}", surface.red, surface.green, surface.blue)});
    rows.push_back({"normal", n.isZero() ? "none" : fmt::format("{:.2f} {:.2f} {:.2f}", n.x(), n.y(), n.z())});
    rows.push_back({"seen in", fmt::format("{} frames", surface.observations)});
    rows.push_back({"attention", attentionText(answer.leaf->ior, answer.now)});
  }
  rows.push_back({"object", answer.object ? std::to_string(answer.object->value) : "none"});
  rows.push_back({"attended", grouped(static_cast<std::int64_t>(answer.attentions.size())) + " times until tick " +
                                  std::to_string(answer.now.value)});
  std::cout << alignedTable(rows);
  for (const AttendedBy& by : answer.attentions) {
    std::cout << fmt::format("    tick {:>6}  frame {}, rank {}\n", by.tick.value, by.frame.value, by.rank);
  }
}

struct SliceOptions {
  std::optional<double> x, y, z;
  std::string output;
  bool force = false;

  [[nodiscard]] SlicePlane plane() const {
    if (x) return {0, *x};
    if (y) return {1, *y};
    return {2, *z};
  }
};

char symbolOf(std::uint8_t state) {
  constexpr char kSymbols[kCellStates] = {' ', '.', 'o', 'a', '#'};
  return kSymbols[state];
}

std::string lineOf(const cv::Mat1b& cells, int row) {
  std::string line;
  for (int u = 0; u < cells.cols; ++u) line += symbolOf(cells(row, u));
  return line;
}

void printJson(const MapSlice& slice) {
  constexpr const char* kAxes[] = {"x", "y", "z"};
  Json counts = Json::object(), rows = Json::array();
  const auto count = slice.counts();
  for (std::size_t i = 0; i < kCellStates; ++i) counts[nameOf(static_cast<CellState>(i))] = count[i];
  for (int v = 0; v < slice.cells.rows; ++v) rows.push_back(lineOf(slice.cells, v));
  const Json json = {
      {"schema", kInspectSchema},
      {"plane", {{"axis", kAxes[slice.plane.axis]}, {"at_m", slice.plane.at_m}}},
      {"cell_m", slice.cell_m},
      {"columns", {{"axis", kAxes[slice.column_axis]}, {"first_m", slice.first_column_m}, {"step_m", slice.cell_m}}},
      {"rows", {{"axis", kAxes[slice.row_axis]}, {"first_m", slice.first_row_m}, {"step_m", slice.row_step_m}}},
      {"counts", counts},
      {"cells", rows}};
  std::cout << json.dump(2) << "\n";
}

void printText(const MapSlice& slice) {
  // Characters are about twice as high as wide.
  constexpr int kColumns = 100;
  const int columns = std::min(kColumns, slice.cells.cols);
  const int rows = slice.cells.cols == 0 ? 0 : std::max(1, slice.cells.rows * columns / (2 * slice.cells.cols));
  const cv::Mat1b cells = shrinkCells(slice.cells, columns, rows);
  for (int v = 0; v < cells.rows; ++v) {
    std::string line = lineOf(cells, v);
    line.erase(line.find_last_not_of(' ') + 1);
    std::cout << line << "\n";
  }
  const auto counts = slice.counts();
  std::cout << fmt::format("{} x {} cells of {:g} cm:", slice.cells.cols, slice.cells.rows, slice.cell_m * 100.0);
  for (std::size_t i = 1; i < kCellStates; ++i) {
    std::cout << fmt::format("{} {} {} ({})", i == 1 ? "" : ",", grouped(counts[i]), nameOf(static_cast<CellState>(i)),
                             symbolOf(static_cast<std::uint8_t>(i)));
  }
  std::cout << "\n";
}

void cut(const InspectTarget& target, const SliceOptions& options) {
  std::optional<OutputFile> file;  // made first: an output that cannot be written is said before the map is read
  if (!options.output.empty()) {
    file.emplace(options.output, options.force ? WhenFileExists::kReplace : WhenFileExists::kRefuse);
  }
  const IorMap map = loadMap(SessionReader(target.session));
  const MapSlice slice = sliceMap(map.view(), options.plane());
  if (file) {
    std::vector<std::uint8_t> png;
    cv::imencode(".png", paintSlice(slice), png);
    file->stream().write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
    file->finish();
    std::cerr << "written: " << std::filesystem::absolute(options.output).lexically_normal().string() << "\n";
  }
  if (target.json) {
    printJson(slice);
  } else {
    printText(slice);
  }
}

void printHistogramJson(const LeafHistogram& histogram, const std::string& quantity, Tick now) {
  Json bins = Json::array();
  for (std::size_t i = 0; i < histogram.counts.size(); ++i) {
    const double from = histogram.lowest + histogram.step * static_cast<double>(i);
    bins.push_back({{"from", from}, {"to", from + histogram.step}, {"leaves", histogram.counts[i]}});
  }
  const Json json = {
      {"schema", kInspectSchema},     {"of", quantity},         {"tick", now.value}, {"leaves", histogram.leaves},
      {"without", histogram.without}, {"mean", histogram.mean}, {"bins", bins}};
  std::cout << json.dump(2) << "\n";
}

void printHistogramText(const LeafHistogram& histogram, const std::string& quantity) {
  constexpr double kBarWidth = 50.0;
  std::vector<std::vector<std::string>> rows;
  const auto most = histogram.counts.empty() ? 1 : *std::max_element(histogram.counts.begin(), histogram.counts.end());
  for (std::size_t i = 0; i < histogram.counts.size(); ++i) {
    const double from = histogram.lowest + histogram.step * static_cast<double>(i);
    const auto length = static_cast<std::size_t>(
        std::ceil(kBarWidth * static_cast<double>(histogram.counts[i]) / static_cast<double>(most)));
    std::string bar;
    for (std::size_t j = 0; j < length; ++j) bar += "█";
    rows.push_back({fmt::format("{:g}", from), grouped(histogram.counts[i]), bar});
  }
  // Bars begin at the same column, so they are set behind the aligned numbers.
  std::vector<std::vector<std::string>> numbers;
  for (const auto& row : rows) numbers.push_back({row[0], row[1]});
  const std::string table = alignedTable(numbers);
  std::cout << quantity << " of " << grouped(histogram.leaves) << " occupied leaves, " << grouped(histogram.without)
            << " without; mean of the others " << fmt::format("{:.3g}", histogram.mean) << "\n";
  std::size_t begin = 0;
  for (const auto& row : rows) {
    const std::size_t end = table.find('\n', begin);
    std::cout << table.substr(begin, end - begin) << "  " << row[2] << "\n";
    begin = end + 1;
  }
}

void count(const InspectTarget& target, const std::string& quantity, int bins) {
  const IorMap map = loadMap(SessionReader(target.session));
  const LeafHistogram histogram = histogramOf(map.view(), leafQuantity(quantity), bins);
  if (target.json) {
    printHistogramJson(histogram, quantity, map.now());
  } else {
    printHistogramText(histogram, quantity);
  }
}

void addQuery(CLI::App& inspect, const std::shared_ptr<InspectTarget>& target) {
  auto point = std::make_shared<std::vector<double>>();
  CLI::App* query = inspect.add_subcommand("query", "what the map and attention know of a point");
  query->add_option("X Y Z", *point, "the point in W, metres")->required()->expected(3);
  query->fallthrough();
  query->callback([target, point] {
    const PointAnswer answer = ask(target->session, *point);
    target->json ? printJson(answer) : printText(answer);
  });
}

void addSlice(CLI::App& inspect, const std::shared_ptr<InspectTarget>& target) {
  auto options = std::make_shared<SliceOptions>();
  CLI::App* slice = inspect.add_subcommand("slice", "the leaves that a plane cuts, as text or as a picture");
  CLI::Option_group* plane = slice->add_option_group("plane", "at right angles to an axis of W");
  plane->add_option("--x", options->x, "where along x, metres");
  plane->add_option("--y", options->y, "where along y (down in the first camera's picture), metres: a plan");
  plane->add_option("--z", options->z, "where along z (ahead of the first camera), metres");
  plane->require_option(1);
  auto* output = slice->add_option("-o,--output", options->output, "a PNG to write");
  slice->add_flag("--force", options->force, "replace a file that exists")->needs(output);
  slice->fallthrough();
  slice->callback([target, options] { cut(*target, *options); });
}

void addHistogram(CLI::App& inspect, const std::shared_ptr<InspectTarget>& target) {
  auto quantity = std::make_shared<std::string>("weight");
  auto bins = std::make_shared<int>(20);
  CLI::App* histogram = inspect.add_subcommand("histogram", "how IOR weight, occupancy or observations are spread");
  histogram
      ->add_option("--of", *quantity,
                   "weight (ticks until attention forgets a leaf), occupancy, or observations (frames)")
      ->check(CLI::IsMember(leafQuantityNames()))
      ->capture_default_str();
  histogram->add_option("--bins", *bins, "most bins")->check(CLI::Range(1, 1000))->capture_default_str();
  histogram->fallthrough();
  histogram->callback([target, quantity, bins] { count(*target, *quantity, *bins); });
}

}  // namespace

void addInspectMap(CLI::App& inspect, const std::shared_ptr<InspectTarget>& target) {
  addQuery(inspect, target);
  addSlice(inspect, target);
  addHistogram(inspect, target);
}

}  // namespace saccade::app
