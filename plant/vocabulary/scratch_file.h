/// Data that is kept on the disk instead of in memory.
#pragma once

#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <vector>

namespace servomill {

/// A file without a name, which goes with the process however that ends. For any number of threads.
class ScratchFile {
 public:
  /// @param folder    where it takes room; must allow files. Empty: that of temporary files
  /// @param contents  for messages: "recorded signals"
  /// @throws SystemError, as all members
  explicit ScratchFile(std::string folder, std::string contents);
  ~ScratchFile();
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  /// Bytes of all that this process has in the folder of temporary files (TMPDIR).
  static std::uint64_t temporary_bytes();

  std::uint64_t size() const;
  /// Returns the place where the bytes begin.
  std::uint64_t append(std::span<const std::uint8_t> bytes);
  void read(std::uint64_t place, std::span<std::uint8_t> bytes) const;
  /// All bytes that were appended, as long as the file is there; once, and then nothing is
  /// appended. The system reads them when they are used, so that a disk that fails ends the process
  /// then.
  /// @pre size() > 0
  std::span<const std::uint8_t> map();
  /// Gives back the memory of mapped bytes that were read. The span remains valid.
  void release() const;

 private:
  [[noreturn]] void fail_to_write(const std::string& reason) const;

  bool is_temporary_;  // in the folder of temporary files
  std::string folder_, contents_;
  int descriptor_ = -1;
  mutable std::mutex mutex_;
  std::uint64_t size_ = 0;
  void* mapped_ = nullptr;
};

/// The bytes of values without pointers.
template <class T>
std::span<const std::uint8_t> bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const std::uint8_t*>(values.data()), values.size() * sizeof(T)};
}
template <class T>
std::span<std::uint8_t> bytes_of(std::vector<T>& values) {
  return {reinterpret_cast<std::uint8_t*>(values.data()), values.size() * sizeof(T)};
}

}  // namespace servomill
