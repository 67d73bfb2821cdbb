#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "controllers/dialects/planar_arc.h"
#include "controllers/dialects/siemens_frame.h"
#include "controllers/dialects/siemens_state.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

constexpr double kLeastSweep = 1e-3 * deg;  // below, rounding decides between 0 and a full turn
constexpr double kSamePoint = 1.0 * nm;     // a tenth of the last digit that programs have
// Rise of CIP along the normal of a plane of two axes. Taken as linear, it is off by at most 0.11
// of that, the largest of |a / pi - (1 - cos a) / 2|.
constexpr double kMostTilt = 1.0 * um;
constexpr double kCollinear = 1e-9;  // rad, between the chords of CIP

std::size_t at(int axis) { return static_cast<std::size_t>(axis); }
char name_of(int axis) { return letter(kAllAxes[at(axis)]); }
bool is_linear_axis(int axis) { return axis < 3; }

// Modes required by every motion.
void check_modes(const SiemensState& state, const SiemensBlock& block,
                 const SiemensContext& context) {
  const auto fail = [&](int column, std::string message) {
    context.fail(block.line, column, std::move(message));
  };
  if (!state.motion) fail(block.column, "positions without a known G0, G1, G2 or G3");
  if (!state.is_cutter_off) {
    fail(block.column, "the cutter compensation may be on; G40 switches it off");
  }
  for (int a = 3; a < kAxisWords; ++a) {
    const std::optional<SiemensNumber>& word = block.axes[at(a)];
    if (word && !state.is_transformation_off) {
      fail(word->column,
           fmt::format("{}: a transformation may be active; TRAFOOF switches it off", name_of(a)));
    }
  }
}

// One block with positions: program coordinates first, then the machine's.
class Motion {
 public:
  Motion(SiemensState& state, const SiemensBlock& block, const SiemensContext& context)
      : state_(state), block_(block), context_(context), frame_(state, block, context) {}

  MachineAction run() {
    const bool is_arc = *state_.motion >= 2;
    const bool is_through_point = *state_.motion == kThroughPoint;
    if (is_through_point) {
      check_through_words();
    } else if (is_arc) {
      check_arc_words();
    } else {
      check_line_words();
    }
    read_targets();
    complete_rotated_plane();
    if (is_through_point) {
      add_arc_through_point();
    } else if (is_arc) {
      add_arc();
    }
    out_.line = block_.line;
    out_.kind = is_arc                ? ActionKind::arc
                : *state_.motion == 1 ? ActionKind::feed
                                      : ActionKind::rapid;
    finish_positions();
    set_path();
    if (out_.kind != ActionKind::rapid) set_feed();
    return out_;
  }

 private:
  [[noreturn]] void fail(int column, std::string message) const {
    context_.fail(block_.line, column, std::move(message));
  }
  [[noreturn]] void fail(std::string message) const { fail(block_.column, std::move(message)); }

  bool has(int axis) const { return block_.axes[at(axis)].has_value(); }

  void check_line_words() const {
    if (block_.has_centre() || block_.CR || block_.TURN) {
      fail(fmt::format("I, J, K, CR and TURN are for G2 and G3; G{} is in force", *state_.motion));
    }
    refuse_through_point();
  }

  void refuse_through_point() const {
    if (!block_.has_through()) return;
    fail(fmt::format("I1, J1 and K1 are for CIP; G{} is in force", *state_.motion));
  }

  void check_arc_words() {
    if (frame_.is_of_machine()) fail("SUPA with G2 or G3 is not read");
    refuse_through_point();
    if (!state_.normal_axis) fail("the plane of the arc is not known; G17, G18 or G19 sets it");
    out_.normal_axis = *state_.normal_axis;
    u_ = (out_.normal_axis + 1) % 3;
    v_ = (out_.normal_axis + 2) % 3;
    if (!context_.rules.G18_is_ZX && out_.normal_axis == 1) std::swap(u_, v_);
    refuse_rotary_axes();
    const auto& along_normal = block_.centre[at(out_.normal_axis)];
    if (along_normal) {
      fail(along_normal->column,
           fmt::format("{} is not in the plane of the arc", "IJK"[out_.normal_axis]));
    }
    if (block_.CR && block_.has_centre()) fail(block_.CR->column, "CR and a centre in one block");
    if (!block_.CR && !block_.has_centre()) fail("the arc has neither a centre nor CR");
    if (frame_.rotation() != 0.0 && out_.normal_axis != 2) {
      fail("an arc outside the XY plane under a rotated work offset is not read");
    }
    if (context_.rules.length_needs_a_line) refuse_new_length(out_.normal_axis);
  }

