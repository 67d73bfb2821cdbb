#include "tests/sim/programs/verification/random_program.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace servomill::sim::programs {
namespace {

constexpr double kInch = 25.4;

}  // namespace

RandomProgram::RandomProgram(std::uint32_t seed, const Options& options)
    : random_(seed), options_(options) {
  const std::vector<Step> steps = options.is_interrupted ? interrupted_steps() : mixed_steps();
  begin();
  for (int i = 0; i < options.steps; ++i)
    (this->*steps[pick(static_cast<unsigned>(steps.size()))])();
  end();
}

std::vector<RandomProgram::Step> RandomProgram::mixed_steps() {
  std::vector<Step> steps = {
      &RandomProgram::rapid,       &RandomProgram::feed,       &RandomProgram::feed,
      &RandomProgram::arc,         &RandomProgram::arc,        &RandomProgram::helix,
      &RandomProgram::full_circle, &RandomProgram::increments, &RandomProgram::polar,
      &RandomProgram::coolant,     &RandomProgram::spindle,    &RandomProgram::dwell,
      &RandomProgram::plane};
  // a few seldom things a program, so that most programs can be written for every control
  const std::vector<Step> seldom = {&RandomProgram::shift,
                                    &RandomProgram::work_system,
                                    &RandomProgram::stop,
                                    &RandomProgram::machine_position,
                                    &RandomProgram::home,
                                    &RandomProgram::cycle,
                                    &RandomProgram::pocket,
                                    &RandomProgram::loop,
                                    &RandomProgram::expression,
                                    &RandomProgram::by_time,
                                    &RandomProgram::per_revolution,
                                    &RandomProgram::path_mode,
                                    &RandomProgram::slash,
                                    &RandomProgram::change_tool,
                                    &RandomProgram::arc_by_radius,
                                    &RandomProgram::arc_about_absolute_centre,
                                    &RandomProgram::contour,
                                    &RandomProgram::subroutine,
                                    &RandomProgram::branch,
                                    &RandomProgram::repeat,
                                    &RandomProgram::spindle_cycle,
                                    &RandomProgram::repeated_cycle,
                                    &RandomProgram::side_cycle,
                                    &RandomProgram::other_home,
                                    &RandomProgram::suspended_shift,
                                    &RandomProgram::stored_offset,
                                    &RandomProgram::other_length,
                                    &RandomProgram::message,
                                    &RandomProgram::preselect,
                                    &RandomProgram::pallet,
                                    &RandomProgram::switch_unit,
                                    &RandomProgram::machine_feed,
                                    &RandomProgram::saved_state,
                                    &RandomProgram::optional_cut,
                                    &RandomProgram::optional_cut,
                                    &RandomProgram::spelling};
  for (int i = 0; i < 3; ++i) steps.push_back(seldom[pick(static_cast<unsigned>(seldom.size()))]);
  if (options_.has_rotary_axes) {
    for (int i = 0; i < 3; ++i) steps.push_back(&RandomProgram::rotate);
    steps.push_back(&RandomProgram::rotate_far);
    steps.push_back(&RandomProgram::rotate_with_all);
  }
  return steps;
}

double RandomProgram::uniform(double low, double high) {
  return low + (high - low) * static_cast<double>(random_()) / 4294967296.0;
}

std::string RandomProgram::number(double mm_value) const {
  return fmt::format("{:.4f}", is_inch_ ? mm_value / kInch : mm_value);
}

std::string RandomProgram::word(char letter, double mm_value) const {
  return fmt::format(" {}{}", letter, number(mm_value));
}

// Keeps account of what the printed number leads to.
std::string RandomProgram::axis(int i, double to) {
  const auto k = static_cast<std::size_t>(i);
  const double value = is_incremental_ ? to - at_[k] : to;
  const std::string text = number(value);
  const double printed = std::stod(text) * (is_inch_ ? kInch : 1.0);
  at_[k] = is_incremental_ ? at_[k] + printed : printed;
  return fmt::format(" {}{}", "XYZ"[i], text);
}

