#include "saccade/discovery/region_merging.hpp"

#include <algorithm>
#include <cmath>

namespace saccade {

void RegionMerging::run(const SegmentTable& table, std::span<const std::uint8_t> active, int max_area,
                        const Unlikeness& unlikeness, const Report& report) {
  steps_.clear();
  used_ = static_cast<std::size_t>(table.count());
  if (regions_.size() < 2 * used_) regions_.resize(2 * used_);
  for (std::size_t i = 0; i < used_; ++i) {
    const auto id = static_cast<std::int32_t>(i);
    Region& region = regions_[i];
    region.sums = table.sums(id);
    region.alive = active[i] != 0 && region.sums.area <= max_area;
    region.segments.assign(1, id);
    region.links.clear();
  }
  for (std::size_t i = 0; i < used_; ++i) {
    if (!regions_[i].alive) continue;
    for (const SegmentEdge& edge : table.edges(static_cast<std::int32_t>(i))) {
      if (edge.neighbor < 0 || !regions_[static_cast<std::size_t>(edge.neighbor)].alive) continue;
      const SharedBoundary boundary{edge.length, edge.known, edge.nearer + edge.farther, edge.color_step};
      regions_[i].links.push_back({edge.neighbor, boundary});
      const auto id = static_cast<std::int32_t>(i);
      if (id < edge.neighbor) push(id, edge.neighbor, boundary, unlikeness);
    }
  }
  while (!steps_.empty()) {
    std::pop_heap(steps_.begin(), steps_.end(), std::greater<>());
    const Step step = steps_.back();
    steps_.pop_back();
    const auto a = static_cast<std::size_t>(step.a), b = static_cast<std::size_t>(step.b);
    if (!regions_[a].alive || !regions_[b].alive) continue;
    if (regions_[a].sums.area + regions_[b].sums.area > max_area) continue;
    const std::int32_t merged = merge(step.a, step.b);
    const Region& region = regions_[static_cast<std::size_t>(merged)];
    report(region.segments, region.sums);
    for (const Link& link : region.links) push(link.region, merged, link.boundary, unlikeness);
  }
}

void RegionMerging::push(std::int32_t a, std::int32_t b, const SharedBoundary& boundary, const Unlikeness& unlikeness) {
  const double value =
      unlikeness(regions_[static_cast<std::size_t>(a)].sums, regions_[static_cast<std::size_t>(b)].sums, boundary);
  if (!std::isfinite(value)) return;
  steps_.push_back({value, a, b});
  std::push_heap(steps_.begin(), steps_.end(), std::greater<>());
}

std::int32_t RegionMerging::merge(std::int32_t a, std::int32_t b) {
  const std::size_t made = used_++;
  Region &first = regions_[static_cast<std::size_t>(a)], &second = regions_[static_cast<std::size_t>(b)],
         &region = regions_[made];
  first.alive = second.alive = false;
  region.alive = true;
  region.sums = first.sums;
  region.sums += second.sums;
  region.segments.clear();
  std::merge(first.segments.begin(), first.segments.end(), second.segments.begin(), second.segments.end(),
             std::back_inserter(region.segments));
  region.links.clear();
  for (auto i = first.links.begin(), j = second.links.begin(); i != first.links.end() || j != second.links.end();) {
    const bool take_first = j == second.links.end() || (i != first.links.end() && i->region <= j->region);
    const Link link = take_first ? *i++ : *j++;
    if (!regions_[static_cast<std::size_t>(link.region)].alive) continue;
    if (!region.links.empty() && region.links.back().region == link.region) {
      SharedBoundary& sum = region.links.back().boundary;
      sum.length += link.boundary.length;
      sum.known += link.boundary.known;
      sum.stepped += link.boundary.stepped;
      sum.color_step += link.boundary.color_step;
    } else {
      region.links.push_back(link);
    }
  }
  const auto id = static_cast<std::int32_t>(made);
  for (const Link& link : region.links) {  // the new id is the largest: at the end it stays sorted
    regions_[static_cast<std::size_t>(link.region)].links.push_back({id, link.boundary});
  }
  return id;
}

}  // namespace saccade
