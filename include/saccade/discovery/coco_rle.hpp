#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include <opencv2/core.hpp>

namespace saccade {

/// Writes the `counts` string of the COCO mask format: run lengths in column-major order, the first of a run of zeros,
/// differences to the last but one run from the fourth on, five bits a character. pycocotools' mask.encode gives the
/// same string.
class CocoRleWriter {
 public:
  explicit CocoRleWriter(cv::Size image) : height_(image.height), pixels_(std::int64_t{1} * image.area()) {}

  /// Adds the pixels begin_v ... end_v - 1 of column u. Runs come by rising column and row; those that touch become
  /// one.
  void addRun(int u, int begin_v, int end_v) {
    const std::int64_t begin = u * height_ + begin_v;
    if (begin != end_) {
      flush();
      begin_ = begin;
    }
    end_ = u * height_ + end_v;
  }
  /// The string for the runs that were added; the writer is done.
  [[nodiscard]] std::string finish();

 private:
  void flush();
  void append(std::int64_t length);

  std::int64_t height_, pixels_;
  std::int64_t begin_ = 0, end_ = 0;  ///< the last set pixels, a run that may still grow
  std::int64_t written_ = 0;          ///< pixels whose runs are in the text
  std::int64_t last_ = 0, last_but_one_ = 0;
  int runs_ = 0;
  std::string text_;
};

/// The string of CocoRleWriter for the pixels of `mask` that are not 0.
[[nodiscard]] std::string encodeCocoRle(const cv::Mat1b& mask);

/// Calls `visit(u, begin_v, end_v)` for each run of set pixels within a column, columns from the left, runs from the
/// top. Throws std::invalid_argument if the runs of `counts` do not fill an image of `size`.
void forEachCocoRun(std::string_view counts, cv::Size size, const std::function<void(int, int, int)>& visit);

/// The mask (0 or 255) of `size` that `counts` describes. Throws std::invalid_argument if the runs do not fill it.
[[nodiscard]] cv::Mat1b decodeCocoRle(std::string_view counts, cv::Size size);

}  // namespace saccade
