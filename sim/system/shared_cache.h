/// Results that many points of a sweep have in common, computed once.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <future>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <type_traits>
#include <unordered_map>
#include <utility>

namespace servomill::sim::system {

/// All that a result depends on, byte for byte: where keys are equal, so are the results. Numbers
/// count by their bits (-0.0 is not 0.0), texts and lists with their length.
class MemoKey {
 public:
  template <class Number>
  requires std::is_arithmetic_v<Number> || std::is_enum_v<Number>
  void add(Number value) { bytes_.append(reinterpret_cast<const char*>(&value), sizeof value); }
  void add(std::string_view text) {
    add(text.size());
    bytes_.append(text);
  }
  template <class Derived>
  void add(const Eigen::MatrixBase<Derived>& values) {
    for (Eigen::Index i = 0; i < values.size(); ++i) add(values(i));
  }
  /// An object that the result shares, so that no other one can have its address meanwhile.
  void add_shared(const void* object) { add(reinterpret_cast<std::uintptr_t>(object)); }

  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// Results by key, the least recently used ones forgotten. Any number of threads: the first that
/// asks for a key computes it, the others wait for it. Whoever was given a result keeps it, and as
/// long as somebody does, it is given to others, too: it takes no more memory.
template <class T>
class SharedCache {
 public:
  using Pointer = std::shared_ptr<const T>;

  /// @param capacity  sum of the weights of all results that are kept, beside the last one
  /// @param weigh     weight of a result; nullptr: each weighs 1
  explicit SharedCache(std::size_t capacity, std::size_t (*weigh)(const T&) = nullptr)
      : capacity_(capacity), weigh_(weigh) {}

  /// @param make  () -> T or Pointer; what it throws is thrown, and asked for anew next time
  template <class Make>
  Pointer get(const MemoKey& key, Make make) {
    std::promise<Pointer> promise;
    std::shared_future<Pointer> result;
    bool mine = false;
    {
      const std::lock_guard lock(mutex_);
      if (const auto known = by_key_.find(key.bytes()); known != by_key_.end()) {
        entries_.splice(entries_.begin(), entries_, known->second);
        result = known->second->result;
      } else if (Pointer kept = kept_elsewhere(key)) {
        return kept;
      } else {
        mine = true;
        ++made_;
        entries_.push_front({key.bytes(), promise.get_future().share(), 0, {}});
        by_key_.emplace(entries_.front().key, entries_.begin());
      }
    }
    if (!mine) {
      Pointer shared = result.get();
      return shared ? shared : pointer_to(make());  // it failed there, and will here
    }
    try {
      Pointer made = pointer_to(make());
      promise.set_value(made);
      keep(key, made);
      return made;
    } catch (...) {
      promise.set_value(nullptr);
      forget(key);
      throw;
    }
  }

  /// How many results were computed so far.
  std::size_t made() const {
    const std::lock_guard lock(mutex_);
    return made_;
  }
  /// How many are kept.
  std::size_t size() const {
    const std::lock_guard lock(mutex_);
    return entries_.size();
  }

 private:
  struct Entry {
    std::string key;
    std::shared_future<Pointer> result;
    std::size_t weight;            // 0 while it is computed
    std::weak_ptr<const T> alive;  // empty while it is computed
  };

  static Pointer pointer_to(Pointer made) { return made; }
  static Pointer pointer_to(T&& made) { return std::make_shared<const T>(std::move(made)); }

  Pointer kept_elsewhere(const MemoKey& key) const {
    const auto known = forgotten_.find(key.bytes());
    return known == forgotten_.end() ? nullptr : known->second.lock();
  }
  void keep(const MemoKey& key, const Pointer& made) {
    const std::lock_guard lock(mutex_);
    const auto known = by_key_.find(key.bytes());
    if (known == by_key_.end()) return;
    weight_ -= known->second->weight;  // another thread may have made it, too
    known->second->weight = weigh_ != nullptr ? weigh_(*made) : 1;
    weight_ += known->second->weight;
    known->second->alive = made;
    while (weight_ > capacity_ && entries_.size() > 1) drop(std::prev(entries_.end()));
  }
  void forget(const MemoKey& key) {
    const std::lock_guard lock(mutex_);
    if (const auto known = by_key_.find(key.bytes()); known != by_key_.end()) drop(known->second);
  }
  void drop(typename std::list<Entry>::iterator entry) {
    weight_ -= entry->weight;
    by_key_.erase(entry->key);
    entry->result = {};
    std::erase_if(forgotten_, [](const auto& known) { return known.second.expired(); });
    if (!entry->alive.expired()) forgotten_.insert_or_assign(entry->key, entry->alive);
    entries_.erase(entry);
  }

  std::size_t capacity_;
  std::size_t (*weigh_)(const T&);
  mutable std::mutex mutex_;
  std::list<Entry> entries_;  // the most recently used one first
  std::unordered_map<std::string_view, typename std::list<Entry>::iterator> by_key_;
  std::unordered_map<std::string, std::weak_ptr<const T>> forgotten_;  // held by others, maybe
  std::size_t weight_ = 0, made_ = 0;
};

}  // namespace servomill::sim::system
