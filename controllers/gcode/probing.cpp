// G38.2 to G38.5, and #5061 ... #5070 that they set.
#include "controllers/gcode/probing.h"

#include <fmt/format.h>

#include "controllers/gcode/interpreter_machine.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

constexpr double kStandAloneRetreat = 0.254 * mm;  // of rs274 of LinuxCNC 2.9, measured

}  // namespace

std::optional<ProbeContact> AssumedContact::contact(const ProbingMove& move) {
  ProbeContact out{move.end, move.end};
  const Eigen::Vector3d way = (move.end - move.begin).head<3>();
  if (way.norm() > 0.0) out.rest.head<3>() -= kStandAloneRetreat * way.normalized();
  return out;
}

void Interpreter::Machine::require_probing() const {
  const Request::Chosen& chosen = request().motion;
  const std::string name = code_name('G', chosen.code->tenths);
  const auto refuse = [&](std::string_view why) { fail(chosen.column, name + std::string(why)); };
  if (!has_any_axis() && !request().has_polar()) refuse(" requires an axis word");
  if (state_.compensation.is_on)
    refuse(" is not allowed with cutter compensation active; program G40 first");
  if (state_.controls_tip())
    refuse(" is not allowed under TCP control; cancel G43.4, G43.5 or G68.2 first");
  if (state_.feed_mode == FeedMode::inverse_time)
    refuse(" is not allowed with G93; program G94 first");
  if (state_.feed_mode == FeedMode::units_per_revolution)
    refuse(" is not allowed with G95; program G94 first");
  require_feed(request().motion);
  if (!setup_.probed)
    refuse(": the probed surface is unknown here; simulate it with [touch_probe] of a scenario");
}

void Interpreter::Machine::probe() {
  require_probing();
  const Request::Chosen& chosen = request().motion;
  ProbingMove move;
  move.mode.digit = chosen.code->tenths % 10;
  move.begin = state_.position;
  move.end = programmed_end();
  const bool stays = (move.end.array() == move.begin.array()).all();
  if (stays && move.mode.must_switch()) {
    fail(chosen.column, fmt::format("{} has zero travel: start and end coincide",
                                    code_name('G', chosen.code->tenths)));
  }
  note_height();
  const double length = (move.end - move.begin).head<3>().norm();
  move.feed = move_feed(length, 0.0);
  move.begin_machine = state_.to_machine(move.begin);
  move.end_machine = state_.to_machine(move.end);
  move.p_ST = state_.p_ST();
  move.line = line();
  if (!setup_.probed->is_assumed()) require_known_height();
  finish_probing(move, contact_of(move));
}

// A measured height means nothing where the length of the probe is not known.
void Interpreter::Machine::require_known_height() const {
  if (!state_.is_height_unknown && !state_.is_length_unknown) return;
  fail(request().motion.column,
       "the length of the probe is unknown; pass a tool table with --tools");
}

std::optional<ProbeContact> Interpreter::Machine::contact_of(const ProbingMove& move) {
  try {
    return setup_.probed->contact(move);
  } catch (const InputError& error) {
    const Request::Chosen& chosen = request().motion;
    fail(chosen.column, fmt::format("{}: {}", code_name('G', chosen.code->tenths),
                                    error.faults().front().message));
  }
}

void Interpreter::Machine::finish_probing(const ProbingMove& move,
                                          const std::optional<ProbeContact>& contact) {
  const bool is_assumed = setup_.probed->is_assumed();
  const Request::Chosen& chosen = request().motion;
  const std::string name = code_name('G', chosen.code->tenths);
  if (!contact && move.mode.must_switch()) {
    fail(chosen.column,
         fmt::format("{}: the probe {} before the end of the move", name,
                     move.mode.leaves() ? "is still in contact" : "makes no contact"));
  }
  if (is_assumed && noted_.insert("probe").second) {
    warn(chosen.column,
         fmt::format(
             "{}: assumed to {} at the end of the move; the measured position is unknown here",
             name, move.mode.leaves() ? "leave the surface" : "touch"));
  }
  const AxisWords latched = contact ? contact->latched : move.end;
  const AxisWords rest = contact ? contact->rest : move.end;
  const AxisWords reached = is_assumed ? move.end : rest;
  move_to(MoveKind::feed, reached, (reached - move.begin).head<3>().norm(), move.feed);
  out_.back().number = move.mode.digit;
  out_.back().path_mode = PathMode::exact_stop;
  state_.position = rest;
  for (int i = 0; i < kAxisWords; ++i) {
    parameters_.set(parameter::kProbed + i, latched[i] / unit_of(axis_at(i)));
  }
  for (int i = kAxisWords; i < parameter::kProbedAxes; ++i) {
    parameters_.set(parameter::kProbed + i, 0.0);  // U V W
  }
  // rs274 never says that it touched
  const bool has_switched = contact && !(is_assumed && setup_.reader == Reader::linuxcnc);
  parameters_.set(parameter::kProbeSwitched, has_switched ? 1.0 : 0.0);
}

}  // namespace servomill::controllers
