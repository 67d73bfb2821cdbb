#include "sim/programs/compensate/dialect.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "controllers/gcode/number_text.h"

namespace servomill::sim::programs {
namespace {

constexpr std::size_t kLongestComment = 100;
constexpr double kInch = 25.4 * mm;

}  // namespace

std::string plain(std::string_view text, bool is_upper) {
  std::string out;
  for (char c : text) {
    if (c == '(') c = '[';
    if (c == ')') c = ']';
    if (c == '"' || c == '%' || static_cast<unsigned char>(c) >= 0x7f) c = '\'';
    if (is_upper && c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
    out += c;
  }
  return out;
}

bool DialectSettings::lacks(std::string_view function) const {
  return std::find(without.begin(), without.end(), function) != without.end();
}

bool DialectMotion::names(Axis axis) const {
  return std::any_of(words.begin(), words.end(),
                     [&](const auto& word) { return word.first == axis; });
}

int DialectPrinter::decimals(Axis axis) const {
  // 1 um goes with 0.0001 inch and 0.001 deg (IS-B), 0.1 um with 0.00001 inch and 0.0001 deg (IS-C)
  const int of_mm = static_cast<int>(std::lround(-std::log10(settings_.resolution / mm)));
  return is_linear(axis) && is_inch_ ? of_mm + 1 : of_mm;
}

double DialectPrinter::unit(Axis axis) const {
  return is_linear(axis) ? (is_inch_ ? kInch : mm) : deg;
}

void DialectPrinter::comment(std::string_view text) {
  while (text.size() > kLongestComment) {
    const std::size_t blank = text.rfind(' ', kLongestComment);
    const bool has_blank = blank != std::string_view::npos && blank > 0;
    const std::size_t cut = has_blank ? blank : kLongestComment;
    put_comment(text.substr(0, cut));
    text.remove_prefix(has_blank ? cut + 1 : cut);
  }
  put_comment(text);
}

void DialectPrinter::begin_smoothing() {
  if (settings_.smoothing > 0.0 && !smooths_) put_smoothing(true);
  smooths_ = settings_.smoothing > 0.0;
}

void DialectPrinter::end_smoothing() {
  if (smooths_) put_smoothing(false);
  smooths_ = false;
}

void DialectPrinter::assume(std::string clause) {
  if (std::find(assumptions_.begin(), assumptions_.end(), clause) == assumptions_.end()) {
    assumptions_.push_back(std::move(clause));
  }
}

void DialectPrinter::warn(std::string sentence) {
  if (std::find(warnings_.begin(), warnings_.end(), sentence) == warnings_.end()) {
    warnings_.push_back(std::move(sentence));
  }
}

std::string DialectPrinter::rate(double x, int decimals, std::string_view name) const {
  std::string text = controllers::fixed_text(x, decimals);
  if (text == "0") {
    throw Unsayable{fmt::format("has {} = {:g}, smaller than the resolution of {} decimals", name,
                                x, decimals)};
  }
  return text;
}

void DialectPrinter::check_positions(const DialectMotion& motion, double most) const {
  for (const auto& [axis, value] : motion.words) {
    if (std::abs(value) <= most) continue;
    throw Unsayable{fmt::format("moves to {}{:g}; at most {} is allowed", letter(axis), value,
                                controllers::fixed_text(most, 4))};
  }
}

std::unique_ptr<DialectPrinter> make_dialect(const DialectSettings& settings,
                                             std::vector<std::string>& lines) {
  switch (settings.dialect) {
    case Dialect::heidenhain:
      return make_heidenhain(settings, lines);
    case Dialect::fanuc:
      return make_fanuc(settings, lines);
    case Dialect::siemens:
      return make_siemens(settings, lines);
    case Dialect::linuxcnc:
      break;
  }
  assert(false);
  return nullptr;
}

}  // namespace servomill::sim::programs
