// Cycles and functions of the control, by name; patterns of holes.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "controllers/siemens/translator.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::siemens {
namespace {

// Cycles whose path is internal to the control.
constexpr auto kInternal = std::to_array<std::string_view>(
    {"POCKET1", "POCKET2", "POCKET3",  "POCKET4", "SLOT1",    "SLOT2",   "LONGHOLE",
     "CYCLE60", "CYCLE61", "CYCLE62",  "CYCLE63", "CYCLE64",  "CYCLE70", "CYCLE71",
     "CYCLE72", "CYCLE73", "CYCLE74",  "CYCLE75", "CYCLE76",  "CYCLE77", "CYCLE78",
     "CYCLE79", "CYCLE90", "CYCLE899", "CYCLE99", "CYCLE801", "CYCLE802"});

// Cycles that measure: their results are unknown.
bool is_measuring(std::string_view name) {
  constexpr std::string_view kFront = "CYCLE9";
  return (name.starts_with(kFront) && name.size() == 8) || name == "CYCLE114" ||
         name == "CYCLE116" || name == "CYCLE119" || name == "CYCLE150";
}

}  // namespace

bool Translator::is_cycle(std::string_view name) {
  constexpr std::array<std::string_view, 5> kFronts = {"CYCLE", "HOLES", "POCKET", "SLOT",
                                                       "LONGHOLE"};
  return std::any_of(kFronts.begin(), kFronts.end(),
                     [&](std::string_view front) { return name.starts_with(front); });
}

bool Translator::run_cycle(const Call& call) {
  if (run_drilling_cycle(call)) return true;
  if (call.name == "CYCLE832") {
    smoothing(call);
  } else if (call.name == "HOLES1" || call.name == "HOLES2") {
    pattern(call);
  } else if (call.name == "CYCLE800") {
    swivel(call);
  } else if (call.name == "CYCLE80") {
    modal_call_.reset();
  } else {
    return refuse_cycle(call);
  }
  return true;
}

// A survey continues after a cycle that it cannot follow: positions are unknown.
bool Translator::refuse_cycle(const Call& call) {
  const bool is_internal =
      std::find(kInternal.begin(), kInternal.end(), call.name) != kInternal.end();
  if (!is_internal && !is_measuring(call.name)) return false;
  const std::string why =
      is_internal ? "the path is internal to the control; have the CAM system output the moves"
                  : "measuring cycles are not supported: the measured values are unknown";
  if (!setup_.accepts_unknown_positions) {
    fail(call.place, fmt::format("{}: {}", call.name, why));
  }
  require_no_compensation(call.name);
  warn_once(call.name,
            fmt::format("{}: {}; extent and cycle time exclude its moves", call.name, why));
  path_.note({"G91 G30 X0 Y0 Z0", place_, {false, false, call.name}});
  note("G90");
  forget_linear_positions();
  return true;
}

// CYCLE832(tolerance, kind): kind 0 deselects it. [C] "High Speed Settings"
void Translator::smoothing(const Call& call) {
  const double tolerance = value_of(call, 0, 0.0, "the tolerance") * unit();
  if (tolerance < 0.0) fail(call.place, "CYCLE832: the tolerance must be >= 0");
  const bool is_off =
      call.arguments.size() > 1 && std::fmod(value_of(call, 1, 0.0, "the type"), 10.0) == 0.0;
  tolerance_line_ = tolerance > 0.0 && !is_off ? "G64 " + word('P', tolerance) : "G64";
  use_path(false);
}

// HOLES1(SPCA, SPCO, STA1, FDIS, DBH, NUM): on a line, from its nearer end. HOLES2(CPA, CPO, RAD,
// STA1, INDA, NUM): on a circle, all around where INDA is 0. [C] "Row of holes", "Circle of holes"
std::vector<Point> Translator::points_of(const Call& call) const {
  constexpr double kMax = 10000.0;
  const bool is_row = call.name == "HOLES1";
  const double NUM = value_of(call, 5, {}, "NUM");
  if (!(NUM >= 1.0 && NUM <= kMax) || NUM != std::floor(NUM)) {
    fail(call.place, fmt::format("{}: NUM must be an integer from 1 to {}", call.name, kMax));
  }
  const auto length = [&](std::size_t at, std::optional<double> otherwise, std::string_view name) {
    return value_of(call, at, otherwise, name) * unit();
  };
  const Point origin(length(0, {}, is_row ? "SPCA" : "CPA"),
                     length(1, {}, is_row ? "SPCO" : "CPO"));
  const double STA1 = value_of(call, is_row ? 2 : 3, 0.0, "STA1");
  const auto ray = [](double angle) { return Point(std::cos(angle * deg), std::sin(angle * deg)); };
  std::vector<Point> out;
  for (int i = 0; i < static_cast<int>(NUM); ++i) {
    if (is_row) {
      const double way = length(3, 0.0, "FDIS") +
                         i * length(4, NUM > 1.0 ? std::nullopt : std::optional(0.0), "DBH");
      out.push_back(origin + way * ray(STA1));
    } else {
      const double INDA = value_of(call, 4, 0.0, "INDA");
      const double step = INDA != 0.0 ? INDA : 360.0 / NUM;
      out.push_back(origin + length(2, {}, "RAD") * ray(STA1 + i * step));
    }
  }
  return out;
}

void Translator::pattern(const Call& call) {
  require_no_compensation(call.name);
  refuse_pattern_options(call);
  std::vector<Point> points = points_of(call);
  const auto now = program_point(modes_.normal);
  const bool is_row = call.name == "HOLES1";
  if (is_row && now && (points.back() - *now).norm() < (points.front() - *now).norm()) {
    std::reverse(points.begin(), points.end());
  }
  if (modal_call_ && find_program(modal_call_->name) != nullptr) {
    fail(call.place,
         fmt::format(
             "{} with a modal subprogram call (MCALL) is not supported; program the positions",
             call.name));
  }
  const auto axes = plane_axes(modes_.normal);
  for (const Point& point : points) {
    std::array<std::optional<double>, 3> to{};
    to[axes[0]] = point.x();
    to[axes[1]] = point.y();
    cycle_move({}, to);
    if (modal_call_) this->call(*modal_call_, 1);
  }
}

}  // namespace servomill::controllers::siemens