void RandomProgram::begin() {
  is_inch_ = one_in(5);
  line("(a random part)");
  line(is_inch_ ? "G20" : "G21");
  line("G17 G40 G49 G80 G90 G94 G54");
  if (one_in(2)) line("G53 G0 Z0");
  change_tool();
}

void RandomProgram::approach() {
  if (is_incremental_) line("G90");
  is_incremental_ = false;
  line("G0" + axis(0, uniform(10, 90)) + axis(1, uniform(10, 90)));
  if (options_.has_rotary_axes)
    line(fmt::format("G0 A{:.3f} C{:.3f}", uniform(-30, 30), uniform(-90, 90)));
  line(fmt::format("G43 H{}", tool_) + axis(2, uniform(5, 20)));
}

void RandomProgram::change_tool() {
  if (is_incremental_) line("G90");
  is_incremental_ = false;
  if (has_tool_) {
    if (one_in(2)) line("M9");
    if (one_in(2)) line("M5");
    if (one_in(2)) line("G53 G0 Z0");
  }
  has_tool_ = true;
  tool_ = one_in(2) ? 1 : 2;
  line(fmt::format("T{}{}M6", tool_, one_in(2) ? " " : "\n"));
  line(fmt::format("S{} M3", 100 * (5 + pick(100))));
  approach();
  if (one_in(2)) line("M8");
  line("G1" + axis(2, uniform(-5, 0)) + " F" + number(50.0 * (1 + pick(40))));
}

void RandomProgram::end() {
  if (is_incremental_) line("G90");
  if (one_in(2)) line("M9");
  if (one_in(3)) line("G53 G0 Z0");
  if (one_in(2)) line("M5");
  line(one_in(2) ? "M30" : "M2");
}

void RandomProgram::rapid() {
  std::string text = "G0";
  const unsigned which = 1 + pick(7);
  for (int i = 0; i < 3; ++i) {
    if ((which >> i & 1U) != 0) text += axis(i, uniform(i == 2 ? 1 : 5, i == 2 ? 20 : 95));
  }
  line(text);
}

void RandomProgram::feed() {
  std::string text = "G1";
  const unsigned which = 1 + pick(7);
  for (int i = 0; i < 3; ++i) {
    if ((which >> i & 1U) != 0) text += axis(i, uniform(i == 2 ? -10 : 5, i == 2 ? 5 : 95));
  }
  if (one_in(3)) text += " F" + number(10.0 * (1 + pick(200)));
  line(text);
}

// An arc in the plane in force, whose end lies on its circle but for digits.
void RandomProgram::arc() {
  const int a = (normal_ + 1) % 3, b = (normal_ + 2) % 3;
  const double r = uniform(2, 15), from = uniform(0, 2 * std::numbers::pi);
  const double to = from + uniform(0.3, 5.5);
  const double ca = at_[static_cast<std::size_t>(a)] - r * std::cos(from);
  const double cb = at_[static_cast<std::size_t>(b)] - r * std::sin(from);
  const bool is_clockwise = one_in(2);
  std::string text = is_clockwise ? "G2" : "G3";
  const std::string centre =
      word("IJK"[a], -r * std::cos(from)) + word("IJK"[b], -r * std::sin(from));
  text += axis(a, ca + r * std::cos(to)) + axis(b, cb + r * std::sin(to));
  line(text + centre);
}

void RandomProgram::helix() {
  const int a = (normal_ + 1) % 3, b = (normal_ + 2) % 3;
  const double r = uniform(2, 10), from = uniform(0, 2 * std::numbers::pi);
  const double to = from + uniform(0.5, 5.5);
  const double ca = at_[static_cast<std::size_t>(a)] - r * std::cos(from);
  const double cb = at_[static_cast<std::size_t>(b)] - r * std::sin(from);
  const std::string centre =
      word("IJK"[a], -r * std::cos(from)) + word("IJK"[b], -r * std::sin(from));
  std::string text = one_in(2) ? "G2" : "G3";
  text += axis(a, ca + r * std::cos(to)) + axis(b, cb + r * std::sin(to));
  text += axis(normal_, at_[static_cast<std::size_t>(normal_)] + uniform(-3, 3));
  line(text + centre + (one_in(4) ? " P2" : ""));
}

