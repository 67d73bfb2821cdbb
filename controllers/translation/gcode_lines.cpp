#include "controllers/translation/gcode_lines.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <numbers>
#include <utility>

namespace servomill::controllers::translation {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

int started_turns(double sweep) {
  constexpr double kRounding = 1e-9;
  return std::max(1, static_cast<int>(std::ceil(std::abs(sweep) / kTurn - kRounding)));
}

std::string feed_word(const Feed& feed) {
  if (feed.kind == Feed::Kind::rapid) return {};
  if (feed.kind == Feed::Kind::unknown) return " F1";
  const double value = feed.kind == Feed::Kind::time ? 60.0 / feed.value : feed.value;
  return " " + word('F', value);
}

}  // namespace

std::string word(char letter, double value) {
  constexpr int kDecimals = 9;
  std::array<char, 400> buffer;  // the longest number has 309 digits before the point
  buffer[0] = letter;
  char* const begin = buffer.data() + 1;
  char* end = std::to_chars(begin, buffer.data() + buffer.size(), value, std::chars_format::fixed,
                            kDecimals)
                  .ptr;
  while (end[-1] == '0') --end;
  if (end[-1] == '.') --end;
  if (std::string_view(begin, end) == "-0") return {letter, '0'};
  return {buffer.data(), end};
}

GcodeLine GcodeLines::take() {
  GcodeLine line = std::move(lines_.front());
  lines_.pop_front();
  return line;
}

void GcodeLines::put_plane(int normal, const Place& place) {
  if (std::exchange(normal_, normal) == normal) return;
  put(normal == 2 ? "G17" : normal == 1 ? "G18" : "G19", place);
}

void GcodeLines::put(const Motion& motion) {
  const bool is_arc = motion.element && motion.element->is_arc;
  std::string text = motion.feed.kind == Feed::Kind::time ? "G93 " : "";
  if (motion.is_machine) text += "G53 ";
  if (is_arc) {
    put_plane(motion.normal, motion.place);
    text += motion.element->sweep > 0.0 ? "G3" : "G2";
  } else {
    text += motion.feed.kind == Feed::Kind::rapid ? "G0" : "G1";
  }
  for (std::size_t i = 0; i < motion.words.size(); ++i) {
    if (motion.words[i]) text += " " + word(letter(kAllAxes[i]), *motion.words[i]);
  }
  if (is_arc) {
    const Element& arc = *motion.element;
    const auto axes = plane_axes(motion.normal);
    const Point centre = arc.centre - arc.begin;
    text += " " + word("IJK"[axes[0]], centre.x()) + " " + word("IJK"[axes[1]], centre.y());
    const int turns = started_turns(arc.sweep);
    if (turns > 1) text += fmt::format(" P{}", turns);
  }
  text += feed_word(motion.feed);
  if (motion.is_incremental) put("G91", motion.place);
  put({std::move(text), motion.place, {false, motion.feed.kind == Feed::Kind::unknown, {}}});
  if (motion.is_incremental) put("G90", motion.place);
  if (motion.feed.kind == Feed::Kind::time) put("G94", motion.place);
}

}  // namespace servomill::controllers::translation
