/// Many values that are appended and then read in any order.
#pragma once

#include <cassert>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "plant/vocabulary/scratch_file.h"

namespace servomill {

/// Values without pointers, in memory or, if they are many, in a file without a name that is mapped
/// into it. Reading costs the same; memory that was read can be given back. Copies share the file.
/// Values are appended by one thread and, after finish(), read by any number of threads.
template <class T>
class StoredValues {
 public:
  /// @param contents  for messages: "the path"
  /// @param most_in_memory  bytes of values in memory
  StoredValues(std::string contents, std::size_t most_in_memory)
      : contents_(std::move(contents)), most_in_memory_(most_in_memory / sizeof(T)) {}

  /// Says how many values will come, at most.
  /// @throws SystemError if a file is needed and cannot be made
  void reserve(std::size_t count) {
    if (count > most_in_memory_) make_file();
    values_.reserve(file_ ? kBlock : count);
  }
  /// @throws SystemError if the disk is full
  void push_back(const T& value) {
    assert(mapped_ == nullptr);
    if (file_ == nullptr && values_.size() == most_in_memory_) make_file();
    if (file_ != nullptr && values_.size() >= kBlock) write();
    values_.push_back(value);
    ++size_;
  }
  /// To be called once, before anything but the last value is read.
  /// @throws SystemError
  void finish() {
    assert(mapped_ == nullptr);
    if (file_ == nullptr || size_ == 0) return;
    last_ = values_.back();
    write();
    values_ = {};
    mapped_ = reinterpret_cast<const T*>(file_->map().data());
  }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  /// @pre finish()
  const T& operator[](std::size_t index) const {
    return mapped_ != nullptr ? mapped_[index] : values_[index];
  }
  /// Values from first to before last.
  /// @pre finish()
  std::span<const T> range(std::size_t first, std::size_t last) const {
    return {(mapped_ != nullptr ? mapped_ : values_.data()) + first, last - first};
  }
  /// @pre not empty
  const T& back() const { return mapped_ != nullptr ? last_ : values_.back(); }

  /// Gives back memory of values that were read; they stay where they are.
  void release() const {
    if (mapped_ != nullptr) file_->release();
  }
  bool is_on_disk() const { return file_ != nullptr; }

 private:
  static constexpr std::size_t kBlock = 1 + 1'000'000 / sizeof(T);  // written at once

  void make_file() {
    if (file_ == nullptr) file_ = std::make_shared<ScratchFile>("", contents_);
  }
  void write() {
    file_->append(bytes_of(values_));
    values_.clear();
  }

  std::string contents_;
  std::size_t most_in_memory_;
  std::vector<T> values_;  // of a file, those that are not in it yet
  std::shared_ptr<ScratchFile> file_;
  const T* mapped_ = nullptr;
  T last_{};
  std::size_t size_ = 0;
};

}  // namespace servomill
