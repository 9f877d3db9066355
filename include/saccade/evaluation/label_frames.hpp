#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace saccade {

/// The label images of a sequence by frame name, kept losslessly packed: some kilobytes a frame instead of 600.
class LabelFrames {
 public:
  void add(const std::string& frame_name, const cv::Mat1w& label);

  [[nodiscard]] bool empty() const { return packed_.empty(); }
  [[nodiscard]] std::size_t size() const { return packed_.size(); }
  [[nodiscard]] bool has(const std::string& frame_name) const { return packed_.contains(frame_name); }
  /// None where the frame has no label.
  [[nodiscard]] std::optional<cv::Mat1w> find(const std::string& frame_name) const;

  /// Writes each label as `folder/NAME.png`, 16 bit, and `ignore_from`, if there is one, as labels.yaml. Makes the
  /// folder. Throws IoError.
  void save(const std::filesystem::path& folder, std::optional<int> ignore_from) const;

 private:
  std::map<std::string, std::vector<std::uint8_t>> packed_;  // PNG
};

}  // namespace saccade