void RandomProgram::full_circle() {
  const int a = (normal_ + 1) % 3, b = (normal_ + 2) % 3;
  const double r = uniform(1, 10), from = uniform(0, 2 * std::numbers::pi);
  line(std::string(one_in(2) ? "G2" : "G3") + word("IJK"[a], -r * std::cos(from)) +
       word("IJK"[b], -r * std::sin(from)));
}

void RandomProgram::increments() {
  is_incremental_ = !is_incremental_;
  line(is_incremental_ ? "G91" : "G90");
}

void RandomProgram::polar() {
  if (normal_ != 2 || is_incremental_) return;
  const std::string radius = number(uniform(20, 60)),
                    angle = fmt::format("{:.3f}", uniform(10, 80));
  line(fmt::format("G{} @{} ^{}", one_in(2) ? 0 : 1, radius, angle));
  const double r = std::stod(radius) * (is_inch_ ? kInch : 1.0);
  const double phi = std::stod(angle) * std::numbers::pi / 180.0;
  at_[0] = r * std::cos(phi);
  at_[1] = r * std::sin(phi);
}

void RandomProgram::shift() {
  if (is_incremental_) return;
  if (one_in(2)) {
    line("G92" + axis(0, uniform(0, 30)) + axis(1, uniform(0, 30)));
    line("G0" + axis(0, uniform(0, 30)));
    line("G92.1");
  } else {
    line("G52" + word('X', uniform(-5, 5)) + word('Y', uniform(-5, 5)));
    line("G0" + axis(0, uniform(5, 30)) + axis(1, uniform(5, 30)));
    line("G1" + axis(0, uniform(5, 30)) + " F" + number(400));
    line("G52 X0 Y0");
  }
  line("G0" + axis(0, uniform(5, 90)) + axis(1, uniform(5, 90)));
}

void RandomProgram::work_system() {
  if (is_incremental_) return;
  const unsigned system = one_in(4) ? pick(9) : pick(3);
  line(system < 6 ? fmt::format("G{}", 54 + system) : fmt::format("G59.{}", system - 5));
  line("G0" + axis(2, uniform(5, 20)));
  line("G0" + axis(0, uniform(10, 90)) + axis(1, uniform(10, 90)));
}

void RandomProgram::coolant() { line(one_in(3) ? "M9" : one_in(12) ? "M7" : "M8"); }

void RandomProgram::spindle() {
  if (one_in(2)) return line(fmt::format("S{}", 100 * (5 + pick(100))));
  if (one_in(6)) return line(fmt::format("G97 S{:.3f}", uniform(500, 9000)));
  if (one_in(6)) line("M5");
  line(one_in(3) ? "M4" : "M3");
}

void RandomProgram::dwell() { line(fmt::format("G4 P{:.2f}", uniform(0.1, 3))); }

void RandomProgram::stop() {
  line(one_in(2) ? "M0" : "M1");
  if (one_in(4)) return;  // a control on which positions are lost refuses what follows
  line("S1500 M3");
  approach();
}

void RandomProgram::machine_position() {
  if (is_incremental_) return;
  line("G53 G0 Z0");
  if (one_in(2)) line(fmt::format("G53 G0 X{} Y{}", number(50), number(60)));
  approach();
}

void RandomProgram::home() {
  if (!is_incremental_) line("G91");
  line("G28 Z0");
  line("G90");
  is_incremental_ = false;
  approach();
}

void RandomProgram::cycle() {
  if (is_incremental_ || normal_ != 2) return;
  line("G0" + axis(2, 10));
  const unsigned which = pick(5);
  const std::string code = which == 0   ? "G81"
                           : which == 1 ? "G82 P0.5"
                           : which == 2 ? "G83 Q" + number(1.5)
                           : which == 3 ? "G73 Q" + number(2)
                                        : "G85";
  line(std::string(one_in(2) ? "G98 " : "G99 ") + code + word('Z', -4) + word('R', 2) +
       axis(0, uniform(10, 80)) + axis(1, uniform(10, 80)) + " F" + number(200));
  line(axis(0, uniform(10, 80)).substr(1));
  line(axis(0, uniform(10, 80)).substr(1) + axis(1, uniform(10, 80)));
  line("G80");
  line("G0" + axis(2, 15));
}

