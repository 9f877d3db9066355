#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "saccade/exchange/map_difference.hpp"
#include "saccade/exchange/map_merge.hpp"
#include "saccade/exchange/map_points.hpp"
#include "saccade/exchange/output_file.hpp"
#include "saccade/objects/object_memory.hpp"
#include "saccade/session/session_map.hpp"
#include "session_frames.hpp"
#include "terminal.hpp"

namespace saccade::app {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string before, after, ply;
  SessionFrames frames;
  bool json = false, force = false;
  MapDifferenceConfig comparison;
};

struct Side {
  explicit Side(const std::string& path) : session(path), map(loadMap(session)), objects(findObjects(session)) {}

  SessionReader session;
  IorMap map;
  std::vector<AttendedObject> objects;
};

/// The object that a changed region mostly belongs to: the smallest one that holds half of its leaves.
std::optional<ObjectId> objectOf(const ChangedRegion& region, const std::vector<AttendedObject>& objects) {
  const AttendedObject* best = nullptr;
  for (const AttendedObject& object : objects) {
    const auto held = std::count_if(region.leaves.begin(), region.leaves.end(), [&](const LeafKey& key) {
      return std::binary_search(object.blocks.begin(), object.blocks.end(), blockOf(key));
    });
    if (2 * held < static_cast<std::ptrdiff_t>(region.leaves.size())) continue;
    if (best == nullptr || object.blocks.size() < best->blocks.size()) best = &object;
  }
  return best != nullptr ? std::optional(best->id) : std::nullopt;
}

/// A change as a line of the table and an entry of the JSON.
struct Change {
  std::string what;
  const ChangedRegion* before = nullptr;
  const ChangedRegion* after = nullptr;
  std::optional<ObjectId> object_before, object_after;
};

std::vector<Change> listChanges(const MapDifference& difference, const std::vector<AttendedObject>& objects_before,
                                const std::vector<AttendedObject>& objects_after) {
  std::vector<Change> changes;
  std::vector<bool> gone_told(difference.gone.size()), appeared_told(difference.appeared.size());
  for (const MovedRegion& moved : difference.moved) {
    changes.push_back({"moved", &difference.gone[moved.gone], &difference.appeared[moved.appeared], {}, {}});
    gone_told[moved.gone] = appeared_told[moved.appeared] = true;
  }
  for (std::size_t i = 0; i < difference.gone.size(); ++i) {
    if (!gone_told[i]) changes.push_back({"gone", &difference.gone[i], nullptr, {}, {}});
  }
  for (std::size_t i = 0; i < difference.appeared.size(); ++i) {
    if (!appeared_told[i]) changes.push_back({"appeared", nullptr, &difference.appeared[i], {}, {}});
  }
  for (Change& change : changes) {
    if (change.before != nullptr) change.object_before = objectOf(*change.before, objects_before);
    if (change.after != nullptr) change.object_after = objectOf(*change.after, objects_after);
  }
  return changes;
}

Json jsonOf(const ChangedRegion* region, const std::optional<ObjectId>& object) {
  if (region == nullptr) return nullptr;
  const Eigen::Vector3d &low = region->box_W.min(), &high = region->box_W.max();
  return {{"leaves", region->leaves.size()},
          {"box3d", {low.x(), low.y(), low.z(), high.x(), high.y(), high.z()}},
          {"object", object ? Json(object->value) : Json(nullptr)}};
}

void printJson(const MapDifference& difference, const std::vector<Change>& changes) {
  Json list = Json::array();
  for (const Change& change : changes) {
    Json entry = {{"change", change.what},
                  {"before", jsonOf(change.before, change.object_before)},
                  {"after", jsonOf(change.after, change.object_after)}};
    if (change.before != nullptr && change.after != nullptr) {
      entry["distance_m"] = (change.after->mean_W - change.before->mean_W).norm();
    }
    list.push_back(entry);
  }
  const Json json = {
      {"changes", list},
      {"leaves",
       {{"same", difference.same}, {"known_before_only", difference.only_a}, {"known_after_only", difference.only_b}}},
      {"attention",
       {{"gained", difference.attention_gained.size()},
        {"attended_before", difference.attended_a},
        {"attended_after", difference.attended_b},
        {"inhibited_before", difference.inhibited_a},
        {"inhibited_after", difference.inhibited_b}}}};
  std::cout << json.dump(2) << "\n";
}

