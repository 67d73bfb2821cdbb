/// Many moves, held compactly.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "plant/vocabulary/move.h"

namespace servomill {

class ScratchFile;

/// Moves in their order, each held as what differs from the one before: a straight block of three
/// axes takes about 60 bytes, a Move takes 320. Of a long list what goes beyond some megabytes is
/// on the disk. What is read from it is what was put in, bit for bit.
class MoveList {
 public:
  MoveList() = default;
  MoveList(std::span<const Move> moves);                                    // NOLINT: they are one
  MoveList(const std::vector<Move>& moves) : MoveList(std::span(moves)) {}  // NOLINT

  /// Bytes of moves in memory.
  static constexpr std::size_t kMaxInMemory = 32'000'000;

  /// @throws SystemError if the disk is full
  void push_back(const Move& move);
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  /// A copy; costs as much as going through a hundred moves.
  Move operator[](std::size_t index) const;
  std::vector<Move> all() const;
  class Iterator;
  Iterator begin() const;
  std::default_sentinel_t end() const { return {}; }

 private:
  // All of a Move but plane, spline and text, which are indices here.
  static constexpr std::size_t kWords = 32;
  using Words = std::array<std::uint64_t, kWords>;

  // So many moves are held together; the first of them by what differs from a Move{}.
  static constexpr std::size_t kChunk = 256;

  struct Chunk {
    std::vector<std::uint64_t> words;  // empty: in the file
    std::uint64_t place = 0;
    std::uint32_t size = 0;
  };

  Words words_of(const Move& move);
  bool is_in_file(std::size_t chunk) const;
  const std::vector<std::uint64_t>& words_in_memory(std::size_t chunk) const;
  void read_words(std::size_t chunk, std::vector<std::uint64_t>& words) const;
  void close_chunk();

  std::vector<std::uint32_t> masks_;  // words of each move that differ
  std::vector<Chunk> chunks_;         // those words
  std::vector<std::uint64_t> open_;   // of the chunk that is being filled
  std::size_t bytes_in_memory_ = 0;
  std::shared_ptr<ScratchFile> file_;  // of the chunks beyond
  std::vector<std::shared_ptr<const WorkPlane>> planes_ = {nullptr};
  std::vector<std::shared_ptr<const Spline>> splines_ = {nullptr};
  std::vector<std::string> texts_ = {""};
  std::size_t size_ = 0;
  Words last_{};
};

/// Reads one move after the other.
class MoveList::Iterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using iterator_concept = std::input_iterator_tag;
  using difference_type = std::ptrdiff_t;
  using value_type = Move;
  using reference = const Move&;
  using pointer = const Move*;

  explicit Iterator(const MoveList& list, std::size_t chunk = 0);
  /// It stays valid until the next step.
  const Move& operator*() const { return move_; }
  const Move* operator->() const { return &move_; }
  Iterator& operator++();
  void operator++(int) { ++*this; }
  bool operator==(std::default_sentinel_t) const { return is_at_end_; }

 private:
  const MoveList* list_;
  std::size_t index_ = 0, at_ = 0;  // of the next move; of its words in the chunk
  bool is_at_end_ = false, is_read_ = false;
  Words words_{};
  std::vector<std::uint64_t> read_;  // of a chunk in the file
  Move move_;
};

/// Moves of a program, to be gone through: all in a row, or held compactly.
class MoveRange {
 public:
  MoveRange(std::span<const Move> moves) : moves_(moves) {}     // NOLINT: any of these
  MoveRange(const std::vector<Move>& moves) : moves_(moves) {}  // NOLINT
  MoveRange(const MoveList& list) : list_(&list) {}             // NOLINT

  std::size_t size() const { return list_ != nullptr ? list_->size() : moves_.size(); }

  class Iterator {
   public:
    explicit Iterator(const MoveRange& range)
        : at_(range.moves_.data()), end_(at_ + range.moves_.size()) {
      if (range.list_ != nullptr) list_ = std::make_unique<MoveList::Iterator>(*range.list_);
    }
    const Move& operator*() const { return list_ ? **list_ : *at_; }
    Iterator& operator++() {
      if (list_) {
        ++*list_;
      } else {
        ++at_;
      }
      return *this;
    }
    bool operator==(std::default_sentinel_t) const {
      return list_ ? *list_ == std::default_sentinel : at_ == end_;
    }

   private:
    const Move *at_, *end_;
    std::unique_ptr<MoveList::Iterator> list_;
  };
  Iterator begin() const { return Iterator(*this); }
  std::default_sentinel_t end() const { return {}; }

 private:
  std::span<const Move> moves_;
  const MoveList* list_ = nullptr;
};

/// The first move for which `is_it` holds, or an empty one.
template <class Moves, class IsIt>
std::optional<Move> first_move(const Moves& moves, IsIt is_it) {
  for (const Move& move : moves) {
    if (is_it(move)) return move;
  }
  return std::nullopt;
}

}  // namespace servomill
