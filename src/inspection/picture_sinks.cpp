#include "saccade/inspection/picture_sinks.hpp"

#include <fstream>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include "saccade/core/errors.hpp"

namespace saccade {
namespace {

cv::Mat1i weightsOf(const IorView& view) {
  cv::Mat1i weights(view.leaf_index.size(), 0);
  for (int v = 0; v < weights.rows; ++v) {
    for (int u = 0; u < weights.cols; ++u) weights(v, u) = static_cast<int>(view.weightAt(u, v));
  }
  return weights;
}

}  // namespace

FramePanels panelsOf(const RgbdFrame& frame, const FrameReport& report) {
  FramePanels panels;
  panels.color = frame.color;
  panels.saliency = report.seen->saliency;
  panels.color_segments = report.seen->color.labels;
  panels.surface_segments = report.seen->surface.labels;
  if (report.ior != nullptr) {
    panels.inhibited = report.ior->inhibited;
    panels.ior_weight = weightsOf(*report.ior);
  }
  for (std::size_t i = 0; i < report.attended; ++i) {
    panels.boxes.push_back({report.open[i].box, static_cast<int>(i), false});
  }
  panels.caption =
      fmt::format("{}   {}   tick {}   {} open, {} inhibited, {} attended", report.name, nameOf(report.tracking.status),
                  report.tick.value, report.open.size(), report.inhibited.size(), report.attended);
  return panels;
}

VideoSink::VideoSink(const std::filesystem::path& path, double frames_per_second)
    : path_(path), frames_per_second_(frames_per_second) {
  if (!std::ofstream(path)) throw IoError(path, "a video file that can be written", "none");
}

void VideoSink::accept(const RgbdFrame& frame, const FrameReport& report) {
  const cv::Mat3b picture = drawFramePicture(panelsOf(frame, report));
  if (!writer_) writer_ = std::make_unique<VideoWriter>(path_, picture.size(), frames_per_second_);
  writer_->write(picture);
}

void VideoSink::finish() {
  if (writer_) writer_->finish();
}

PictureFolderSink::PictureFolderSink(const std::filesystem::path& folder) : folder_(folder) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure || !std::filesystem::is_directory(folder)) {
    throw IoError(folder, "a folder for pictures", failure ? failure.message() : "a file");
  }
}

void PictureFolderSink::accept(const RgbdFrame& frame, const FrameReport& report) {
  const std::filesystem::path path = folder_ / (report.name + ".png");
  bool written = false;
  try {
    written = cv::imwrite(path.string(), drawFramePicture(panelsOf(frame, report)));
  } catch (const cv::Exception&) {
    written = false;
  }
  if (!written) throw IoError(path, "room for a picture", "a full disk or a folder that cannot be written");
}

}  // namespace saccade
