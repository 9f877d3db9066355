#include "inspection/session_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "inspection/tile_entries.hpp"
#include "saccade/attention/saliency.hpp"
#include "saccade/inspection/layer_picture.hpp"
#include "saccade/map/morton_code.hpp"

namespace saccade {
namespace {

constexpr double kSamePlace_m = 0.5;     ///< the part of the map around a camera serves others this near
constexpr std::size_t kMostViews = 200;  ///< frames from which lastSeen() looks at the map
constexpr int kLookReduction = 4;        ///< of the camera's resolution then
constexpr std::uint32_t kLastShare = (1u << 14) - 1;
constexpr double kNearest_m = 0.05;  ///< points nearer to the camera are not projected
constexpr int kJpegQuality = 88;

/// Box of projected points, clipped to the picture.
class PixelBox {
 public:
  void add(const PinholeCamera& camera, const Eigen::Vector3d& p_C) {
    if (p_C.z() < kNearest_m) return;
    box_.extend(camera.project(p_C));
  }
  [[nodiscard]] cv::Rect within(const PinholeCamera& camera, double margin_px) const {
    if (box_.isEmpty()) return {};
    const auto clip = [](double value, int size) {
      return static_cast<int>(std::lround(std::clamp(value, 0.0, static_cast<double>(size))));
    };
    const int left = clip(box_.min().x() - margin_px, camera.width),
              top = clip(box_.min().y() - margin_px, camera.height);
    return {left, top, clip(box_.max().x() + margin_px, camera.width) - left,
            clip(box_.max().y() + margin_px, camera.height) - top};
  }

 private:
  Eigen::AlignedBox2d box_;
};

}  // namespace

SessionPictures::SessionPictures(const OpenSession& session) : session_(session) {}

cv::Mat3b SessionPictures::color(std::int64_t ordinal) const {
  const auto keyframe = session_.reader.keyframe(FrameOrdinal{ordinal});
  return keyframe ? keyframe->color : cv::Mat3b();
}

cv::Mat3b SessionPictures::saliency(const cv::Mat3b& color) const {
  cv::Mat1b grey;
  SaliencyModel(session_.config.discovery.perception.saliency).compute(color).convertTo(grey, CV_8U, 255.0);
  cv::Mat3b picture;
  cv::cvtColor(grey, picture, cv::COLOR_GRAY2BGR);
  return picture;
}

cv::Mat3b SessionPictures::map(const Pose& T_WC) {
  const MapTree tree = mapAround(T_WC.translation()).view();
  const SurfaceView& view = renderer_.renderSurface(tree, session_.reader.metadata().camera, T_WC);
  return paintLayer(view, PictureLayer::kColor, tree, -Eigen::Vector3d::UnitY(), {});
}

cv::Mat3b SessionPictures::ior(const Pose& T_WC, Tick tick, const StateOf& state_of) {
  const MapTree tree = mapAround(T_WC.translation()).view();
  SurfaceView view = renderer_.renderSurface(tree, session_.reader.metadata().camera, T_WC);
  view.ior.inhibited = cv::Mat1b(view.ior.leaf_index.size());
  for (VisibleLeaf& leaf : view.ior.leaves) leaf.ior = state_of(leaf.key);
  for (int v = 0; v < view.ior.inhibited.rows; ++v) {
    for (int u = 0; u < view.ior.inhibited.cols; ++u) {
      const VisibleLeaf* leaf = view.ior.leafAt(u, v);
      view.ior.inhibited(v, u) = leaf != nullptr && inhibited(leaf->ior, tick) ? 255 : 0;
    }
  }
  return paintLayer(view, PictureLayer::kIorFlag, tree, -Eigen::Vector3d::UnitY(), {});
}

/// Looks at the map from up to kMostViews of the frames, in order, and notes for each block when it was last seen.
std::string SessionPictures::lastSeen() {
  std::map<std::uint64_t, std::uint32_t> last;  // by Morton code of the block of 4×4×4
  const PinholeCamera camera = session_.reader.metadata().camera.reducedBy(kLookReduction);
  const std::size_t count = session_.frames.size(), step = std::max<std::size_t>(1, count / kMostViews);
  for (std::size_t i = 0; i < count; i += step) {
    const std::optional<Pose>& T_WC = session_.frames[i].T_WC;
    if (!T_WC) continue;
    const IorView& view = renderer_.renderIor(mapAround(T_WC->translation()).view(), camera, *T_WC);
    const auto share = static_cast<std::uint32_t>(i * kLastShare / std::max<std::size_t>(1, count - 1));
    for (const VisibleLeaf& leaf : view.leaves) last[mortonCode(leaf.key) >> 6] = share;
  }
  TileEntries entries;
  for (const auto& [block, share] : last) entries.add(block << 6, share);
  return entries.take();
}

cv::Mat3b SessionPictures::cut(const cv::Mat3b& picture, const Pose& T_WC, const Eigen::AlignedBox3d& box_W) const {
  const PinholeCamera& camera = session_.reader.metadata().camera;
  PixelBox box;
  for (int corner = 0; corner < 8; ++corner) {
    box.add(camera, T_WC.inverse() * box_W.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)));
  }
  constexpr double kMargin_px = 12.0;
  const cv::Rect part = box.within(camera, kMargin_px) & cv::Rect({0, 0}, picture.size());
  return part.area() > 0 ? picture(part).clone() : cv::Mat3b();
}

const IorMap& SessionPictures::mapAround(const Eigen::Vector3d& centre_W) {
  if (!around_ || (centre_W - around_W_).norm() > kSamePlace_m) {
    around_.reset();
    around_.emplace(loadMap(session_.reader, MapRegion::ball(centre_W, renderer_.config().far_m + kSamePlace_m)));
    around_W_ = centre_W;
  }
  return *around_;
}

cv::Rect seenBox(std::span<const LeafKey> leaves, double leaf_size_m, const PinholeCamera& camera, const Pose& T_WC) {
  const Pose T_CW = T_WC.inverse();
  PixelBox box;
  for (const LeafKey& key : leaves) {
    const Eigen::Vector3d centre =
        (Eigen::Vector3d(key.x, key.y, key.z).array() - MapTree::kCentreKey + 0.5) * leaf_size_m;
    box.add(camera, T_CW * centre);
  }
  return box.within(camera, 0.0);
}

std::string jpegOf(const cv::Mat3b& picture) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
  return {bytes.begin(), bytes.end()};
}

}  // namespace saccade
