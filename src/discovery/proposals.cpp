#include "saccade/discovery/proposals.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "saccade/discovery/box_agreement.hpp"
#include "saccade/discovery/region_merging.hpp"

namespace saccade {
namespace {

constexpr double kForbidden = std::numeric_limits<double>::infinity();
// Pairs: at most this mean colour difference, or at most this share of depth steps between them.
constexpr double kPairColor = 0.12;
constexpr double kPairSteps = 0.3;
// Regions with a larger share of depth steps on their common boundary are never one thing's surface.
constexpr double kMaxSteps = 0.6;

std::uint64_t hashOf(std::span<const std::int32_t> segments) {
  std::uint64_t hash = 0xCBF29CE484222325ULL;
  for (const std::int32_t segment : segments) {
    hash = (hash ^ static_cast<std::uint64_t>(segment + 1)) * 0x9E3779B97F4A7C15ULL;
    hash ^= hash >> 29;
  }
  return hash;
}

// Counts keys that are hashes already. One array, forgotten at once: most keys are asked for once.
class KeyCounts {
 public:
  void clear() {
    slots_.assign(std::max(kFirstSlots, slots_.size()), Slot{});
    used_ = 0;
  }
  // Counts one more of `key`; returns how many there are.
  int add(std::uint64_t key) {
    if (2 * (used_ + 1) > slots_.size()) grow();
    Slot& slot = slots_[placeOf(key)];
    used_ += slot.count == 0 ? 1 : 0;
    slot.key = key;
    return ++slot.count;
  }
  [[nodiscard]] int of(std::uint64_t key) const { return slots_[placeOf(key)].count; }

 private:
  struct Slot {
    std::uint64_t key = 0;
    int count = 0;  // 0: the slot is free
  };
  static constexpr std::size_t kFirstSlots = 4096;

  // Where the key is, or would be.
  [[nodiscard]] std::size_t placeOf(std::uint64_t key) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t i = static_cast<std::size_t>(key >> 20) & mask;
    while (slots_[i].count != 0 && slots_[i].key != key) i = (i + 1) & mask;
    return i;
  }
  void grow() {
    std::vector<Slot> before(2 * slots_.size());
    before.swap(slots_);
    for (const Slot& slot : before) {
      if (slot.count != 0) slots_[placeOf(slot.key)] = slot;
    }
  }

  std::vector<Slot> slots_;
  std::size_t used_ = 0;
};

// Boxes and areas are told apart in steps of 1/32 to 1/16 of the box's sides and of 15 % of the area: the boxes of two
// candidates in one cell overlap by more than 0.75, mostly by more than 0.9.
std::uint64_t cellOf(const cv::Rect& box, int area) {
  constexpr double kAreaStep = 0.14;  // ln 1.15
  const auto stepOf = [](int side) {
    return static_cast<int>(std::bit_floor(static_cast<unsigned>(std::max(1, side / 16))));
  };
  const int step_u = stepOf(box.width), step_v = stepOf(box.height);
  std::uint64_t hash = 0xCBF29CE484222325ULL;
  for (const int value : {step_u, step_v, box.x / step_u, box.y / step_v, (box.x + box.width) / step_u,
                          (box.y + box.height) / step_v, static_cast<int>(std::log(area) / kAreaStep)}) {
    hash = (hash ^ static_cast<std::uint64_t>(value + 1)) * 0x9E3779B97F4A7C15ULL;
    hash ^= hash >> 29;
  }
  return hash;
}

}  // namespace

/// Gathers the candidates of one source and drops those met before; what it needs for that is recycled.
class Proposer::Pool {
 public:
  /// Begins a frame. `boxes`: of both sources.
  void begin(const Perception& seen, CandidateSource source, const ProposalConfig& config, KeyCounts& boxes) {
    table_ = &seen.table(source);
    source_ = source;
    boxes_ = &boxes;
    known_.clear();
    pool_.clear();
    cells_.clear();
    takeBlock();
    distinct_boxes_ = config.distinct_boxes && !config.paper;
    distinct_unions_ = !config.paper;
    const cv::Size size = seen.imageSize();
    max_area_ = config.paper ? size.area() : static_cast<int>(config.max_area_share * size.area());
    min_area_ = config.paper ? 1 : config.min_area;
  }

  [[nodiscard]] int maxArea() const { return max_area_; }