  void refuse_rotary_axes() const {
    for (int a = 3; a < kAxisWords; ++a) {
      if (!has(a)) continue;
      fail(block_.axes[at(a)]->column,
           fmt::format("{} in a block with an arc is not read", name_of(a)));
    }
  }

  // [P] p. 198 allows I1, J1 and K1 to be omitted only where their value is 0.
  void check_through_words() const {
    if (frame_.is_of_machine()) fail("SUPA with CIP is not read");
    if (frame_.rotation() != 0.0) fail("CIP under a rotated work offset is not read");
    if (block_.has_centre() || block_.CR || block_.TURN) {
      fail("I, J, K, CR and TURN are for G2 and G3; CIP is in force");
    }
    refuse_rotary_axes();
    for (std::size_t i = 0; i < 3; ++i) {
      if (!block_.through[i]) fail(fmt::format("CIP without {}1", "IJK"[i]));
    }
    if (context_.rules.length_needs_a_line) refuse_new_length(-1);
  }

  // [W1] p. 13: a new tool length acts with the first motion of its axis, which must be a line.
  // @param still  axis that moves only if it is programmed in the block
  void refuse_new_length(int still) const {
    for (int a = 0; a < 3; ++a) {
      if (!has(a) && a == still) continue;
      const double length = frame_.length(a);
      const std::optional<double>& before = state_.length_shift[at(a)];
      if (before ? *before != length : length != 0.0) {
        fail(fmt::format("the tool length changes in {}: it acts with G0 or G1 only", name_of(a)));
      }
    }
  }

  double unit_of(int axis, int column) const {
    if (!is_linear_axis(axis)) return deg;
    if (!state_.units) fail(column, "inch or metric is not known; G710 or G700 sets it");
    return state_.units->length;
  }

  void read_targets() {
    for (int a = 0; a < kAxisWords; ++a) {
      if (!has(a)) continue;
      const SiemensNumber& word = *block_.axes[at(a)];
      const double value = word.value * unit_of(a, word.column);
      is_used_[at(a)] = true;
      target_[a] = is_incremental(word, name_of(a)) ? start_of_increment(a, word.column) + value
                                                    : angle_of(a, word.form, value);
    }
    out_.is_commanded = is_used_;
  }

  // Absolute position of an axis; that of a modulo axis in the turn in which it arrives.
  double angle_of(int a, SiemensForm form, double value) const {
    constexpr double kTurn = 2.0 * std::numbers::pi, kRounding = 1e-9;  // rad
    if (is_linear_axis(a) || !context_.settings.is_modulo[at(a - 3)]) return value;
    const double angle = value - std::floor(value / kTurn) * kTurn;
    const std::optional<double> start = frame_.program(state_.position, a);
    if (!start) return value;  // the count of turns begins here
    const bool is_AC = form == SiemensForm::absolute && context_.rules.AC_is_not_shortest;
    if (context_.settings.G90_is_shortest && !is_AC) {
      return *start + std::remainder(angle - *start, kTurn);
    }
    return std::floor((*start + kRounding) / kTurn) * kTurn + angle;
  }

  bool is_incremental(const SiemensNumber& word, char name) const {
    bool incremental = word.form == SiemensForm::incremental;
    if (word.form == SiemensForm::number) {
      if (!state_.is_incremental) fail(word.column, "G90 or G91 is not known");
      incremental = *state_.is_incremental;
    }
    if (incremental && frame_.is_of_machine()) {
      fail(word.column, fmt::format("{}: SUPA needs absolute positions", name));
    }
    return incremental;
  }

