#include "controllers/dialects/siemens_arc.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "controllers/dialects/planar_arc.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

constexpr double kMinSweep = 1e-3 * deg;  // below, rounding decides between 0 and a full turn
constexpr double kSamePoint = 1.0 * nm;   // a tenth of the last digit that programs have
// Rise of CIP along the normal of a plane of two axes. Taken as linear, it is off by at most 0.11
// of that, the largest of |a / pi - (1 - cos a) / 2|.
constexpr double kMaxTilt = 1.0 * um;
constexpr double kCollinear = 1e-9;  // rad, between the chords of CIP

}  // namespace

void refuse_through_point(const SiemensState& state, const SiemensBlock& block,
                          const SiemensContext& context) {
  if (!block.has_through()) return;
  context.fail(block.line, block.column,
               fmt::format("I1, J1 and K1 require CIP; G{} is active", *state.motion));
}

void SiemensArc::fail(int column, std::string message) const {
  context_.fail(block_.line, column, std::move(message));
}

void SiemensArc::check_words() {
  if (is_through_point()) {
    check_through_words();
  } else {
    check_centre_words();
  }
}

void SiemensArc::read(MachineAction& out) {
  if (is_through_point()) {
    read_through_point(out);
  } else {
    read_about_centre(out);
  }
  out.normal_axis = normal_axis_;
}

void SiemensArc::check_centre_words() {
  if (frame_.is_of_machine()) fail("SUPA with G2 or G3 is not supported");
  refuse_through_point(state_, block_, context_);
  if (!state_.normal_axis) fail("the plane of the arc is unknown; program G17, G18 or G19");
  normal_axis_ = *state_.normal_axis;
  u_ = (normal_axis_ + 1) % 3;
  v_ = (normal_axis_ + 2) % 3;
  if (!context_.rules.G18_is_ZX && normal_axis_ == 1) std::swap(u_, v_);
  refuse_rotary_axes();
  const auto& along_normal = block_.centre[place_of(normal_axis_)];
  if (along_normal) {
    fail(along_normal->column,
         fmt::format("{} is not in the plane of the arc", "IJK"[normal_axis_]));
  }
  if (block_.CR && block_.has_centre()) fail(block_.CR->column, "CR is not allowed with a centre");
  if (!block_.CR && !block_.has_centre()) fail("an arc requires a centre or CR");
  if (frame_.rotation() != 0.0 && normal_axis_ != 2) {
    fail("an arc outside the XY plane with a rotated work offset is not supported");
  }
  if (context_.rules.length_needs_a_line) refuse_new_length(normal_axis_);
}

void SiemensArc::refuse_rotary_axes() const {
  for (int a = 3; a < kAxisWords; ++a) {
    if (!block_.axes[place_of(a)]) continue;
    fail(block_.axes[place_of(a)]->column,
         fmt::format("{} in a block with an arc is not supported", siemens_axis_letter(a)));
  }
}

// [P] p. 198 allows I1, J1 and K1 to be omitted only where their value is 0.
void SiemensArc::check_through_words() const {
  if (frame_.is_of_machine()) fail("SUPA with CIP is not supported");
  if (frame_.rotation() != 0.0) fail("CIP with a rotated work offset is not supported");
  if (block_.has_centre() || block_.CR || block_.TURN) {
    fail("I, J, K, CR and TURN require G2 or G3; CIP is active");
  }
  refuse_rotary_axes();
  for (std::size_t i = 0; i < 3; ++i) {
    if (!block_.through[i]) fail(fmt::format("CIP requires {}1", "IJK"[i]));
  }
  if (context_.rules.length_needs_a_line) refuse_new_length(-1);
}

// [W1] p. 13: a new tool length acts with the first motion of its axis, which must be a line.
// @param still  axis that moves only if it is programmed in the block
void SiemensArc::refuse_new_length(int still) const {
  for (int a = 0; a < 3; ++a) {
    if (!block_.axes[place_of(a)] && a == still) continue;
    const double length = frame_.length(a);
    const std::optional<double>& before = state_.length_shift[place_of(a)];
    if (before ? *before != length : length != 0.0) {
      fail(fmt::format("the tool length changes in {}; this requires G0 or G1",
                       siemens_axis_letter(a)));
    }
  }
}

Eigen::Vector2d SiemensArc::start_in_plane() const {
  const std::optional<double> u = frame_.program(state_.position, u_);
  const std::optional<double> v = frame_.program(state_.position, v_);
  if (!u || !v)
    fail(fmt::format("the start position of the arc in {} is unknown",
                     siemens_axis_letter(u ? v_ : u_)));
  return {*u, *v};
}

void SiemensArc::read_about_centre(MachineAction& out) {
  const Eigen::Vector2d start = start_in_plane();
  for (const int a : {u_, v_}) {
    if (!target_.is_used[place_of(a)]) target_.add_start(a);
    target_.is_commanded[place_of(a)] = true;
  }
  const Eigen::Vector2d end(target_.words[u_], target_.words[v_]);
  const bool is_clockwise = (*state_.motion == 2) == context_.rules.G2_is_clockwise;
  const Eigen::Vector2d centre =
      block_.CR ? centre_of_radius(start, end, is_clockwise) : programmed_centre(start);
  out.turns = turns_of(start, end, centre, is_clockwise);
  AxisWords machine = AxisWords::Zero();
  machine[u_] = centre[0];
  machine[v_] = centre[1];
  std::array<bool, kAxisWords> plane{};
  plane[place_of(u_)] = plane[place_of(v_)] = true;
  frame_.to_machine(machine, plane);
  out.centre = machine.head<3>();
}

