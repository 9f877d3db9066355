#include "saccade/rendering/depth_completion.hpp"

#include <algorithm>
#include <cmath>

#include "core/fill_image.hpp"

namespace saccade {
namespace {

constexpr int kReduction = 2;  // of the model's view
// Where the plane of a model's pixel would lead farther than this share of the depth away within the pixel, it is seen
// so flat, or so close to an edge, that its depth alone is better.
constexpr float kMostSlope = 0.02F;

bool isMeasured(float depth_m) {
  return depth_m > 0.0F;
}

/// Moves `edge` of each column on from row `v` to the next one where it stands at `v` and nothing is measured. Returns
/// whether any moved.
bool moveEdges(const float* depth_m, int v, int step, std::vector<int>& edges) {
  int moved = 0;
  for (std::size_t u = 0; u < edges.size(); ++u) {
    const int moves = static_cast<int>(edges[u] == v) & static_cast<int>(!isMeasured(depth_m[u]));
    edges[u] += moves * step;
    moved |= moves;
  }
  return moved != 0;
}

}  // namespace

/// Whether there are any.
bool DepthCompletion::findStrips(const cv::Mat1f& depth_m) {
  const int width = depth_m.cols, height = depth_m.rows;
  top_.assign(static_cast<std::size_t>(width), 0);
  bottom_.assign(static_cast<std::size_t>(width), height - 1);  // the last measured row, for now
  for (int v = 0; v < height && moveEdges(depth_m[v], v, 1, top_); ++v) {
  }
  for (int v = height - 1; v >= 0 && moveEdges(depth_m[v], v, -1, bottom_); --v) {
  }
  for (int& row : bottom_) ++row;

  strips_.create(height, width);
  bool any = false;
  for (int v = 0; v < height; ++v) {
    std::uint8_t* strip = strips_[v];
    int inside = 0;
    for (int u = 0; u < width; ++u) {
      const auto column = static_cast<std::size_t>(u);
      strip[u] = static_cast<std::uint8_t>(static_cast<int>(v < top_[column]) | static_cast<int>(v >= bottom_[column]));
      inside += strip[u];
    }
    const float* row = depth_m[v];
    const auto begin = std::find_if(row, row + width, isMeasured) - row;
    std::fill_n(strip, begin, std::uint8_t{1});
    auto end = static_cast<std::ptrdiff_t>(width);
    while (end > begin && !isMeasured(row[end - 1])) --end;
    std::fill(strip + end, strip + width, std::uint8_t{1});
    any = any || inside > 0 || begin > 0 || end < width;
  }
  return any;
}

/// Whether anything was met there.
bool DepthCompletion::lookAtStrips(const PinholeCamera& camera, const SurfaceVolume& surface, const Pose& T_WC) {
  const PinholeCamera reduced = camera.reducedBy(kReduction);
  wanted_.create(reduced.height, reduced.width);
  for (int v = 0; v < reduced.height; ++v) {
    const std::uint8_t* upper = strips_[kReduction * v];
    const std::uint8_t* lower = strips_[kReduction * v + 1];
    for (int u = 0; u < reduced.width; ++u) {
      const int at = kReduction * u;
      wanted_(v, u) = static_cast<std::uint8_t>(upper[at] | upper[at + 1] | lower[at] | lower[at + 1]);
    }
  }
  surface.rayCast(reduced, T_WC, view_, &wanted_);
  for (int v = 0; v < reduced.height; ++v) {
    const float* row = view_.depth_m[v];
    if (std::any_of(row, row + reduced.width, isMeasured)) return true;
  }
  return false;
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
  if (!config_.enabled || surface.empty() || !findStrips(measured.depth_m)) return false;
  if (!lookAtStrips(measured.camera, surface, T_WC)) return false;
  completed.camera = measured.camera;
  measured.depth_m.copyTo(completed.depth_m);
  measured.vertices.copyTo(completed.vertices);
  measured.normals.copyTo(completed.normals);
  for (int v = 0; v < measured.depth_m.rows; ++v) fillRow(v, completed);
  return true;
}

}  // namespace saccade
