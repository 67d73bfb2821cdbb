// Random programs of optional blocks, stops, reference moves and tool changes: what makes
// positions, spindle and coolant uncertain, each next to each.
#include <fmt/format.h>

#include "tests/sim/programs/verification/random_program.h"

namespace servomill::sim::programs {

// Each program has some of the kinds, so that many can be written for every control.
std::vector<RandomProgram::Step> RandomProgram::interrupted_steps() {
  std::vector<Step> steps = {
      &RandomProgram::single_axis, &RandomProgram::single_axis, &RandomProgram::rapid,
      &RandomProgram::feed,        &RandomProgram::naming,      &RandomProgram::naming,
      &RandomProgram::naming,      &RandomProgram::coolant,     &RandomProgram::spindle};
  const std::vector<std::vector<Step>> kinds = {
      {&RandomProgram::optional_block, &RandomProgram::optional_block,
       &RandomProgram::optional_block, &RandomProgram::optional_cut, &RandomProgram::slash},
      {&RandomProgram::bare_stop, &RandomProgram::bare_stop, &RandomProgram::stop},
      {&RandomProgram::bare_reference, &RandomProgram::bare_reference, &RandomProgram::other_home,
       &RandomProgram::optional_reference},
      {&RandomProgram::bare_tool_change, &RandomProgram::change_tool, &RandomProgram::preselect},
      {&RandomProgram::machine_position, &RandomProgram::dwell, &RandomProgram::arc}};
  for (const std::vector<Step>& kind : kinds) {
    if (!one_in(3)) steps.insert(steps.end(), kind.begin(), kind.end());
  }
  if (one_in(3)) steps.push_back(&RandomProgram::work_system);
  if (one_in(12)) steps.push_back(&RandomProgram::reference_of_all);
  if (options_.has_rotary_axes) steps.push_back(&RandomProgram::rotate);
  return steps;
}

// One that the operator's switch leaves out, mostly with every axis named again behind it.
void RandomProgram::optional_block() {
  if (is_incremental_) line("G90");
  is_incremental_ = false;
  const std::array<double, 3> before = at_;
  const unsigned which = pick(12);
  switch (which) {
    case 0:
      line("/G0" + axis(2, uniform(-3, 25)));
      break;
    case 1:
      line("/G0" + axis(0, uniform(10, 90)) + axis(1, uniform(10, 90)));
      break;
    case 2:
      line("/G0" + axis(0, uniform(10, 90)) + axis(2, uniform(1, 25)));
      break;
    case 3:
      line("/G1" + axis(1, uniform(10, 90)) + " F" + number(300));
      break;
    case 4:
      line("/G53 G0 Z0");
      break;
    case 5:
      line(one_in(2) ? "/M3" : "/M5");
      break;
    case 6:
      line(fmt::format("/S{}", 100 * (5 + pick(100))));
      break;
    default:
      line(which == 7   ? "/M0"
           : which == 8 ? "/M1"
           : which == 9 ? "/M8"
           : which < 11 ? "/M9"
                        : "/G4 P0.5");
      break;
  }
  if (one_in(2)) at_ = before;  // increments and arcs of the rest begin at either
  if (!one_in(4)) naming();
}

void RandomProgram::optional_reference() {
  if (is_incremental_) line("G90");
  is_incremental_ = false;
  line("/G91");
  line(one_in(2) ? "/G28 Z0" : "/G30 Z0");
  line("/G90");
  if (!one_in(4)) naming();
}

// The operator may jog; often nothing is named again.
void RandomProgram::bare_stop() {
  line(one_in(2) ? "M0" : "M1");
  if (!one_in(3)) naming();
}

void RandomProgram::bare_reference() {
  if (!is_incremental_) line("G91");
  line(one_in(2) ? "G28 Z0" : "G30 Z0");
  if (one_in(3)) line(one_in(2) ? "G28 Z0" : "M1");
  is_incremental_ = one_in(4);
  if (!is_incremental_) line("G90");
  if (!one_in(3)) naming();
}

// Without axes, or by a position in between.
void RandomProgram::reference_of_all() {
  if (is_incremental_) line("G90");
  is_incremental_ = false;
  const char* code = one_in(2) ? "G28" : "G30";
  const unsigned which = pick(3);
  line(which == 0   ? code
       : which == 1 ? code + axis(2, uniform(20, 30))
                    : code + axis(0, uniform(10, 90)) + axis(1, uniform(10, 90)));
  naming();
}

// Without a word about spindle, coolant or length behind it.
void RandomProgram::bare_tool_change() {
  tool_ = one_in(2) ? 1 : 2;
  line(fmt::format("T{} M6", tool_));
  if (one_in(2)) line(fmt::format("G43 H{}", tool_));
  if (one_in(2)) line("S1200 M3");
  if (!one_in(3)) naming();
}

void RandomProgram::single_axis() {
  const int i = static_cast<int>(pick(3));
  const double to = i == 2 ? uniform(-3, 20) : uniform(10, 90);
  const std::string feed = !one_in(3) ? "G0" : "G1 F" + number(400);
  line(feed + axis(i, to));
}

// Every axis by rapid, in an order that pleases the program.
void RandomProgram::naming() {
  if (is_incremental_) line("G90");
  is_incremental_ = false;
  const std::string X = axis(0, uniform(10, 90)), Y = axis(1, uniform(10, 90));
  const std::string Z = axis(2, uniform(5, 25));
  switch (pick(4)) {
    case 0:
      return line("G0" + X + Y + Z);
    case 1:
      line("G0" + Z);
      return line("G0" + X + Y);
    case 2:
      line("G0" + X);
      line("G0" + Y);
      return line("G0" + Z);
    default:
      line("G0" + X + Y);
      return line("G0" + Z);
  }
}

}  // namespace servomill::sim::programs