void printText(const MapDifference& difference, const std::vector<Change>& changes) {
  std::vector<std::vector<std::string>> rows = {{"change", "leaves", "object", "centre before", "after", "by"}};
  const auto text = [](const ChangedRegion* region) {
    if (region == nullptr) return std::string("-");
    return fmt::format("{:.2f} {:.2f} {:.2f}", region->mean_W.x(), region->mean_W.y(), region->mean_W.z());
  };
  for (const Change& change : changes) {
    const ChangedRegion& region = change.after != nullptr ? *change.after : *change.before;
    const bool both = change.before != nullptr && change.after != nullptr;
    const auto& object = change.object_after ? change.object_after : change.object_before;
    rows.push_back(
        {change.what, grouped(static_cast<std::int64_t>(region.leaves.size())),
         object ? std::to_string(object->value) : "-", text(change.before), text(change.after),
         both ? fmt::format("{:.1f} cm", 100.0 * (change.after->mean_W - change.before->mean_W).norm()) : ""});
  }
  const auto count = [](std::size_t n) { return grouped(static_cast<std::int64_t>(n)); };
  if (changes.empty()) {
    std::cout << "nothing appeared, went or moved\n";
  } else {
    std::cout << alignedTable(rows);
  }
  std::cout << alignedTable({
      {"occupied leaves that stayed", count(difference.same)},
      {"seen before only", count(difference.only_a)},
      {"seen after only", count(difference.only_b)},
      {"leaves attended before, after", count(difference.attended_a) + ", " + count(difference.attended_b)},
      {"inhibited before, after", count(difference.inhibited_a) + ", " + count(difference.inhibited_b)},
      {"leaves that gained attention", count(difference.attention_gained.size())},
  });
}

/// Both maps' leaves: what stayed in grey, what is gone in red, what appeared in green, attention gained in blue.
std::vector<MapPoint> paintedPoints(const MapDifference& difference, const IorMap& before, const IorMap& after) {
  constexpr Rgb kStayed{150, 150, 150}, kGone{220, 30, 30}, kAppeared{30, 200, 60}, kGained{40, 110, 255};
  std::vector<LeafKey> gone, appeared, gained = difference.attention_gained;
  for (const ChangedRegion& region : difference.gone)
    gone.insert(gone.end(), region.leaves.begin(), region.leaves.end());
  for (const ChangedRegion& region : difference.appeared) {
    appeared.insert(appeared.end(), region.leaves.begin(), region.leaves.end());
  }
  for (std::vector<LeafKey>* keys : {&gone, &appeared, &gained}) std::sort(keys->begin(), keys->end());
  const auto within = [](const std::vector<LeafKey>& keys, const LeafKey& key) {
    return std::binary_search(keys.begin(), keys.end(), key);
  };
  std::vector<Rgb> colors;
  std::vector<MapPoint> points = occupiedPoints(after, LeafPaint::kColor, [&](const MapLeaf& leaf) {
    const LeafKey& key = leaf.key.corner;
    colors.push_back(within(appeared, key) ? kAppeared : within(gained, key) ? kGained : kStayed);
    return true;
  });
  for (std::size_t i = 0; i < points.size(); ++i) points[i].color = colors[i];
  for (MapPoint& point :
       occupiedPoints(before, LeafPaint::kColor, [&](const MapLeaf& leaf) { return within(gone, leaf.key.corner); })) {
    point.color = kGone;
    points.push_back(point);
  }
  return points;
}

void run(const Options& options) {
  std::optional<OutputFile> ply;
  const auto when_exists = options.force ? WhenFileExists::kReplace : WhenFileExists::kRefuse;
  if (!options.ply.empty()) ply.emplace(options.ply, when_exists);
  const Side before(options.before);
  Side after(options.after);
  if (!options.frames.isSame()) {
    const Pose T_AB = options.frames.resolve(before.session, after.session);
    after.map = resampleMap(after.map, T_AB, before.map.config());
    after.objects.clear();  // their blocks lie in the other frame
  }
  const MapDifference difference = compareMaps(before.map, after.map, options.comparison);
  const std::vector<Change> changes = listChanges(difference, before.objects, after.objects);
  options.json ? printJson(difference, changes) : printText(difference, changes);
  if (!ply) return;
  writePly(paintedPoints(difference, before.map, after.map), ply->stream());
  ply->finish();
  std::cerr << "written: " << options.ply << " (gone red, appeared green, attention gained blue)\n";
}

}  // namespace

void addDiff(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("diff", "Say what changed between two sessions of a scene");
  command->add_option("A", options->before, "the earlier session")->required();
  command->add_option("B", options->after, "the later session")->required();
  options->frames.addTo(*command);
  command->add_flag("--json", options->json, "print JSON");
  command->add_option("--ply", options->ply, "write both maps as points: gone red, appeared green, attended blue");
  command->add_option("--tolerance", options->comparison.tolerance_leaves, "leaves by which a surface may shift")
      ->check(CLI::Range(0, 16));
  command->add_option("--min-leaves", options->comparison.least_leaves, "leave out changes of fewer leaves")
      ->check(CLI::PositiveNumber);
  command->add_flag("--force", options->force, "replace a PLY file that exists");
  command->callback([options] { run(*options); });
}

}  // namespace saccade::app