  void add(std::span<const std::int32_t> segments) {
    SegmentSums sums;
    for (const std::int32_t segment : segments) sums += table_->sums(segment);
    add(segments, sums);
  }

  void add(std::span<const std::int32_t> segments, const SegmentSums& sums) {
    if (segments.empty() || sums.area < min_area_ || sums.area > max_area_) return;
    const std::uint64_t cell = cellOf(sums.box(), sums.area);
    if (distinct_unions_ && (!isNew(segments) || (boxes_->add(cell) > 1 && distinct_boxes_))) return;
    Candidate& candidate = pool_.emplace_back();
    candidate.source = source_;
    SegmentIds::Block& block = *blocks_.front();
    candidate.segments = SegmentIds(blocks_.front(), block.size(), segments.size());
    block.insert(block.end(), segments.begin(), segments.end());
    candidate.box = sums.box();
    candidate.area = sums.area;
    cells_.push_back(cell);
  }

  [[nodiscard]] const Candidates& candidates() const { return pool_; }
  // Appends the candidates to `all`. Call when both sources are done: what is proposed later counts too.
  void handOver(Candidates& all) {
    for (std::size_t i = 0; distinct_boxes_ && i < pool_.size(); ++i) pool_[i].unions = boxes_->of(cells_[i]);
    all.insert(all.end(), std::make_move_iterator(pool_.begin()), std::make_move_iterator(pool_.end()));
  }

 private:
  // Whether these segments have not been proposed yet; two unions are taken for one if 64 bits of hash are equal.
  [[nodiscard]] bool isNew(std::span<const std::int32_t> segments) { return known_.add(hashOf(segments)) == 1; }

  // A block for the ids of this frame's segments: one that no candidate of an earlier frame holds any more.
  void takeBlock() {
    auto free = std::find_if(blocks_.begin(), blocks_.end(), [](const auto& block) { return block.use_count() == 1; });
    if (free == blocks_.end()) free = blocks_.insert(free, std::make_shared<SegmentIds::Block>());
    std::atomic_thread_fence(std::memory_order_acquire);  // whoever let go of it last has read what it wanted
    std::iter_swap(blocks_.begin(), free);
    blocks_.front()->clear();
  }

  const SegmentTable* table_ = nullptr;
  CandidateSource source_ = CandidateSource::kColor;
  KeyCounts* boxes_ = nullptr;
  KeyCounts known_;
  bool distinct_unions_ = true, distinct_boxes_ = true;
  int min_area_ = 1, max_area_ = 0;
  std::vector<std::shared_ptr<SegmentIds::Block>> blocks_;  ///< the first is this frame's
  Candidates pool_;
  std::vector<std::uint64_t> cells_;  ///< of the candidates
};

namespace {

using Pool = Proposer::Pool;

// What something covers of the segments of a frame.
class SegmentCover {
 public:
  void begin(const SegmentTable& table) {
    table_ = &table;
    covered_.assign(static_cast<std::size_t>(table.count()), 0);
    touched_.clear();
  }
  void add(std::int32_t segment, int pixels) {
    int& covered = covered_[static_cast<std::size_t>(segment)];
    if (covered == 0) touched_.push_back(segment);
    covered += pixels;
  }
  // The segments of which at least `share` is covered, rising; forgets what is.
  [[nodiscard]] std::span<const std::int32_t> take(double share) {
    selected_.clear();
    for (const std::int32_t segment : touched_) {
      int& covered = covered_[static_cast<std::size_t>(segment)];
      if (covered >= share * table_->sums(segment).area) selected_.push_back(segment);
      covered = 0;
    }
    touched_.clear();
    std::sort(selected_.begin(), selected_.end());
    return selected_;
  }

