#include "controllers/gcode/program_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "plant/vocabulary/byte_order_mark.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/stored_text.h"
#include "plant/vocabulary/user_file.h"

namespace servomill::controllers {
namespace {

constexpr std::size_t kPiece = 1U << 16;        // read at once, bytes
constexpr std::size_t kLongestKept = 1U << 15;  // of one line
constexpr std::size_t kLongestSkipped = 10'000'000;

}  // namespace

struct ProgramText::Reader {
  OpenFile file = {};
  std::shared_ptr<const StoredText> text = {};  // in place of a file
  std::size_t at = 0;                           // in the text

  std::size_t read(char* to, std::size_t most) {
    if (!text) return std::fread(to, 1, most, file.get());
    const std::size_t count = text->copy(to, most, at);
    at += count;
    return count;
  }
  bool go_to(std::uint64_t offset) {
    if (!text) return ::fseeko(file.get(), static_cast<off_t>(offset), SEEK_SET) == 0;
    at = static_cast<std::size_t>(offset);
    return true;
  }
  bool has_failed() const { return !text && std::ferror(file.get()) != 0; }
};

std::optional<ProgramText> LineSource::written() const { return std::nullopt; }

ProgramText::ProgramText() = default;
ProgramText::ProgramText(ProgramText&&) noexcept = default;
ProgramText& ProgramText::operator=(ProgramText&&) noexcept = default;
ProgramText::~ProgramText() = default;

ProgramText ProgramText::of_text(std::string text, std::string file) {
  ProgramText out;
  out.file_ = std::move(file);
  out.buffer_ = std::move(text);
  out.at_end_ = true;
  out.skip_byte_order_mark();
  return out;
}

ProgramText ProgramText::of_shared_text(std::shared_ptr<const StoredText> text, std::string file) {
  ProgramText out;
  out.file_ = std::move(file);
  out.reader_ = std::make_unique<Reader>();
  out.reader_->text = std::move(text);
  out.refill();
  out.skip_byte_order_mark();
  return out;
}

ProgramText ProgramText::of_file(const std::string& path) {
  ProgramText out;
  out.file_ = path;
  std::string why;
  out.reader_ = std::make_unique<Reader>(Reader{open_input(path, why)});
  if (!why.empty()) throw InputError({path}, fmt::format("cannot be read: {}", why));
  if (!out.refill()) out.fail();
  out.skip_byte_order_mark();
  return out;
}

ProgramText ProgramText::again() const {
  if (!reader_) return of_text(buffer_, file_);
  return reader_->text ? of_shared_text(reader_->text, file_) : of_file(file_);
}

ProgramText ProgramText::of_source(std::unique_ptr<LineSource> source, std::string file) {
  ProgramText out;
  out.file_ = std::move(file);
  out.source_ = std::move(source);
  out.at_end_ = true;
  return out;
}

void ProgramText::fail() const {
  throw InputError({file_, number_, 0}, fmt::format("cannot be read: {}", std::strerror(errno)));
}

// Keeps what is left of the buffer and reads on behind it. False if the file cannot be read.
bool ProgramText::refill() {
  if (at_end_) return true;
  buffer_.erase(0, at_);
  base_ += at_;
  at_ = 0;
  const std::size_t kept = buffer_.size();
  buffer_.resize(kept + kPiece);
  const std::size_t got = reader_->read(buffer_.data() + kept, kPiece);
  buffer_.resize(kept + got);
  at_end_ = got < kPiece;
  return !reader_->has_failed();
}

// Lines are views into the buffer and remain valid until the next call. A line longer than
// kLongestKept is returned truncated and skipped from there on, so that no file can exhaust the
// memory.
bool ProgramText::next(std::string_view& line) {
  throw_if_interrupted();
  if (source_) {
    Place place;
    if (!source_->next(long_line_, place)) return false;
    file_ = std::move(place.file);
    number_ = place.line;
    column_ = place.column;
    line = long_line_;
    return true;
  }
  if (wanted_) seek(*std::exchange(wanted_, std::nullopt));
  const auto line_end = [&] {
    const void* found = std::memchr(buffer_.data() + at_, '\n', buffer_.size() - at_);
    return found == nullptr
               ? std::string::npos
               : static_cast<std::size_t>(static_cast<const char*>(found) - buffer_.data());
  };
  if (std::exchange(in_long_line_, false)) skip_to_line_end();
  std::size_t end = line_end();
  while (end == std::string::npos && !at_end_ && buffer_.size() - at_ <= kLongestKept) {
    if (!refill()) fail();
    end = line_end();
  }
  if (at_ == buffer_.size()) return false;
  ++number_;
  if (end == std::string::npos) {
    if (!at_end_) {
      long_line_.assign(buffer_, at_, kLongestKept);
      in_long_line_ = true;
      line = long_line_;
      return true;
    }
    end = buffer_.size();
  }
  line = std::string_view(buffer_).substr(at_, std::min(end - at_, kLongestKept));
  at_ = std::min(end + 1, buffer_.size());
  return true;
}

// A line without end must neither fill the memory nor be read.
void ProgramText::skip_to_line_end() {
  for (const std::uint64_t from = base_ + at_; base_ + at_ - from < kLongestSkipped;) {
    const std::size_t end = buffer_.find('\n', at_);
    if (end != std::string::npos) {
      at_ = end + 1;
      return;
    }
    at_ = buffer_.size();
    if (at_end_) return;
    if (!refill()) fail();
  }
  throw InputError(
      {file_, number_, 0},
      fmt::format("line longer than {} characters; this is not a program", kLongestSkipped));
}

// LinuxCNC refuses such a program.
void ProgramText::skip_byte_order_mark() {
  if (base_ == 0 && at_ == 0 && buffer_.starts_with(kByteOrderMark)) at_ = kByteOrderMark.size();
}

void ProgramText::seek(std::uint64_t offset) {
  if (offset >= base_ && offset <= base_ + buffer_.size()) {
    at_ = static_cast<std::size_t>(offset - base_);
    skip_byte_order_mark();
    return;
  }
  buffer_.clear();
  at_ = 0;
  base_ = offset;
  at_end_ = false;
  if (!reader_->go_to(offset) || !refill()) fail();
  skip_byte_order_mark();
}

}  // namespace servomill::controllers