  // SD42440 and SD42442 decide whether an increment carries a new offset along; without a new one
  // nothing depends on them. [K2] p. 1-7
  double start_of_increment(int a, int column) const {
    const std::optional<double> start = frame_.program(state_.position, a);
    if (!start)
      fail(column, fmt::format("an increment from an unknown position of {}", name_of(a)));
    const bool is_same = state_.frame_shift[at(a)] == frame_.offset(a) &&
                         state_.length_shift[at(a)] == frame_.length(a);
    if (!is_same && context_.rules.increment_needs_same_offset) {
      fail(column,
           fmt::format("an increment of {} after a new work offset or tool length: settings "
                       "decide whether it carries that along",
                       name_of(a)));
    }
    return *start;
  }

  // Under a rotated work offset X moves both axes of the machine.
  void complete_rotated_plane() {
    if (frame_.rotation() == 0.0 || !(is_used_[0] || is_used_[1])) return;
    for (const int a : {0, 1}) {
      if (!is_used_[at(a)]) add_start(a);
    }
    out_.is_commanded[0] = out_.is_commanded[1] = true;
  }

  void add_start(int a) {
    const std::optional<double> start = frame_.program(state_.position, a);
    if (!start) fail(fmt::format("the position of {} is not known", name_of(a)));
    target_[a] = *start;
    is_used_[at(a)] = true;
  }

  Eigen::Vector2d arc_start() const {
    const std::optional<double> u = frame_.program(state_.position, u_);
    const std::optional<double> v = frame_.program(state_.position, v_);
    if (!u || !v)
      fail(fmt::format("the arc starts at an unknown position of {}", name_of(u ? v_ : u_)));
    return {*u, *v};
  }

  void add_arc() {
    const Eigen::Vector2d start = arc_start();
    for (const int a : {u_, v_}) {
      if (!is_used_[at(a)]) add_start(a);
      out_.is_commanded[at(a)] = true;
    }
    const Eigen::Vector2d end(target_[u_], target_[v_]);
    const bool is_clockwise = (*state_.motion == 2) == context_.rules.G2_is_clockwise;
    const Eigen::Vector2d centre =
        block_.CR ? centre_of_radius(start, end, is_clockwise) : programmed_centre(start);
    out_.turns = turns_of(start, end, centre, is_clockwise);
    AxisWords machine = AxisWords::Zero();
    machine[u_] = centre[0];
    machine[v_] = centre[1];
    std::array<bool, kAxisWords> plane{};
    plane[at(u_)] = plane[at(v_)] = true;
    frame_.to_machine(machine, plane);
    out_.centre = machine.head<3>();
  }

  Eigen::Vector3d through_point(const Eigen::Vector3d& start) const {
    Eigen::Vector3d out;
    for (int i = 0; i < 3; ++i) {
      const SiemensNumber& word = *block_.through[at(i)];
      const bool counts_from_start =
          is_incremental(word, "IJK"[i]) || !context_.rules.CIP_point_is_absolute;
      out[i] = (counts_from_start ? start[i] : 0.0) + word.value * unit_of(i, word.column);
    }
    return out;
  }

  // The circle through three points, where its plane is that of two axes.
  void add_arc_through_point() {
    Eigen::Vector3d start, end;
    for (int a = 0; a < 3; ++a) {
      const std::optional<double> known = frame_.program(state_.position, a);
      if (!known) fail(fmt::format("the arc starts at an unknown position of {}", name_of(a)));
      start[a] = *known;
      if (!is_used_[at(a)]) add_start(a);
      end[a] = target_[a];
    }
    const Eigen::Vector3d through = through_point(start);
    const Eigen::Vector3d p = through - start, q = end - start, normal = p.cross(q);
    if (q.norm() < kSamePoint) fail("CIP with equal start and end: the circle is not determined");
    if (normal.norm() < kCollinear * p.norm() * q.norm()) {
      fail("the three points of CIP are on a line");
    }
    normal.cwiseAbs().maxCoeff(&out_.normal_axis);
    u_ = (out_.normal_axis + 1) % 3;
    v_ = (out_.normal_axis + 2) % 3;
    if (std::max(std::abs(p[out_.normal_axis]), std::abs(q[out_.normal_axis])) >
        kMostTilt + 1e-12) {
      fail("CIP in a plane that is not that of two axes is not read");
    }
    const Eigen::Vector3d centre =
        start + (p.squaredNorm() * q.cross(normal) + q.squaredNorm() * normal.cross(p)) /
                    (2.0 * normal.squaredNorm());
    const bool is_positive = normal[out_.normal_axis] > 0.0;
    out_.turns = is_positive == context_.rules.CIP_passes_its_point ? 1 : -1;
    out_.is_commanded[at(u_)] = out_.is_commanded[at(v_)] = true;
    AxisWords machine = AxisWords::Zero();
    machine.head<3>() = centre;
    frame_.to_machine(machine, {true, true, true, false, false, false});
    out_.centre = machine.head<3>();
  }

