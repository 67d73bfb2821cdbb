/// Text of any length.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace servomill {

class ScratchFile;

/// A text, in memory or, if it is long, in a file without a name that takes room in the folder of
/// temporary files. It is read in pieces, so that a long text is never in memory as a whole.
/// Appended to by one thread and then read by any number of threads.
class StoredText {
 public:
  /// Bytes of a text in memory; of a longer one, less than kPiece.
  static constexpr std::size_t kMaxInMemory = 4'000'000;
  /// Bytes that each_piece() hands out at once.
  static constexpr std::size_t kPiece = 1U << 20U;

  /// @param most_in_memory  bytes of a text that needs no file
  /// @throws SystemError if the file cannot be made or the disk is full, as all members that append
  explicit StoredText(std::string_view text = {}, std::size_t most_in_memory = kMaxInMemory);

  StoredText(StoredText&&) noexcept = default;
  StoredText& operator=(StoredText&&) noexcept = default;

  /// Announces the length of the whole text: a long one is written to its file from the first
  /// piece on.
  void reserve(std::size_t bytes);
  void append(std::string_view text);

  std::size_t size() const { return in_file_ + tail_.size(); }
  bool empty() const { return size() == 0; }
  bool is_on_disk() const { return file_ != nullptr; }

  /// Copies the bytes from `at` on.
  /// @return their number: `most`, or what is left of the text
  /// @throws SystemError if the disk fails, as all members that read
  std::size_t copy(char* to, std::size_t most, std::size_t at) const;

  /// Calls visit(std::string_view) for one piece after the other: all are kPiece long but the last.
  template <class Visit>
  void each_piece(Visit visit) const {
    std::string buffer;
    for (std::size_t at = 0; at < size(); at += kPiece) visit(piece(at, buffer));
  }

  /// All of it, for texts that are known to be short.
  std::string all() const;

  bool operator==(const StoredText& other) const;

 private:
  std::string_view piece(std::size_t at, std::string& buffer) const;
  void make_file();
  void write_pieces();

  std::size_t most_in_memory_;
  std::shared_ptr<ScratchFile> file_;  // of whole pieces
  std::size_t in_file_ = 0;            // bytes
  std::string tail_;                   // after those
};

}  // namespace servomill
