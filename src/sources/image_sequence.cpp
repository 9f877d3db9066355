#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "saccade/core/errors.hpp"
#include "saccade/core/multiversion.hpp"
#include "saccade/sources/depth_registration.hpp"
#include "saccade/sources/image_files.hpp"
#include "saccade/sources/label_folder.hpp"
#include "saccade/sources/undistortion.hpp"
#include "sources/frame_list.hpp"

namespace saccade {
namespace {

// Opening fails if none of so many first frames can be used: then the whole input is of the wrong kind.
constexpr std::size_t kProbedFrames = 5;
constexpr std::uint16_t kSaturated = 65535;

std::string sizeText(int width, int height) {
  return std::to_string(width) + " x " + std::to_string(height) + " px";
}

/// Raw depth in metres; the values of `invalid` become 0. Returns whether anything was measured.
SACCADE_MULTIVERSION
bool convertDepth(const std::uint16_t* raw, std::size_t count, float metres_per_unit, const std::uint16_t* invalid,
                  std::size_t invalid_count, float* depth_m) {
  std::uint16_t any = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint16_t value = raw[i] == kSaturated ? std::uint16_t{0} : raw[i];
    any = static_cast<std::uint16_t>(any | value);
    depth_m[i] = static_cast<float>(value) * metres_per_unit;
  }
  for (std::size_t k = 0; k < invalid_count; ++k) {
    for (std::size_t i = 0; i < count; ++i) depth_m[i] = raw[i] == invalid[k] ? 0.0f : depth_m[i];
  }
  return any != 0;
}

/// The folders of image files, all layouts: decodes, removes distortion, registers depth.
class ImageSequence final : public FrameSource {
 public:
  ImageSequence(FrameList list, const FrameRange& range, const std::filesystem::path& labels);

  [[nodiscard]] const SourceDescription& description() const override { return description_; }
  [[nodiscard]] ReadStatus read(RgbdFrame& frame) override;
  [[nodiscard]] const std::string& skipReason() const override { return skip_reason_; }

 private:
  void takeLabels(const std::filesystem::path& labels);
  void selectRange(const FrameRange& range);
  void settleCameras();
  void describe();
  void probe();
  void load(const FrameFiles& files, RgbdFrame& frame);
  void loadDepth(const FrameFiles& files, RgbdFrame& frame);

  std::vector<FrameFiles> frames_;  // the selected ones
  RgbdCalibration calibration_;
  SourceDescription description_;
  std::size_t next_ = 0;
  std::string skip_reason_;