// Cutter compensation around a rectangle.
void RandomProgram::pocket() {
  if (is_incremental_ || normal_ != 2) return;
  const double x = uniform(25, 45), y = uniform(25, 45), w = uniform(20, 35), h = uniform(20, 35);
  const bool is_left = one_in(2);
  line("G0" + axis(0, x - 12) + axis(1, y - 12));
  line(fmt::format("G{} D{} G1", is_left ? 41 : 42, tool_) + axis(0, x) + axis(1, y) + " F" +
       number(600));
  if (is_left) {
    line("G1" + axis(1, y + h));
    line("G1" + axis(0, x + w));
    line("G1" + axis(1, y));
  } else {
    line("G1" + axis(0, x + w));
    line("G1" + axis(1, y + h));
    line("G1" + axis(0, x));
  }
  line(is_left ? "G1" + axis(0, x) : "G1" + axis(1, y));
  line("G40 G1" + axis(0, x - 12) + axis(1, y - 12));
}

void RandomProgram::loop() {
  if (is_incremental_) return;
  const int n = 100 + loops_++;
  line(fmt::format("#1 = 0\no{} while [#1 lt 3]", n));
  line(fmt::format("  G1 X[{} + #1] F{}", number(20), number(500)));
  line("  #1 = [#1 + 1]");
  line(fmt::format("o{} endwhile", n));
  line("G1" + axis(0, 30));
}

void RandomProgram::expression() {
  if (is_incremental_) return;
  line(fmt::format("#2 = {}", number(uniform(20, 40))));
  line("G1 X[#2 * 1.5] Y#2");
  line("G1" + axis(0, 40) + axis(1, 40));
}

void RandomProgram::rotate() {
  if (is_incremental_) return;
  const std::string angles = fmt::format(" A{:.3f} C{:.3f}", uniform(-40, 40), uniform(-120, 120));
  if (one_in(3)) return line("G0" + angles);
  if (one_in(2)) return line("G1" + angles + " F" + number(1000));
  line("G93 G1" + axis(0, uniform(10, 80)) + axis(1, uniform(10, 80)) + angles +
       fmt::format(" F{:.2f}", uniform(2, 30)));
  line("G94 F" + number(800));
}

void RandomProgram::by_time() {
  line(fmt::format("G93 G1") + axis(0, uniform(10, 80)) + fmt::format(" F{:.2f}", uniform(2, 30)));
  line("G94 F" + number(700));
}

void RandomProgram::per_revolution() {
  line("G95 F" + number(0.1));
  line("G1" + axis(0, uniform(10, 80)));
  line("G94 F" + number(700));
}

void RandomProgram::path_mode() {
  const unsigned which = pick(5);
  line(which == 0   ? "G61.1"
       : which == 1 ? "G61"
       : which == 2 ? "G64 P" + number(0.01)
       : which == 3 ? "G64 P" + number(0.02) + " Q" + number(0.01)
                    : "G64");
}

// Block that the operator's switch leaves out.
void RandomProgram::slash() {
  const unsigned which = pick(6);
  if (which == 0) return line("/M8");
  if (which == 1) return line("/M9");
  if (which == 2) return line(fmt::format("/G4 P{:.2f}", uniform(0.1, 2)));
  if (which == 3) return line("/(MSG, not with the switch)");
  if (which == 4) {
    line(one_in(2) ? "/M0" : "/M1");
    if (!one_in(4)) approach();
    return;
  }
  if (is_incremental_) return;
  line("/G1" + axis(0, uniform(10, 80)) + " F" + number(300));
  approach();
}

void RandomProgram::plane() {
  if (one_in(2)) return;
  normal_ = static_cast<int>(pick(3));
  line(normal_ == 2 ? "G17" : normal_ == 1 ? "G18" : "G19");
}

}  // namespace servomill::sim::programs
