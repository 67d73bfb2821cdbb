#include "sim/engine/recorded_rows.h"

#include <algorithm>
#include <utility>

#include "plant/heat/temperature.h"
#include "plant/vocabulary/units.h"
#include "sim/engine/recorded_signals.h"
#include "sim/model/heat.h"
#include "sim/model/machine.h"

namespace servomill::sim::engine {

using records::Signal;

namespace {

records::RowKeeping kept_with(records::RowKeeping keeping, const RunOutputs& outputs) {
  keeping.encodes_beside = outputs.makes_rows_beside;
  return keeping;
}

}  // namespace

RecordedRows::RecordedRows(const model::MachineSettings& machine,
                           const plant::VolumetricModel& machine_errors,
                           const plant::VolumetricModel* imposed, const ProgramPath& path,
                           const std::map<int, Eigen::Vector3d>& tips,
                           const model::RecordFormat& format, bool rotary_displaced,
                           std::vector<const strategies::Strategy*> correcting, bool cuts,
                           records::RowKeeping keeping, bool teeth, bool oriented, bool windows,
                           const RunOutputs& outputs)
    : machine_(machine),
      machine_errors_(&machine_errors),
      imposed_(imposed),
      path_(path),
      tips_(tips),
      rotary_displaced_(rotary_displaced),
      correcting_(std::move(correcting)),
      cuts_(cuts),
      teeth_(teeth),
      bends_(!machine.inertial_compliances.empty()),
      has_bed_(stands_on_bed(machine)),
      keeping_(kept_with(std::move(keeping), outputs)),
      oriented_(oriented),
      windows_(windows),
      wants_axes_(wants_axis_signals(outputs)),
      wants_contour_error_(outputs.wants("contour_error")) {
  for (int joint = 0; joint < kJoints; ++joint) {
    if (!machine.chain.layout.has(joint)) continue;
    (joint < kLinearJoints ? linear_ : rotary_).push_back(joint);
  }
  std::vector<Signal> all = recorded_signals(machine, {.imposed = imposed != nullptr,
                                                       .uncorrectable = !correcting_.empty(),
                                                       .cut = cuts_,
                                                       .teeth = teeth_,
                                                       .programmed = keeping_.thinning.has_value(),
                                                       .oriented = oriented_,
                                                       .windows = windows_});
  round_to(format, all);
  if (outputs.signals) choose(outputs, all);
  const records::Series columns(std::move(all));
  signals_ = columns.signals();
  width_ = columns.width();
  rounding_ = Rounding(columns);
}

records::Series RecordedRows::take() {
  if (!keeper_) expect(0);
  records::Series series = keeper_->take();
  series.leave_out(left_out_);
  return series;
}

void RecordedRows::add(const std::vector<Snapshot>& block, std::span<const double> directions) {
  const std::size_t plays = machine_errors_->plays().size();
  if (!keeper_) expect(0);
  rows_.resize(block.size() * width_);
  double* row = rows_.data();
  for (std::size_t first = 0; first < block.size();) {
    const std::size_t end = find_places(block, first);
    find_poses(directions.subspan(first * plays, (end - first) * plays));
    for (std::size_t n = first; n < end; ++n) {
      if (chosen_.empty()) {
        make_row(block[n], n - first, row);
      } else {
        make_row(block[n], n - first, whole_row_.data());
        for (std::size_t c = 0; c < width_; ++c) row[c] = whole_row_[chosen_[c]];
      }
      rounding_.apply(row);
      row += width_;
    }
    first = end;
  }
  keeper_->add(rows_);
}

// Keeps the signals that are asked for, and those by which every row is found.
void RecordedRows::choose(const RunOutputs& outputs, std::vector<Signal>& signals) {
  std::vector<Signal> kept;
  std::size_t column = 0;
  for (Signal& signal : signals) {
    const std::size_t end = column + signal.columns();
    const bool is_kept =
        outputs.wants(signal.name) ||
        std::find(kOfEveryRow.begin(), kOfEveryRow.end(), signal.name) != kOfEveryRow.end();
    if (!is_kept) {
      left_out_.push_back(signal.name);
      column = end;
      continue;
    }
    for (; column < end; ++column) chosen_.push_back(column);
    kept.push_back(std::move(signal));
  }
  whole_row_.resize(column);
  signals = std::move(kept);
}

// Finds the places in the original program, from row `first` to the next change of the tool;
// returns the row of that.
std::size_t RecordedRows::find_places(const std::vector<Snapshot>& block, std::size_t first) {
  pieces_.clear();
  Q_prog_.clear();
  Q_true_.clear();
  int tool = 0;
  for (std::size_t n = first; n < block.size(); ++n) {
    const Snapshot& now = block[n];
    const int tool_offset = path_.tool_offset(now.piece);
    if (n == first) tool = tool_offset;
    if (tool_offset != tool) return n;
    const bool by_turn = rotary_displaced_ && path_.stands(now.piece);
    const Joints Q_near = by_turn ? ideal_joints(now.Q_true, tool_offset) : now.Q_ref;
    pieces_.push_back(now.piece);
    Q_prog_.push_back(path_.joints(now.piece, now.s, machine_.chain.layout, Q_near));
    Q_true_.push_back(now.Q_true);
  }
  return block.size();
}

// Joints of the ideal machine for the actual pose of the tool.
Joints RecordedRows::ideal_joints(const Joints& Q_true, int tool_offset) const {
  const auto tip = tips_.find(tool_offset);
  const Eigen::Vector3d p_ST = tip == tips_.end() ? Eigen::Vector3d::Zero() : tip->second;
  return inverse_.nearest(machine_errors_->forward(Q_true, p_ST), p_ST, Q_true).Q;
}

// Computes the poses of the machine with errors for a tip in the spindle nose.
void RecordedRows::find_actual(const Eigen::Vector3d& p_ST, std::span<const double> directions,
                               std::vector<ToolPose>& out) const {
  out.resize(Q_true_.size());
  if (directions.empty()) {
    machine_errors_->poses(Q_true_, p_ST, out);
  } else {
    machine_errors_->poses(Q_true_, p_ST, directions, out);
  }
}

// Finds the directions across the tool axis: where a tip goes that is 1 m farther along X.
void RecordedRows::find_sides(std::span<const double> directions) {
  std::vector<ToolPose> beside;
  find_actual(p_ST_ + Eigen::Vector3d::UnitX(), directions, beside);
  side_.clear();
  for (std::size_t i = 0; i < beside.size(); ++i) {
    side_.push_back(beside[i].p_WT - actual_[i].p_WT);
  }
}

// Computes the actual and the nominal pose of the tool.
void RecordedRows::find_poses(std::span<const double> directions) {
  const auto tip = tips_.find(path_.tool_offset(pieces_.front()));
  p_ST_ = tip == tips_.end() ? Eigen::Vector3d::Zero() : tip->second;
  nominal_.resize(Q_prog_.size());
  ideal_.poses(Q_prog_, p_ST_, nominal_);
  find_actual(p_ST_, directions, actual_);
  if (oriented_) find_sides(directions);
  if (imposed_ == nullptr) return;
  displacement_.resize(Q_prog_.size());
  imposed_->joint_offsets(Q_prog_, p_ST_, displacement_);
}

// Adds what the structure and the temperature of the part displace the tip by.
void RecordedRows::displace_tip(const Snapshot& now, Eigen::Vector3d& p_WT) const {
  if (cuts_ || bends_) {
    p_WT += plant::linear_jacobian(machine_.chain, now.Q_true) *
            (now.deflection + now.inertial_deflection);
  }
  if (!machine_.heat || !machine_.heat->part) return;
  const model::PartExpansion& part = *machine_.heat->part;
  const double T = temperatures_[static_cast<std::size_t>(part.body)];
  p_WT = part.measured(p_WT, T - machine_.heat->reference);
}

const plant::TipOfLinearJoints& RecordedRows::tip_at(const Joints& Q_rotary) {
  constexpr int kRotary = kJoints - kLinearJoints;
  if (!stand_ || stand_->Q_rotary.tail<kRotary>() != Q_rotary.tail<kRotary>() ||
      stand_->p_ST != p_ST_) {
    stand_ = {Q_rotary, p_ST_, plant::tip_of_linear_joints(machine_.chain, Q_rotary, p_ST_)};
  }
  return stand_->tip;
}

// The contour error (m) is measured where the program is defined: at the TCP under TCP control,
// else in axis coordinates with the rotary axes as programmed.
double RecordedRows::contour_error(std::size_t place) {
  const std::size_t piece = pieces_[place];
  const Eigen::Vector3d& p_WT = actual_[place].p_WT;
  if (path_.is_tip(piece)) return path_.distance(p_WT, piece);
  const Joints& Q_prog = Q_prog_[place];
  const auto Q = plant::inverse_fixed_rotary(machine_.chain, tip_at(Q_prog), p_WT, Q_prog);
  return Q ? path_.distance(Q->head<3>(), piece) : (p_WT - nominal_[place].p_WT).norm();
}

void RecordedRows::put_axes(const Snapshot& now, RowWriter& row) const {
  const auto per_axis = [&](const Joints& Q, double unit_linear, double unit_rotary) {
    row.put(Q, linear_, unit_linear);
    row.put(Q, rotary_, unit_rotary);
  };
  per_axis(now.Q_ref, mm, deg);
  per_axis(now.Q_cmd, mm, deg);
  per_axis(now.Q_fb, mm, deg);
  per_axis(now.Q_meas, mm, deg);
  per_axis(now.Q_true, mm, deg);
  per_axis(now.Q_cmd - now.Q_fb, um, deg);
  per_axis(now.dQ_true, mm, deg);
  per_axis(now.current, 1.0, 1.0);
  per_axis(now.torque, 1.0, 1.0);
}

// The order of the values is that of recorded_signals().
void RecordedRows::make_row(const Snapshot& now, std::size_t place, double* to) {
  const std::size_t piece = pieces_[place];
  displace_tip(now, actual_[place].p_WT);
  const ToolPose &nominal = nominal_[place], &actual = actual_[place];
  RowWriter row(to);
  row.put(now.time);
  row.put(now.s / mm);
  row.put(path_.line(piece));
  row.put(path_.section(piece));
  row.put(path_.is_rapid(piece) ? 1.0 : 0.0);
  if (wants_axes_) {
    put_axes(now, row);
  } else {
    row.skip(axis_signals() * (linear_.size() + rotary_.size()));
  }
  if (imposed_ != nullptr) {
    Joints displacement = Joints::Zero();
    displacement.head<3>() = displacement_[place];
    row.put(displacement, linear_, um);
  }
  row.put(nominal.p_WT, mm);
  row.put(actual.p_WT, mm);
  row.put(actual.p_WT - nominal.p_WT, um);
  row.put(nominal.k_W, 1.0);
  row.put(actual.k_W, 1.0);
  row.put(wants_contour_error_ ? contour_error(place) / um : 0.0);
  if (oriented_) row.put(side_[place], 1.0);
  if (!correcting_.empty()) put_residual(place, row);
  put_structure(now, row);
  for (const double T : temperatures_) row.put(celsius(T));
  if (keeping_.thinning) row.put(Q_prog_[place], linear_, mm);
  if (windows_) row.put(now.window);
  if (windows_) row.put(now.in_window);
}

// Force, and how the structure and the bed give way.
void RecordedRows::put_structure(const Snapshot& now, RowWriter& row) const {
  if (cuts_) {
    row.put(now.cutting_force, 1.0);
    for (const int joint : linear_) row.put(now.deflection[joint] / um);
  }
  if (teeth_) row.put(now.spindle_angle / deg);
  if (bends_) {
    for (const int joint : linear_) row.put(now.inertial_deflection[joint] / um);
  }
  if (has_bed_) {
    for (const int joint : linear_) row.put(now.bed[joint] / um);
  }
}

void RecordedRows::put_residual(std::size_t place, RowWriter& row) const {
  strategies::Residual sum;
  for (const strategies::Strategy* strategy : correcting_) {
    const auto left = strategy->uncorrectable(Q_prog_[place]).value_or(strategies::Residual{});
    sum.tip += left.tip;
    sum.axis += left.axis;
  }
  row.put(sum.tip / um);
  row.put(sum.axis / urad);
}

}  // namespace servomill::sim::engine
