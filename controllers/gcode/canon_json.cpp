#include "controllers/gcode/canon_json.h"

#include <fmt/format.h>

#include <iterator>
#include <string_view>

#include "controllers/gcode/modal_state.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

std::string number(double x) {
  std::string text = fmt::format("{:.9f}", x);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

std::string array(std::initializer_list<double> values) {
  std::string text;
  for (const double x : values) text += fmt::format("{}{}", text.empty() ? "" : ",", number(x));
  return fmt::format("[{}]", text);
}

std::string words(const AxisWords& w) {
  return array({w[0] / mm, w[1] / mm, w[2] / mm, w[3] / deg, w[4] / deg, w[5] / deg});
}

std::string quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (byte < 0x20 || byte >= 0x7f) {
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
      return "feed";
    case MoveKind::arc:
      return "arc";
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

std::string feed_fields(const Move& move) {
  const bool moves_xyz = move.kind == MoveKind::arc || move.s_end > move.s_begin;
  return fmt::format(R"(,"feed":{},"fmode":"{}")",
                     number(move.feed / (moves_xyz ? mm_per_min : deg_per_min)),
                     move.feed_mode == FeedMode::inverse_time ? "inv" : "upm");
}

std::string arc_fields(const Move& move) {
  static constexpr std::string_view kPlanes[] = {"YZ", "XZ", "XY"};
  const int n = move.arc.normal_axis;
  const Eigen::Vector3d& c = move.arc.centre;
  const Eigen::Vector3d& m = move.centre_machine;
  return fmt::format(R"(,"plane":"{}","center":{},"mcenter":{},"turns":{})",
                     kPlanes[static_cast<std::size_t>(n)],
                     array({c[(n + 1) % 3] / mm, c[(n + 2) % 3] / mm}),
                     array({m[0] / mm, m[1] / mm, m[2] / mm}), move.arc.turns);
}

// What X Y Z of "mend" are: nothing is said if they are positions of the axes.
std::string control_fields(const Move& move) {
  const Eigen::Vector3d& k = move.tool_axis;
  switch (move.tool_control) {
    case ToolControl::none:
      return {};
    case ToolControl::rotary_axes:
      return R"(,"control":"G43.4")";
    case ToolControl::tool_axis:
      return fmt::format(R"(,"control":"G43.5","axis":{})", array({k.x(), k.y(), k.z()}));
    case ToolControl::work_plane:
      return R"(,"control":"G68.2")";
  }
  return {};
}

std::string own_fields(const Move& move) {
  switch (move.kind) {
    case MoveKind::rapid:
    case MoveKind::end:
      return {};
    case MoveKind::feed:
      return feed_fields(move);
    case MoveKind::arc:
      return feed_fields(move) + arc_fields(move);
    case MoveKind::dwell:
      return fmt::format(R"(,"sec":{})", number(move.value));
    case MoveKind::tool:
      return fmt::format(R"(,"n":{})", move.number);
    case MoveKind::spindle:
      return fmt::format(R"(,"dir":{},"rpm":{})", move.direction, number(move.value / rpm));
    case MoveKind::coolant:
      return fmt::format(R"(,"mist":{},"flood":{})", (move.number & kMist) != 0,
                         (move.number & kFlood) != 0);
    case MoveKind::stop:
      return fmt::format(R"(,"kind":"{}")",
                         move.number == 0 ? "PROGRAM_STOP" : "OPTIONAL_PROGRAM_STOP");
    case MoveKind::message:
      return fmt::format(R"(,"text":{})", quoted(collapsed_blanks(move.text)));
  }
  return {};
}

}  // namespace

std::string canon_json(const Move& move) {
  std::string text = fmt::format(R"({{"t":"{}","line":{})", kind_name(move), move.line);
  if (is_motion(move.kind)) {
    text += fmt::format(R"(,"end":{},"mend":{})", words(move.end), words(move.end_machine));
    text += control_fields(move);
  }
  return text + own_fields(move) + '}';
}

std::string canon_error_json(const std::string& message) {
  return fmt::format(R"({{"t":"error","msg":{}}})", quoted(message));
}

}  // namespace servomill::controllers
