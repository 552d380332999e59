// Keeps the values used last within a bound on their bytes.
#pragma once

#include <cstdint>
#include <iterator>
#include <list>
#include <memory>
#include <unordered_map>
#include <utility>

namespace hpm {

// Not thread-safe. A value larger than the bound is handed out but not kept.
// Spare values fill what room is left, and go first.
template <class Key, class Value>
class LruCache {
 public:
  explicit LruCache(uint64_t max_bytes) : max_bytes_(max_bytes) {}

  // Null if the key is not there.
  std::shared_ptr<const Value> Find(const Key& key) {
    const auto it = index_.find(key);
    if (it == index_.end()) return nullptr;
    entries_.splice(entries_.begin(), entries_, it->second);
    return it->second->value;
  }

  // Does not count as a use.
  std::shared_ptr<const Value> Peek(const Key& key) const {
    const auto it = index_.find(key);
    return it == index_.end() ? nullptr : it->second->value;
  }

  void Insert(const Key& key,
              std::shared_ptr<const Value> value,
              uint64_t num_bytes) {
    if (num_bytes > max_bytes_ || index_.count(key) > 0) return;
    entries_.push_front({key, std::move(value), num_bytes});
    index_[key] = entries_.begin();
    num_bytes_ += num_bytes;
    while (num_bytes_ > max_bytes_) {
      num_bytes_ -= entries_.back().num_bytes;
      index_.erase(entries_.back().key);
      entries_.pop_back();
    }
  }

  // Kept if that takes no room from others; spare until Find() uses it.
  void InsertSpare(const Key& key,
                   std::shared_ptr<const Value> value,
                   uint64_t num_bytes) {
    if (num_bytes > max_bytes_ - num_bytes_ || index_.count(key) > 0) return;
    entries_.push_back({key, std::move(value), num_bytes});
    index_[key] = std::prev(entries_.end());
    num_bytes_ += num_bytes;
  }

  // is_unwanted(key)
  template <class IsUnwanted>
  void EraseIf(const IsUnwanted& is_unwanted) {
    for (auto it = entries_.begin(); it != entries_.end();) {
      if (!is_unwanted(it->key)) {
        ++it;
        continue;
      }
      num_bytes_ -= it->num_bytes;
      index_.erase(it->key);
      it = entries_.erase(it);
    }
  }

  uint64_t num_bytes() const { return num_bytes_; }

 private:
  struct Entry {
    Key key;
    std::shared_ptr<const Value> value;
    uint64_t num_bytes;
  };

  uint64_t max_bytes_;
  uint64_t num_bytes_ = 0;
  std::list<Entry> entries_;  // most recently used first
  std::unordered_map<Key, typename std::list<Entry>::iterator> index_;
};

}  // namespace hpm