 private:
  const SegmentTable* table_ = nullptr;
  std::vector<int> covered_;  ///< pixels, by segment
  std::vector<std::int32_t> touched_, selected_;
};

// The paper's rule: a blob selects the segments of which it covers at least the share `overlap`.
void addBlobUnions(const Perception& seen, CandidateSource source, double overlap, SegmentCover& cover, Pool& pool) {
  const SegmentTable& table = seen.table(source);
  cover.begin(table);
  for (const SalientBlob& blob : seen.blobs) {
    for (const PixelRun& run : blob.runs) {
      const std::span<const LabelRun> row = table.runs().row(run.row);
      auto labelled = std::upper_bound(row.begin(), row.end(), run.first_column,
                                       [](int column, const LabelRun& other) { return column < other.end_u; });
      for (int u = run.first_column; u < run.end_column; ++labelled) {
        const int next = std::min(labelled->end_u, run.end_column);
        if (labelled->label >= 0) cover.add(labelled->label, next - u);
        u = next;
      }
    }
    pool.add(cover.take(overlap));
  }
}

// Mean absolute difference of the mean colours, 0..1.
double colorDifference(const SegmentSums& a, const SegmentSums& b) {
  double sum = 0.0;
  for (std::size_t c = 0; c < 3; ++c) sum += std::abs(a.color[c] / a.area - b.color[c] / b.area);
  return sum / 765.0;
}

double steppedShare(const SharedBoundary& boundary) {
  return boundary.known > 0 ? static_cast<double>(boundary.stepped) / boundary.known : 0.0;
}

// Positive where two patches meet as on the outside of a box (convex), negative as in a corner of a room; the sine of
// the bend. 0 where normals are missing.
double convexBend(const SegmentSums& a, const SegmentSums& b) {
  if (a.normal_count == 0 || b.normal_count == 0 || a.depth_count == 0 || b.depth_count == 0) return 0.0;
  const Eigen::Vector3d n_a = Eigen::Vector3d(a.normal[0], a.normal[1], a.normal[2]).normalized();
  const Eigen::Vector3d n_b = Eigen::Vector3d(b.normal[0], b.normal[1], b.normal[2]).normalized();
  const Eigen::Vector3d p_a = Eigen::Vector3d(a.vertex[0], a.vertex[1], a.vertex[2]) / a.depth_count;
  const Eigen::Vector3d p_b = Eigen::Vector3d(b.vertex[0], b.vertex[1], b.vertex[2]) / b.depth_count;
  const Eigen::Vector3d way = p_b - p_a;
  const double distance = way.norm();
  return distance > 0.0 ? 0.5 * (n_b - n_a).dot(way) / distance : 0.0;
}

// How far two regions are from filling their common box: small where one closes the other's gap.
double looseFit(const SegmentSums& a, const SegmentSums& b) {
  const double box = (a.box() | b.box()).area();
  return 1.0 - (a.area + b.area) / box;
}

double relativeSize(const SegmentSums& a, const SegmentSums& b, double image_area) {
  return (a.area + b.area) / image_area;
}

void addPairs(const SegmentTable& table, Pool& pool) {
  for (std::int32_t a = 0; a < table.count(); ++a) {
    for (const SegmentEdge& edge : table.edges(a)) {
      if (edge.neighbor <= a) continue;
      const SharedBoundary boundary{edge.length, edge.known, edge.nearer + edge.farther, edge.color_step};
      const double steps = steppedShare(boundary);
      const bool alike = colorDifference(table.sums(a), table.sums(edge.neighbor)) < kPairColor;
      if (steps > kMaxSteps || (!alike && (edge.known == 0 || steps > kPairSteps))) continue;
      const std::array<std::int32_t, 2> pair{a, edge.neighbor};
      pool.add(pair);
    }
  }
}

// Surface patches without the supporting planes: first all that hang together, then what the merging meets.
void addSurfaceUnions(const Perception& seen, const ProposalConfig& config, RegionMerging& merging, Pool& pool) {
  const SegmentTable& table = seen.surface_segments;
  std::vector<std::uint8_t> all(static_cast<std::size_t>(table.count()), 1), free = all;
  for (std::int32_t i = 0; i < table.count(); ++i) {
    if (seen.planes.planeOf(i) != SupportPlanes::kNoPlane) free[static_cast<std::size_t>(i)] = 0;
  }
  const auto report = [&](std::span<const std::int32_t> segments, const SegmentSums& sums) {
    pool.add(segments, sums);
  };
  const double image_area = seen.imageSize().area();
  const auto byShape = [&](const SegmentSums& a, const SegmentSums& b, const SharedBoundary& boundary) {
    const double steps = steppedShare(boundary);
    if (boundary.known == 0 || steps > kMaxSteps) return kForbidden;
    return steps - convexBend(a, b) + 0.5 * looseFit(a, b) + relativeSize(a, b, image_area);
  };
  const auto byColor = [&](const SegmentSums& a, const SegmentSums& b, const SharedBoundary& boundary) {
    const double steps = steppedShare(boundary);
    if (boundary.known == 0 || steps > kMaxSteps) return kForbidden;
    return colorDifference(a, b) + 0.3 * steps + relativeSize(a, b, image_area);
  };
  if (config.plane_removal) {
    merging.run(table, free, pool.maxArea(), byShape, report);
    merging.run(table, free, pool.maxArea(), byColor, report);
  }
  if (config.merging) merging.run(table, all, pool.maxArea(), byShape, report);
}

void addColorUnions(const Perception& seen, RegionMerging& merging, Pool& pool) {
  const SegmentTable& table = seen.color_segments;
  const std::vector<std::uint8_t> all(static_cast<std::size_t>(table.count()), 1);
  const double image_area = seen.imageSize().area();
  const auto report = [&](std::span<const std::int32_t> segments, const SegmentSums& sums) {
    pool.add(segments, sums);
  };
  merging.run(
      table, all, pool.maxArea(),
      [&](const SegmentSums& a, const SegmentSums& b, const SharedBoundary& boundary) {
        return boundary.color_step / boundary.length + colorDifference(a, b) + relativeSize(a, b, image_area);
      },
      report);
  if (!seen.has_depth) return;
  merging.run(
      table, all, pool.maxArea(),
      [&](const SegmentSums& a, const SegmentSums& b, const SharedBoundary& boundary) {
        const double unknown = 1.0 - static_cast<double>(boundary.known) / boundary.length;
        return steppedShare(boundary) + 0.5 * unknown + 0.5 * colorDifference(a, b) + 0.5 * looseFit(a, b) +
               2.0 * relativeSize(a, b, image_area);
      },
      report);
}

// Depth candidates find the object, colour segments its outline: those that lie mostly within one are selected by it.
void addCrossSelections(const Perception& seen, const Candidates& depth_pool, double share, SegmentCover& cover,
                        Pool& pool) {
  cover.begin(seen.color_segments);
  for (const Candidate& candidate : depth_pool) {
    for (const std::int32_t segment : candidate.segments) {
      for (const SegmentOverlap::Share& overlap : seen.overlap.ofSecond(segment)) {
        cover.add(overlap.other, overlap.pixels);
      }
    }
    pool.add(cover.take(share));
  }
}

void addSegments(const SegmentTable& table, Pool& pool) {
  for (std::int32_t i = 0; i < table.count(); ++i) {
    pool.add(std::array<std::int32_t, 1>{i});
  }
}

}  // namespace

