#include "controllers/gcode/canon_json.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <string_view>

#include "controllers/gcode/modal_state.h"
#include "plant/vocabulary/spline_curve.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

constexpr int kDecimals = 9;
constexpr double kPerUnit = 1e9;
constexpr double kExactBelow = 9e15;  // integers up to here are exact

// Fixed point with up to nine decimals, zeros at the end left out.
void add_number(double x, std::string& out) {
  const double scaled = std::round(x * kPerUnit);
  if (!(std::abs(scaled) < kExactBelow)) {
    if (std::isnan(x)) {  // Z with a tool of unknown length
      out += "null";
      return;
    }
    std::string text = fmt::format("{:.9f}", x);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
    out += text;
    return;
  }
  auto left = static_cast<std::uint64_t>(std::abs(scaled));
  char digits[24];
  char* const end = digits + sizeof digits;
  char* at = end;
  const auto take_digit = [&] {
    *--at = static_cast<char>('0' + left % 10);
    left /= 10;
  };
  auto fraction = static_cast<std::uint32_t>(left % 1'000'000'000);
  left /= 1'000'000'000;
  if (fraction != 0) {
    int decimals = kDecimals;
    for (; fraction % 10 == 0; fraction /= 10) --decimals;
    for (; decimals > 0; --decimals, fraction /= 10) {
      *--at = static_cast<char>('0' + fraction % 10);
    }
    *--at = '.';
  }
  do {
    take_digit();
  } while (left != 0);
  if (scaled < 0.0) *--at = '-';
  out.append(at, end);
}

void add_array(std::initializer_list<double> values, std::string& out) {
  char before = '[';
  for (const double x : values) {
    out += before;
    add_number(x, out);
    before = ',';
  }
  out += ']';
}

void add_words(const AxisWords& w, std::string& out) {
  add_array({w[0] / mm, w[1] / mm, w[2] / mm, w[3] / deg, w[4] / deg, w[5] / deg}, out);
}

std::string quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (byte < 0x20 || byte == 0x7f) {
      out += fmt::format("\\u{:04x}", byte);
    } else {
      out += c;
    }
  }
  return out + '"';
}

std::string collapsed_blanks(std::string_view text) {
  std::string out;
  bool gap = false;
  for (const char c : text) {
    const bool blank = c == ' ' || c == '\t';
    if (!blank && gap && !out.empty()) out += ' ';
    gap = blank;
    if (!blank) out += c;
  }
  return out;
}

std::string_view kind_name(const Move& move) {
  switch (move.kind) {
    case MoveKind::rapid:
      return "rapid";
    case MoveKind::feed:
      return move.synchronised == Synchronised::tap_in ? "tap"
             : move.number == 0                        ? "feed"
                                                       : "probe";
    case MoveKind::arc:
      return "arc";
    case MoveKind::spline:
      return "nurbs";
    case MoveKind::dwell:
      return "dwell";
    case MoveKind::tool:
      return "tool";
    case MoveKind::spindle:
      return "spindle";
    case MoveKind::coolant:
      return "coolant";
    case MoveKind::stop:
      return "stop";
    case MoveKind::end:
      return "end";
    case MoveKind::message:
      return move.number == kPrintMessage ? "print" : "msg";
  }
  return "";
}

void add_feed(const Move& move, std::string& out) {
  const bool is_curve = move.kind == MoveKind::arc || move.kind == MoveKind::spline;
  const bool moves_xyz = is_curve || move.s_end > move.s_begin;
  const bool per_revolution = move.feed_mode == FeedMode::units_per_revolution;
  out += R"(,"feed":)";
  add_number(per_revolution ? move.value / (moves_xyz ? mm : deg)
                            : move.feed / (moves_xyz ? mm_per_min : deg_per_min),
             out);
  out += per_revolution                             ? R"(,"fmode":"upr")"
         : move.feed_mode == FeedMode::inverse_time ? R"(,"fmode":"inv")"
                                                    : R"(,"fmode":"upm")";
}

