#include "saccade/discovery/box_agreement.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>

#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

// The least intersection over union, as a fraction of whole numbers.
constexpr int kLeastIouNumerator = 7, kLeastIouDenominator = 10;

// Boxes by rising area, each kind of value by itself; ends excluded.
struct SortedBoxes {
  std::vector<int> left, top, right, bottom, area, unions, agreeing;

  explicit SortedBoxes(std::size_t count) {
    for (std::vector<int>* values : {&left, &top, &right, &bottom, &area, &unions, &agreeing}) values->reserve(count);
  }
  void append(const Candidate& candidate) {
    const cv::Rect& box = candidate.box;
    left.push_back(box.x);
    top.push_back(box.y);
    right.push_back(box.x + box.width);
    bottom.push_back(box.y + box.height);
    area.push_back(box.area());
    unions.push_back(candidate.unions);
    agreeing.push_back(candidate.unions);
  }
};

// Counts box `i` and those of `begin` .. `end` for each other where they agree.
SACCADE_MULTIVERSION void countWith(SortedBoxes& boxes, std::size_t i, std::size_t begin, std::size_t end) {
  const int left = boxes.left[i], top = boxes.top[i], right = boxes.right[i], bottom = boxes.bottom[i];
  const int area = boxes.area[i], unions = boxes.unions[i];
  const int *lefts = boxes.left.data(), *tops = boxes.top.data(), *rights = boxes.right.data(),
            *bottoms = boxes.bottom.data(), *areas = boxes.area.data(), *weights = boxes.unions.data();
  int* const counts = boxes.agreeing.data();
  int own = 0;
  for (std::size_t j = begin; j < end; ++j) {
    const int width = std::max(0, std::min(right, rights[j]) - std::max(left, lefts[j]));
    const int height = std::max(0, std::min(bottom, bottoms[j]) - std::max(top, tops[j]));
    const int shared = width * height, together = area + areas[j] - shared;
    const int agrees = kLeastIouDenominator * shared >= kLeastIouNumerator * together ? 1 : 0;
    own += agrees * weights[j];
    counts[j] += agrees * unions;
  }
  boxes.agreeing[i] += own;
}

}  // namespace

std::vector<int> countAgreeing(const Candidates& candidates) {
  std::vector<std::size_t> order(candidates.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    const int a = candidates[i].box.area(), b = candidates[j].box.area();
    return a != b ? a < b : i < j;
  });
  SortedBoxes boxes(order.size());
  for (const std::size_t i : order) boxes.append(candidates[i]);
  // Boxes of too different areas cannot agree: of rising areas only those up to `end` can.
  std::size_t end = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    while (end < order.size() &&
           std::int64_t{kLeastIouNumerator} * boxes.area[end] <= std::int64_t{kLeastIouDenominator} * boxes.area[i]) {
      ++end;
    }
    countWith(boxes, i, i + 1, end);
  }
  std::vector<int> agreeing(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) agreeing[order[i]] = boxes.agreeing[i];
  return agreeing;
}

}  // namespace saccade
