#include "controllers/gcode/macro/program_places.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <limits>

#include "controllers/gcode/lexer.h"

namespace servomill::controllers::macro {
namespace {

constexpr int kMaxLoops = 3;  // in each other, and their highest number

// The ']' that closes the first '[', or npos: a statement behind DO may have brackets, too.
std::size_t end_of_condition(const std::string& body, std::size_t begin) {
  int depth = 0;
  for (std::size_t at = begin; at < body.size(); ++at) {
    if (body[at] == '[') ++depth;
    if (body[at] == ']' && --depth == 0) return at;
  }
  return std::string::npos;
}

// The number behind DO of a line of WHILE or DO, or behind END; 0: none.
int loop_number(const Line& line) {
  Cursor cursor(line.body);
  cursor.go_to(line.begin);
  if (line.statement == Statement::while_) {
    const std::size_t close = end_of_condition(line.body, line.begin);
    if (close == std::string::npos) return 0;
    cursor.go_to(close);
    cursor.advance();
  }
  if (!cursor.accept(line.statement == Statement::end ? "END" : "DO")) return 0;
  std::uint64_t number = 0;
  cursor.take_digits(number);
  return static_cast<int>(std::min<std::uint64_t>(number, 1000));
}

}  // namespace

void ProgramPlaces::look_through() {
  if (is_known_) return;
  is_known_ = true;
  const ProgramText::Mark here = text_.mark();
  text_.rewind();
  Line line;
  std::vector<std::size_t> open;
  ProgramText::Mark before = text_.mark();
  for (std::string_view next; text_.next(next); before = text_.mark()) {
    read_line(next, line);
    if (line.is_optional && skips_optional_) continue;
    if (line.statement == Statement::program_number) {
      open.clear();
      programs_.push_back({std::atol(line.body.c_str() + line.begin + 1), before});
    }
    const bool is_loop = line.statement == Statement::while_ || line.statement == Statement::do_ ||
                         line.statement == Statement::end;
    if (is_loop) add_loop_line(line, before, loop_number(line), open);
  }
  text_.go_to(here);
}

void ProgramPlaces::add_loop_line(const Line& line, const ProgramText::Mark& before, int number,
                                  std::vector<std::size_t>& open) {
  const int at = text_.number();
  if (line.statement != Statement::end) {
    Loop loop;
    loop.number = number;
    loop.begin = before;
    loop.begin_line = at;
    loop.fault = fmt::format("DO{0} has no END{0}", number);
    for (const std::size_t one : open) {
      if (loops_[one].number != number) continue;
      loop.fault = fmt::format("DO{} within the loop DO{} of line {}", number, number,
                               loops_[one].begin_line);
    }
    if (number < 1 || number > kMaxLoops) loop.fault = "the number of DO must be 1, 2 or 3";
    loop_begins_[at] = loops_.size();
    open.push_back(loops_.size());
    loops_.push_back(std::move(loop));
    return;
  }
  if (open.empty() || loops_[open.back()].number != number) return;
  Loop& loop = loops_[open.back()];
  if (loop.fault.starts_with("DO") && loop.fault.find("has no") != std::string::npos) {
    loop.fault.clear();
  }
  loop.behind = text_.mark();
  loop.end_line = at;
  loop_ends_[at] = open.back();
  open.pop_back();
}

std::optional<ProgramText::Mark> ProgramPlaces::program(long number) {
  look_through();
  for (const Program& one : programs_) {
    if (one.number == number) return one.begin;
  }
  return std::nullopt;
}

std::optional<ProgramText::Mark> ProgramPlaces::find_block(long number,
                                                           const ProgramText::Mark& from,
                                                           std::uint64_t until) {
  text_.go_to(from);
  Line line;
  ProgramText::Mark before = text_.mark();
  for (std::string_view next; before.offset < until && text_.next(next); before = text_.mark()) {
    read_line(next, line);
    if (line.block_number == number && !(line.is_optional && skips_optional_)) return before;
  }
  return std::nullopt;
}

// Forward to the end of the program, then from its beginning. Source: Fanuc B-63944EN,
// unconditional branch (from memory).
std::optional<ProgramText::Mark> ProgramPlaces::block(long number) {
  look_through();
  const ProgramText::Mark here = text_.mark();
  const auto known = blocks_.find({here.offset, number});
  if (known != blocks_.end()) return known->second;
  ProgramText::Mark begin;
  std::uint64_t end = std::numeric_limits<std::uint64_t>::max();
  for (const Program& one : programs_) {
    if (one.begin.offset < here.offset) {
      if (&one != &programs_.front() || programs_.size() > 1) begin = one.begin;
    } else {
      end = std::min(end, one.begin.offset);
    }
  }
  auto found = find_block(number, here, end);
  if (!found) found = find_block(number, begin, here.offset);
  text_.go_to(here);
  return blocks_[{here.offset, number}] = found;
}

const Loop* ProgramPlaces::loop_from(int line) {
  look_through();
  const auto found = loop_begins_.find(line);
  return found == loop_begins_.end() ? nullptr : &loops_[found->second];
}

const Loop* ProgramPlaces::loop_to(int line) {
  look_through();
  const auto found = loop_ends_.find(line);
  return found == loop_ends_.end() ? nullptr : &loops_[found->second];
}

const Loop* ProgramPlaces::loop_entered(int from_line, int to_line) {
  look_through();
  const Loop* out = nullptr;
  for (const Loop& loop : loops_) {
    const auto holds = [&](int line) { return loop.begin_line < line && line <= loop.end_line; };
    if (holds(to_line) && !holds(from_line)) out = &loop;
  }
  return out;
}

}  // namespace servomill::controllers::macro
