#include "saccade/inspection/layer_picture.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <opencv2/imgproc.hpp>

#include "inspection/leaf_walk.hpp"

namespace saccade {
namespace {

constexpr double kStrayShare = 0.01;  ///< of the pixels at either end that a range in metres leaves out
constexpr float kHole = std::numeric_limits<float>::quiet_NaN();

/// One value a pixel: what the layer measures; NaN at holes.
cv::Mat1f valuesOf(const SurfaceView& view, PictureLayer layer, const MapTree& map, const Eigen::Vector3d& up_W) {
  const IorView& ior = view.ior;
  std::vector<float> of_leaf(ior.leaves.size());
  const double leaf_m = ior.leaf_size_m;
  for (std::size_t i = 0; i < ior.leaves.size(); ++i) {
    const VisibleLeaf& leaf = ior.leaves[i];
    if (layer == PictureLayer::kOccupancy) {
      of_leaf[i] = 1.0f / (1.0f + std::exp(-findLeafNode(map, leaf.key).logOdds()));
    } else if (layer == PictureLayer::kHeight) {
      const Eigen::Vector3d centre =
          (Eigen::Vector3d(leaf.key.x, leaf.key.y, leaf.key.z).array() - MapTree::kCentreKey + 0.5) * leaf_m;
      of_leaf[i] = static_cast<float>(centre.dot(up_W));
    } else if (layer == PictureLayer::kIorWeight) {
      of_leaf[i] = static_cast<float>(weight(leaf.ior, ior.now));
    }
  }
  cv::Mat1f values(ior.leaf_index.size(), kHole);
  for (int v = 0; v < values.rows; ++v) {
    for (int u = 0; u < values.cols; ++u) {
      const std::int32_t leaf = ior.leaf_index(v, u);
      if (leaf == IorView::kNoLeaf) continue;
      values(v, u) = layer == PictureLayer::kDepth ? ior.depth_m(v, u) : of_leaf[static_cast<std::size_t>(leaf)];
    }
  }
  return values;
}

/// Values as grey levels of the range, 0 at holes.
cv::Mat1b levelsOf(const cv::Mat1f& values, const LayerRange& range) {
  const double width = std::max(range.highest - range.lowest, 1e-9);
  cv::Mat1b levels(values.size(), static_cast<uchar>(0));
  for (int v = 0; v < values.rows; ++v) {
    for (int u = 0; u < values.cols; ++u) {
      if (!std::isnan(values(v, u))) {
        levels(v, u) = cv::saturate_cast<uchar>(255.0 * (values(v, u) - range.lowest) / width);
      }
    }
  }
  return levels;
}

cv::Mat3b painted(const cv::Mat1b& levels, cv::ColormapTypes map) {
  cv::Mat3b picture;
  cv::applyColorMap(levels, picture, map);
  return picture;
}

/// The scene in grey, `share` as bright as it is, for colours to stand on.
cv::Mat3b greyScene(const SurfaceView& view, double share) {
  cv::Mat1b grey;
  cv::cvtColor(view.color, grey, cv::COLOR_BGR2GRAY);
  cv::Mat3b scene;
  cv::cvtColor(grey * share, scene, cv::COLOR_GRAY2BGR);
  return scene;
}

cv::Mat3b paintNormals(const SurfaceView& view) {
  cv::Mat3b picture(view.normals.size());
  for (int v = 0; v < picture.rows; ++v) {
    for (int u = 0; u < picture.cols; ++u) {
      const cv::Vec3f& n = view.normals(v, u);
      picture(v, u) =
          cv::Vec3b(cv::saturate_cast<uchar>(127.5f + 127.5f * n[2]), cv::saturate_cast<uchar>(127.5f + 127.5f * n[1]),
                    cv::saturate_cast<uchar>(127.5f + 127.5f * n[0]));
    }
  }
  return picture;
}

cv::Mat3b paintWeight(const SurfaceView& view, const LayerRange& range) {
  cv::Mat1f weights;
  view.weight.convertTo(weights, CV_32F);
  cv::Mat3b picture = greyScene(view, 0.45);
  painted(levelsOf(weights, {0.0, range.highest}), cv::COLORMAP_HOT).copyTo(picture, view.weight > 0);
  return picture;
}

cv::Mat3b paintFlag(const SurfaceView& view) {
  cv::Mat3b picture = greyScene(view, 0.35);
  picture.setTo(cv::Scalar(255, 255, 255), view.ior.inhibited);
  return picture;
}

}  // namespace

const std::vector<std::string>& pictureLayerNames() {
  static const std::vector<std::string> names = {"color", "depth", "normal", "occupancy", "height", "weight", "flag"};
  return names;
}

PictureLayer pictureLayer(std::string_view name) {
  const std::vector<std::string>& names = pictureLayerNames();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    throw std::invalid_argument("expected a layer color, depth, normal, occupancy, height, weight or flag, found \"" +
                                std::string(name) + "\"");
  }
  return static_cast<PictureLayer>(found - names.begin());
}

LayerRange rangeOf(const SurfaceView& view, PictureLayer layer, const MapTree& map, const Eigen::Vector3d& up_W) {
  if (layer == PictureLayer::kOccupancy) return {0.5, 1.0};
  const cv::Mat1f values = valuesOf(view, layer, map, up_W);
  std::vector<float> seen;
  std::copy_if(values.begin(), values.end(), std::back_inserter(seen), [](float value) { return !std::isnan(value); });
  if (seen.empty()) return {};
  const bool in_metres = layer == PictureLayer::kDepth || layer == PictureLayer::kHeight;
  const auto stray = static_cast<std::size_t>(in_metres ? kStrayShare * static_cast<double>(seen.size()) : 0.0);
  const auto nth = [&](std::size_t n) {
    std::nth_element(seen.begin(), seen.begin() + static_cast<std::ptrdiff_t>(n), seen.end());
    return static_cast<double>(seen[n]);
  };
  return {nth(stray), std::max(nth(seen.size() - 1 - stray), 1e-3)};
}

cv::Mat3b paintLayer(const SurfaceView& view, PictureLayer layer, const MapTree& map, const Eigen::Vector3d& up_W,
                     const LayerRange& range, const cv::Vec3b& background) {
  cv::Mat3b picture;
  switch (layer) {
    case PictureLayer::kColor:
      picture = view.color.clone();
      break;
    case PictureLayer::kNormal:
      picture = paintNormals(view);
      break;
    case PictureLayer::kIorWeight:
      picture = paintWeight(view, range);
      break;
    case PictureLayer::kIorFlag:
      picture = paintFlag(view);
      break;
    case PictureLayer::kDepth:
    case PictureLayer::kOccupancy:
    case PictureLayer::kHeight:
      picture = painted(levelsOf(valuesOf(view, layer, map, up_W), range), cv::COLORMAP_VIRIDIS);
      break;
  }
  picture.setTo(background, view.ior.leaf_index == IorView::kNoLeaf);
  return picture;
}

}  // namespace saccade
