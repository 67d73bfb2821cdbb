#include "plant/vocabulary/move_list.h"

#include <bit>

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

// Complete: a member that is added to one of these does not compile here. Of plane and text there
// are indices.
template <class Each>
void visit(Move& move, int& plane_index, int& text_index, Each each) {
  auto& [kind, line, end, end_machine, arc, centre_machine, feed, feed_mode, path_mode,
         path_tolerance, value, number, tool_control, direction, work_offset, is_shifted,
         tool_offset, tool_axis, plane, text, s_begin, s_end] = move;
  auto& [normal_axis, centre, turns] = arc;
  (void)plane, (void)text;
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
  each.integers(tool_offset, plane_index);
  each.integers(text_index, text_index);
  each.small(kind, feed_mode, path_mode, tool_control, is_shifted);
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
  int plane = 0, text = 0;
  if (given.plane != nullptr) {
    if (given.plane != planes_.back()) planes_.push_back(given.plane);
    plane = static_cast<int>(planes_.size()) - 1;
  }
  if (!given.text.empty()) {
    if (given.text != texts_.back()) texts_.push_back(given.text);
    text = static_cast<int>(texts_.size()) - 1;
  }
  Words words;
  // only read, but the members are the same as those that are written
  visit(const_cast<Move&>(given), plane, text, Writer{words.data()});
  return words;
}

const std::vector<std::uint64_t>& MoveList::chunk_of(std::size_t index) const {
  const std::size_t chunk = index / kChunk;
  return chunk < chunks_.size() ? chunks_[chunk] : open_;
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
  chunks_.emplace_back(open_.begin(), open_.end());
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
    int plane = 0, text = 0;
    visit(first, plane, text, Writer{words_.data()});
  }
  const std::vector<std::uint64_t>& from = list_->chunk_of(index_);
  predict(words_);
  for (std::uint32_t mask = list_->masks_[index_]; mask != 0; mask &= mask - 1) {
    words_[static_cast<std::size_t>(std::countr_zero(mask))] = from[at_++];
  }
  int plane = 0, text = 0;
  visit(move_, plane, text, Reader{words_.data()});
  const auto& plane_now = list_->planes_[static_cast<std::size_t>(plane)];
  const std::string& text_now = list_->texts_[static_cast<std::size_t>(text)];
  if (move_.plane != plane_now) move_.plane = plane_now;
  if (move_.text != text_now) move_.text = text_now;
  ++index_;
  return *this;
}

}  // namespace servomill
