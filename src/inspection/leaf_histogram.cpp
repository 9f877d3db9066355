#include "saccade/inspection/leaf_histogram.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "inspection/leaf_walk.hpp"

namespace saccade {
namespace {

double valueOf(MapNode leaf, LeafQuantity quantity, Tick now) {
  switch (quantity) {
    case LeafQuantity::kIorWeight:
      return weight(leaf.ior(), now);
    case LeafQuantity::kOccupancy:
      return 1.0 / (1.0 + std::exp(-static_cast<double>(leaf.logOdds())));
    case LeafQuantity::kObservations:
      return leaf.surface().observations;
  }
  return 0.0;
}

}  // namespace

const std::vector<std::string>& leafQuantityNames() {
  static const std::vector<std::string> names = {"weight", "occupancy", "observations"};
  return names;
}

LeafQuantity leafQuantity(std::string_view name) {
  const std::vector<std::string>& names = leafQuantityNames();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    throw std::invalid_argument("expected weight, occupancy or observations, found \"" + std::string(name) + "\"");
  }
  return static_cast<LeafQuantity>(found - names.begin());
}

LeafHistogram histogramOf(const MapTree& map, LeafQuantity quantity, int bins) {
  if (bins < 1) throw std::invalid_argument("histogram: expected at least 1 bin, found " + std::to_string(bins));
  LeafHistogram histogram;
  std::vector<double> values;
  forEachOccupiedLeaf(map, [&](const NodeKey&, MapNode leaf) {
    const double value = valueOf(leaf, quantity, map.now);
    ++histogram.leaves;
    if (value > 0.0) values.push_back(value);
  });
  histogram.without = histogram.leaves - static_cast<std::int64_t>(values.size());
  if (values.empty()) return histogram;
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  if (quantity == LeafQuantity::kOccupancy) {
    histogram.lowest = 0.5;
    histogram.step = 0.5 / bins;
    histogram.counts.assign(static_cast<std::size_t>(bins), 0);
  } else {
    histogram.lowest = *least;
    histogram.step = std::max(1.0, std::ceil((*most - *least + 1.0) / bins));
    histogram.counts.assign(static_cast<std::size_t>((*most - *least) / histogram.step) + 1, 0);
  }
  for (const double value : values) {
    const double bin = std::max(0.0, (value - histogram.lowest) / histogram.step);
    ++histogram.counts[std::min(static_cast<std::size_t>(bin), histogram.counts.size() - 1)];
    histogram.mean += value / static_cast<double>(values.size());
  }
  return histogram;
}

}  // namespace saccade
