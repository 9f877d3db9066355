#pragma once

#include <cstddef>
#include <list>
#include <map>
#include <memory>
#include <string>
#include <utility>

namespace saccade {

/// Texts by key, of which the last used are kept up to a number of bytes.
template <typename Key>
class ByteCache {
 public:
  explicit ByteCache(std::size_t capacity_bytes) : capacity_(capacity_bytes) {}

  /// The text of `key`; null if it is not kept.
  [[nodiscard]] std::shared_ptr<const std::string> find(const Key& key) {
    const auto found = places_.find(key);
    if (found == places_.end()) return nullptr;
    entries_.splice(entries_.begin(), entries_, found->second);
    return found->second->second;
  }
  void insert(const Key& key, std::shared_ptr<const std::string> text) {
    if (places_.contains(key)) return;
    held_ += text->size();
    entries_.emplace_front(key, std::move(text));
    places_[key] = entries_.begin();
    while (held_ > capacity_ && entries_.size() > 1) {
      held_ -= entries_.back().second->size();
      places_.erase(entries_.back().first);
      entries_.pop_back();
    }
  }
  void clear() {
    entries_.clear();
    places_.clear();
    held_ = 0;
  }
  [[nodiscard]] std::size_t heldBytes() const { return held_; }

 private:
  using Entries = std::list<std::pair<Key, std::shared_ptr<const std::string>>>;

  std::size_t capacity_, held_ = 0;
  Entries entries_;
  std::map<Key, typename Entries::iterator> places_;
};

}  // namespace saccade
