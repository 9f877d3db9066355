#include <algorithm>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "inspect.hpp"
#include "saccade/objects/forgetting.hpp"
#include "saccade/objects/object_history.hpp"
#include "saccade/objects/object_memory.hpp"
#include "saccade/session/session_map.hpp"
#include "saccade/session/session_snapshot.hpp"
#include "terminal.hpp"

namespace saccade::app {
namespace {

using Json = nlohmann::ordered_json;

/// A session's objects with the map they lie in.
struct Objects {
  explicit Objects(const std::string& path, int least_looks)
      : session(path),
        still(session),
        map(loadMap(session)),
        log(loadAttendLog(session)),
        all(findObjects(log, least_looks)) {}

  SessionReader session;
  SessionSnapshot still;
  IorMap map;
  AttendLog log;
  std::vector<AttendedObject> all;
};

/// Names of frames by the tick that their attention closed.
std::map<std::uint32_t, FrameRecord> framesByTick(const SessionReader& session) {
  std::map<std::uint32_t, FrameRecord> frames;
  for (FrameRecord& frame : session.frames()) {
    if (frame.tracking != "lost" && frame.tick > 0) frames.emplace(frame.tick - 1, std::move(frame));
  }
  return frames;
}

std::string nameOfFrame(const std::map<std::uint32_t, FrameRecord>& frames, Tick tick) {
  const auto frame = frames.find(tick.value);
  return frame == frames.end() ? "tick " + std::to_string(tick.value) : frame->second.name;
}

Json jsonOf(const Eigen::AlignedBox3d& box) {
  if (box.isEmpty()) return nullptr;
  return Json::array({box.min().x(), box.min().y(), box.min().z(), box.max().x(), box.max().y(), box.max().z()});
}

std::string textOf(const Eigen::AlignedBox3d& box) {
  if (box.isEmpty()) return "gone";
  const Eigen::Vector3d c = box.center(), s = box.sizes() * 100.0;
  return fmt::format("{:.2f} {:.2f} {:.2f}  {:.0f} x {:.0f} x {:.0f} cm", c.x(), c.y(), c.z(), s.x(), s.y(), s.z());
}

std::string seconds(double ticks, const std::map<std::uint32_t, FrameRecord>& frames) {
  if (frames.size() < 2) return "";
  const auto first = frames.begin(), last = std::prev(frames.end());
  const double pace = (last->second.stamp_s - first->second.stamp_s) / static_cast<double>(last->first - first->first);
  return pace > 0.0 ? fmt::format(" ({:.1f} s at this pace)", ticks * pace) : "";
}

void listObjects(const InspectTarget& target, int least_looks) {
  const Objects objects(target.session, least_looks);
  const auto frames = framesByTick(objects.session);
  Json list = Json::array();
  std::vector<std::vector<std::string>> rows = {
      {"object", "seen", "first", "last", "leaves", "inhibited", "best view", "centre in W, size"}};
  for (const AttendedObject& object : objects.all) {
    const std::vector<LeafKey> leaves = leavesOf(object, objects.map);
    const ObjectAttention attention = attentionOf(leaves, objects.map);
    const Eigen::AlignedBox3d box = boxOf(leaves, objects.map.config().leaf_size_m);
    const ObjectLook& best = object.bestView();
    list.push_back({{"id", object.id.value},
                    {"times_seen", object.looks.size()},
                    {"first_tick", object.looks.front().tick.value},
                    {"last_tick", object.looks.back().tick.value},
                    {"leaves", attention.leaves},
                    {"attended", attention.attended},
                    {"inhibited", attention.inhibited},
                    {"best_view", {{"frame", nameOfFrame(frames, best.tick)}, {"rank", best.rank}}},
                    {"box3d", jsonOf(box)}});
    rows.push_back({std::to_string(object.id.value), grouped(static_cast<std::int64_t>(object.looks.size())),
                    std::to_string(object.looks.front().tick.value), std::to_string(object.looks.back().tick.value),
                    grouped(attention.leaves), grouped(attention.inhibited), nameOfFrame(frames, best.tick),
                    textOf(box)});
  }
  if (target.json) {
    std::cout << Json({{"schema", kInspectSchema}, {"tick", objects.map.now().value}, {"objects", list}}).dump(2)
              << "\n";
  } else {
    std::cout << alignedTable(rows) << objects.all.size() << " objects at tick " << objects.map.now().value << "\n";
  }
}

Json jsonOf(const std::vector<LeafEvent>& events) {
  Json list = Json::array();
  for (const LeafEvent& event : events) {
    list.push_back({{"tick", event.tick.value}, {"frame", event.frame.value}, {"leaves", event.leaves}});
  }
  return list;
}

void printWhyJson(const Objects& objects, const AttendedObject& object, const ObjectHistory& history,
                  const std::vector<ForgettingRecord>& forgettings) {
  Json looks = Json::array();
  for (const ObjectLook& look : object.looks) {
    looks.push_back({{"tick", look.tick.value}, {"frame", look.frame.value}, {"rank", look.rank}});
  }
  Json by_hand = Json::array();
  for (const ForgettingRecord& record : forgettings) {
    by_hand.push_back(
        {{"tick", record.tick.value}, {"utc", record.when}, {"what", record.what}, {"leaves", record.leaves}});
  }
  const auto expiry = [](std::uint32_t tick) { return tick == 0 ? Json(nullptr) : Json(tick); };
  const Json json = {{"schema", kInspectSchema},
                     {"id", object.id.value},
                     {"tick", objects.map.now().value},
                     {"leaves", history.leaves},
                     {"attended", history.attended},
                     {"inhibited", history.inhibited},
                     {"first_forgotten_at_tick", expiry(history.next_expiry)},
                     {"last_forgotten_at_tick", expiry(history.last_expiry)},
                     {"looks", looks},
                     {"flags_on", jsonOf(history.flags_on)},
                     {"turned_free", jsonOf(history.forgotten)},
                     {"forgotten_by_hand", by_hand}};
  std::cout << json.dump(2) << "\n";
}

void printWhyText(const Objects& objects, const AttendedObject& object, const ObjectHistory& history,
                  const std::vector<ForgettingRecord>& forgettings) {
  const std::uint32_t now = objects.map.now().value;
  const auto frames = framesByTick(objects.session);
  std::cout << fmt::format("object {}: {} of its {} leaves are inhibited at tick {}, {} remember an attention\n",
                           object.id.value, history.inhibited, history.leaves, now, history.attended);
  if (history.inhibited > 0) {
    std::cout << fmt::format("  it will be forgotten from tick {} to tick {}, in {} to {} ticks{}\n",
                             history.next_expiry, history.last_expiry, history.next_expiry - now,
                             history.last_expiry - now, seconds(history.last_expiry - now, frames));
  }
  std::cout << "  looks:\n";
  for (const ObjectLook& look : object.looks) {
    std::cout << fmt::format("    tick {:>6}  {}, rank {}\n", look.tick.value, nameOfFrame(frames, look.tick),
                             look.rank);
  }
  for (const LeafEvent& event : history.flags_on) {
    std::cout << fmt::format("  flag on at tick {}: {} leaves\n", event.tick.value, event.leaves);
  }
  for (const LeafEvent& event : history.forgotten) {
    std::cout << fmt::format("  turned free at tick {}: {} leaves\n", event.tick.value, event.leaves);
  }
  for (const ForgettingRecord& record : forgettings) {
    std::cout << fmt::format("  forgotten by hand at tick {} ({}): {}, {} leaves of the map\n", record.tick.value,
                             record.when, record.what, record.leaves);
  }
}

void explain(const InspectTarget& target, int id) {
  const Objects objects(target.session, 1);
  const auto object =
      std::find_if(objects.all.begin(), objects.all.end(), [&](const AttendedObject& o) { return o.id.value == id; });
  if (object == objects.all.end()) {
    throw std::invalid_argument(
        fmt::format("inspect why: {} has objects 1 to {}, not {}", target.session, objects.all.size(), id));
  }
  const ObjectHistory history = historyOf(*object, objects.log, objects.map);
  const std::vector<ForgettingRecord> forgettings = listForgettings(objects.session);
  (target.json ? printWhyJson : printWhyText)(objects, *object, history, forgettings);
}

}  // namespace

void addInspectObjects(CLI::App& inspect, const std::shared_ptr<InspectTarget>& target) {
  auto least_looks = std::make_shared<int>(2);
  CLI::App* objects = inspect.add_subcommand("objects", "candidates that returned on the same leaves, as objects");
  objects->add_option("--min-seen", *least_looks, "leave out what was looked at in fewer ticks")
      ->check(CLI::PositiveNumber);
  objects->fallthrough();
  objects->callback([target, least_looks] { listObjects(*target, *least_looks); });

  auto id = std::make_shared<int>(0);
  CLI::App* why = inspect.add_subcommand("why", "which looks inhibit an object, since when, and for how long");
  why->add_option("ID", *id, "number of the object")->required();
  why->fallthrough();
  why->callback([target, id] { explain(*target, *id); });
}

}  // namespace saccade::app
