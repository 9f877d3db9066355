#include "saccade/segmentation/color_segments.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "segmentation/color_edges.hpp"
#include "segmentation/flat_partition.hpp"
#include "segmentation/label_upsampling.hpp"
#include "segmentation/open_edges.hpp"
#include "segmentation/tile_merging.hpp"

namespace saccade {
namespace {

/// What segments the half as `config` says of the whole.
ColorSegmentsConfig ofTheHalf(ColorSegmentsConfig config) {
  constexpr int kPixels = 4;  // of the whole in one of the half
  config.k /= kPixels;
  config.min_size = (config.min_size + kPixels - 1) / kPixels;
  return config;
}

}  // namespace

void ColorSegmentsConfig::describe(ConfigVisitor& visitor) {
  visitor.number("k", k, {0.0, 1e6}, "", "scale of observation, larger gives larger segments");
  visitor.number("sigma", sigma, {0.0, 5.0}, "px", "Gaussian smoothing before segmentation");
  visitor.integer("min_size", min_size, {1, 1e9}, "px", "smaller segments join their most similar neighbour");
  visitor.flag("halved", halved, "segments the image at half its size and fits the outlines to it: faster, as good");
}

/// The graph of components left by the tiles, and the merging along its edges by rising weight.
class ColorSegmenter::Graph {
 public:
  explicit Graph(const ColorSegmentsConfig& config)
      : k_(static_cast<float>(config.k)), min_size_(config.min_size), edges_(config.sigma), tiles_(k_) {}

  void segment(const cv::Mat3b& bgr, Segmentation& result);

 private:
  using Node = std::uint32_t;

  /// Between a node's pixels and another's; nodes are the components left by the tiles.
  struct Edge {
    Node a, b;
    std::uint32_t step;
  };
  struct Component {
    float internal;  ///< Int(C), grey levels
    int area;        ///< px
    int nodes;
  };

  void mergeTiles(int end_step);
  void gatherEdges();
  void takePendingEdges(int end_step);
  void sortBatch();
  void mergeBatch();
  void unite(Node a, Node b, float weight);
  void absorbSmallComponents();
  void numberComponents(Segmentation& result);
  [[nodiscard]] bool isSmall(Node node) const { return components_[partition_.label(node)].area < min_size_; }

