/// The text of a program, line by line, and what a '%' among its lines means.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "plant/vocabulary/input_error.h"

namespace servomill {
class StoredText;
}  // namespace servomill

namespace servomill::controllers {

class ProgramText;

/// Parts of a line that a survey does not know. They travel with the line, since no number in it
/// can say so.
struct LineUnknowns {
  bool tilt = false;        ///< the angles of the work plane are placeholders
  bool feed = false;        ///< the number of F is a placeholder
  std::string motion = {};  ///< cycle whose moves are unknown; the line is their placeholder
};

/// Writes the lines of a program in another language as lines in G-code.
class LineSource {
 public:
  virtual ~LineSource() = default;
  /// @param line, place  set to the next line, and to the block that it comes from
  /// @return false behind the end of the program
  /// @throws InputError at a block with an error
  virtual bool next(std::string& line, Place& place) = 0;
  /// Warnings since the last call.
  virtual std::vector<Fault> take_warnings() = 0;
  /// True for blocks of a control, which its rules apply to; false for lines as LinuxCNC has them.
  virtual bool is_of_control() const { return false; }
  /// Column in the program as written of one in the line that came last.
  virtual int original_column(int column) const { return column; }
  /// Unknown parts of the line that came last.
  virtual LineUnknowns unknowns() const { return {}; }
  /// Programs that call each other: how many, and "; in O9010, called in part.nc:12".
  virtual int call_depth() const { return 0; }
  virtual std::string call_stack() const { return {}; }
  /// The program as written, from its first line.
  virtual std::optional<ProgramText> written() const;
};

inline bool is_blank(std::string_view line) {
  return line.find_first_not_of(" \t\r") == std::string_view::npos;
}

/// Hands out the lines of a text or of a file, and goes back to a line that it has handed out. Of
/// a file or a shared text it holds a piece of constant size, however long that is. A byte-order
/// mark (UTF-8) at the begin is left out.
class ProgramText {
 public:
  /// Beginning of a line.
  struct Mark {
    std::uint64_t offset = 0;  // in bytes
    int line = 0;              // number of the line before
  };

  /// @param file  name for messages
  static ProgramText of_text(std::string text, std::string file);
  /// The same of a text that others hold, too: it is not copied.
  static ProgramText of_shared_text(std::shared_ptr<const StoredText> text, std::string file);
  /// @throws InputError if the file cannot be read
  static ProgramText of_file(const std::string& path);
  /// The same text or file again, from its first line.
  /// @pre !is_generated()
  ProgramText again() const;
  /// Lines that come one by one, and do not come again: no mark leads back to them.
  static ProgramText of_source(std::unique_ptr<LineSource> source, std::string file);

  ProgramText(ProgramText&&) noexcept;
  ProgramText& operator=(ProgramText&&) noexcept;
  ~ProgramText();

  /// The next line without its end; it stays valid until the next call. Of a line longer than
  /// 32 KiB only so much.
  /// @throws InputError if the file can no longer be read, or a line never ends
  bool next(std::string_view& line);
  /// Number of the line handed out last, from 1.
  int number() const { return number_; }
  const std::string& file() const { return file_; }
  /// True for lines of a `LineSource`.
  bool is_generated() const { return source_ != nullptr; }
  /// That source, or nullptr.
  const LineSource* source() const { return source_.get(); }
  /// Column of the block that the line handed out last comes from; 0: of its own.
  int column() const { return column_; }
  std::vector<Fault> take_warnings() {
    return source_ ? source_->take_warnings() : std::vector<Fault>();
  }

  /// Behind the line handed out last.
  Mark mark() const { return {wanted_ ? *wanted_ : base_ + at_, number_}; }
  /// From the next call of `next` on; the line handed out last stays valid until then.
  void go_to(const Mark& mark) {
    wanted_ = mark.offset;
    in_long_line_ = false;
    number_ = mark.line;
  }
  void rewind() { go_to({}); }

 private:
  struct Reader;  // an open file, or a text that others hold

  ProgramText();
  [[noreturn]] void fail() const;
  bool refill();
  void seek(std::uint64_t offset);
  void skip_to_line_end();
  void skip_byte_order_mark();

  std::string file_;
  std::string buffer_;      // of a text of its own: all of it
  std::uint64_t base_ = 0;  // offset of buffer_ in the file
  std::size_t at_ = 0;      // where the next line begins, in buffer_
  int number_ = 0;
  std::optional<std::uint64_t> wanted_;  // where to read on
  bool at_end_ = false;                  // nothing follows buffer_
  bool in_long_line_ = false;            // the line handed out last did not fit
  std::string long_line_;                // what is kept of a line that does not fit
  std::unique_ptr<Reader> reader_;
  std::unique_ptr<LineSource> source_;
  int column_ = 0;  // of the line of a source
};

/// Meaning of a '%' by its place.
enum class Percent { start, end, misplaced };

class PercentRule {
 public:
  void saw_line() { first_ = false; }
  bool saw_nothing() const { return first_; }
  /// True if the program began with a '%'.
  bool is_framed() const { return open_; }
  Percent saw_percent() {
    const Percent meaning = first_ ? Percent::start : open_ ? Percent::end : Percent::misplaced;
    if (meaning == Percent::start) open_ = true;
    first_ = false;
    return meaning;
  }

 private:
  bool first_ = true;
  bool open_ = false;
};

}  // namespace servomill::controllers
