#include <algorithm>

#include "saccade/core/errors.hpp"
#include "saccade/sources/image_files.hpp"
#include "saccade/sources/label_folder.hpp"
#include "saccade/sources/sensor_source.hpp"
#include "sources/frame_list.hpp"
#include "sources/ideal_frames.hpp"
#include "sources/range_image_text.hpp"

namespace saccade {
namespace {

// Opening fails if none of so many first frames can be used: then the whole input is of the wrong kind.
constexpr std::size_t kProbedFrames = 5;

std::string sizeText(int width, int height) {
  return std::to_string(width) + " x " + std::to_string(height) + " px";
}

/// The folders of image files, all layouts: decodes colour, depth and labels and checks that they are what they should.
class ImageFolder final : public SensorSource {
 public:
  ImageFolder(FrameList list, const FrameRange& range, const std::filesystem::path& labels);

  [[nodiscard]] const RgbdCalibration& calibration() const override { return calibration_; }
  [[nodiscard]] const SourceDescription& description() const override { return description_; }
  [[nodiscard]] ReadStatus read(SensorFrame& frame) override;
  [[nodiscard]] const std::string& skipReason() const override { return skip_reason_; }

 private:
  void takeLabels(const std::filesystem::path& labels);
  void selectRange(const FrameRange& range);
  void settleSize();
  void describe();
  void probe();
  void load(const FrameFiles& files, SensorFrame& frame);
  void loadDepth(const FrameFiles& files, SensorFrame& frame);

  std::vector<FrameFiles> frames_;  // the selected ones
  RgbdCalibration calibration_;
  SourceDescription description_;
  std::size_t next_ = 0;
  std::string skip_reason_;
  ImageReader reader_;
};

ImageFolder::ImageFolder(FrameList list, const FrameRange& range, const std::filesystem::path& labels)
    : frames_(std::move(list.frames)),
      calibration_(std::move(list.calibration)),
      description_(std::move(list.description)) {
  for (std::size_t i = 0; i < frames_.size(); ++i) frames_[i].index.value = static_cast<std::int64_t>(i);
  description_.total_frames = static_cast<std::int64_t>(frames_.size());
  if (!labels.empty()) takeLabels(labels);
  selectRange(range);
  settleSize();
  describe();
  probe();
}

void ImageFolder::takeLabels(const std::filesystem::path& labels) {
  const LabelFolder folder(labels);
  for (FrameFiles& files : frames_) files.label = folder.find(files.name);
  description_.ignore_from = folder.ignoreFrom();
  if (std::none_of(frames_.begin(), frames_.end(), [](const FrameFiles& files) { return files.label.has_value(); })) {
    throw IoError(folder.path(), "label images named like the frames (" + frames_.front().name + ".png)",
                  "none for any of " + counted(description_.total_frames, "frame"));
  }
}

void ImageFolder::selectRange(const FrameRange& range) {
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

// Where the calibration is a bare matrix, the first readable image tells the size.
void ImageFolder::settleSize() {
  PinholeCamera& color = calibration_.color;
  if (color.width != 0) return;
  for (const FrameFiles& files : frames_) {
    try {
      const ImageHeader header = reader_.header(files.color);
      color.width = header.width;
      color.height = header.height;
      return;
    } catch (const IoError&) {
      if (&files == &frames_.back()) throw;
    }
  }
}

void ImageFolder::describe() {
  describeCalibration(calibration_, description_);
  for (const FrameFiles& files : frames_) {
    description_.has_depth |= !files.depth.empty();
    description_.has_poses |= files.T_WC.has_value();
    description_.has_labels |= files.label.has_value();
  }
}

// The first frames tell whether the input is what it seems; single bad ones are left to read().
void ImageFolder::probe() {
  SensorFrame frame;
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

ReadStatus ImageFolder::read(SensorFrame& frame) {
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

void ImageFolder::load(const FrameFiles& files, SensorFrame& frame) {
  const PinholeCamera& color = calibration_.color;
  reader_.readColor(files.color, frame.color);
  if (frame.color.cols != color.width || frame.color.rows != color.height) {
    throw IoError(files.color, sizeText(color.width, color.height) + " (" + calibration_.origin + ")",
                  sizeText(frame.color.cols, frame.color.rows));
  }
  loadDepth(files, frame);
  if (!files.label) {
    frame.label.release();
    return;
  }
  reader_.readLabel(*files.label, frame.label);
  if (frame.label.size() != frame.color.size()) {
    throw IoError(*files.label, sizeText(color.width, color.height) + ", as colour",
                  sizeText(frame.label.cols, frame.label.rows));
  }
}

void ImageFolder::loadDepth(const FrameFiles& files, SensorFrame& frame) {
  if (files.depth.empty()) {
    frame.raw_depth.release();
    frame.depth_m.release();
    return;
  }
  const PinholeCamera& camera = calibration_.depth ? calibration_.depth->camera : calibration_.color;
  if (files.depth.extension() == kRangeImageTextExtension) {
    frame.raw_depth.release();
    readRangeImageText(files.depth, {camera.width, camera.height}, frame.depth_m);
    return;
  }
  frame.depth_m.release();
  reader_.readDepth(files.depth, frame.raw_depth);
  if (frame.raw_depth.cols != camera.width || frame.raw_depth.rows != camera.height) {
    throw IoError(
        files.depth,
        sizeText(camera.width, camera.height) +
            (calibration_.depth ? " (" + calibration_.origin + ")" : ", as the colour image it is registered to"),
        sizeText(frame.raw_depth.cols, frame.raw_depth.rows));
  }
  const bool measured = std::any_of(frame.raw_depth.begin(), frame.raw_depth.end(),
                                    [](std::uint16_t raw) { return raw != 0 && raw != kSaturatedDepth; });
  if (!measured) throw IoError(files.depth, "some pixels with a depth measurement", "none");
}

}  // namespace

std::unique_ptr<SensorSource> openFrameList(FrameList list, const FrameRange& range,
                                            const std::filesystem::path& labels) {
  return std::make_unique<ImageFolder>(std::move(list), range, labels);
}

}  // namespace saccade
