#include "plant/vocabulary/move_list.h"

#include <bit>
#include <utility>

#include "plant/vocabulary/scratch_file.h"

namespace servomill {
namespace {

std::uint64_t bits_of(double x) { return std::bit_cast<std::uint64_t>(x); }
std::uint64_t pair_of(int low, int high) {
  return static_cast<std::uint64_t>(static_cast<std::uint32_t>(low)) |
         static_cast<std::uint64_t>(static_cast<std::uint32_t>(high)) << 32;
}
int low_of(std::uint64_t pair) { return static_cast<int>(static_cast<std::uint32_t>(pair)); }
int high_of(std::uint64_t pair) { return static_cast<int>(static_cast<std::uint32_t>(pair >> 32)); }

// Puts the members of a move into words, or takes them out of words, in the same order.
struct Writer {
  std::uint64_t* to;
  void number(double& x) { *to++ = bits_of(x); }
  void integers(int& a, int& b) { *to++ = pair_of(a, b); }
  template <class... Small>
  void small(Small&... x) {
    std::uint64_t word = 0;
    ((word = word << 8 | static_cast<std::uint8_t>(x)), ...);
    *to++ = word;
  }
};
struct Reader {
  const std::uint64_t* from;
  void number(double& x) { x = std::bit_cast<double>(*from++); }
  void integers(int& a, int& b) { a = low_of(*from), b = high_of(*from), ++from; }
  template <class... Small>
  void small(Small&... x) {
    const std::uint64_t word = *from++;
    std::size_t shift = 8 * sizeof...(Small);
    ((shift -= 8, x = static_cast<Small>(word >> shift & 0xff)), ...);
  }
};

// Places of plane, spline and text of a move.
struct Indices {
  int plane = 0, spline = 0, text = 0;
};

// Complete: a member that is added to one of these does not compile here.
template <class Each>
void visit(Move& move, Indices& at, Each each) {
  auto& [kind, line, end, end_machine, arc, centre_machine, feed, feed_mode, path_mode,
         path_tolerance, value, number, tool_control, synchronised, direction, work_offset,
         is_shifted, tool_offset, tool_axis, plane, spline, text, s_begin, s_end] = move;
  auto& [normal_axis, centre, turns] = arc;
  (void)plane, (void)spline, (void)text;
  each.number(s_begin);
  each.integers(line, number);
  for (double& x : end) each.number(x);
  for (double& x : end_machine) each.number(x);
  for (double& x : centre) each.number(x);
  for (double& x : centre_machine) each.number(x);
  for (double& x : tool_axis) each.number(x);
  for (double* x : {&s_end, &feed, &path_tolerance, &value}) each.number(*x);
  each.integers(normal_axis, turns);
  each.integers(direction, work_offset);
  each.integers(tool_offset, at.plane);
  each.integers(at.text, at.spline);
  each.small(kind, feed_mode, path_mode, tool_control, is_shifted, synchronised);
}
constexpr std::size_t kBegin = 0, kLine = 1, kEnd = 23;  // places of s_begin, line, s_end

// A block mostly begins where the one before ended, on the next line.
template <class Words>
void predict(Words& words) {
  words[kBegin] = words[kEnd];
  words[kLine] = pair_of(low_of(words[kLine]) + 1, high_of(words[kLine]));
}

}  // namespace

MoveList::MoveList(std::span<const Move> moves) {
  for (const Move& move : moves) push_back(move);
}

MoveList::Words MoveList::words_of(const Move& given) {
  const auto index = [](auto& held, const auto& one) {
    if (held.back() != one) held.push_back(one);
    return static_cast<int>(held.size()) - 1;
  };
  Indices at;
  if (given.plane != nullptr) at.plane = index(planes_, given.plane);
  if (given.spline != nullptr) at.spline = index(splines_, given.spline);
  if (!given.text.empty()) at.text = index(texts_, given.text);
  Words words;
  // only read, but the members are the same as those that are written
  visit(const_cast<Move&>(given), at, Writer{words.data()});
  return words;
}

bool MoveList::is_in_file(std::size_t chunk) const {
  return chunk < chunks_.size() && chunks_[chunk].words.empty() && chunks_[chunk].size > 0;
}

const std::vector<std::uint64_t>& MoveList::words_in_memory(std::size_t chunk) const {
  return chunk < chunks_.size() ? chunks_[chunk].words : open_;
}

void MoveList::read_words(std::size_t chunk, std::vector<std::uint64_t>& words) const {
  words.resize(chunks_[chunk].size);
  file_->read(chunks_[chunk].place, bytes_of(words));
}

void MoveList::push_back(const Move& move) {
  if (size_ % kChunk == 0) {
    if (size_ > 0) close_chunk();
    last_ = words_of(Move{});
  }
  const Words words = words_of(move);
  predict(last_);
  std::uint32_t mask = 0;
  for (std::size_t i = 0; i < kWords; ++i) {
    if (words[i] == last_[i]) continue;
    mask |= 1U << i;
    open_.push_back(words[i]);
  }
  masks_.push_back(mask);
  last_ = words;
  ++size_;
}

// Exactly as large as it is.
void MoveList::close_chunk() {
  Chunk& chunk = chunks_.emplace_back();
  chunk.size = static_cast<std::uint32_t>(open_.size());
  const std::size_t bytes = open_.size() * sizeof(open_[0]);
  if (bytes_in_memory_ + bytes <= kMaxInMemory) {
    bytes_in_memory_ += bytes;
    chunk.words.assign(open_.begin(), open_.end());
  } else {
    if (file_ == nullptr) file_ = std::make_shared<ScratchFile>("", "moves of the program");
    chunk.place = file_->append(bytes_of(std::as_const(open_)));
  }
  open_.clear();
}

MoveList::Iterator MoveList::begin() const { return Iterator(*this); }

Move MoveList::operator[](std::size_t index) const {
  Iterator at(*this, index / kChunk);
  for (std::size_t n = 0; n < index % kChunk; ++n) ++at;
  return *at;
}

std::vector<Move> MoveList::all() const {
  std::vector<Move> out;
  out.reserve(size_);
  for (const Move& move : *this) out.push_back(move);
  return out;
}

MoveList::Iterator::Iterator(const MoveList& list, std::size_t chunk)
    : list_(&list), index_(chunk * kChunk) {
  ++*this;
}

MoveList::Iterator& MoveList::Iterator::operator++() {
  if (index_ == list_->size_) {
    is_at_end_ = true;
    return *this;
  }
  if (index_ % kChunk == 0) {
    at_ = 0;
    Move first;
    Indices none;
    visit(first, none, Writer{words_.data()});
    is_read_ = list_->is_in_file(index_ / kChunk);
    if (is_read_) list_->read_words(index_ / kChunk, read_);
  }
  const auto& from = is_read_ ? read_ : list_->words_in_memory(index_ / kChunk);
  predict(words_);
  for (std::uint32_t mask = list_->masks_[index_]; mask != 0; mask &= mask - 1) {
    words_[static_cast<std::size_t>(std::countr_zero(mask))] = from[at_++];
  }
  Indices at;
  visit(move_, at, Reader{words_.data()});
  const auto take = [](auto& now, const auto& held, int index) {
    const auto& wanted = held[static_cast<std::size_t>(index)];
    if (now != wanted) now = wanted;
  };
  take(move_.plane, list_->planes_, at.plane);
  take(move_.spline, list_->splines_, at.spline);
  take(move_.text, list_->texts_, at.text);
  ++index_;
  return *this;
}

}  // namespace servomill