Eigen::Vector3d SiemensArc::through_point(const Eigen::Vector3d& start) const {
  Eigen::Vector3d out;
  for (int i = 0; i < 3; ++i) {
    const SiemensNumber& word = *block_.through[place_of(i)];
    const bool counts_from_start =
        target_.is_incremental(word, "IJK"[i]) || !context_.rules.CIP_point_is_absolute;
    out[i] = (counts_from_start ? start[i] : 0.0) + word.value * target_.unit_of(i, word.column);
  }
  return out;
}

// The circle through three points, where its plane is that of two axes.
void SiemensArc::read_through_point(MachineAction& out) {
  Eigen::Vector3d start, end;
  for (int a = 0; a < 3; ++a) {
    const std::optional<double> known = frame_.program(state_.position, a);
    if (!known)
      fail(fmt::format("the start position of the arc in {} is unknown", siemens_axis_letter(a)));
    start[a] = *known;
    if (!target_.is_used[place_of(a)]) target_.add_start(a);
    end[a] = target_.words[a];
  }
  const Eigen::Vector3d through = through_point(start);
  const Eigen::Vector3d p = through - start, q = end - start, normal = p.cross(q);
  if (q.norm() < kSamePoint) fail("CIP: start and end coincide: the circle is undetermined");
  if (normal.norm() < kCollinear * p.norm() * q.norm()) {
    fail("the three points of CIP are collinear");
  }
  normal.cwiseAbs().maxCoeff(&normal_axis_);
  u_ = (normal_axis_ + 1) % 3;
  v_ = (normal_axis_ + 2) % 3;
  if (std::max(std::abs(p[normal_axis_]), std::abs(q[normal_axis_])) > kMaxTilt + 1e-12) {
    fail("CIP in a plane not spanned by two axes is not supported");
  }
  const Eigen::Vector3d centre =
      start + (p.squaredNorm() * q.cross(normal) + q.squaredNorm() * normal.cross(p)) /
                  (2.0 * normal.squaredNorm());
  const bool is_positive = normal[normal_axis_] > 0.0;
  out.turns = is_positive == context_.rules.CIP_passes_its_point ? 1 : -1;
  target_.is_commanded[place_of(u_)] = target_.is_commanded[place_of(v_)] = true;
  AxisWords machine = AxisWords::Zero();
  machine.head<3>() = centre;
  frame_.to_machine(machine, {true, true, true, false, false, false});
  out.centre = machine.head<3>();
}

Eigen::Vector2d SiemensArc::programmed_centre(const Eigen::Vector2d& start) const {
  Eigen::Vector2d centre = start;
  for (int i = 0; i < 2; ++i) {
    const std::optional<SiemensNumber>& word = block_.centre[place_of(i == 0 ? u_ : v_)];
    if (!word) continue;
    const double value = word->value * target_.unit_of(u_, word->column);
    const bool is_relative =
        word->form != SiemensForm::absolute && context_.rules.centre_counts_from_start;
    centre[i] = is_relative ? start[i] + value : value;
  }
  return centre;
}

Eigen::Vector2d SiemensArc::centre_of_radius(const Eigen::Vector2d& start,
                                             const Eigen::Vector2d& end, bool is_clockwise) const {
  const double r = block_.CR->value * target_.unit_of(u_, block_.CR->column);
  const Eigen::Vector2d chord = end - start;
  const double d = chord.norm();
  if (d < kSamePoint)
    fail(block_.CR->column, "CR: start and end coincide: the circle is undetermined");
  if (std::abs(r) < 0.5 * d - kMaxRadiusDifference) {
    fail(block_.CR->column,
         fmt::format("CR = {}: start and end are {:.6g} mm apart", block_.CR->value, d / mm));
  }
  const double h = std::sqrt(std::max(0.0, r * r - 0.25 * d * d));
  const bool is_long = (r < 0.0) == context_.rules.negative_CR_is_long;
  const double side = is_clockwise != is_long ? -1.0 : 1.0;
  return 0.5 * (start + end) + side * h / d * Eigen::Vector2d(-chord[1], chord[0]);
}

Eigen::Vector3d SiemensArc::in_space(const Eigen::Vector2d& point) const {
  Eigen::Vector3d out = Eigen::Vector3d::Zero();
  out[u_] = point[0];
  out[v_] = point[1];
  return out;
}

int SiemensArc::turns_of(const Eigen::Vector2d& start, const Eigen::Vector2d& end,
                         const Eigen::Vector2d& centre, bool is_clockwise) const {
  const Eigen::Vector2d from = start - centre, to = end - centre;
  if (const auto fault = arc_fault(in_space(start), in_space(end), in_space(centre), 3 - u_ - v_)) {
    fail(*fault);
  }
  int added = block_.TURN ? static_cast<int>(block_.TURN->value) : 0;
  if (!context_.rules.TURN_adds_turns && added > 0) --added;
  const double angle = std::atan2(from[0] * to[1] - from[1] * to[0], from.dot(to));
  const bool is_full = (end - start).norm() < kSamePoint;
  if (!is_full && std::abs(angle) < kMinSweep) {
    fail(
        "start and end of the arc nearly coincide: rounding decides between no motion and a full "
        "circle");
  }
  if (is_full && !context_.rules.equal_ends_are_full_circle) --added;
  return is_clockwise ? -1 - added : 1 + added;
}

}  // namespace servomill::controllers
