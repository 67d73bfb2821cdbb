#include "sim/programs/compensate/iso_dialect.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controllers/gcode/number_text.h"

namespace servomill::sim::programs {

using controllers::fixed_text;

void add_word(std::string& line, std::string_view word) {
  if (word.empty()) return;
  if (!line.empty()) line += ' ';
  line += word;
}

void IsoDialect::spindle(int direction, double rpm, bool is_named) {
  std::string text;
  const std::string S = speed(rpm);
  if (modes_.S != S && (direction != 0 || rpm > 0.0)) {
    add_word(text, "S" + S);
    modes_.S = S;
  }
  if (is_named || modes_.direction != direction) {
    add_word(text, direction > 0 ? "M3" : direction < 0 ? "M4" : "M5");
  }
  modes_.direction = direction;
  if (!text.empty()) put(text);
}

void IsoDialect::stop(int code) {
  put("M" + std::to_string(code));
  // some builders stop the spindle, too
  if (modes_.direction != 0) modes_.direction.reset();
}

void IsoDialect::forget_modes() {
  modes_ = {};
  modes_.feed_mode.reset();
  modes_.length.reset();
}

void IsoDialect::Modes::join(const Modes& before) {
  const auto keep = [](auto& now, const auto& then) {
    if (now != then) now.reset();
  };
  keep(code, before.code);
  keep(F, before.F);
  keep(S, before.S);
  keep(feed_mode, before.feed_mode);
  keep(direction, before.direction);
  keep(work_system, before.work_system);
  keep(length, before.length);
}

void IsoDialect::begin_optional() {
  before_optional_ = modes_;
  first_optional_ = lines_.size();
}

// Comments stay as they are.
void IsoDialect::end_optional() {
  for (std::size_t i = first_optional_; i < lines_.size(); ++i) {
    const char first = lines_[i].front();
    if (first != '(' && first != ';' && first != '/') lines_[i].insert(0, "/");
  }
  modes_.join(before_optional_);
}

std::string IsoDialect::numbered(const std::string& line, const std::string& number) {
  const bool is_optional = line.front() == '/';
  return fmt::format("{}{} {}\n", is_optional ? "/" : "", number, line.substr(is_optional ? 1 : 0));
}

void IsoDialect::add_feed_mode(const DialectMotion& motion, std::string& text) {
  if (motion.is_rapid || modes_.feed_mode == motion.feed_mode) return;
  const auto mode = motion.feed_mode;
  add_word(text, mode == FeedMode::inverse_time       ? "G93"
                 : mode == FeedMode::units_per_minute ? "G94"
                                                      : "G95");
  modes_.feed_mode = mode;
  modes_.F.reset();
}

std::string IsoDialect::position_word(Axis axis, double value) {
  return letter(axis) + number(fixed_text(value, decimals(axis)));
}

std::string IsoDialect::arc_code(const DialectArc& arc) const {
  return arc.is_counter_clockwise ? "G3" : "G2";
}

std::string IsoDialect::arc_words(const DialectArc& arc) const {
  std::string text;
  for (int i = 0; i < 3; ++i) {
    if (i == arc.path.c) continue;
    add_word(text, "IJK"[i] + number(fixed_text(arc.from_begin[i], decimals(Axis::X))));
  }
  return text;
}

std::string IsoDialect::motion_text(const DialectMotion& motion, std::string_view prefix) {
  std::string text(prefix);
  add_feed_mode(motion, text);
  const std::string code = motion.is_rapid ? "G0" : motion.arc ? arc_code(*motion.arc) : "G1";
  if (modes_.code != code) add_word(text, code);
  modes_.code = code;
  for (const auto& [axis, value] : motion.words) {
    add_word(text, position_word(axis, value));
  }
  if (motion.arc) add_word(text, arc_words(*motion.arc));
  if (!motion.is_rapid) {
    const bool is_per_revolution = motion.feed_mode == FeedMode::units_per_revolution;
    const bool is_by_time = motion.feed_mode == FeedMode::inverse_time;
    const bool is_finer = is_per_revolution || (is_inch_ && !is_by_time);
    // a number has at most eight digits (B-63844EN/02, appendix of command ranges; M)
    const int whole = std::max(1, static_cast<int>(std::floor(std::log10(motion.feed))) + 1);
    const int digits = std::clamp(8 - whole, 0, feed_decimals() + (is_finer ? 1 : 0));
    const std::string F = number(rate(motion.feed, digits, "F"));
    if (modes_.F != F || motion.feed_mode == FeedMode::inverse_time) add_word(text, "F" + F);
    modes_.F = F;
  }
  return text;
}

}  // namespace servomill::sim::programs