  float k_;
  int min_size_;
  ColorEdges edges_;
  TileMerger tiles_;
  OpenEdges open_edges_;
  std::vector<std::int32_t> nodes_;  ///< of the pixels, rows padded
  std::ptrdiff_t node_stride_ = 0;
  std::size_t node_count_ = 0;
  std::vector<Component> components_;  ///< by label
  FlatPartition<Node> partition_;      ///< of the nodes
  std::vector<Edge> pending_;          ///< in row order
  std::size_t pending_size_ = 0;
  std::vector<Edge> batch_;  ///< edges about to be merged, in row order
  std::size_t batch_size_ = 0;
  std::vector<Edge> sorted_;  ///< the batch by rising weight
  std::vector<std::uint32_t> step_positions_;
  std::vector<Edge> rejected_;  ///< edges between components that did not merge, by rising weight
  std::vector<int> numbers_;
};

void ColorSegmenter::Graph::segment(const cv::Mat3b& bgr, Segmentation& result) {
  edges_.weigh(bgr);
  const auto [light, middle] = edges_.stepsAtShares(std::array{0.6, 0.8});
  mergeTiles(light);
  gatherEdges();
  rejected_.clear();
  for (const int end_step : {middle, ColorEdges::kSteps}) {
    takePendingEdges(end_step);
    sortBatch();
    mergeBatch();
  }
  absorbSmallComponents();
  numberComponents(result);
}

/// Merges within each tile; what it leaves becomes the nodes of the graph.
void ColorSegmenter::Graph::mergeTiles(int end_step) {
  constexpr std::size_t kTilePixels = TileMerger::kWidth * TileMerger::kHeight;
  std::array<std::int32_t, kTilePixels> node_of_label;
  const cv::Size size = edges_.size();
  node_stride_ = size.width + ColorEdges::kPadding;
  nodes_.resize(static_cast<std::size_t>(node_stride_ * size.height));
  std::size_t count = 0;
  for (int y = 0; y < size.height; y += TileMerger::kHeight) {
    for (int x = 0; x < size.width; x += TileMerger::kWidth) {
      const cv::Rect tile(x, y, std::min(TileMerger::kWidth, size.width - x),
                          std::min(TileMerger::kHeight, size.height - y));
      tiles_.merge(edges_, tile, end_step);
      components_.resize(std::max(components_.size(), count + kTilePixels + 1));
      for (int v = 0; v < tile.height; ++v) {
        const std::uint16_t* labels = tiles_.labels(v);
        for (int u = 0; u < tile.width; ++u) {
          const std::size_t pixel = static_cast<std::size_t>(v * TileMerger::kWidth + u);
          node_of_label[pixel] = static_cast<std::int32_t>(count);
          components_[count] = {tiles_.component(pixel).internal, tiles_.component(pixel).area, 1};
          count += labels[u] == pixel ? 1 : 0;
        }
      }
      for (int v = 0; v < tile.height; ++v) {
        const std::uint16_t* labels = tiles_.labels(v);
        std::int32_t* row = nodes_.data() + (y + v) * node_stride_ + x;
        for (int u = 0; u < tile.width; ++u) {
          row[u] = node_of_label[labels[u]];
        }
      }
    }
  }
  node_count_ = count;
  partition_.reset(node_count_);
}

/// Makes all edges between different nodes that can matter pending, in row order.
void ColorSegmenter::Graph::gatherEdges() {
  const cv::Size size = edges_.size();
  const std::array<std::ptrdiff_t, kEdgeDirections> offsets{1, node_stride_, node_stride_ + 1, node_stride_ - 1};
  const std::size_t most_in_row = static_cast<std::size_t>(kEdgeDirections * size.width);
  pending_size_ = 0;
  open_edges_.begin(edges_, nodes_.data(), node_stride_);
  for (int y = 0; y < size.height; ++y) {
    open_edges_.nextRow();
    if (pending_.size() < pending_size_ + most_in_row + 1) {
      pending_.resize(2 * (pending_size_ + most_in_row + 1));
    }
    Edge* out = pending_.data() + pending_size_;
    for (int d = 0; d < kEdgeDirections; ++d) {
      const std::uint16_t* steps = edges_.steps(y, d);
      const std::uint16_t* open = open_edges_.open(d);
      const std::int32_t* here = nodes_.data() + y * node_stride_;
      const std::int32_t* there = here + offsets[static_cast<std::size_t>(d)];
      const auto [first, end] = edges_.columns(y, d);
      for (int x = first; x < end; ++x) {
        *out = {static_cast<Node>(here[x]), static_cast<Node>(there[x]),
                steps[x] & std::uint32_t{ColorEdges::kStepMask}};
        out += open[x] & 1U;
      }
    }
    pending_size_ = static_cast<std::size_t>(out - pending_.data());
  }
}

/// Moves the pending edges of less than `end_step` to the batch, and drops those inside a component.
void ColorSegmenter::Graph::takePendingEdges(int end_step) {
  batch_.resize(std::max(batch_.size(), pending_size_ + 1));
  Edge* taken = batch_.data();
  Edge* kept = pending_.data();
  for (std::size_t i = 0; i < pending_size_; ++i) {
    const Edge edge = pending_[i];
    *taken = edge;
    *kept = edge;
    const bool open = partition_.label(edge.a) != partition_.label(edge.b);
    const bool take = edge.step < static_cast<std::uint32_t>(end_step);
    taken += open & take ? 1 : 0;
    kept += open & !take ? 1 : 0;
  }
  batch_size_ = static_cast<std::size_t>(taken - batch_.data());
  pending_size_ = static_cast<std::size_t>(kept - pending_.data());
}

/// Counting sort by weight; equal weights stay in row order.
void ColorSegmenter::Graph::sortBatch() {
  sorted_.resize(std::max(sorted_.size(), batch_size_));
  step_positions_.assign(ColorEdges::kSteps, 0U);
  for (std::size_t i = 0; i < batch_size_; ++i) {
    ++step_positions_[batch_[i].step];
  }
  std::exclusive_scan(step_positions_.begin(), step_positions_.end(), step_positions_.begin(), 0U);
  for (std::size_t i = 0; i < batch_size_; ++i) {
    sorted_[step_positions_[batch_[i].step]++] = batch_[i];
  }
}

/// Edges inside a component are dropped chunk by chunk, without a branch that the processor could guess wrongly.
void ColorSegmenter::Graph::mergeBatch() {
  const std::vector<float>& distances = ColorEdges::distances();
  constexpr std::size_t kChunk = 64;
  std::array<Edge, kChunk> open;
  for (std::size_t first = 0; first < batch_size_; first += kChunk) {
    const std::size_t end = std::min(batch_size_, first + kChunk);
    std::size_t count = 0;
    for (std::size_t i = first; i < end; ++i) {
      open[count] = sorted_[i];
      count += partition_.label(sorted_[i].a) != partition_.label(sorted_[i].b) ? 1 : 0;
    }
    for (std::size_t i = 0; i < count; ++i) {
      const Edge& edge = open[i];
      const Node a = partition_.label(edge.a), b = partition_.label(edge.b);
      if (a == b) {
        continue;
      }
      const float weight = distances[edge.step];
      const Component &one = components_[a], &two = components_[b];
      if (accepts(one.internal, one.area, weight, k_) && accepts(two.internal, two.area, weight, k_)) {
        unite(edge.a, edge.b, weight);
      } else {
        rejected_.push_back(edge);
      }
    }
  }
}

/// Joins the components of two nodes along an edge of that weight.
void ColorSegmenter::Graph::unite(Node a, Node b, float weight) {
  if (components_[partition_.label(a)].nodes < components_[partition_.label(b)].nodes) {
    std::swap(a, b);
  }
  Component& kept = components_[partition_.label(a)];
  const Component& joined = components_[partition_.label(b)];
  kept.area += joined.area;
  kept.nodes += joined.nodes;
  kept.internal = weight;
  partition_.join(b, a);
}

/// Joins components under the smallest size to the neighbour across their lightest edge.
void ColorSegmenter::Graph::absorbSmallComponents() {
  for (const Edge& edge : rejected_) {
    if ((isSmall(edge.a) || isSmall(edge.b)) && partition_.label(edge.a) != partition_.label(edge.b)) {
      unite(edge.a, edge.b, ColorEdges::distances()[edge.step]);
    }
  }
}

/// Numbers the components by their first pixels and labels the pixels.
void ColorSegmenter::Graph::numberComponents(Segmentation& result) {
  constexpr int kUnnumbered = -1;
  numbers_.assign(node_count_, kUnnumbered);
  result.count = 0;
  result.labels.create(edges_.size());
  for (int y = 0; y < result.labels.rows; ++y) {
    const std::int32_t* nodes = nodes_.data() + y * node_stride_;
    int* row = result.labels[y];
    for (int x = 0; x < result.labels.cols; ++x) {
      int& number = numbers_[partition_.label(static_cast<std::size_t>(nodes[x]))];
      if (number == kUnnumbered) {
        number = result.count++;
      }
      row[x] = number;
    }
  }
}

ColorSegmenter::ColorSegmenter(ColorSegmentsConfig config) : config_(config) {
  requireValid(config_);
  graph_ = std::make_unique<Graph>(config_.halved ? ofTheHalf(config_) : config_);
  upsampler_ = std::make_unique<LabelUpsampler>();
}

ColorSegmenter::~ColorSegmenter() = default;
ColorSegmenter::ColorSegmenter(ColorSegmenter&&) noexcept = default;
ColorSegmenter& ColorSegmenter::operator=(ColorSegmenter&&) noexcept = default;

const Segmentation& ColorSegmenter::segment(const cv::Mat3b& bgr) {
  segment(bgr, segmentation_);
  return segmentation_;
}

void ColorSegmenter::segment(const cv::Mat3b& bgr, Segmentation& segmentation) {
  if (bgr.empty()) {
    throw std::invalid_argument("colour segments: expected an image, found an empty one");
  }
  if (config_.halved) {
    graph_->segment(upsampler_->halve(bgr), half_);
    upsampler_->upsample(half_, bgr, segmentation);
  } else {
    graph_->segment(bgr, segmentation);
  }
}

}  // namespace saccade