  Eigen::Vector2d programmed_centre(const Eigen::Vector2d& start) const {
    Eigen::Vector2d centre = start;
    for (int i = 0; i < 2; ++i) {
      const std::optional<SiemensNumber>& word = block_.centre[at(i == 0 ? u_ : v_)];
      if (!word) continue;
      const double value = word->value * unit_of(u_, word->column);
      const bool is_relative =
          word->form != SiemensForm::absolute && context_.rules.centre_counts_from_start;
      centre[i] = is_relative ? start[i] + value : value;
    }
    return centre;
  }

  Eigen::Vector2d centre_of_radius(const Eigen::Vector2d& start, const Eigen::Vector2d& end,
                                   bool is_clockwise) const {
    const double r = block_.CR->value * unit_of(u_, block_.CR->column);
    const Eigen::Vector2d chord = end - start;
    const double d = chord.norm();
    if (d < kSamePoint)
      fail(block_.CR->column, "CR with equal start and end: the circle is not determined");
    if (std::abs(r) < 0.5 * d - kMaxRadiusDifference) {
      fail(block_.CR->column,
           fmt::format("CR = {}: start and end are {:.6g} mm apart", block_.CR->value, d / mm));
    }
    const double h = std::sqrt(std::max(0.0, r * r - 0.25 * d * d));
    const bool is_long = (r < 0.0) == context_.rules.negative_CR_is_long;
    const double side = is_clockwise != is_long ? -1.0 : 1.0;
    return 0.5 * (start + end) + side * h / d * Eigen::Vector2d(-chord[1], chord[0]);
  }

  Eigen::Vector3d in_space(const Eigen::Vector2d& point) const {
    Eigen::Vector3d out = Eigen::Vector3d::Zero();
    out[u_] = point[0];
    out[v_] = point[1];
    return out;
  }

  int turns_of(const Eigen::Vector2d& start, const Eigen::Vector2d& end,
               const Eigen::Vector2d& centre, bool is_clockwise) const {
    const Eigen::Vector2d from = start - centre, to = end - centre;
    if (const auto fault =
            arc_fault(in_space(start), in_space(end), in_space(centre), 3 - u_ - v_)) {
      fail(*fault);
    }
    int added = block_.TURN ? static_cast<int>(block_.TURN->value) : 0;
    if (!context_.rules.TURN_adds_turns && added > 0) --added;
    const double angle = std::atan2(from[0] * to[1] - from[1] * to[0], from.dot(to));
    const bool is_full = (end - start).norm() < kSamePoint;
    if (!is_full && std::abs(angle) < kLeastSweep) {
      fail("start and end of the arc nearly meet: rounding decides between none and a full circle");
    }
    if (is_full && !context_.rules.equal_ends_are_full_circle) --added;
    return is_clockwise ? -1 - added : 1 + added;
  }

