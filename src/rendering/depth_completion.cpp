#include "saccade/rendering/depth_completion.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

constexpr int kReduction = 4;  // of the model's view
// Where the plane of a model's pixel would lead farther than this share of the depth away within the pixel, it is seen
// so flat, or so close to an edge, that its depth alone is better.
constexpr float kMostSlope = 0.02F;

bool isMeasured(float depth_m) {
  return depth_m > 0.0F;
}

/// Moves the edge of each column from `begin` to `end` on by `step` where it stands at row `v` and nothing is measured
/// there.
SACCADE_MULTIVERSION
void moveEdges(const float* depth_m, int begin, int end, int v, int step, int* edges) {
  for (int u = begin; u < end; ++u) {
    const int moves = static_cast<int>(edges[u] == v) & static_cast<int>(!(depth_m[u] > 0.0F));
    edges[u] += moves * step;
  }
}

/// Moves the edges of all columns, which stand at row `from`, on to the first one that is measured, or past the image.
void findEdges(const cv::Mat1f& depth_m, int from, int step, int* edges) {
  int begin = 0, end = depth_m.cols;  // of the columns whose edges still move
  for (int v = from; v >= 0 && v < depth_m.rows && begin < end; v += step) {
    moveEdges(depth_m[v], begin, end, v, step, edges);
    while (begin < end && edges[begin] != v + step) ++begin;
    while (begin < end && edges[end - 1] != v + step) --end;
  }
}

/// Marks what of row `v` lies above or below all that is measured in its column.
SACCADE_MULTIVERSION
void markOutside(const int* first, const int* last, int width, int v, std::uint8_t* strip) {
  for (int u = 0; u < width; ++u) {
    strip[u] = static_cast<std::uint8_t>(static_cast<int>(v < first[u]) | static_cast<int>(v > last[u]));
  }
}

}  // namespace

void DepthCompletion::findStrips(const cv::Mat1f& depth_m) {
  const int width = depth_m.cols, height = depth_m.rows;
  first_.assign(static_cast<std::size_t>(width), 0);
  last_.assign(static_cast<std::size_t>(width), height - 1);
  findEdges(depth_m, 0, 1, first_.data());
  for (std::size_t u = 0; u < first_.size(); ++u) {
    if (first_[u] == height) last_[u] = -1;  // what the next line would find, slowly
  }
  findEdges(depth_m, height - 1, -1, last_.data());
  strips_.create(height, width);
  for (int v = 0; v < height; ++v) {
    const float* row = depth_m[v];
    std::uint8_t* strip = strips_[v];
    markOutside(first_.data(), last_.data(), width, v, strip);
    int begin = 0, end = width;
    while (begin < width && !isMeasured(row[begin])) strip[begin++] = 1;
    while (end > begin && !isMeasured(row[end - 1])) strip[--end] = 1;
  }
}

/// The pixels of the model's view that a strip touches; whether there are any.
bool DepthCompletion::findWanted() {
  bool any = false;
  for (int v = 0; v < wanted_.rows; ++v) {
    for (int u = 0; u < wanted_.cols; ++u) {
      std::uint8_t touched = 0;
      for (int i = 0; i < kReduction; ++i) {
        const std::uint8_t* strip = &strips_(kReduction * v + i, kReduction * u);
        for (int k = 0; k < kReduction; ++k) touched |= strip[k];
      }
      wanted_(v, u) = touched;
      any = any || touched != 0;
    }
  }
  return any;
}

void DepthCompletion::fillRow(int v, DepthMaps& completed) const {
  const PinholeCamera &camera = completed.camera, &reduced = view_.camera;
  const int row = std::min(v / kReduction, reduced.height - 1);
  const auto y = static_cast<float>((v - camera.cy) / camera.fy);
  const auto y_M = static_cast<float>((row - reduced.cy) / reduced.fy);
  const auto per_fx = static_cast<float>(1.0 / camera.fx), per_fx_M = static_cast<float>(1.0 / reduced.fx);
  const auto cx = static_cast<float>(camera.cx), cx_M = static_cast<float>(reduced.cx);
  const std::uint8_t* strip = strips_[v];
  const float* seen = view_.depth_m[row];
  const cv::Vec3f* normals = view_.normals[row];
  for (int u = 0; u < camera.width; ++u) {
    const int column = std::min(u / kReduction, reduced.width - 1);
    const float d = seen[column];
    if (strip[u] == 0 || !isMeasured(d)) continue;
    const cv::Vec3f& n = normals[column];
    const float x = (static_cast<float>(u) - cx) * per_fx;
    const float x_M = (static_cast<float>(column) - cx_M) * per_fx_M;
    const float on_plane = d * (n[0] * x_M + n[1] * y_M + n[2]) / (n[0] * x + n[1] * y + n[2]);
    const float z = std::abs(on_plane - d) <= kMostSlope * d ? on_plane : d;  // false for NaN
    completed.depth_m(v, u) = z;
    completed.vertices(v, u) = {x * z, y * z, z};
    completed.normals(v, u) = n;
  }
}

bool DepthCompletion::complete(const DepthMaps& measured, const SurfaceVolume& surface, const Pose& T_WC,
                               DepthMaps& completed) {
  if (!config_.enabled || surface.empty()) return false;
  findStrips(measured.depth_m);
  const PinholeCamera reduced = measured.camera.reducedBy(kReduction);
  wanted_.create(reduced.height, reduced.width);
  if (!findWanted()) return false;
  surface.rayCast(reduced, T_WC, view_, &wanted_);
  if (cv::countNonZero(view_.depth_m) == 0) return false;
  completed.camera = measured.camera;
  measured.depth_m.copyTo(completed.depth_m);
  measured.vertices.copyTo(completed.vertices);
  measured.normals.copyTo(completed.normals);
  for (int v = 0; v < measured.depth_m.rows; ++v) fillRow(v, completed);
  return true;
}

}  // namespace saccade
