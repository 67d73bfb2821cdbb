#include "plant/kinematics/structure.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace servomill::plant {
namespace {

constexpr int kRotaryJoints = kJoints - kLinearJoints;
constexpr std::string_view kBlanks = " \t";

bool is_rotary_letter(char c) { return c >= 'A' && c <= 'C'; }
bool is_axis_letter(char c) { return is_rotary_letter(c) || (c >= 'X' && c <= 'Z'); }

struct Token {
  std::string_view text;  // w b t, an axis with its prime, or a spindle
  std::size_t at;         // place in the string, from 0

  bool is_axis() const { return is_axis_letter(text.front()); }
  bool is_spindle() const { return text.front() == '('; }
  bool is_primed() const { return text.back() == '\''; }
  Axis axis() const { return *axis_of(text[is_spindle() ? 1 : 0]); }
};

class Parser {
 public:
  Parser(std::string_view text, const Place& at) : text_(text), origin_(at) {}

  Structure parse() {
    read_tokens();
    check_ends();
    check_spindle();
    Structure structure = read_axes();
    if (!faults_.empty()) throw InputError(std::move(faults_));
    return structure;
  }

 private:
  void fault(std::size_t at, std::string_view message) {
    Place place = origin_;
    place.column += static_cast<int>(at);
    faults_.push_back({std::move(place), fmt::format("structure '{}': {}", text_, message)});
  }

  void read_tokens() {
    begin_ = std::min(text_.find_first_not_of(kBlanks), text_.size());
    end_ = text_.find_last_not_of(kBlanks) + 1;  // npos + 1 is 0
    // brackets
    if (begin_ < end_ && text_[begin_] == '[') {
      ++begin_;
    } else {
      fault(begin_, "must start with '['");
    }
    if (begin_ < end_ && text_[end_ - 1] == ']') {
      --end_;
    } else {
      fault(end_, "must end with ']'");
    }
    // what stands between them
    for (std::size_t i = begin_; i < end_;) i += read_token(i);
  }

  // Length of the token that begins at i.
  std::size_t read_token(std::size_t i) {
    const char c = text_[i];
    if (kBlanks.find(c) != std::string_view::npos) return 1;
    std::size_t length = 1;
    if (is_axis_letter(c)) {
      if (i + 1 < end_ && text_[i + 1] == '\'') length = 2;
    } else if (c == '(') {
      const std::string_view spindle = text_.substr(i, std::min<std::size_t>(4, end_ - i));
      if (spindle.size() < 4 || !is_rotary_letter(spindle[1]) || spindle.substr(2) != "1)") {
        fault(i, "a spindle must be written (A1), (B1) or (C1)");
        const std::size_t close = text_.find(')', i);
        return close < end_ ? close + 1 - i : end_ - i;
      }
      length = 4;
    } else if (c == '\'') {
      fault(i, "a prime must follow an axis");
      return 1;
    } else if (c != 'w' && c != 'b' && c != 't') {
      fault(i, fmt::format("'{}' is not an axis; must be one of X Y Z A B C", c));
      return 1;
    }
    tokens_.push_back({text_.substr(i, length), i});
    return length;
  }

  void check_ends() {
    check_once('w', "workpiece", begin_);
    check_once('b', "bed", end_);
    check_once('t', "tool", end_);
    for (std::size_t n = 0; n < tokens_.size(); ++n) {
      const char c = tokens_[n].text.front();
      if (c == 'w' && n != 0) fault(tokens_[n].at, "w (workpiece) must come first");
      if (c == 't' && n + 1 != tokens_.size()) fault(tokens_[n].at, "t (tool) must come last");
    }
  }

  void check_once(char symbol, std::string_view meaning, std::size_t at_if_missing) {
    int count = 0;
    for (const Token& token : tokens_) {
      if (token.text.front() == symbol && ++count == 2) {
        fault(token.at, fmt::format("{} ({}) appears twice", symbol, meaning));
      }
    }
    if (count == 0) fault(at_if_missing, fmt::format("{} ({}) is missing", symbol, meaning));
  }

  void check_spindle() {
    for (std::size_t n = 0; n < tokens_.size(); ++n) {
      if (!tokens_[n].is_spindle()) continue;
      const bool before_tool = n + 1 < tokens_.size() && tokens_[n + 1].text == "t";
      if (!before_tool) {
        fault(tokens_[n].at,
              fmt::format("spindle {} must come directly before t", tokens_[n].text));
      }
    }
  }

  Structure read_axes() {
    Structure structure;
    Side side = Side::workpiece;
    int rotary = 0;
    for (const Token& token : tokens_) {
      if (token.text == "b") side = Side::tool;
      if (token.is_spindle()) structure.spindle = token.axis();
      if (!token.is_axis()) continue;
      const Axis axis = token.axis();
      if (token.is_primed() && side == Side::tool) {
        fault(token.at, fmt::format("{} has a prime but is on the tool side of b", token.text));
      }
      const auto same = [axis](const StructureAxis& a) { return a.axis == axis; };
      if (std::any_of(structure.axes.begin(), structure.axes.end(), same)) {
        fault(token.at, fmt::format("axis {} appears twice", letter(axis)));
        continue;
      }
      if (!is_linear(axis) && ++rotary == kRotaryJoints + 1) {
        fault(token.at, fmt::format("{} is rotary axis number {}; at most {} are allowed",
                                    letter(axis), rotary, kRotaryJoints));
      }
      structure.axes.push_back({axis, side});
    }
    return structure;
  }

  std::string_view text_;
  Place origin_;
  std::size_t begin_ = 0, end_ = 0;  // of what stands between the brackets
  std::vector<Token> tokens_;
  std::vector<Fault> faults_;
};

}  // namespace

JointLayout Structure::layout() const {
  JointLayout layout;
  const auto has = [this](Axis axis) {
    return std::any_of(axes.begin(), axes.end(),
                       [axis](const StructureAxis& a) { return a.axis == axis; });
  };
  std::size_t rotary = kLinearJoints;
  for (const Axis axis : kAllAxes) {
    if (!has(axis)) continue;
    layout.axis[is_linear(axis) ? static_cast<std::size_t>(index_of(axis)) : rotary++] = axis;
  }
  return layout;
}

Structure parse_structure(std::string_view text, const Place& at) {
  return Parser(text, at).parse();
}

std::string to_string(const Structure& structure) {
  std::string text = "[w";
  Side side = Side::workpiece;
  for (const StructureAxis& a : structure.axes) {
    if (a.side != side) text += " b";
    side = a.side;
    text += fmt::format(" {}{}", letter(a.axis), side == Side::workpiece ? "'" : "");
  }
  if (side == Side::workpiece) text += " b";
  if (structure.spindle) text += fmt::format(" ({}1)", letter(*structure.spindle));
  return text + " t]";
}

}  // namespace servomill::plant
