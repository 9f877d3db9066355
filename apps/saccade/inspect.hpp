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

/// `inspect SESSION objects` and `inspect SESSION why ID`.
void addInspectObjects(CLI::App& inspect, const std::shared_ptr<InspectTarget>& target);

}  // namespace saccade::app
