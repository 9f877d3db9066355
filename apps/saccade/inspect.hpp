#pragma once

#include <memory>
#include <string>

#include <CLI/App.hpp>

namespace saccade::app {

/// What all of `inspect`'s questions share.
struct InspectTarget {
  std::string session;
  bool json = false;
};

/// Version of the JSON that `inspect` prints (docs/inspect-json.md): rises when a key goes or changes its meaning, not
/// when one comes.
constexpr int kInspectSchema = 1;

/// `inspect SESSION objects` and `inspect SESSION why ID`.
void addInspectObjects(CLI::App& inspect, const std::shared_ptr<InspectTarget>& target);
/// `inspect SESSION query X Y Z`, `slice` and `histogram`.
void addInspectMap(CLI::App& inspect, const std::shared_ptr<InspectTarget>& target);
/// `inspect SESSION timeline`.
void addInspectTimeline(CLI::App& inspect, const std::shared_ptr<InspectTarget>& target);

}  // namespace saccade::app
