/// Signals of many values that are computed once: few of them in memory, many on the disk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace servomill::sim::records {

/// Room that signals share: memory, and behind its limit a file without a name. One encoder, so
/// not for several threads.
class SignalStore {
 public:
  /// @param folder  of the file; empty: that of temporary files
  /// @param most_in_memory  bytes of encoded values
  explicit SignalStore(std::string folder, std::size_t most_in_memory = 16'000'000);
  ~SignalStore();
  SignalStore(const SignalStore&) = delete;
  SignalStore& operator=(const SignalStore&) = delete;

  static constexpr int kCompression = 1;

 private:
  friend class StoredSignal;
  /// @return number of the chunk
  std::size_t add(std::span<const double> values, std::size_t chunk_rows);
  void read(std::size_t chunk, std::size_t chunk_rows, std::span<double> values);
  std::vector<std::uint8_t> encoded(std::size_t chunk) const;

  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// One value after the other, all of a number that is known before. Copies share what is stored.
/// All members throw SystemError.
class StoredSignal {
 public:
  StoredSignal() = default;  ///< without values
  StoredSignal(std::shared_ptr<SignalStore> store, std::size_t size);

  /// @pre fewer than size() have come
  void append(double value);

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  std::vector<double> all() const;

  /// As a result file holds them (records/chunk_encoder.h, SignalStore::kCompression).
  std::size_t chunk_rows() const { return chunk_rows_; }
  std::size_t chunks() const { return chunks_.size(); }
  std::size_t rows_of(std::size_t chunk) const;
  std::vector<std::uint8_t> encoded(std::size_t chunk) const;

  /// Reads the values in their order and holds one chunk of them.
  /// @pre all have come
  class Reader {
   public:
    explicit Reader(const StoredSignal& signal) : signal_(&signal) {}
    /// @pre not at the end
    double next();

   private:
    const StoredSignal* signal_;
    std::size_t chunk_ = 0, at_ = 0;
    std::vector<double> values_;
  };

 private:
  std::shared_ptr<SignalStore> store_;
  std::size_t size_ = 0, come_ = 0, chunk_rows_ = 1;
  std::vector<double> filling_;  // the chunk that is not full
  std::vector<std::size_t> chunks_;
};

}  // namespace servomill::sim::records
