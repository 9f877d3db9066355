#include "saccade/discovery/coco_rle.hpp"

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <utility>
#include <vector>

namespace saccade {
namespace {

constexpr int kBitsPerCharacter = 5;
constexpr char kFirstCharacter = '0';  // 48; the characters used are '0' ... 'o'

void appendNumber(std::int64_t value, std::string& text) {
  for (bool more = true; more;) {
    std::int64_t bits = value & 0x1F;
    value >>= kBitsPerCharacter;
    more = (bits & 0x10) != 0 ? value != -1 : value != 0;
    if (more) bits |= 0x20;
    text.push_back(static_cast<char>(bits + kFirstCharacter));
  }
}

std::int64_t takeNumber(std::string_view text, std::size_t& position) {
  std::int64_t value = 0;
  for (int shift = 0;; shift += kBitsPerCharacter) {
    if (position == text.size() || shift > 50) {
      throw std::invalid_argument("COCO run lengths: a number is cut off at character " + std::to_string(position));
    }
    const int bits = text[position++] - kFirstCharacter;
    if (bits < 0 || bits > 0x3F) {
      throw std::invalid_argument("COCO run lengths: character " + std::to_string(position - 1) +
                                  " is none of '0'..'o'");
    }
    value |= static_cast<std::int64_t>(bits & 0x1F) << shift;
    if ((bits & 0x20) != 0) continue;
    if ((bits & 0x10) != 0) value |= -(std::int64_t{1} << (shift + kBitsPerCharacter));
    return value;
  }
}

}  // namespace

void CocoRleWriter::flush() {
  if (begin_ == end_) return;
  append(begin_ - written_);
  append(end_ - begin_);
  written_ = end_;
}

void CocoRleWriter::append(std::int64_t length) {
  appendNumber(runs_ > 2 ? length - last_but_one_ : length, text_);
  last_but_one_ = last_;
  last_ = length;
  ++runs_;
}

std::string CocoRleWriter::finish() {
  flush();
  if (written_ < pixels_ || runs_ == 0) append(pixels_ - written_);
  return std::move(text_);
}

std::string encodeCocoRle(const cv::Mat1b& mask) {
  cv::Mat1b columns;
  cv::transpose(mask, columns);
  CocoRleWriter writer(mask.size());
  for (int u = 0; u < columns.rows; ++u) {
    const std::uint8_t* column = columns[u];
    for (int v = 0; v < columns.cols; ++v) {
      if (column[v] != 0) writer.addRun(u, v, v + 1);
    }
  }
  return writer.finish();
}

void forEachCocoRun(std::string_view counts, cv::Size size, const std::function<void(int, int, int)>& visit) {
  const std::int64_t pixels = std::int64_t{1} * size.width * size.height;
  std::vector<std::int64_t> runs;
  std::int64_t filled = 0;
  for (std::size_t position = 0; position < counts.size();) {
    std::int64_t run = takeNumber(counts, position);
    if (runs.size() > 2) run += runs[runs.size() - 2];
    if (run < 0 || run > pixels - filled) {
      throw std::invalid_argument("COCO run lengths: run " + std::to_string(runs.size()) + " has " +
                                  std::to_string(run) + " pixels where " + std::to_string(pixels - filled) +
                                  " are left");
    }
    if (runs.size() % 2 == 1) {
      for (std::int64_t at = filled; at < filled + run;) {
        const auto begin_v = static_cast<int>(at % size.height);
        const auto end_v = static_cast<int>(std::min<std::int64_t>(size.height, begin_v + filled + run - at));
        visit(static_cast<int>(at / size.height), begin_v, end_v);
        at += end_v - begin_v;
      }
    }
    filled += run;
    runs.push_back(run);
  }
  if (filled != pixels) {
    throw std::invalid_argument("COCO run lengths: they fill " + std::to_string(filled) + " of " +
                                std::to_string(pixels) + " pixels");
  }
}

cv::Mat1b decodeCocoRle(std::string_view counts, cv::Size size) {
  cv::Mat1b mask(size, std::uint8_t{0});
  forEachCocoRun(counts, size, [&](int u, int begin_v, int end_v) {
    for (int v = begin_v; v < end_v; ++v) mask(v, u) = 255;
  });
  return mask;
}

}  // namespace saccade
