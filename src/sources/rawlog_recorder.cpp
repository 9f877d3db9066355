#include <algorithm>
#include <mrpt/core/Clock.h>
#include <mrpt/io/CFileGZOutputStream.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <mrpt/serialization/CArchive.h>
#include <zlib.h>

#include <fmt/format.h>

#include "saccade/core/errors.hpp"
#include "sources/rawlog_poses.hpp"
#include "sources/recorders.hpp"

namespace saccade {
namespace {

constexpr const char* kSensorLabel = "RGBD";
constexpr const char* kPoseLabel = "RGBD_POSE";

mrpt::img::TCamera toMrpt(const PinholeCamera& camera, const LensDistortion& lens) {
  mrpt::img::TCamera stored;
  stored.ncols = static_cast<std::uint32_t>(camera.width);
  stored.nrows = static_cast<std::uint32_t>(camera.height);
  stored.setIntrinsicParamsFromValues(camera.fx, camera.fy, camera.cx, camera.cy);
  if (!lens.isZero()) stored.setDistortionPlumbBob(lens.k1, lens.k2, lens.p1, lens.p2, lens.k3);
  return stored;
}

/// Stream of observations, one CObservation3DRangeScan a frame, images embedded without loss.
class RawlogRecorder final : public RecordingWriter {
 public:
  RawlogRecorder(const std::filesystem::path& path, const RgbdCalibration& calibration)
      : file_(path), depth_(calibration) {
    // MRPT's own default would embed JPEG.
    mrpt::img::CImage::DISABLE_JPEG_COMPRESSION(true);
    constexpr int kFastest = 1;
    if (!stream_.open(file_.partialPath().string(), kFastest)) {
      throw IoError(file_.partialPath(), "a file that can be written", "none");
    }
    const PinholeCamera& depth_camera = calibration.depth ? calibration.depth->camera : calibration.color;
    scan_.sensorLabel = kSensorLabel;
    scan_.range_is_depth = !calibration.depth_along_ray;
    scan_.rangeUnits = static_cast<float>(1.0 / depth_.unitsPerMetre());
    scan_.cameraParams =
        toMrpt(depth_camera, calibration.depth ? calibration.depth->distortion : calibration.color_distortion);
    scan_.cameraParamsIntensity = toMrpt(calibration.color, calibration.color_distortion);
    const Pose T_CD = calibration.depth ? calibration.depth->T_CD : Pose::Identity();
    T_RC_ = opticalInRangeCamera() * T_CD.inverse();
    scan_.relativePoseIntensityWRTDepth = saccade::toMrpt(T_RC_);
    for (const std::uint16_t raw : calibration.depth_invalid) invalid_.push_back(raw);
    invalid_.push_back(65535);
  }

  void write(const SensorFrame& frame) override {
    scan_.timestamp = mrpt::Clock::fromDouble(0.0) + mrpt::Clock::duration(stampIn(kMrptTicks, frame.stamp_s));
    scan_.hasIntensityImage = true;
    scan_.intensityImage = mrpt::img::CImage(frame.color, mrpt::img::SHALLOW_COPY);
    scan_.hasRangeImage = frame.hasDepth();
    if (frame.hasDepth()) takeDepth(depth_.of(frame));
    lost_labels_ |= !frame.label.empty();
    try {
      auto archive = mrpt::serialization::archiveFrom(stream_);
      if (frame.T_WC) {
        mrpt::obs::CObservationRobotPose pose;
        pose.sensorLabel = kPoseLabel;
        pose.timestamp = scan_.timestamp;
        pose.pose.mean = saccade::toMrpt(*frame.T_WC * T_RC_.inverse());
        archive << pose;
      }
      archive << scan_;
    } catch (const std::exception&) {
      throw IoError(file_.partialPath(), "room for the recording", "it could not be written in full");
    }
  }

  void finish() override {
    stream_.close();
    requireReadable();
    file_.complete();
  }

  [[nodiscard]] std::vector<std::string> losses() const override {
    std::vector<std::string> losses;
    if (depth_.rounded())
      losses.push_back(fmt::format("depth in metres was rounded to 1/{:g} m", depth_.unitsPerMetre()));
    if (lost_labels_) losses.emplace_back("labels are not kept in a rawlog");
    return losses;
  }

 private:
  /// MRPT knows one value without measurement, 0.
  void takeDepth(const cv::Mat1w& raw) {
    scan_.rangeImage_setSize(raw.rows, raw.cols);
    for (int v = 0; v < raw.rows; ++v) {
      for (int u = 0; u < raw.cols; ++u) {
        const std::uint16_t value = raw(v, u);
        const bool measured = std::find(invalid_.begin(), invalid_.end(), value) == invalid_.end();
        scan_.rangeImage(v, u) = measured ? value : std::uint16_t{0};
      }
    }
  }

  /// Closing does not say whether the last bytes reached the disk: the whole stream must unpack, with its checksum.
  void requireReadable() const {
    const gzFile file = ::gzopen(file_.partialPath().c_str(), "rb");
    bool whole = file != nullptr;
    std::vector<char> buffer(1 << 20);
    int got = 0;
    while (whole && (got = ::gzread(file, buffer.data(), static_cast<unsigned>(buffer.size()))) > 0) {
    }
    whole = whole && got == 0 && ::gzclose(file) == Z_OK;
    if (!whole) throw IoError(file_.partialPath(), "room for the recording", "it could not be written in full");
  }

  PartialFile file_;
  RecordedDepth depth_;
  mrpt::io::CFileGZOutputStream stream_;
  mrpt::obs::CObservation3DRangeScan scan_;
  Pose T_RC_ = Pose::Identity();
  std::vector<std::uint16_t> invalid_;
  bool lost_labels_ = false;
};

}  // namespace

std::unique_ptr<RecordingWriter> makeRawlogRecorder(const std::filesystem::path& file,
                                                    const RgbdCalibration& calibration) {
  return std::make_unique<RawlogRecorder>(file, calibration);
}

}  // namespace saccade
