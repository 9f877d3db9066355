#include <algorithm>
#include <cctype>
#include <map>
#include <memory>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <set>

#include <fmt/format.h>

#include "saccade/core/errors.hpp"
#include "sources/bag_images.hpp"
#include "sources/bag_messages.hpp"
#include "sources/ideal_frames.hpp"
#include "sources/recorders.hpp"
#include "sources/recording_files.hpp"
#include "sources/stamp_pairer.hpp"

namespace saccade {
namespace {

constexpr double kSameMoment_s = 0.02;

double stampIn_s(const ros::Time& time) {
  return secondsOf(static_cast<std::int64_t>(time.sec) * 1'000'000'000 + time.nsec, kNanoseconds);
}

std::string lowered(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

bool has(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

/// A topic's fitness as colour or depth: the higher the better, 0: it is not.
int fitness(const std::string& name, const std::string& type, bool as_depth) {
  const std::string topic = lowered(name);
  const bool raw = type == "sensor_msgs/Image", compressed = type == "sensor_msgs/CompressedImage";
  const bool depth = has(topic, "depth") && !has(topic, "aligned_color");
  if ((!raw && !compressed) || depth != as_depth || has(topic, "infra") || has(topic, "/ir/")) return 0;
  if (raw && (has(topic, "compressed") || has(topic, "theora"))) return 0;
  if (!as_depth) return 2 + (raw ? 1 : 0) + (has(topic, "rgb") || has(topic, "color") ? 4 : 0);
  return 2 + (raw ? 1 : 0) + (has(topic, "registered") || has(topic, "aligned") ? 4 : 0);
}

std::string bestTopic(const std::map<std::string, std::string>& types, bool as_depth) {
  std::string best;
  int best_fitness = 0;
  for (const auto& [topic, type] : types) {
    const int fit = fitness(topic, type, as_depth);
    if (fit > best_fitness) {
      best = topic;
      best_fitness = fit;
    }
  }
  return best;
}

/// The camera_info beside an image topic: ".../camera_info" for ".../image_raw[/compressed]".
std::string infoTopic(const std::string& image_topic, const std::map<std::string, std::string>& types) {
  std::string place = image_topic;
  while (!place.empty()) {
    place.erase(place.find_last_of('/'));
    if (types.count(place + "/camera_info") != 0) return place + "/camera_info";
  }
  return "";
}

/// One camera as its camera_info has it; rectified topics have no distortion left.
std::pair<PinholeCamera, LensDistortion> cameraOf(const CameraInfoMessage& info, bool rectified,
                                                  const std::filesystem::path& path) {
  const auto width = static_cast<int>(info.width), height = static_cast<int>(info.height);
  if (rectified && info.P[0] > 0) return {{width, height, info.P[0], info.P[5], info.P[2], info.P[6]}, {}};
  LensDistortion lens;
  const bool distorted = std::any_of(info.D.begin(), info.D.end(), [](double d) { return d != 0.0; });
  if (distorted) {
    if (info.distortion_model != "plumb_bob" || info.D.size() < 4) {
      throw IoError(path, "plumb_bob distortion or none", info.distortion_model);
    }
    lens = {info.D[0], info.D[1], info.D[2], info.D[3], info.D.size() > 4 ? info.D[4] : 0.0};
  }
  return {{width, height, info.K[0], info.K[4], info.K[2], info.K[5]}, lens};
}

/// What /tf and /tf_static said last about each frame.
class TransformTree {
 public:
  void add(const TransformMessage& message) {
    for (const auto& t : message.transforms) {
      const Eigen::Quaterniond q(t.transform.rotation.w, t.transform.rotation.x, t.transform.rotation.y,
                                 t.transform.rotation.z);
      Pose T = Pose::Identity();
      T.linear() = q.normalized().toRotationMatrix();
      T.translation() =
          Eigen::Vector3d(t.transform.translation.x, t.transform.translation.y, t.transform.translation.z);
      if (T.matrix().allFinite())
        edges_[bare(t.child_frame_id)] = {bare(t.header.frame_id), T, stampIn_s(t.header.stamp)};
    }
  }
  struct ToRoot {
    std::string root;
    Pose T_root_frame = Pose::Identity();
    double newest_s = 0.0;  ///< of the transforms on the way
  };
  [[nodiscard]] ToRoot toRoot(const std::string& frame) const {
    ToRoot way{bare(frame)};
    constexpr int kMostSteps = 32;  // a loop in the tree must not be followed for ever
    for (int step = 0; step < kMostSteps; ++step) {
      const auto edge = edges_.find(way.root);
      if (edge == edges_.end()) break;
      way.T_root_frame = edge->second.T_parent_child * way.T_root_frame;
      way.newest_s = std::max(way.newest_s, edge->second.stamp_s);
      way.root = edge->second.parent;
    }
    return way;
  }

 private:
  struct Edge {
    std::string parent;
    Pose T_parent_child;
    double stamp_s;
  };
  static std::string bare(const std::string& frame) { return frame.starts_with('/') ? frame.substr(1) : frame; }
  std::map<std::string, Edge> edges_;
};

class BagSource final : public SensorSource {
 public:
  BagSource(const std::filesystem::path& path, const FrameRange& range) : path_(path), cursor_(range) {
    try {
      bag_.open(path.string(), rosbag::bagmode::Read);
      chooseTopics();
      readHeads();
      openView();
    } catch (const rosbag::BagException& error) {
      throw IoError(path, "a whole ROS 1 bag", error.what());
    } catch (const ros::Exception& error) {
      throw IoError(path, "a whole ROS 1 bag", error.what());
    }
  }

  [[nodiscard]] const RgbdCalibration& calibration() const override { return calibration_; }
  [[nodiscard]] const SourceDescription& description() const override { return description_; }
  [[nodiscard]] const std::string& skipReason() const override { return skip_reason_; }
  [[nodiscard]] SourceProgress progress() const override { return {0, end_reason_}; }

  [[nodiscard]] ReadStatus read(SensorFrame& frame) override {
    while (!cursor_.passed()) {
      const auto pair = nextPair();
      if (!pair) return ReadStatus::kEnd;
      if (!cursor_.take()) continue;
      frame.index = cursor_.last();
      frame.name = fmt::format("{:06}", frame.index.value);
      frame.stamp_s = pair->first_stamp_s;
      frame.T_WC = pair->first->T_WC;
      return load(*pair, frame);
    }
    return ReadStatus::kEnd;
  }

 private:
  struct ColorMessage {
    rosbag::MessageInstance message;
    std::optional<Pose> T_WC;
  };

  void chooseTopics() {
    rosbag::View all(bag_);
    for (const rosbag::ConnectionInfo* connection : all.getConnections())
      types_[connection->topic] = connection->datatype;
    color_topic_ = bestTopic(types_, false);
    depth_topic_ = bestTopic(types_, true);
    if (!color_topic_.empty() && !depth_topic_.empty()) return;
    std::string found;
    for (const auto& [topic, type] : types_) found += (found.empty() ? "" : ", ") + topic + " (" + type + ")";
    throw IoError(path_, "a topic of colour images and one of depth images", found.empty() ? "no messages" : found);
  }

  template <typename Message>
  std::shared_ptr<Message> firstOf(const std::string& topic) {
    rosbag::View view(bag_, rosbag::TopicQuery(topic));
    for (const rosbag::MessageInstance& message : view) {
      const auto instance = message.instantiate<Message>();
      if (instance) return std::make_shared<Message>(*instance);
    }
    return nullptr;
  }

  /// Calibration: the side file, else the first camera_info of each camera and the static transform between them.
  void readHeads() {
    const std::string color_info = infoTopic(color_topic_, types_), depth_info = infoTopic(depth_topic_, types_);
    const auto color = color_info.empty() ? nullptr : firstOf<CameraInfoMessage>(color_info);
    const auto depth = depth_info.empty() ? nullptr : firstOf<CameraInfoMessage>(depth_info);
    if (color) color_frame_ = color->header.frame_id;
    if (std::optional<RgbdCalibration> side = findSideCalibration(path_)) {
      calibration_ = *std::move(side);
    } else {
      if (!color || !(color->K[0] > 0)) {
        throw IoError(
            path_, "a camera_info beside " + color_topic_ + " (or a side file " + path_.filename().string() + ".yaml)",
            color ? "one without intrinsics" : "none");
      }
      calibration_.origin = color_info;
      std::tie(calibration_.color, calibration_.color_distortion) = cameraOf(*color, has(color_topic_, "rect"), path_);
      if (depth && depth->header.frame_id != color->header.frame_id) readDepthCamera(*depth);
    }
    if (calibration_.depth_units_per_metre > 0) {
      description_.depth_scale_origin = calibration_.origin;
    } else {
      calibration_.depth_units_per_metre = 1000.0;
      description_.depth_scale_origin = "ROS depth is in millimetres (16UC1) or metres (32FC1)";
    }
    description_.kind = "ROS bag";
    description_.location = path_.string();
    description_.frames = description_.total_frames = -1;
    description_.has_depth = true;
    description_.remarks.push_back("topics " + color_topic_ + " and " + depth_topic_);
    describeCalibration(calibration_, description_);
  }

  void readDepthCamera(const CameraInfoMessage& info) {
    rosbag::View transforms(bag_, rosbag::TopicQuery(std::vector<std::string>{"/tf_static", "/tf"}));
    for (const rosbag::MessageInstance& message : transforms) {
      if (const auto tf = message.instantiate<TransformMessage>()) tree_.add(*tf);
      const auto of_depth = tree_.toRoot(info.header.frame_id), of_color = tree_.toRoot(color_frame_);
      if (of_depth.root != of_color.root) continue;
      DepthCamera depth;
      std::tie(depth.camera, depth.distortion) = cameraOf(info, has(depth_topic_, "rect"), path_);
      depth.T_CD = of_color.T_root_frame.inverse() * of_depth.T_root_frame;
      calibration_.depth = depth;
      return;
    }
    throw IoError(path_,
                  "a transform between " + info.header.frame_id + " and " + color_frame_ + " (or a side file " +
                      path_.filename().string() + ".yaml)",
                  "none in /tf and /tf_static");
  }

  void openView() {
    view_ = std::make_unique<rosbag::View>(
        bag_, rosbag::TopicQuery(std::vector<std::string>{color_topic_, depth_topic_, "/tf", "/tf_static"}));
    next_ = view_->begin();
    description_.has_poses = types_.count("/tf") != 0 && !color_frame_.empty();
  }

  using Pairer = StampPairer<std::shared_ptr<const ColorMessage>, std::shared_ptr<const rosbag::MessageInstance>>;

  std::optional<Pairer::Pair> nextPair() {
    std::optional<Pairer::Pair> pair = pairer_.next();
    while (!pair && advance()) pair = pairer_.next();
    return pair;
  }

  /// Hands the next message of the bag on; false at the end. A damaged rest is given up and said to be.
  bool advance() {
    if (ended_) return false;
    try {
      if (next_ == view_->end()) {
        ended_ = true;
      } else {
        takeMessage(*next_);
        ++next_;
      }
    } catch (const std::exception& error) {
      end_reason_ = IoError(path_, "a whole ROS 1 bag", error.what()).what();
      ended_ = true;
    }
    if (ended_) pairer_.end();
    return true;
  }

  void takeMessage(const rosbag::MessageInstance& message) {
    if (message.getTopic() == color_topic_) {
      const double stamp_s = stampOf(message);
      pairer_.addFirst(stamp_s, std::make_shared<ColorMessage>(ColorMessage{message, poseAt(stamp_s)}));
    } else if (message.getTopic() == depth_topic_) {
      pairer_.addSecond(stampOf(message), std::make_shared<rosbag::MessageInstance>(message));
    } else if (const auto tf = message.instantiate<TransformMessage>()) {
      tree_.add(*tf);
    }
  }

  static double stampOf(const rosbag::MessageInstance& message) {
    if (const auto image = message.instantiate<ImageMessage>()) return stampIn_s(image->header.stamp);
    if (const auto image = message.instantiate<CompressedImageMessage>()) return stampIn_s(image->header.stamp);
    return stampIn_s(message.getTime());
  }

  /// The colour camera in the root of the tree, if something on the way moved just now.
  std::optional<Pose> poseAt(double stamp_s) const {
    if (color_frame_.empty()) return std::nullopt;
    const TransformTree::ToRoot way = tree_.toRoot(color_frame_);
    if (way.root == color_frame_ || std::abs(way.newest_s - stamp_s) > kSameMoment_s) return std::nullopt;
    return way.T_root_frame;
  }

  ReadStatus load(const Pairer::Pair& pair, SensorFrame& frame) {
    std::string wrong = loadColor(pair.first->message, frame.color);
    if (wrong.empty()) wrong = loadDepth(*pair.second, frame);
    const PinholeCamera& depth = calibration_.depth ? calibration_.depth->camera : calibration_.color;
    const cv::Size depth_size = frame.raw_depth.empty() ? frame.depth_m.size() : frame.raw_depth.size();
    if (wrong.empty() && (frame.color.size() != cv::Size(calibration_.color.width, calibration_.color.height) ||
                          depth_size != cv::Size(depth.width, depth.height))) {
      wrong = fmt::format("{} x {} and {} x {} px instead of the calibration's {} x {} and {} x {}", frame.color.cols,
                          frame.color.rows, depth_size.width, depth_size.height, calibration_.color.width,
                          calibration_.color.height, depth.width, depth.height);
    }
    if (wrong.empty()) return ReadStatus::kFrame;
    skip_reason_ = IoError(path_, "usable images in frame " + frame.name, wrong).what();
    return ReadStatus::kSkip;
  }

  static std::string loadColor(const rosbag::MessageInstance& message, cv::Mat3b& color) {
    if (const auto image = message.instantiate<ImageMessage>()) return readColor(*image, color);
    if (const auto image = message.instantiate<CompressedImageMessage>()) return readColor(*image, color);
    return "a message that is no image";
  }
  static std::string loadDepth(const rosbag::MessageInstance& message, SensorFrame& frame) {
    if (const auto image = message.instantiate<ImageMessage>()) {
      return readDepth(*image, frame.raw_depth, frame.depth_m);
    }
    if (const auto image = message.instantiate<CompressedImageMessage>()) {
      return readDepth(*image, frame.raw_depth, frame.depth_m);
    }
    return "a message that is no image";
  }

  std::filesystem::path path_;
  rosbag::Bag bag_;
  RangeCursor cursor_;
  std::map<std::string, std::string> types_;
  std::string color_topic_, depth_topic_, color_frame_;
  std::unique_ptr<rosbag::View> view_;
  rosbag::View::iterator next_;
  Pairer pairer_;
  TransformTree tree_;
  bool ended_ = false;
  std::string skip_reason_, end_reason_;
  RgbdCalibration calibration_;
  SourceDescription description_;
};

}  // namespace

std::unique_ptr<SensorSource> openBag(const std::filesystem::path& file, const FrameRange& range) {
  return std::make_unique<BagSource>(file, range);
}

}  // namespace saccade
