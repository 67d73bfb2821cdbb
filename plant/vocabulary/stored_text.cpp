#include "plant/vocabulary/stored_text.h"

#include <algorithm>
#include <cstdint>
#include <span>

#include "plant/vocabulary/scratch_file.h"

namespace servomill {

StoredText::StoredText(std::string_view text, std::size_t most_in_memory)
    : most_in_memory_(most_in_memory) {
  reserve(text.size());
  append(text);
}

void StoredText::make_file() {
  if (file_ == nullptr) file_ = std::make_shared<ScratchFile>("", "text of the program");
}

void StoredText::reserve(std::size_t bytes) {
  if (bytes > most_in_memory_) {
    make_file();
  } else {
    tail_.reserve(bytes);
  }
}

void StoredText::append(std::string_view text) {
  while (!text.empty()) {
    const std::string_view next = text.substr(0, kPiece);
    text.remove_prefix(next.size());
    tail_ += next;
    if (tail_.size() > most_in_memory_) make_file();
    if (file_ != nullptr && tail_.size() >= kPiece) write_pieces();
  }
}

void StoredText::write_pieces() {
  const std::size_t whole = tail_.size() / kPiece * kPiece;
  file_->append({reinterpret_cast<const std::uint8_t*>(tail_.data()), whole});
  in_file_ += whole;
  tail_.erase(0, whole);
  if (tail_.capacity() > 2 * kPiece) tail_.shrink_to_fit();
}

std::size_t StoredText::copy(char* to, std::size_t most, std::size_t at) const {
  const std::size_t count = std::min(most, size() - std::min(at, size()));
  const std::size_t from_file = at < in_file_ ? std::min(count, in_file_ - at) : 0;
  if (from_file > 0) file_->read(at, {reinterpret_cast<std::uint8_t*>(to), from_file});
  if (count > from_file) tail_.copy(to + from_file, count - from_file, at + from_file - in_file_);
  return count;
}

// In memory it is not copied. Pieces begin at multiples of kPiece, so that none is in both places.
std::string_view StoredText::piece(std::size_t at, std::string& buffer) const {
  if (at >= in_file_) return std::string_view(tail_).substr(at - in_file_, kPiece);
  buffer.resize(kPiece);
  copy(buffer.data(), kPiece, at);
  return buffer;
}

std::string StoredText::all() const {
  std::string out(size(), '\0');
  copy(out.data(), out.size(), 0);
  return out;
}

bool StoredText::operator==(const StoredText& other) const {
  if (size() != other.size()) return false;
  std::string mine, others;
  for (std::size_t at = 0; at < size(); at += kPiece) {
    if (piece(at, mine) != other.piece(at, others)) return false;
  }
  return true;
}

}  // namespace servomill
