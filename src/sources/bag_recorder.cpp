#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <memory>
#include <rosbag/bag.h>

#include "saccade/core/errors.hpp"
#include "sources/bag_messages.hpp"
#include "sources/recorders.hpp"

namespace saccade {
namespace {

constexpr const char* kColorFrame = "camera_rgb_optical_frame";
constexpr const char* kDepthFrame = "camera_depth_optical_frame";
constexpr const char* kWorldFrame = "world";
constexpr double kMillimetres = 1000.0;

CameraInfoMessage infoOf(const PinholeCamera& camera, const LensDistortion& lens, const char* frame) {
  CameraInfoMessage info;
  info.header.frame_id = frame;
  info.width = static_cast<std::uint32_t>(camera.width);
  info.height = static_cast<std::uint32_t>(camera.height);
  info.distortion_model = "plumb_bob";
  info.D = {lens.k1, lens.k2, lens.p1, lens.p2, lens.k3};
  info.K = {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1};
  info.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.P = {camera.fx, 0, camera.cx, 0, 0, camera.fy, camera.cy, 0, 0, 0, 1, 0};
  return info;
}

TransformStampedMessage transformOf(const Pose& T_parent_child, const char* parent, const char* child,
                                    const ros::Time& stamp) {
  TransformStampedMessage transform;
  transform.header.stamp = stamp;
  transform.header.frame_id = parent;
  transform.child_frame_id = child;
  const Eigen::Quaterniond q(T_parent_child.linear());
  transform.transform.translation.x = T_parent_child.translation().x();
  transform.transform.translation.y = T_parent_child.translation().y();
  transform.transform.translation.z = T_parent_child.translation().z();
  transform.transform.rotation.x = q.x();
  transform.transform.rotation.y = q.y();
  transform.transform.rotation.z = q.z();
  transform.transform.rotation.w = q.w();
  return transform;
}

template <typename T>
void setPixels(const cv::Mat_<T>& image, const char* encoding, ImageMessage& message) {
  message.width = static_cast<std::uint32_t>(image.cols);
  message.height = static_cast<std::uint32_t>(image.rows);
  message.encoding = encoding;
  message.is_bigendian = 0;
  message.step = static_cast<std::uint32_t>(image.cols * static_cast<int>(sizeof(T)));
  message.data.resize(static_cast<std::size_t>(message.step) * message.height);
  for (int v = 0; v < image.rows; ++v) {
    std::memcpy(&message.data[static_cast<std::size_t>(v) * message.step], image[v], message.step);
  }
}

/// Topics as openni_launch names them; depth as 16UC1 where the sensor counts millimetres, else as 32FC1 metres.
class BagRecorder final : public RecordingWriter {
 public:
  BagRecorder(const std::filesystem::path& path, const RgbdCalibration& calibration)
      : file_(path), calibration_(calibration) {
    const DepthCamera depth = calibration.depth.value_or(DepthCamera{calibration.color, calibration.color_distortion});
    color_info_ = infoOf(calibration.color, calibration.color_distortion, kColorFrame);
    depth_info_ = infoOf(depth.camera, depth.distortion, calibration.depth ? kDepthFrame : kColorFrame);
    depth_topic_ = calibration.depth ? "/camera/depth/" : "/camera/depth_registered/";
    if (calibration.depth_along_ray) {
      throw IoError(path, "depth along the optical axis, all that a bag can say",
                    "depth along the rays; record it to another kind");
    }
    guarded([&] {
      bag_->open(file_.partialPath().string(), rosbag::bagmode::Write);
      bag_->setCompression(rosbag::compression::LZ4);
    });
  }

