#include "sources/association.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace saccade {

std::vector<StampPair> associate(const std::vector<double>& first_s, const std::vector<double>& second_s,
                                 double max_difference_s) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> candidates;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < first_s.size(); ++i) {
    while (begin < second_s.size() && second_s[begin] < first_s[i] - max_difference_s) ++begin;
    for (std::size_t j = begin; j < second_s.size() && second_s[j] <= first_s[i] + max_difference_s; ++j) {
      candidates.emplace_back(std::abs(first_s[i] - second_s[j]), i, j);
    }
  }
  std::sort(candidates.begin(), candidates.end());

  std::vector<StampPair> pairs;
  std::vector<bool> first_taken(first_s.size()), second_taken(second_s.size());
  for (const auto& [difference, i, j] : candidates) {
    if (first_taken[i] || second_taken[j]) continue;
    first_taken[i] = second_taken[j] = true;
    pairs.emplace_back(i, j);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace saccade
