#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <opencv2/core.hpp>

#include "saccade/sources/image_files.hpp"

namespace saccade {

/// Label images of a sequence by frame name: `NAME.png`, 8 or 16 bit, 0 = no object, else the instance's id.
///
/// Not every frame needs one. `labels.yaml` beside the images or one folder above may say `ignore_from: N`. The images
/// are those of the camera as it is: a source that removes lens distortion removes it from the labels too.
class LabelFolder {
 public:
  /// Opens `folder`, or `folder/label` if that exists. Throws IoError if there is no label image or labels.yaml is bad.
  explicit LabelFolder(const std::filesystem::path& folder);

  [[nodiscard]] const std::filesystem::path& path() const { return folder_; }
  /// Ids from here on count neither as objects nor as background.
  [[nodiscard]] std::optional<int> ignoreFrom() const { return ignore_from_; }
  /// Path of a frame's label image, if it has one.
  [[nodiscard]] std::optional<std::filesystem::path> find(const std::string& frame_name) const;
  /// Label image of a frame, as stored; none where the frame has no label. Throws IoError on a bad image.
  [[nodiscard]] std::optional<cv::Mat1w> load(const std::string& frame_name);

 private:
  std::filesystem::path folder_;
  std::optional<int> ignore_from_;
  ImageReader reader_;
};

}  // namespace saccade