  void finish_positions() {
    const bool keeps_length = context_.rules.D_acts_in_its_block || !block_.D;
    frame_.to_machine(target_, is_used_);
    for (int a = 0; a < kAxisWords; ++a) {
      if (!is_used_[at(a)]) continue;
      const double old_length = state_.length_shift[at(a)].value_or(0.0);
      const double length = frame_.length(a);
      if (!keeps_length) target_[a] += old_length - length;
      const std::optional<double> before = state_.position[at(a)];
      moves_[at(a)] = !before || *before != target_[a] || out_.turns > 1 || out_.turns < -1;
      state_.position[at(a)] = target_[a];
      state_.frame_shift[at(a)] = frame_.offset(a);
      state_.length_shift[at(a)] = length;
    }
    out_.end = state_.position;
    out_.is_machine_position = frame_.is_of_machine();
    out_.tool = state_.tool.value_or(0);
    const std::optional<int> length_axis = frame_.axis_of_any_length();
    if (length_axis && is_used_[at(*length_axis)]) {
      state_.tool_of_length = frame_.length_is_in_force() ? out_.tool : 0;
    }
    out_.tool_offset = state_.tool_of_length;
  }

  void set_path() {
    const bool is_exact = block_.has(SiemensGroup::exact_stop) || state_.path == 60;
    out_.is_path_mode_known = is_exact || state_.path.has_value();
    out_.path_mode = is_exact ? PathMode::exact_stop : PathMode::continuous;
    if (!is_exact && state_.path) out_.path_tolerance = tolerance(*state_.path);
    // [P] p. 181: without RTLION each axis runs at its own rate, but only with exact stop.
    const bool is_continuous = out_.is_path_mode_known && !is_exact;
    const auto axes = std::count(out_.is_commanded.begin(), out_.is_commanded.end(), true);
    if (out_.kind == ActionKind::rapid && context_.rules.G60_rapid_may_bend) {
      out_.is_straight = axes <= 1 || is_continuous || state_.is_rapid_linear == true;
    }
  }

  std::optional<double> tolerance(int path) const {
    if (path == 832) return state_.smoothing;
    if (path == 64) return std::nullopt;
    return (path == 641) == context_.rules.ADIS_is_of_G641 ? state_.ADIS : state_.CTOL;
  }

  void set_feed() {
    if (!state_.feed_mode) fail("G93, G94 or G95 is not known");
    if (!state_.F) fail("no feed is programmed since G93, G94 or G95");
    out_.feed_mode = *state_.feed_mode;
    if (out_.feed_mode == FeedMode::inverse_time) {
      out_.feed = *state_.F / minute;
      return;
    }
    const bool is_arc = out_.kind == ActionKind::arc;
    const bool moves_linear =
        is_arc || std::any_of(moves_.begin(), moves_.begin() + 3, [](bool b) { return b; });
    const bool moves_rotary =
        std::any_of(moves_.begin() + 3, moves_.end(), [](bool b) { return b; });
    if (moves_linear && moves_rotary) {
      fail(
          "linear and rotary axes together: settings decide which of them F counts; G93 does not "
          "depend on them");
    }
    const bool has_linear =
        std::any_of(is_used_.begin(), is_used_.begin() + 3, [](bool b) { return b; });
    const bool is_angle = moves_rotary || !has_linear;
    const double per = out_.feed_mode == FeedMode::units_per_minute ? minute : 1.0;
    out_.feed = *state_.F * (is_angle ? deg : unit_of_feed()) / per;
  }

  double unit_of_feed() const {
    if (!state_.units) fail("inch or metric is not known; G710 or G700 sets it");
    if (!state_.units->is_of_feed && context_.rules.G71_leaves_F) {
      fail("F counts in the basic unit of the control with G70 and G71; G700 and G710 set it");
    }
    return state_.units->length;
  }

  SiemensState& state_;
  const SiemensBlock& block_;
  const SiemensContext& context_;
  SiemensFrame frame_;
  MachineAction out_;
  int u_ = 0, v_ = 1;                     // axes of the plane, in the order of its orientation
  AxisWords target_ = AxisWords::Zero();  // program, at the end machine coordinates
  std::array<bool, kAxisWords> is_used_{};
  std::array<bool, kAxisWords> moves_{};
};

}  // namespace

MachineAction siemens_motion(SiemensState& state, const SiemensBlock& block,
                             const SiemensContext& context) {
  check_modes(state, block, context);
  return Motion(state, block, context).run();
}

}  // namespace servomill::controllers
