#pragma once

#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

namespace saccade {

/// A partition of 0 ... n - 1 into components whose labels can be read at any time without a search: joining two
/// relabels one of them ("quick-find"). Many reads in a row do not wait for each other, as the steps of a search do.
template <typename Index>
class FlatPartition {
 public:
  /// n components of one element, each with its index as label.
  void reset(std::size_t n) {
    labels_.resize(n);
    next_.resize(n);
    std::iota(labels_.begin(), labels_.end(), Index{0});
    std::iota(next_.begin(), next_.end(), Index{0});
  }

  [[nodiscard]] Index label(std::size_t element) const { return labels_[element]; }
  [[nodiscard]] const Index* labels() const { return labels_.data(); }

  /// Gives the component of `element` the label of that of `other`, another one. Cost: the number of its elements.
  void join(Index element, Index other) {
    const Index label = labels_[other];
    Index i = element;
    do {
      labels_[i] = label;
      i = next_[i];
    } while (i != element);
    std::swap(next_[element], next_[other]);
  }

 private:
  std::vector<Index> labels_;
  std::vector<Index> next_;  ///< the elements of a component in a circle
};

}  // namespace saccade