void add_arc(const Move& move, std::string& out) {
  static constexpr std::string_view kPlanes[] = {"YZ", "XZ", "XY"};
  const int n = move.arc.normal_axis;
  const Eigen::Vector3d& c = move.arc.centre;
  const Eigen::Vector3d& m = move.centre_machine;
  out += R"(,"plane":")";
  out += kPlanes[static_cast<std::size_t>(n)];
  out += R"(","center":)";
  add_array({c[(n + 1) % 3] / mm, c[(n + 2) % 3] / mm}, out);
  out += R"(,"mcenter":)";
  add_array({m[0] / mm, m[1] / mm, m[2] / mm}, out);
  fmt::format_to(std::back_inserter(out), R"(,"turns":{})", move.arc.turns);
}

void add_spline(const Spline& spline, std::string& out) {
  const auto add = [&](std::string_view name, auto&& value) {
    fmt::format_to(std::back_inserter(out), R"(,"{}":)", name);
    for (std::size_t i = 0; i < spline.points.size(); ++i) {
      out += i == 0 ? '[' : ',';
      add_number(value(i), out);
    }
    out += ']';
  };
  fmt::format_to(std::back_inserter(out), R"(,"npts":{},"order":{})", spline.points.size(),
                 spline.curve.order());
  add("x", [&](std::size_t i) { return spline.points[i].x() / mm; });
  add("y", [&](std::size_t i) { return spline.points[i].y() / mm; });
  add("weights", [&](std::size_t i) { return spline.curve.weights()[i]; });
}

// Coordinates of X Y Z in "mend"; left out where they are positions of the axes.
void add_control(const Move& move, std::string& out) {
  const Eigen::Vector3d& k = move.tool_axis;
  switch (move.tool_control) {
    case ToolControl::none:
      return;
    case ToolControl::rotary_axes:
      out += R"(,"control":"G43.4")";
      return;
    case ToolControl::tool_axis:
      out += R"(,"control":"G43.5","axis":)";
      return add_array({k.x(), k.y(), k.z()}, out);
    case ToolControl::work_plane:
      out += R"(,"control":"G68.2")";
      return;
  }
}

void add_own_fields(const Move& move, std::string& out) {
  const auto end = std::back_inserter(out);
  switch (move.kind) {
    case MoveKind::rapid:
    case MoveKind::end:
      return;
    case MoveKind::feed:
      if (move.synchronised == Synchronised::no) return add_feed(move, out);
      out += R"(,"sync":)";
      return add_number(move.value / mm, out);
    case MoveKind::arc:
      add_feed(move, out);
      return add_arc(move, out);
    case MoveKind::spline:
      add_feed(move, out);
      return add_spline(*move.spline, out);
    case MoveKind::dwell:
      out += R"(,"sec":)";
      return add_number(move.value, out);
    case MoveKind::tool:
      fmt::format_to(end, R"(,"n":{})", move.number);
      return;
    case MoveKind::spindle:
      fmt::format_to(end, R"(,"dir":{},"rpm":)", move.direction);
      return add_number(move.value / rpm, out);
    case MoveKind::coolant:
      fmt::format_to(end, R"(,"mist":{},"flood":{})", (move.number & kMist) != 0,
                     (move.number & kFlood) != 0);
      return;
    case MoveKind::stop:
      out += move.number == 1 ? R"(,"kind":"OPTIONAL_PROGRAM_STOP")" : R"(,"kind":"PROGRAM_STOP")";
      return;
    case MoveKind::message:
      fmt::format_to(end, R"(,"text":{})", quoted(collapsed_blanks(move.text)));
      return;
  }
}

}  // namespace

void add_canon_json(const Move& move, std::string& out) {
  out += R"({"t":")";
  out += kind_name(move);
  out += R"(","line":)";
  out += fmt::format_int(move.line).c_str();
  if (is_motion(move.kind)) {
    out += R"(,"end":)";
    add_words(move.end, out);
    out += R"(,"mend":)";
    add_words(move.end_machine, out);
    add_control(move, out);
  }
  add_own_fields(move, out);
  out += '}';
}

std::string canon_json(const Move& move) {
  std::string text;
  add_canon_json(move, text);
  return text;
}

std::string canon_error_json(const std::string& message) {
  return fmt::format(R"({{"t":"error","msg":{}}})", quoted(message));
}

}  // namespace servomill::controllers
