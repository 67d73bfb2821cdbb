#include "controllers/gcode/message_text.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

namespace servomill::controllers {
namespace {

constexpr double kZero = 1e-4;  // as LinuxCNC compares
constexpr std::string_view kUnknown = "######";
constexpr std::size_t kMaxDigits = 4;  // of the number of a parameter

bool is_digit(char c) { return c >= '0' && c <= '9'; }

class MessageText {
 public:
  MessageText(std::string_view text, const Parameters& parameters)
      : rest_(text), parameters_(parameters) {}

  std::string expand() {
    while (!rest_.empty()) {
      if (!format() && !name() && !number()) take(1);
    }
    return std::move(out_);
  }

 private:
  void take(std::size_t count) {
    out_ += rest_.substr(0, count);
    rest_.remove_prefix(count);
  }

  void show(std::optional<double> value) {
    if (!value) {
      out_ += kUnknown;
      return;
    }
    out_ += fmt::format("{:.{}f}", std::abs(*value) < kZero ? 0.0 : *value, decimals_);
  }

  bool format() {
    if (rest_[0] != '%' || rest_.size() < 2) return false;
    const bool is_long = rest_.size() >= 4 && rest_[1] == '.' && is_digit(rest_[2]) &&
                         (rest_[3] == 'f' || rest_[3] == 'F');
    if (!is_long && rest_[1] != 'd' && rest_[1] != 'f') return false;
    decimals_ = is_long ? rest_[2] - '0' : rest_[1] == 'd' ? 0 : 4;
    rest_.remove_prefix(is_long ? 4 : 2);
    return true;
  }

  bool name() {
    if (!rest_.starts_with("#<")) return false;
    const std::size_t close = rest_.find('>');
    if (close == std::string_view::npos) return false;
    std::string name;
    for (const char c : rest_.substr(2, close - 2)) {
      if (c != ' ' && c != '\t') name += c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
    }
    rest_.remove_prefix(close + 1);
    show(parameters_.get(name));
    return true;
  }

  bool number() {
    std::size_t end = 1;
    while (rest_[0] == '#' && end < rest_.size() && end <= kMaxDigits + 1 && is_digit(rest_[end])) {
      ++end;
    }
    if (end == 1) return false;
    const int number = std::stoi(std::string(rest_.substr(1, end - 1)));
    rest_.remove_prefix(end);
    if (number == 0) {
      show(0.0);
    } else if (number > parameter::kLast) {
      show(std::nullopt);
    } else {
      show(parameters_.get(number));
    }
    return true;
  }

  std::string_view rest_;
  const Parameters& parameters_;
  int decimals_ = 6;
  std::string out_;
};

}  // namespace

std::string message_text(std::string_view text, const Parameters& parameters) {
  return MessageText(text, parameters).expand();
}

}  // namespace servomill::controllers
