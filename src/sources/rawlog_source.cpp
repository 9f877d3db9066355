#include <deque>
#include <exception>
#include <mrpt/core/Clock.h>
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <mrpt/obs/CRawlog.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/serialization/CArchive.h>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "saccade/core/errors.hpp"
#include "sources/frame_list.hpp"
#include "sources/ideal_frames.hpp"
#include "sources/rawlog_poses.hpp"
#include "sources/recorders.hpp"
#include "sources/recording_files.hpp"

namespace saccade {
namespace {

using mrpt::obs::CObservation3DRangeScan;
using mrpt::obs::CObservationRobotPose;

constexpr double kSameMoment_s = 0.01;  // between a pose and the frame it belongs to

double stampOf(const mrpt::obs::CObservation& observation) {
  const mrpt::Clock::duration since_epoch = observation.timestamp - mrpt::Clock::fromDouble(0.0);
  return secondsOf(since_epoch.count(), kMrptTicks);
}

bool isRgbd(const CObservation3DRangeScan& scan) {
  return scan.hasRangeImage && scan.hasIntensityImage &&
         scan.intensityImageChannel == CObservation3DRangeScan::CH_VISIBLE;
}

PinholeCamera cameraOf(const mrpt::img::TCamera& stored, int width, int height) {
  return {width, height, stored.fx(), stored.fy(), stored.cx(), stored.cy()};
}

LensDistortion lensOf(const mrpt::img::TCamera& stored, const std::filesystem::path& path) {
  if (stored.distortion == mrpt::img::DistortionModel::none) return {};
  if (stored.distortion == mrpt::img::DistortionModel::plumb_bob) {
    return {stored.k1(), stored.k2(), stored.p1(), stored.p2(), stored.k3()};
  }
  throw IoError(path, "cameras with plumb_bob distortion or none", "a fisheye model");
}

/// Reads the observations of a rawlog one after another, whatever they are nested in.
class ObservationStream {
 public:
  explicit ObservationStream(const std::filesystem::path& path) : path_(path) {
    if (!file_.open(path.string())) throw IoError(path, "an MRPT rawlog", "nothing that can be read");
  }

  /// The next observation; none at the end. Throws IoError where the file is damaged or cut off.
  mrpt::obs::CObservation::Ptr next() {
    while (pending_.empty()) {
      const std::uint64_t start = file_.getPosition();
      mrpt::serialization::CSerializable::Ptr object;
      try {
        auto archive = mrpt::serialization::archiveFrom(file_);
        archive >> object;
      } catch (const std::exception&) {
        if (file_.getPosition() == start && read_ > 0) return nullptr;  // nothing behind the last object
        throw IoError(path_, "a whole MRPT rawlog",
                      "damaged data, or the file's end, in the middle of object " + std::to_string(read_ + 1));
      }
      ++read_;
      take(object);
    }
    const auto observation = pending_.front();
    pending_.pop_front();
    return observation;
  }

 private:
  void take(const mrpt::serialization::CSerializable::Ptr& object) {
    if (const auto observation = std::dynamic_pointer_cast<mrpt::obs::CObservation>(object)) {
      pending_.push_back(observation);
    } else if (const auto frame = std::dynamic_pointer_cast<mrpt::obs::CSensoryFrame>(object)) {
      for (const auto& part : *frame) pending_.push_back(part);
    }
  }

  std::filesystem::path path_;
  mrpt::io::CFileGZInputStream file_;
  std::deque<mrpt::obs::CObservation::Ptr> pending_;
  std::int64_t read_ = 0;
};

class RawlogSource final : public SensorSource {
 public:
  RawlogSource(const std::filesystem::path& path, const FrameRange& range)
      : path_(path), stream_(path), cursor_(range) {
    mrpt::img::CImage::setImagesPathBase(mrpt::obs::CRawlog::detectImagesDirectory(path.string()));
    next_ = nextScan();
    if (!next_) {
      throw IoError(path, "range scans with an image of visible light (CObservation3DRangeScan)",
                    counted(others_, "other observation"));
    }
    readCalibration(*next_);
    describe();
  }

  [[nodiscard]] const RgbdCalibration& calibration() const override { return calibration_; }
  [[nodiscard]] const SourceDescription& description() const override { return description_; }
  [[nodiscard]] const std::string& skipReason() const override { return skip_reason_; }
  [[nodiscard]] SourceProgress progress() const override { return {0, end_reason_}; }

  [[nodiscard]] ReadStatus read(SensorFrame& frame) override {
    while (next_ && !cursor_.passed()) {
      const CObservation3DRangeScan::Ptr scan = next_;
      const bool taken = cursor_.take();
      if (taken) frame.T_WC = poseAt(*scan);
      next_ = nextScan();
      if (!taken) continue;
      frame.index = cursor_.last();
      frame.name = fmt::format("{:06}", frame.index.value);
      frame.stamp_s = stampOf(*scan);
      return load(*scan, frame);
    }
    return ReadStatus::kEnd;
  }

 private:
  /// The next RGB-D scan of the first sensor; poses on the way are kept. What follows damage is given up, not the rest.
  CObservation3DRangeScan::Ptr nextScan() {
    try {
      while (const auto observation = stream_.next()) {
        if (const auto pose = std::dynamic_pointer_cast<CObservationRobotPose>(observation)) {
          pose_ = pose;
          continue;
        }
        const auto scan = std::dynamic_pointer_cast<CObservation3DRangeScan>(observation);
        if (scan && isRgbd(*scan) && (sensor_label_.empty() || scan->sensorLabel == sensor_label_)) {
          if (sensor_label_.empty()) sensor_label_ = scan->sensorLabel;
          return scan;
        }
        ++others_;
      }
    } catch (const IoError& error) {
      if (!description_.kind.empty()) {
        end_reason_ = error.what();
        return nullptr;
      }
      throw;
    }
    return nullptr;
  }

