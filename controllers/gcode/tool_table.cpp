#include "controllers/gcode/tool_table.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

constexpr std::string_view kWords = "TPXYZABCDIJQUVW";
constexpr int kMaxOrientation = 9;

// Reads one line, and goes on behind a fault with the next word.
class ToolLine {
 public:
  ToolLine(std::string_view line, Place place, std::vector<Fault>& faults)
      : line_(line), place_(std::move(place)), faults_(faults) {}

  std::optional<ToolEntry> read() {
    const std::size_t faults_before = faults_.size();
    ToolEntry tool;
    for (skip_blanks(); at_ < line_.size(); skip_blanks()) read_word(tool);
    const bool has_number = seen_.find('T') != std::string::npos;
    if (!has_number) fault(0, "the tool number (T word) is missing");
    if (!has_number || faults_.size() > faults_before) return std::nullopt;
    return tool;
  }

  void fault(std::size_t at, std::string message) {
    place_.column = static_cast<int>(at) + 1;
    faults_.push_back({place_, std::move(message)});
  }

 private:
  void skip_blanks() {
    while (at_ < line_.size() && is_blank(line_[at_])) ++at_;
  }

  void skip_word() {
    while (at_ < line_.size() && !is_blank(line_[at_])) ++at_;
  }

  void read_word(ToolEntry& tool) {
    const std::size_t start = at_++;
    const char c = line_[start];
    const char letter = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    if (kWords.find(letter) == std::string_view::npos) {
      fault(start,
            fmt::format("unknown word '{}'; allowed are T P X Y Z A B C D I J Q", printable(c)));
      return skip_word();
    }
    if (seen_.find(letter) != std::string::npos) {
      fault(start, fmt::format("the {} word appears twice", letter));
    }
    seen_ += letter;
    const std::optional<double> value = number();
    if (!value) {
      fault(start, fmt::format("{} must be followed by a number", letter));
      return skip_word();
    }
    store(tool, letter, *value, start);
  }

  static std::string printable(char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte > 0x20 && byte < 0x7f ? std::string(1, c) : fmt::format("\\x{:02x}", byte);
  }

  std::optional<double> number() {
    skip_blanks();
    if (at_ < line_.size() && line_[at_] == '+') ++at_;
    double x = 0.0;
    const auto [end, status] = std::from_chars(line_.data() + at_, line_.data() + line_.size(), x);
    if (status != std::errc() || !std::isfinite(x)) return std::nullopt;
    at_ = static_cast<std::size_t>(end - line_.data());
    return x;
  }

  int integer(char letter, double x, int most, std::size_t start) {
    if (x == std::floor(x) && x >= 0.0 && x <= most) return static_cast<int>(x);
    fault(start, fmt::format("{}{}; must be an integer in 0 ... {}", letter, x, most));
    return 0;
  }

  void store(ToolEntry& tool, char letter, double x, std::size_t start) {
    constexpr int kMaxNumber = 1000000;
    if (const auto axis = axis_of(letter)) {
      tool.offset[index_of(*axis)] = x * (is_linear(*axis) ? mm : deg);
      return;
    }
    switch (letter) {
      case 'T':
        tool.number = integer(letter, x, kMaxNumber, start);
        return;
      case 'P':
        tool.pocket = integer(letter, x, kMaxNumber, start);
        return;
      case 'Q':
        tool.orientation = integer(letter, x, kMaxOrientation, start);
        return;
      case 'D':
        tool.diameter = x * mm;
        return;
      case 'I':
        tool.front_angle = x * deg;
        return;
      case 'J':
        tool.back_angle = x * deg;
        return;
      default:  // U V W
        if (x != 0.0)
          fault(start, fmt::format("{}{}; must be 0: axis {} is not supported", letter, x, letter));
    }
  }

  std::string_view line_;
  Place place_;
  std::vector<Fault>& faults_;
  std::size_t at_ = 0;
  std::string seen_;
};

}  // namespace

ToolTable ToolTable::parse(std::string_view text, const std::string& file) {
  ToolTable table;
  std::vector<Fault> faults;
  int number = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    ++number;
    line = line.substr(0, line.find(';'));
    if (line.find_first_not_of(" \t\r") == std::string_view::npos) continue;
    ToolLine tool_line(line, {file, number, 0}, faults);
    const std::optional<ToolEntry> tool = tool_line.read();
    if (!tool) continue;
    if (table.find(tool->number) != nullptr) {
      tool_line.fault(0, fmt::format("tool T{} appears twice", tool->number));
    } else {
      table.add(*tool);
    }
  }
  if (!faults.empty()) throw InputError(std::move(faults));
  return table;
}

void ToolTable::add(const ToolEntry& tool) {
  if (!tools_.emplace(tool.number, tool).second) {
    throw InputError({}, fmt::format("tool T{} appears twice", tool.number));
  }
}

const ToolEntry* ToolTable::entry_of(int number) const {
  const auto found = tools_.find(number);
  return found == tools_.end() ? nullptr : &found->second;
}

const ToolEntry* ToolTable::find(int number) const {
  static const ToolEntry kAnyTool;
  const ToolEntry* entry = entry_of(number);
  return entry == nullptr && takes_any_ ? &kAnyTool : entry;
}

}  // namespace servomill::controllers
