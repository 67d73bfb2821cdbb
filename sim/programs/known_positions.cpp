#include "sim/programs/known_positions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controllers/gcode/canned_cycles.h"
#include "controllers/gcode/readers/plane_frame.h"
#include "controllers/gcode/request.h"
#include "sim/programs/compensate/work_knowledge.h"
#include "sim/programs/named_axes.h"

namespace servomill::sim::programs {
namespace {

using controllers::ExecutedBlock;

constexpr double kStill = 1e-12;  // m, rad: what rounding leaves of positions
constexpr std::size_t kZ = 2;

// Codes of the non-modal group, ten times.
constexpr int kG10 = 100, kG28 = 280, kG30 = 300, kG52 = 520, kG53 = 530, kG53_1 = 531, kG92 = 920,
              kG92_1 = 921, kG92_2 = 922;

bool names(const ExecutedBlock& block, std::size_t i) { return names_axis(block, kAllAxes[i]); }

bool names_any(const ExecutedBlock& block) {
  for (std::size_t i = 0; i < kAxisWords; ++i) {
    if (names(block, i)) return true;
  }
  return false;
}

bool differs(double a, double b) { return std::abs(a - b) > kStill; }

}  // namespace

std::string work_system_name(int system) {
  return system > kAdditionalSystem
             ? fmt::format("G54.1 P{}", system - kAdditionalSystem)
             : std::string(kWorkSystems[static_cast<std::size_t>(system - 1)]);
}

KnownPositions::Offsets KnownPositions::offsets_of(const ExecutedBlock& block) {
  const controllers::ModalState& state = *block.state;
  AxisWords work = state.work_offset;
  work.head<3>() += block.frame->translation;
  return {state.work_system,
          state.tool_offset_number,
          work,
          state.shift,
          state.tool_offset,
          state.sin_rotation != 0.0,
          state.controls_tip(),
          block.frame->additional_system,
          block.frame->is_translation_known,
          state.tool_control == ToolControl::tool_axis};
}

bool KnownPositions::tool_is_known(const Offsets& now) const {
  return now.tool == 0 || now.tool == controllers::kOtherToolOffset ||
         given_.tool_lengths.contains(now.tool);
}

// Machine coordinates follow from work coordinates. Under tool control X Y Z do not: they are those
// of the tip.
bool KnownPositions::offset_is_known(std::size_t i) const {
  const AxisFlags& work = given_.work_offset[static_cast<std::size_t>(offsets_.work_system - 1)];
  const auto is_known = [&](std::size_t k) { return work[k] && shift_[k]; };
  if (offsets_.controls_tip && i < kLinearJoints) return false;
  if (i == kZ && !tool_is_known(offsets_)) return false;
  if (offsets_.additional_system > 0 && i < kLinearJoints) {
    return offsets_.is_additional_known && shift_[i];
  }
  return i < 2 && offsets_.is_rotated ? is_known(0) && is_known(1) : is_known(i);
}

void GivenPlaces::learn_G10(const ExecutedBlock& block, const AxisFlags& position_is_known) {
  if (non_modal_code(block) != kG10) return;
  const auto& words = *block.request;
  const int L = static_cast<int>(std::lround(words['L']));
  int P = words.has('P') ? static_cast<int>(std::lround(words['P'])) : 0;
  if (L == 1 && words.has('Z')) tool_lengths.insert(P);
  if (L != 2 && L != 20) return;
  if (P == 0) P = block.state->work_system;
  if (P < 1 || P > controllers::kWorkSystems) return;
  AxisFlags& known = work_offset[static_cast<std::size_t>(P - 1)];
  for (std::size_t i = 0; i < kAxisWords; ++i) {
    if (names(block, i))
      known[i] = L == 2 ? known[i] || !block.state->is_incremental : position_is_known[i];
  }
}

void KnownPositions::follow_shift(const ExecutedBlock& block) {
  const int code = non_modal_code(block);
  if (code == kG92_1 || code == kG92_2) shift_.fill(true);
  for (std::size_t i = 0; i < kAxisWords; ++i) {
    if (!names(block, i)) continue;
    if (code == kG92) shift_[i] = machine_[i];
    if (code == kG52) shift_[i] = true;
  }
}

void KnownPositions::begin_line(const ExecutedBlock& block) {
  const Offsets before = offsets_;
  offsets_ = offsets_of(block);
  given_.learn_G10(block, machine_);
  follow_shift(block);
  const bool control_changes = before.controls_tip != offsets_.controls_tip;
  for (std::size_t i = 0; i < kAxisWords; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (control_changes && i < kLinearJoints) machine_[i] = work_[i] = false;
    const bool is_turned =
        !given_.has_machine && (offsets_.has_tool_axis || non_modal_code(block) == kG53_1);
    if (is_turned && i >= kLinearJoints) machine_[i] = work_[i] = false;
    const bool changes = before.work_system != offsets_.work_system ||
                         before.additional_system != offsets_.additional_system ||
                         differs(before.work[k], offsets_.work[k]) ||
                         differs(before.shift[k], offsets_.shift[k]) ||
                         differs(before.tool_offset[k], offsets_.tool_offset[k]) ||
                         (i == kZ && before.tool != offsets_.tool);
    if (changes) work_[i] = machine_[i] && offset_is_known(i);
    if (non_modal_code(block) == kG92 && names(block, i)) work_[i] = true;
  }
  at_begin_of_line_ = at_;
  work_at_begin_of_line_ = work_;
}

// G53 names machine coordinates; G28 and G30 go to places that the control has stored.
void KnownPositions::learn_place(const ExecutedBlock& block) {
  const bool is_given = non_modal_code(block) == kG53 || given_.has_stored_places;
  for (std::size_t i = 0; i < kAxisWords; ++i) {
    if (!names(block, i) && (non_modal_code(block) == kG53 || names_any(block))) continue;
    machine_[i] = is_given;
    work_[i] = is_given && offset_is_known(i);
  }
}

void KnownPositions::learn(const Move& move, const ExecutedBlock& block, bool is_last) {
  const bool is_cycle =
      block.request != nullptr && controllers::is_canned_cycle(block.request->motion_code());
  const auto normal = static_cast<std::size_t>(block.state->normal_axis);
  for (std::size_t i = 0; i < kAxisWords; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const bool is_absolute = !block.state->is_incremental;
    if (is_cycle && i == normal && !work_at_begin_of_line_[i]) {
      // a cycle begins at the height that it comes from, and may go back to it
      const bool goes_back = is_last && !block.state->retracts_to_r;
      work_[i] = is_absolute && !goes_back && differs(move.end_machine[k], at_begin_of_line_[k]);
    } else if (is_absolute && names(block, i)) {
      work_[i] = true;
    } else {
      continue;
    }
    machine_[i] = work_[i] && offset_is_known(i);
  }
}

// Inverts the transformation of the interpreter, machine = R work + offset: the interpreter
// computes with numbers for unknown positions, too, so that work and machine coordinates are
// tracked as known or not.
MoveKnowledge KnownPositions::next(const Move& move, const ExecutedBlock& block, bool is_last) {
  MoveKnowledge out;
  const double c = block.state->cos_rotation, s = block.state->sin_rotation;
  const auto turned = [&](AxisWords v, double sine) {
    v.head<2>() = Eigen::Vector2d(c * v[0] - sine * v[1], sine * v[0] + c * v[1]);
    return v;
  };
  const AxisWords offset = move.end_machine - turned(move.end, s);
  const bool is_additional = block.frame->additional_system > 0;
  out.work_system =
      is_additional ? kAdditionalSystem + block.frame->additional_system : move.work_offset;
  out.system_offset.head<3>() = block.frame->translation;
  out.is_tilted = block.state->plane != nullptr;
  out.begin_machine = at_;
  out.begin_work = turned(at_ - offset, -s);
  out.begin_work_is_known = work_;
  out.begin_machine_is_known = machine_;
  out.is_place = is_last && is_place_of_machine(block);
  out.is_place ? learn_place(block) : learn(move, block, is_last);
  out.end_work_is_known = work_;
  out.end_machine_is_known = machine_;
  const bool is_increment = block.state->is_incremental && !out.is_place;
  out.distance_is_known = true;
  for (std::size_t i = 0; i < kAxisWords; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const bool moves = names(block, i) || differs(move.end_machine[k], at_[k]);
    const bool is_known = (out.begin_work_is_known[i] && work_[i]) ||
                          (out.begin_machine_is_known[i] && machine_[i]) ||
                          (is_increment && names(block, i));
    if (moves && !is_known) out.distance_is_known = false;
  }
  at_ = move.end_machine;
  return out;
}

}  // namespace servomill::sim::programs
