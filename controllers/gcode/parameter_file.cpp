#include "controllers/gcode/parameter_file.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <vector>

#include "controllers/gcode/modal_state.h"
#include "controllers/gcode/parameters.h"
#include "plant/vocabulary/input_error.h"

namespace servomill::controllers {
namespace {

constexpr std::string_view kBlanks = " \t\r";
constexpr std::string_view kRemarks = ";#(";

std::size_t skip_blanks(std::string_view line, std::size_t at) {
  return std::min(line.find_first_not_of(kBlanks, at), line.size());
}

// Reads a number at `at`, with or without a sign, and moves behind it.
template <typename Number>
bool read(std::string_view line, std::size_t& at, Number& out) {
  std::size_t first = at;
  if (first < line.size() && line[first] == '+') ++first;
  const auto [end, status] = std::from_chars(line.data() + first, line.data() + line.size(), out);
  if (status != std::errc()) return false;
  at = static_cast<std::size_t>(end - line.data());
  return true;
}

class ParameterLines {
 public:
  explicit ParameterLines(const std::string& file) : file_(file) {}

  void read_line(std::string_view line) {
    ++line_;
    const std::size_t start = skip_blanks(line, 0);
    constexpr std::string_view kNumberBegins = "0123456789+-";
    if (start == line.size() || kNumberBegins.find(line[start]) == std::string_view::npos) return;
    std::size_t at = start;
    int number = 0;
    if (!read(line, at, number) || (at < line.size() && kBlanks.find(line[at]) == kBlanks.npos)) {
      return fault(
          start, fmt::format("must start with a parameter number from 1 to {}", parameter::kLast));
    }
    if (number < 1 || number > parameter::kLast) {
      return fault(
          start, fmt::format("parameter number {}; must be in 1 ... {}", number, parameter::kLast));
    }
    if (number <= last_) {
      return fault(start,
                   fmt::format("parameter {} after {}; the numbers must increase", number, last_));
    }
    last_ = number;
    read_value(line, skip_blanks(line, at), number);
  }

  std::map<int, double> result() {
    if (!faults_.empty()) throw InputError(std::move(faults_));
    return std::move(stored_);
  }

 private:
  void read_value(std::string_view line, std::size_t start, int number) {
    std::size_t at = start;
    double value = 0.0;
    if (!read(line, at, value)) {
      return fault(start, fmt::format("parameter {} requires a value", number));
    }
    if (!std::isfinite(value)) {
      return fault(start, fmt::format("parameter {} = {}; must be finite", number, value));
    }
    const std::size_t rest = skip_blanks(line, at);
    if (rest < line.size() && kRemarks.find(line[rest]) == kRemarks.npos) {
      return fault(rest, fmt::format("unexpected '{}' after the value of parameter {}",
                                     line.substr(rest), number));
    }
    if (number == parameter::kWorkSystem &&
        (value != std::floor(value) || value < 1.0 || value > kWorkSystems)) {
      return fault(
          start,
          fmt::format("parameter {} = {}, the active work offset; must be an integer from 1 to {}",
                      number, value, kWorkSystems));
    }
    stored_[number] = value;
  }

  void fault(std::size_t at, std::string message) {
    faults_.push_back({{file_, line_, static_cast<int>(at) + 1}, std::move(message)});
  }

  const std::string& file_;
  int line_ = 0, last_ = 0;
  std::map<int, double> stored_;
  std::vector<Fault> faults_;
};

}  // namespace

std::map<int, double> parse_parameter_file(std::string_view text, const std::string& file) {
  ParameterLines lines(file);
  const bool is_empty = text.find_first_not_of(" \t\r\n") == std::string_view::npos;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines.read_line(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  std::map<int, double> stored = lines.result();
  if (stored.empty() && !is_empty) {
    throw InputError({file}, "contains no parameter; expected a number and its value per line");
  }
  return stored;
}

int work_system_of(const std::map<int, double>& stored) {
  const auto found = stored.find(parameter::kWorkSystem);
  return found == stored.end() ? 1 : static_cast<int>(found->second);
}

}  // namespace servomill::controllers
