#include "sim/preparation/preparation_cache.h"

#include <algorithm>

#include "controllers/servo/filters.h"
#include "sim/frequency/margins.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "sim/preparation/case_program.h"

namespace servomill::sim::preparation {
namespace {

std::size_t weight_of(const MoveList& moves) { return moves.size() + 1; }

// An arc is one move and hundreds of phases and pieces.
std::size_t weight_of(const PlannedMotion& motion) {
  return weight_of(*motion.moves) + motion.trajectory.weight();
}

void add(system::MemoKey& key, const controllers::ToolTable& tools) {
  key.add(tools.size());
  for (const auto& [number, tool] : tools.entries()) {
    const auto& [tool_number, pocket, offset, diameter, front_angle, back_angle, orientation] =
        tool;
    key.add(tool_number);
    key.add(pocket);
    key.add(offset);
    key.add(diameter);
    key.add(front_angle);
    key.add(back_angle);
    key.add(orientation);
  }
}

void add(system::MemoKey& key, const plant::ErrorFunction& function) {
  const auto& [polynomial, harmonics, tables, reversals, grids] = function;
  const auto add_all = [&key](const std::vector<double>& values) {
    key.add(values.size());
    for (const double value : values) key.add(value);
  };
  add_all(polynomial);
  key.add(harmonics.size());
  for (const auto& [amplitude, period, phase] : harmonics) {
    key.add(amplitude);
    key.add(period);
    key.add(phase);
  }
  key.add(tables.size());
  for (const auto& [s, error] : tables) {
    add_all(s);
    add_all(error);
  }
  key.add(reversals.size());
  for (const auto& [width, distance] : reversals) {
    add_all(width);
    key.add(distance);
  }
  key.add(grids.size());
  for (const plant::GridFunction& grid : grids) {
    const auto& [axes, at, error, interpolation, repeats] = grid.points();
    key.add(axes.size());
    for (const Axis axis : axes) key.add(axis);
    for (const auto& positions : at) add_all(positions);
    add_all(error);
    key.add(interpolation);
    for (const bool is_repeated : repeats) key.add(is_repeated);
  }
}

void add(system::MemoKey& key, const controllers::FilterChain& filters) {
  const auto& [sections, count] = filters;
  key.add(count);
  for (std::size_t n = 0; n < count; ++n) {
    const auto& [b0, b1, b2, a1, a2] = sections[n];
    for (const double coefficient : {b0, b1, b2, a1, a2}) key.add(coefficient);
  }
}

bool controls_tip(const Move& move) {
  return is_motion(move.kind) && move.tool_control != ToolControl::none;
}

}  // namespace

std::optional<Move> InterpretedProgram::first_shifted_feed() const {
  return first_move(moves, [](const Move& move) { return is_feed(move.kind) && move.is_shifted; });
}

InterpretedProgram::InterpretedProgram(MoveList moves_in, std::vector<Fault> warnings_in,
                                       const controllers::ProgramSetup& setup)
    : moves(std::move(moves_in)),
      warnings(std::move(warnings_in)),
      tips(tips_of(moves, setup.tools)),
      path(moves, setup.start, setup.machine, tips) {
  const AxisWords& start = setup.start;
  first_tip_move_ = first_move(moves, controls_tip);
  // the tip of the first tool that the program works with: the one that a strategy assumes
  const auto works = [](const Move& move) { return is_motion(move.kind) && move.tool_offset != 0; };
  const auto first = first_move(moves, works);
  if (first) first_tip = tips.at(first->tool_offset);
  for (const Move& move : moves) {
    if (!is_motion(move.kind)) continue;
    for (const Axis axis : kAllAxes) {
      if (is_linear(axis) && controls_tip(move)) continue;  // those follow the tip
      int& line = first_line[static_cast<std::size_t>(axis)];
      if (line == 0 && move.end_machine[index_of(axis)] != start[index_of(axis)]) line = move.line;
    }
  }
}

PreparationCache::PreparationCache()
    : programs(kMoves, [](const InterpretedProgram& p) { return weight_of(p.moves); }),
      rewritten(kMoves, [](const RewrittenProgram& p) { return weight_of(p.moves); }),
      motions(kMoves, [](const PlannedMotion& m) { return weight_of(m); }),
      circles(kMoves, [](const SectionsOfMotion& s) { return weight_of(*s.motion); }),
      cuttings(kRows, [](const PlannedCutting& c) { return c.table.rows().size() + 1; }),
      models(kModels),
      strategies(kModels),
      spectral_radii(kRadii),
      open_loops(kDrives),
      loop_responses(kDrives),
      plan_distances(kModels) {}

void add(system::MemoKey& key, const JointLayout& layout) {
  const auto& [axes] = layout;
  for (const auto& axis : axes) {
    key.add(axis.has_value());
    if (axis) key.add(*axis);
  }
}

void add(system::MemoKey& key, const plant::MachineChain& chain) {
  const auto& [axes, layout] = chain;
  key.add(axes.size());
  for (const auto& [axis, side, joint, centre, sense, R_MA, is_inclined] : axes) {
    key.add(axis);
    key.add(side);
    key.add(joint);
    key.add(centre);
    key.add(sense);
    for (int i = 0; i < 3; ++i) key.add(Eigen::Vector3d(R_MA.col(i)));
    key.add(is_inclined);
  }
  add(key, layout);
}

void add(system::MemoKey& key, const plant::ErrorModel& errors) {
  for (const auto& of_axis : errors.components) {
    for (const plant::ErrorFunction& function : of_axis) add(key, function);
  }
  for (const AxisWords& location : errors.locations) key.add(location);
}

void add(system::MemoKey& key, const controllers::ProgramSetup& setup) {
  const auto& [stored, parameters, work_offset, work_rotation, work_system, tools, tool, reader,
               takes_five_axis_codes, decimal_point, feed, additional_offsets, ignored_codes,
               refuses_code, accepts_unknown_lengths, accepts_unknown_dwells,
               accepts_unknown_positions, accepts_unknown_feeds, is_trial, start, block_delete,
               subroutine_file, most_jumps, machine, probed, trials] = setup;
  static_cast<void>(refuses_code);  // of checks, which are not kept
  static_cast<void>(trials);        // what it holds follows from the program and the setup
  static_cast<void>(probed);        // whoever sets it adds what its answers depend on
  key.add(stored.size());
  for (const auto& [number, value] : stored) {
    key.add(number);
    key.add(value);
  }
  key.add(parameters.size());
  for (const auto& [name, value] : parameters) {
    key.add(name);
    key.add(value);
  }
  for (const AxisWords& offset : work_offset) key.add(offset);
  for (const double rotation : work_rotation) key.add(rotation);
  key.add(work_system);
  add(key, tools);
  key.add(tool);
  key.add(static_cast<int>(reader));
  key.add(takes_five_axis_codes);
  key.add(static_cast<int>(decimal_point));
  key.add(feed.value_or(0.0));
  key.add(additional_offsets.size());
  for (const auto& [number, offset] : additional_offsets) {
    key.add(number);
    key.add(offset);
  }
  key.add(ignored_codes.size());
  for (const int code : ignored_codes) key.add(code);
  key.add(accepts_unknown_lengths);
  key.add(accepts_unknown_dwells);
  key.add(accepts_unknown_positions);
  key.add(accepts_unknown_feeds);
  key.add(is_trial);
  key.add(start);
  key.add(block_delete);
  key.add(most_jumps);  // texts of subroutines are of the program
  key.add(machine != nullptr);
  if (machine == nullptr) return;
  add(key, machine->chain());
  key.add(machine->inverse().settings().lower);
  key.add(machine->inverse().settings().upper);
  key.add(machine->axis_tolerance());
  key.add(machine->upper_travel());
}

void add(system::MemoKey& key, const controllers::JointLimits& limits) {
  const auto& [v, a, j] = limits;
  key.add(v);
  key.add(a);
  key.add(j);
}

void add(system::MemoKey& key, const controllers::PathOptions& options) {
  const auto& [tolerance, exact_tolerance, exact_corner, rotary_tolerance, rotary_radius,
               feed_override, rapid_override, tolerance_share, spindle_acceleration, block_time,
               stretch, plans_in_memory] = options;
  for (const double value :
       {tolerance, exact_tolerance, exact_corner, rotary_tolerance, rotary_radius, feed_override,
        rapid_override, tolerance_share, spindle_acceleration, block_time}) {
    key.add(value);
  }
  key.add(stretch);
  key.add(plans_in_memory);
}

void add_linear_axis(system::MemoKey& key, const model::MachineSettings& linear, int joint) {
  const auto j = static_cast<std::size_t>(joint);
  const auto& [base, position, velocity, current] = linear.nc.periods;
  key.add(base);
  for (const Tick period : {position, velocity, current}) key.add(period);
  {
    const auto& [kind, r, J, M, k, c, gap, b_motor, b_load, Kt, i_max, T_i, L, R, Ke, F_load,
                 friction, cogging, bed, solver_tolerance] = linear.drives[j];
    key.add(kind);
    for (const double value : {r, J, M, k, c, gap, b_motor, b_load, Kt, i_max, T_i, L, R, Ke,
                               F_load, bed.M, bed.w, bed.zeta, solver_tolerance}) {
      key.add(value);
    }
  }
  {
    const auto& [Kv, kvf, kaf, Kp, Ki, r, Kt, J, i_max, Tv, v_max, tau_max, di_max, filters] =
        linear.nc.cascade[j];
    for (const double value : {Kv, kvf, kaf, Kp, Ki, r, Kt, J, i_max, Tv, v_max, tau_max, di_max}) {
      key.add(value);
    }
    add(key, filters);
  }
  const auto& [current_loop, position_feedback, friction, backlash, supervision] =
      linear.nc.functions[j];
  const auto& [Kp, Ki, u_max, Ti] = current_loop;
  for (const double value : {Kp, Ki, u_max, Ti}) key.add(value);
  const auto& [kind, gain] = position_feedback;
  key.add(kind);
  key.add(gain);
}

}  // namespace servomill::sim::preparation