  std::optional<Undistortion> undistortion_;       // only where colour is distorted
  std::optional<DepthRegistration> registration_;  // only where depth is not registered
  ImageReader reader_;
  cv::Mat3b distorted_color_;
  cv::Mat1w raw_depth_, distorted_label_;
  cv::Mat1f depth_D_m_;
};

ImageSequence::ImageSequence(FrameList list, const FrameRange& range, const std::filesystem::path& labels)
    : frames_(std::move(list.frames)),
      calibration_(std::move(list.calibration)),
      description_(std::move(list.description)) {
  for (std::size_t i = 0; i < frames_.size(); ++i) frames_[i].index.value = static_cast<std::int64_t>(i);
  description_.total_frames = static_cast<std::int64_t>(frames_.size());
  if (!labels.empty()) takeLabels(labels);
  selectRange(range);
  description_.depth_was_registered = !calibration_.depth;
  settleCameras();
  describe();
  probe();
}

void ImageSequence::takeLabels(const std::filesystem::path& labels) {
  const LabelFolder folder(labels);
  for (FrameFiles& files : frames_) files.label = folder.find(files.name);
  description_.ignore_from = folder.ignoreFrom();
  if (std::none_of(frames_.begin(), frames_.end(), [](const FrameFiles& files) { return files.label.has_value(); })) {
    throw IoError(folder.path(), "label images named like the frames (" + frames_.front().name + ".png)",
                  "none for any of " + counted(description_.total_frames, "frame"));
  }
}

void ImageSequence::selectRange(const FrameRange& range) {
  const std::int64_t total = description_.total_frames;
  const std::int64_t end = std::min(range.end.value_or(total), total);
  std::vector<FrameFiles> selected;
  for (std::int64_t i = range.first; i < end; i += range.step) {
    selected.push_back(std::move(frames_[static_cast<std::size_t>(i)]));
  }
  if (selected.empty()) {
    throw IoError(description_.location, "frames in the selected range",
                  "none of " + counted(total, "frame") + " from " + std::to_string(range.first) + " on");
  }
  frames_ = std::move(selected);
  description_.frames = static_cast<std::int64_t>(frames_.size());
}

void ImageSequence::settleCameras() {
  PinholeCamera& color = calibration_.color;
  if (color.width == 0) {  // the calibration is a bare matrix: the first readable image tells the size
    for (const FrameFiles& files : frames_) {
      try {
        const ImageHeader header = reader_.header(files.color);
        color.width = header.width;
        color.height = header.height;
        break;
      } catch (const IoError&) {
        if (&files == &frames_.back()) throw;
      }
    }
  }
  const DistortedCamera& real = description_.color_camera = {color, calibration_.color_distortion};
  const PinholeCamera& ideal = description_.camera = idealCameraOf(real);
  if (!real.distortion.isZero()) {
    undistortion_.emplace(ideal, real);
    // Depth that is registered to colour lies in the pixels of the distorted image: its rays are the colour lens'.
    if (!calibration_.depth) calibration_.depth = DepthCamera{color, real.distortion, Pose::Identity()};
  }
  if (calibration_.depth) registration_.emplace(ideal, *calibration_.depth);
}

void ImageSequence::describe() {
  description_.intrinsics_origin = calibration_.origin;
  description_.depth_units_per_metre = calibration_.depth_units_per_metre;
  for (const FrameFiles& files : frames_) {
    description_.has_depth |= !files.depth.empty();
    description_.has_poses |= files.T_WC.has_value();
    description_.has_labels |= files.label.has_value();
  }
  if (!description_.depth_was_registered) {
    description_.remarks.emplace_back("depth is rendered into the colour camera");
  }
  if (undistortion_) {
    std::ostringstream remark;
    remark.precision(1);
    remark << std::fixed << "lens distortion is removed; fx " << calibration_.color.fx << " becomes "
           << description_.camera.fx << ", so that no pixel is lost";
    description_.remarks.push_back(remark.str());
  }
}

// The first frames tell whether the input is what it seems; single bad ones are left to read().
void ImageSequence::probe() {
  RgbdFrame frame;
  std::optional<IoError> first_error;
  for (std::size_t i = 0; i < std::min(kProbedFrames, frames_.size()); ++i) {
    try {
      load(frames_[i], frame);
      return;
    } catch (const IoError& error) {
      if (!first_error) first_error = error;
    }
  }
  throw *first_error;
}

ReadStatus ImageSequence::read(RgbdFrame& frame) {
  if (next_ == frames_.size()) return ReadStatus::kEnd;
  const FrameFiles& files = frames_[next_++];
  frame.index = files.index;
  frame.name = files.name;
  frame.stamp_s = files.stamp_s;
  frame.T_WC = files.T_WC;
  try {
    load(files, frame);
    return ReadStatus::kFrame;
  } catch (const IoError& error) {
    skip_reason_ = error.what();
    return ReadStatus::kSkip;
  }
}

void ImageSequence::load(const FrameFiles& files, RgbdFrame& frame) {
  const PinholeCamera& color = calibration_.color;
  cv::Mat3b& stored = undistortion_ ? distorted_color_ : frame.color;
  reader_.readColor(files.color, stored);
  if (stored.cols != color.width || stored.rows != color.height) {
    throw IoError(files.color, sizeText(color.width, color.height) + " (" + calibration_.origin + ")",
                  sizeText(stored.cols, stored.rows));
  }
  if (undistortion_) undistortion_->undistort(distorted_color_, frame.color);

  loadDepth(files, frame);

  if (!files.label) {
    frame.label.release();
    return;
  }
  cv::Mat1w& stored_label = undistortion_ ? distorted_label_ : frame.label;
  reader_.readLabel(*files.label, stored_label);
  if (stored_label.size() != frame.color.size()) {
    throw IoError(*files.label, sizeText(color.width, color.height) + ", as colour",
                  sizeText(stored_label.cols, stored_label.rows));
  }
  if (undistortion_) undistortion_->undistort(distorted_label_, frame.label);
}

void ImageSequence::loadDepth(const FrameFiles& files, RgbdFrame& frame) {
  if (files.depth.empty()) {
    frame.depth_m.release();
    return;
  }
  reader_.readDepth(files.depth, raw_depth_);
  const PinholeCamera& camera = calibration_.depth ? calibration_.depth->camera : calibration_.color;
  if (raw_depth_.cols != camera.width || raw_depth_.rows != camera.height) {
    throw IoError(
        files.depth,
        sizeText(camera.width, camera.height) +
            (calibration_.depth ? " (" + calibration_.origin + ")" : ", as the colour image it is registered to"),
        sizeText(raw_depth_.cols, raw_depth_.rows));
  }
  cv::Mat1f& depth_m = registration_ ? depth_D_m_ : frame.depth_m;
  depth_m.create(raw_depth_.size());
  const bool measured =
      convertDepth(raw_depth_[0], raw_depth_.total(), static_cast<float>(1.0 / calibration_.depth_units_per_metre),
                   calibration_.depth_invalid.data(), calibration_.depth_invalid.size(), depth_m[0]);
  if (!measured) throw IoError(files.depth, "some pixels with a depth measurement", "none");
  if (registration_) registration_->render(depth_D_m_, frame.depth_m);
}

}  // namespace

std::unique_ptr<FrameSource> openFrameList(FrameList list, const FrameRange& range,
                                           const std::filesystem::path& labels) {
  return std::make_unique<ImageSequence>(std::move(list), range, labels);
}

}  // namespace saccade