  void readCalibration(const CObservation3DRangeScan& scan) {
    if (std::optional<RgbdCalibration> side = findSideCalibration(path_)) {
      calibration_ = *std::move(side);
    } else {
      scan.load();
      calibration_.origin = "the rawlog's own calibration (sensor \"" + sensor_label_ + "\")";
      calibration_.color = cameraOf(scan.cameraParamsIntensity, static_cast<int>(scan.intensityImage.getWidth()),
                                    static_cast<int>(scan.intensityImage.getHeight()));
      calibration_.color_distortion = lensOf(scan.cameraParamsIntensity, path_);
      DepthCamera depth;
      depth.camera = cameraOf(scan.cameraParams, static_cast<int>(scan.rangeImage.cols()),
                              static_cast<int>(scan.rangeImage.rows()));
      depth.distortion = lensOf(scan.cameraParams, path_);
      depth.T_CD = fromMrpt(scan.relativePoseIntensityWRTDepth).inverse() * opticalInRangeCamera();
      if (!scan.doDepthAndIntensityCamerasCoincide() || depth.camera != calibration_.color) calibration_.depth = depth;
      calibration_.depth_along_ray = !scan.range_is_depth;
      if (!(calibration_.color.fx > 0) || !(depth.camera.fx > 0)) {
        throw IoError(path_, "the intrinsics of both cameras (or a side file " + path_.filename().string() + ".yaml)",
                      "none");
      }
    }
    if (!(calibration_.depth_units_per_metre > 0)) {
      // A float has some 7 digits: the one nearest to 1/10000 means 10000.
      const double units = 1.0 / static_cast<double>(scan.rangeUnits);
      const double unit_of_sixth_digit = std::pow(10.0, std::floor(std::log10(units)) - 5.0);
      calibration_.depth_units_per_metre = std::round(units / unit_of_sixth_digit) * unit_of_sixth_digit;
      description_.depth_scale_origin = "the rawlog's rangeUnits";
    } else {
      description_.depth_scale_origin = calibration_.origin;
    }
  }

  void describe() {
    description_.location = path_.string();
    description_.frames = description_.total_frames = -1;
    description_.has_depth = true;
    description_.has_poses = poseAt(*next_).has_value();
    describeCalibration(calibration_, description_);
    description_.kind = "MRPT rawlog";
  }

  /// Pose of the colour camera, where the robot's pose was logged at the same moment.
  std::optional<Pose> poseAt(const CObservation3DRangeScan& scan) const {
    if (!pose_ || std::abs(stampOf(*pose_) - stampOf(scan)) > kSameMoment_s) return std::nullopt;
    const Pose T_WC =
        fromMrpt(pose_->pose.mean) * fromMrpt(scan.sensorPose) * fromMrpt(scan.relativePoseIntensityWRTDepth);
    return T_WC.matrix().allFinite() ? std::optional(T_WC) : std::nullopt;
  }

  ReadStatus load(const CObservation3DRangeScan& scan, SensorFrame& frame) {
    try {
      scan.load();
      const cv::Mat& image = scan.intensityImage.asCvMatRef();
      if (image.channels() == 1) {
        cv::cvtColor(image, frame.color, cv::COLOR_GRAY2BGR);
      } else {
        image.copyTo(frame.color);
      }
    } catch (const std::exception&) {
      return skip(frame, "an image that can be loaded", "none (is the folder of external images there?)");
    }
    const PinholeCamera& depth = calibration_.depth ? calibration_.depth->camera : calibration_.color;
    const auto rows = static_cast<int>(scan.rangeImage.rows()), cols = static_cast<int>(scan.rangeImage.cols());
    if (frame.color.cols != calibration_.color.width || frame.color.rows != calibration_.color.height ||
        cols != depth.width || rows != depth.height) {
      return skip(frame, "images of the calibration's size",
                  fmt::format("{} x {} and {} x {}", frame.color.cols, frame.color.rows, cols, rows));
    }
    frame.raw_depth.create(rows, cols);
    for (int v = 0; v < rows; ++v) {
      for (int u = 0; u < cols; ++u) frame.raw_depth(v, u) = scan.rangeImage(v, u);
    }
    scan.unload();
    return ReadStatus::kFrame;
  }

  ReadStatus skip(const SensorFrame& frame, const std::string& expected, const std::string& found) {
    skip_reason_ = IoError(path_, expected + " in frame " + frame.name, found).what();
    return ReadStatus::kSkip;
  }

  std::filesystem::path path_;
  ObservationStream stream_;
  RangeCursor cursor_;
  std::string sensor_label_, skip_reason_, end_reason_;
  std::int64_t others_ = 0;
  CObservation3DRangeScan::Ptr next_;
  CObservationRobotPose::Ptr pose_;
  RgbdCalibration calibration_;
  SourceDescription description_;
};

}  // namespace

std::unique_ptr<SensorSource> openRawlog(const std::filesystem::path& file, const FrameRange& range) {
  return std::make_unique<RawlogSource>(file, range);
}

}  // namespace saccade