  void write(const SensorFrame& frame) override {
    constexpr std::int64_t kPerSecond = 1'000'000'000;
    const std::int64_t stamp_ns = stampIn(kNanoseconds, frame.stamp_s);
    const ros::Time stamp(static_cast<std::uint32_t>(stamp_ns / kPerSecond),
                          static_cast<std::uint32_t>(stamp_ns % kPerSecond));
    // Readers get messages of one time in any order, so transforms are logged 1 ns before the images that need them.
    // A bag may not hold the time 0, which ROS takes for "none".
    const ros::Duration step(0, 1);
    const ros::Time logged = std::max(stamp, ros::TIME_MIN + step), before = logged - step;
    guarded([&] {
      if (written_++ == 0) writeStatic(before);
      if (frame.T_WC) {
        bag_->write("/tf", before, TransformMessage{{transformOf(*frame.T_WC, kWorldFrame, kColorFrame, stamp)}});
      }
      color_.header.stamp = color_info_.header.stamp = depth_.header.stamp = depth_info_.header.stamp = stamp;
      color_.header.frame_id = color_info_.header.frame_id;
      depth_.header.frame_id = depth_info_.header.frame_id;
      setPixels(frame.color, "bgr8", color_);
      bag_->write("/camera/rgb/camera_info", logged, color_info_);
      bag_->write("/camera/rgb/image_raw", logged, color_);
      if (!frame.hasDepth()) return;
      setDepth(frame);
      bag_->write(depth_topic_ + "camera_info", logged, depth_info_);
      bag_->write(depth_topic_ + "image_raw", logged, depth_);
    });
    lost_labels_ |= !frame.label.empty();
  }

  void finish() override {
    guarded([&] { bag_->close(); });
    if (scaled_) writeSideFile();
    file_.complete();
  }

  [[nodiscard]] std::vector<std::string> losses() const override {
    if (!lost_labels_) return {};
    return {"labels are not kept in a bag"};
  }

 private:
  template <typename Action>
  void guarded(const Action& action) {
    if (!bag_) throw IoError(file_.partialPath(), "a bag that can be written", "one that failed before");
    try {
      action();
    } catch (const std::exception& error) {
      // Its destructor would write again, throw again and so end the program: a broken bag is left alone instead.
      (void)bag_.release();
      throw IoError(file_.partialPath(), "room for the recording", error.what());
    }
  }

  void writeStatic(const ros::Time& logged) {
    if (!calibration_.depth) return;
    const Pose T_CD = calibration_.depth->T_CD;
    bag_->write("/tf_static", logged, TransformMessage{{transformOf(T_CD, kColorFrame, kDepthFrame, logged)}});
  }

  [[nodiscard]] bool isMeasured(std::uint16_t raw) const {
    const std::vector<std::uint16_t>& invalid = calibration_.depth_invalid;
    return raw != 0 && raw != 65535 && std::find(invalid.begin(), invalid.end(), raw) == invalid.end();
  }

  void setDepth(const SensorFrame& frame) {
    if (!frame.depth_m.empty()) return setPixels(frame.depth_m, "32FC1", depth_);
    const auto& raw = frame.raw_depth;
    if (calibration_.depth_units_per_metre == kMillimetres) {
      depth_mm_.create(raw.size());
      std::transform(raw.begin(), raw.end(), depth_mm_.begin(),
                     [&](std::uint16_t value) { return isMeasured(value) ? value : std::uint16_t{0}; });
      return setPixels(depth_mm_, "16UC1", depth_);
    }
    const auto metres_per_unit = static_cast<float>(1.0 / calibration_.depth_units_per_metre);
    depth_m_.create(raw.size());
    std::transform(raw.begin(), raw.end(), depth_m_.begin(), [&](std::uint16_t value) {
      return isMeasured(value) ? static_cast<float>(value) * metres_per_unit : std::numeric_limits<float>::quiet_NaN();
    });
    setPixels(depth_m_, "32FC1", depth_);
    scaled_ = true;
  }

  /// Metres do not tell which unit the sensor counts; recording the bag again takes it from here.
  void writeSideFile() const {
    RgbdCalibration stored = calibration_;
    stored.depth_invalid.clear();
    std::filesystem::path side = file_.path();
    side += ".yaml";
    std::ofstream yaml(side);
    yaml << "# written by saccade record: the bag's own calibration, and the sensor's unit of depth\n"
         << calibrationYaml(stored);
    yaml.flush();
    if (!yaml) throw IoError(side, "room for the calibration", "it could not be written in full");
  }

  PartialFile file_;
  RgbdCalibration calibration_;
  std::unique_ptr<rosbag::Bag> bag_ = std::make_unique<rosbag::Bag>();
  std::string depth_topic_;
  CameraInfoMessage color_info_, depth_info_;
  ImageMessage color_, depth_;
  cv::Mat1w depth_mm_;
  cv::Mat1f depth_m_;
  std::int64_t written_ = 0;
  bool scaled_ = false, lost_labels_ = false;
};

}  // namespace

std::unique_ptr<RecordingWriter> makeBagRecorder(const std::filesystem::path& file,
                                                 const RgbdCalibration& calibration) {
  return std::make_unique<BagRecorder>(file, calibration);
}

}  // namespace saccade
