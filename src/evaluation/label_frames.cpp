#include "saccade/evaluation/label_frames.hpp"

#include <fstream>

#include <opencv2/imgcodecs.hpp>

#include "saccade/core/errors.hpp"

namespace saccade {

void LabelFrames::add(const std::string& frame_name, const cv::Mat1w& label) {
  cv::imencode(".png", label, packed_[frame_name], {cv::IMWRITE_PNG_COMPRESSION, 1});
}

std::optional<cv::Mat1w> LabelFrames::find(const std::string& frame_name) const {
  const auto found = packed_.find(frame_name);
  if (found == packed_.end()) return std::nullopt;
  return cv::Mat1w(cv::imdecode(found->second, cv::IMREAD_UNCHANGED));
}

void LabelFrames::save(const std::filesystem::path& folder, std::optional<int> ignore_from) const {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure) throw IoError(folder, "a folder for label images", failure.message());
  const auto write = [](const std::filesystem::path& path, const char* data, std::size_t size) {
    std::ofstream file(path, std::ios::binary);
    file.write(data, static_cast<std::streamsize>(size));
    file.close();
    if (!file) throw IoError(path, "a file that can be written", "a full disk or a folder that cannot be written");
  };
  for (const auto& [name, png] : packed_) {
    write(folder / (name + ".png"), reinterpret_cast<const char*>(png.data()), png.size());
  }
  if (!ignore_from) return;
  const std::string yaml = "ignore_from: " + std::to_string(*ignore_from) + "\n";
  write(folder / "labels.yaml", yaml.data(), yaml.size());
}

}  // namespace saccade
