#include "saccade/sources/label_folder.hpp"

#include <fstream>
#include <limits>

#include <yaml-cpp/yaml.h>

#include "saccade/core/errors.hpp"

namespace saccade {
namespace {

std::optional<int> loadIgnoreFrom(const std::filesystem::path& path) {
  try {
    std::ifstream file(path);
    const YAML::Node root = YAML::Load(file);
    if (!root.IsMap() || !root["ignore_from"]) return std::nullopt;
    const int ignore_from = root["ignore_from"].as<int>();
    if (ignore_from < 1) throw IoError(path, "ignore_from of 1 or more", std::to_string(ignore_from));
    return ignore_from;
  } catch (const YAML::Exception& error) {
    throw IoError(path, "a whole number ignore_from", error.what());
  }
}

bool holdsPng(const std::filesystem::path& folder) {
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".png") return true;
  }
  return false;
}

}  // namespace

LabelFolder::LabelFolder(const std::filesystem::path& folder)
    : folder_(std::filesystem::is_directory(folder / "label") ? folder / "label" : folder) {
  if (!holdsPng(folder_)) {
    throw IoError(folder, "a folder of label images NAME.png",
                  std::filesystem::exists(folder) ? "no PNG there" : "no such folder");
  }
  for (const std::filesystem::path& yaml : {folder_ / "labels.yaml", folder_ / ".." / "labels.yaml"}) {
    if (!std::filesystem::exists(yaml)) continue;
    ignore_from_ = loadIgnoreFrom(yaml);
    break;
  }
}

std::optional<std::filesystem::path> LabelFolder::find(const std::string& frame_name) const {
  std::filesystem::path path = folder_ / (frame_name + ".png");
  if (!std::filesystem::exists(path)) return std::nullopt;
  return path;
}

std::optional<cv::Mat1w> LabelFolder::load(const std::string& frame_name) {
  const std::optional<std::filesystem::path> path = find(frame_name);
  if (!path) return std::nullopt;
  cv::Mat1w label;
  reader_.readLabel(*path, label);
  return label;
}

}  // namespace saccade