/// What is recycled from frame to frame.
struct Proposer::Scratch {
  RegionMerging merging;
  SegmentCover cover;
  KeyCounts boxes;
  Pool color, depth;
};

Proposer::Proposer(ProposalConfig config) : config_(config), scratch_(std::make_unique<Scratch>()) {}
Proposer::~Proposer() = default;
Proposer::Proposer(Proposer&&) noexcept = default;
Proposer& Proposer::operator=(Proposer&&) noexcept = default;

Candidates Proposer::propose(const Perception& seen) {
  auto& [merging, cover, boxes, color, depth] = *scratch_;
  boxes.clear();
  color.begin(seen, CandidateSource::kColor, config_, boxes);
  depth.begin(seen, CandidateSource::kDepth, config_, boxes);
  addBlobUnions(seen, CandidateSource::kColor, config_.overlap, cover, color);
  if (seen.has_depth) addBlobUnions(seen, CandidateSource::kDepth, config_.overlap, cover, depth);
  if (!config_.paper) {
    if (config_.single_segments) addSegments(seen.color_segments, color);
    if (config_.adjacent_pairs) addPairs(seen.color_segments, color);
    if (config_.merging) addColorUnions(seen, merging, color);
    if (config_.single_segments) addSegments(seen.surface_segments, depth);
    if (config_.adjacent_pairs) addPairs(seen.surface_segments, depth);
    addSurfaceUnions(seen, config_, merging, depth);
    if (config_.cross_selection) addCrossSelections(seen, depth.candidates(), config_.cross_share, cover, color);
  }
  Candidates pool;
  pool.reserve(color.candidates().size() + depth.candidates().size());
  color.handOver(pool);
  depth.handOver(pool);
  if (!config_.paper) {
    const std::vector<int> agreeing = countAgreeing(pool);
    for (std::size_t i = 0; i < pool.size(); ++i) pool[i].unions = agreeing[i];
  }
  return pool;
}

Candidates proposeCandidates(const Perception& seen, const ProposalConfig& config) {
  return Proposer(config).propose(seen);
}

}  // namespace saccade
