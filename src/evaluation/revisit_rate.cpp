#include "saccade/evaluation/revisit_rate.hpp"

namespace saccade {

void RevisitCounter::addCandidate(std::span<const LeafId> leaves) {
  if (leaves.empty()) return;
  std::size_t known = 0;
  for (const LeafId leaf : leaves) {
    known += earlier_.contains(leaf) ? 1 : 0;
    current_.insert(leaf);
  }
  ++candidates_;
  if (2 * known >= leaves.size()) ++revisits_;
}

void RevisitCounter::closeTick() {
  earlier_.merge(current_), current_.clear();
}

}  // namespace saccade
