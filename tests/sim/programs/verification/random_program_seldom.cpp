// Parts of random programs that few programs have.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "tests/sim/programs/verification/random_program.h"

namespace servomill::sim::programs {

void RandomProgram::arc_by_radius() {
  const int a = (normal_ + 1) % 3, b = (normal_ + 2) % 3;
  const double da = uniform(2, 8), db = uniform(-8, 8);
  const double r = std::hypot(da, db) * uniform(0.6, 1.5) * (one_in(3) ? -1.0 : 1.0);
  line((one_in(2) ? "G2" : "G3") + axis(a, at_[static_cast<std::size_t>(a)] + da) +
       axis(b, at_[static_cast<std::size_t>(b)] + db) + word('R', r));
}

void RandomProgram::arc_about_absolute_centre() {
  const int a = (normal_ + 1) % 3, b = (normal_ + 2) % 3;
  const double r = uniform(2, 15), from = uniform(0, 2 * std::numbers::pi);
  const double to = from + uniform(0.3, 5.5);
  const double ca = at_[static_cast<std::size_t>(a)] - r * std::cos(from);
  const double cb = at_[static_cast<std::size_t>(b)] - r * std::sin(from);
  const std::string centre = word("IJK"[a], ca) + word("IJK"[b], cb);
  line("G90.1");
  line((one_in(2) ? "G2" : "G3") + axis(a, ca + r * std::cos(to)) + axis(b, cb + r * std::sin(to)) +
       centre);
  line("G91.1");
}

// Cutter compensation around the outside of a rectangle with rounded corners.
void RandomProgram::contour() {
  if (is_incremental_ || normal_ != 2) return;
  const double x = uniform(25, 45), y = uniform(25, 45), w = uniform(20, 35), h = uniform(20, 35);
  const double c = uniform(2, 8);
  line("G0" + axis(0, x - 12) + axis(1, y + c - 12));
  const std::string code = one_in(3)   ? "G41.1 D" + number(6)
                           : one_in(2) ? "G41"
                                       : fmt::format("G41 D{}", tool_);
  line(code + " G1" + axis(0, x) + axis(1, y + c) + " F" + number(600));
  line("G1" + axis(1, y + h - c));
  line("G2" + axis(0, x + c) + axis(1, y + h) + word('I', c) + word('J', 0));
  line("G1" + axis(0, x + w - c));
  line("G2" + axis(0, x + w) + axis(1, y + h - c) + word('I', 0) + word('J', -c));
  line("G1" + axis(1, y + c));
  line("G2" + axis(0, x + w - c) + axis(1, y) + word('I', -c) + word('J', 0));
  line("G1" + axis(0, x + c));
  line("G2" + axis(0, x) + axis(1, y + c) + word('I', 0) + word('J', c));
  line("G40 G1" + axis(0, x - 12) + axis(1, y + c - 12));
}

void RandomProgram::subroutine() {
  if (is_incremental_) return;
  const int n = 100 + loops_++;
  line(fmt::format("o{0} sub\n  G1 X[#1 + 1] Y#2 F{1}\n  G4 P0.1\no{0} endsub", n, number(700)));
  const std::string x = number(uniform(10, 60)), y = number(uniform(10, 60));
  line(fmt::format("o{} call [{}] [{}]", n, x, y));
  line("G1" + axis(0, uniform(10, 60)) + axis(1, uniform(10, 60)));
}

void RandomProgram::branch() {
  if (is_incremental_) return;
  const int n = 100 + loops_++;
  line(fmt::format("#3 = {}", pick(2)));
  line(fmt::format("o{0} if [#3 EQ 1]\n  G1 X{1} F{3}\no{0} else\n  G1 X{2} F{3}\no{0} endif", n,
                   number(30), number(50), number(500)));
  line("G1" + axis(0, uniform(10, 60)) + axis(1, uniform(10, 60)));
}

void RandomProgram::repeat() {
  if (is_incremental_) return;
  const int n = 100 + loops_++;
  line(fmt::format("o{0} repeat [3]\n  G91 G1 X{1} Y{2} F{3}\n  G90\no{0} endrepeat", n,
                   number(uniform(-2, 2)), number(uniform(-2, 2)), number(500)));
  line("G1" + axis(0, uniform(10, 60)) + axis(1, uniform(10, 60)));
}

// Cycles that stop or reverse the spindle.
void RandomProgram::spindle_cycle() {
  if (is_incremental_ || normal_ != 2) return;
  line("S800 M3");
  line("G0" + axis(2, 10));
  const unsigned which = pick(3);
  const std::string code = which == 0 ? "G84" : which == 1 ? "G86 P0.3" : "G89 P0.4";
  line("G98 " + code + word('Z', -4) + word('R', 2) + axis(0, uniform(10, 80)) +
       axis(1, uniform(10, 80)) + " F" + number(800));
  line(axis(1, uniform(10, 80)).substr(1));
  line("G80");
  line("G0" + axis(2, 15));
}

void RandomProgram::repeated_cycle() {
  if (is_incremental_ || normal_ != 2) return;
  line("G0" + axis(0, uniform(20, 40)) + axis(1, uniform(20, 40)));
  line("G0" + axis(2, 10));
  line("G91 G99 G81" + word('X', uniform(4, 9)) + word('Y', uniform(-3, 3)) + word('Z', -5) +
       word('R', -7) + fmt::format(" L{} F", 2 + pick(3)) + number(200));
  line("G90 G80");
  approach();
}

void RandomProgram::side_cycle() {
  if (is_incremental_ || normal_ == 2) return;
  const int a = (normal_ + 1) % 3, b = (normal_ + 2) % 3;
  line("G0" + axis(normal_, 60));
  line("G98 G81" + word("XYZ"[normal_], 40) + word('R', 50) + axis(a, uniform(5, 20)) +
       axis(b, uniform(5, 20)) + " F" + number(200));
  line("G80");
}

void RandomProgram::other_home() {
  if (!is_incremental_) line("G91");
  line(one_in(2) ? "G30 Z0" : "G28 Z0");
  if (one_in(3)) line("G28 X0 Y0");
  line("G90");
  is_incremental_ = false;
  approach();
}

void RandomProgram::suspended_shift() {
  if (is_incremental_) return;
  line("G92" + axis(0, uniform(0, 30)) + axis(1, uniform(0, 30)) + axis(2, uniform(2, 9)));
  line("G0" + axis(0, uniform(0, 30)) + axis(2, uniform(2, 9)));
  line("G92.2");
  line("G0" + axis(0, uniform(5, 90)) + axis(1, uniform(5, 90)) + axis(2, uniform(20, 30)));
  if (one_in(2))
    line("G92.3\nG0" + axis(0, uniform(0, 30)) + axis(1, uniform(0, 30)) + axis(2, uniform(2, 9)));
  line("G92.1");
  line("G0" + axis(0, uniform(5, 90)) + axis(1, uniform(5, 90)) + axis(2, uniform(20, 30)));
}

void RandomProgram::stored_offset() {
  if (is_incremental_) return;
  if (one_in(2)) {
    line("G10 L2 P1" + word('X', 210) + word('Y', 240));
  } else {
    line("G10 L20 P0" + axis(0, uniform(0, 30)) + axis(1, uniform(0, 30)));
  }
  approach();
}

void RandomProgram::other_length() {
  if (is_incremental_) return;
  const unsigned which = pick(4);
  line("G53 G0 Z0");
  line(which == 0   ? "G49"
       : which == 1 ? "G43.1" + word('Z', 45)
       : which == 2 ? "G43"
                    : fmt::format("G43 H{}", 3 - tool_));
  line("G0" + axis(2, uniform(60, 70)));
  line("G1" + axis(0, uniform(10, 80)) + " F" + number(400));
  line("G53 G0 Z0");
  approach();
}

void RandomProgram::message() {
  const unsigned which = pick(4);
  line(which == 0   ? "(MSG, next side)"
       : which == 1 ? "(a comment: 50% done)"
       : which == 2 ? "; behind a semicolon"
                    : "(DEBUG, #5420 in X)");
}

void RandomProgram::preselect() { line(one_in(2) ? "T1" : "T2"); }

void RandomProgram::pallet() {
  line("M60");
  line("S1500 M3");
  approach();
}

// Feeds and positions are in other numbers behind it.
void RandomProgram::switch_unit() {
  if (is_incremental_) return;
  is_inch_ = !is_inch_;
  line(is_inch_ ? "G20" : "G21");
  if (one_in(2)) line("F" + number(500));
  line("G0" + axis(0, uniform(5, 90)) + axis(1, uniform(5, 90)));
}

void RandomProgram::machine_feed() {
  if (is_incremental_) return;
  line("G53 G0 Z0");
  line(fmt::format("G53 G1 X{} F{}", number(uniform(40, 60)), number(900)));
  if (options_.has_rotary_axes) line("G53 G0 A0 C0");
  approach();
}

void RandomProgram::saved_state() {
  if (is_incremental_) return;
  line("M70");
  line("G91");
  line("G1" + word('X', 1.5) + " F" + number(300));
  line("M72");
  line("G0" + axis(0, uniform(5, 90)) + axis(1, uniform(5, 90)));
}

void RandomProgram::spelling() {
  if (is_incremental_) return;
  line("N10 g0" + axis(0, uniform(5, 90)));
  line("g1y" + number(20) + "f" + number(500));
  line("G01" + axis(1, uniform(5, 90)));
}

// From one end of the travel of C to the other.
void RandomProgram::rotate_far() {
  if (is_incremental_) return;
  line(fmt::format("G{} C{:.3f}", one_in(2) ? "0" : "1 F2000", uniform(-400, 400)));
}

void RandomProgram::rotate_with_all() {
  const double scale = is_incremental_ ? 0.1 : 1.0;
  std::string text =
      "G1" + axis(0, uniform(10, 80)) + axis(1, uniform(10, 80)) + axis(2, uniform(-5, 5)) +
      fmt::format(" A{:.3f} C{:.3f}", scale * uniform(-40, 40), scale * uniform(-120, 120));
  line(text + " F" + number(900));
}

// A cut that the operator may leave out; behind it every axis is named again.
void RandomProgram::optional_cut() {
  if (is_incremental_) line("G90");
  is_incremental_ = false;
  line("G0" + axis(2, uniform(15, 25)));
  line("/G0" + axis(0, uniform(10, 90)) + axis(1, uniform(10, 90)));
  line("/G1" + axis(2, uniform(-3, 3)) + " F" + number(250));
  if (one_in(2)) line("/M8");
  if (one_in(2)) line("/G1" + axis(0, uniform(10, 90)));
  if (one_in(3)) line("/G4 P0.4");
  line("/G0" + axis(2, uniform(15, 25)));
  line("G0" + axis(0, uniform(10, 90)) + axis(1, uniform(10, 90)));
  line("G0" + axis(2, uniform(5, 10)));
  line("G1" + axis(2, uniform(-3, 3)) + " F" + number(400));
}

}  // namespace servomill::sim::programs
