#include "sim/engine/recorder.h"

#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "plant/heat/temperature.h"
#include "plant/kinematics/inverse.h"
#include "plant/vocabulary/units.h"
#include "sim/engine/recorded_row.h"
#include "sim/engine/recorded_signals.h"
#include "sim/model/heat.h"

namespace servomill::sim::engine {
namespace {

using records::Signal;

constexpr std::size_t kBlockRows = 1024;

}  // namespace

class Recorder::Rows {
 public:
  Rows(const model::MachineSettings& machine, const plant::VolumetricModel& machine_errors,
       const plant::VolumetricModel* imposed, const ProgramPath& path,
       const std::map<int, Eigen::Vector3d>& tips, const model::RecordFormat& format,
       bool rotary_displaced, std::vector<const strategies::Strategy*> correcting, bool cuts,
       records::RowKeeping keeping, bool teeth, bool oriented, bool windows)
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
        keeping_(std::move(keeping)),
        oriented_(oriented),
        windows_(windows) {
    for (int joint = 0; joint < kJoints; ++joint) {
      if (!machine.chain.layout.has(joint)) continue;
      (joint < kLinearJoints ? linear_ : rotary_).push_back(joint);
    }
    std::vector<Signal> all =
        recorded_signals(machine, {.imposed = imposed != nullptr,
                                   .uncorrectable = !correcting_.empty(),
                                   .cut = cuts_,
                                   .teeth = teeth_,
                                   .programmed = keeping_.thinning.has_value(),
                                   .oriented = oriented_,
                                   .windows = windows_});
    round_to(format, all);
    const records::Series columns(std::move(all));
    signals_ = columns.signals();
    width_ = columns.width();
    rounding_ = Rounding(columns);
  }

  void expect(std::size_t rows) { keeper_.emplace(signals_, keeping_, rows); }

  records::Series take() {
    if (!keeper_) expect(0);
    return keeper_->take();
  }

  /// @param errors  of the machine from here on
  void use(const plant::VolumetricModel& errors, const std::vector<double>& temperatures) {
    machine_errors_ = &errors;
    temperatures_ = temperatures;
  }

  void add(const std::vector<Snapshot>& block, std::span<const double> directions) {
    const std::size_t plays = machine_errors_->plays().size();
    if (!keeper_) expect(0);
    rows_.resize(block.size() * width_);
    double* row = rows_.data();
    for (std::size_t first = 0; first < block.size();) {
      const std::size_t end = find_places(block, first);
      find_poses(directions.subspan(first * plays, (end - first) * plays));
      for (std::size_t n = first; n < end; ++n) {
        make_row(block[n], n - first, row);
        rounding_.apply(row);
        row += width_;
      }
      first = end;
    }
    keeper_->add(rows_);
  }

 private:
  std::size_t find_places(const std::vector<Snapshot>& block, std::size_t first);
  Joints ideal_joints(const Joints& Q_true, int tool_offset) const;
  void find_actual(const Eigen::Vector3d& p_ST, std::span<const double> directions,
                   std::vector<ToolPose>& out) const;
  void find_sides(std::span<const double> directions);
  void find_poses(std::span<const double> directions);
  void displace_tip(const Snapshot& now, Eigen::Vector3d& p_WT) const;
  void make_row(const Snapshot& now, std::size_t place, double* to);
  void put_structure(const Snapshot& now, RowWriter& row) const;
  void put_residual(std::size_t place, RowWriter& row) const;

  const model::MachineSettings& machine_;
  const plant::VolumetricModel* machine_errors_;
  std::vector<double> temperatures_;  // K
  const plant::VolumetricModel* imposed_;
  const ProgramPath& path_;
  const std::map<int, Eigen::Vector3d>& tips_;
  const bool rotary_displaced_;
  const std::vector<const strategies::Strategy*> correcting_;
  const bool cuts_;
  const bool teeth_;
  const bool bends_;    // under acceleration
  const bool has_bed_;  // that moves
  const plant::VolumetricModel ideal_{machine_.chain, {}};
  const plant::InverseKinematics inverse_{machine_.chain};
  std::vector<int> linear_, rotary_;  // joints that the machine has
  // of rows that follow each other with the same tool
  Eigen::Vector3d p_ST_ = Eigen::Vector3d::Zero();
  std::vector<std::size_t> pieces_;
  std::vector<Joints> Q_prog_, Q_true_;
  std::vector<ToolPose> nominal_, actual_;
  std::vector<Eigen::Vector3d> displacement_, side_;
  const records::RowKeeping keeping_;
  const bool oriented_;  // the direction across the tool axis is recorded
  const bool windows_;   // rows outside of some are left out
  std::vector<Signal> signals_;
  std::size_t width_ = 0;
  Rounding rounding_{records::Series()};
  std::vector<double> rows_;  // of a block
  std::optional<records::RowKeeper> keeper_;
};

// Finds the places in the original program, from row `first` to the next change of the tool;
// returns the row of that.
std::size_t Recorder::Rows::find_places(const std::vector<Snapshot>& block, std::size_t first) {
  pieces_.clear();
  Q_prog_.clear();
  Q_true_.clear();
  int tool = 0;
  for (std::size_t n = first; n < block.size(); ++n) {
    const Snapshot& now = block[n];
    const ProgramPath::Piece piece = path_.piece(now.piece);
    if (n == first) tool = piece.tool_offset;
    if (piece.tool_offset != tool) return n;
    const bool by_turn = rotary_displaced_ && piece.s_end == piece.s_begin;
    const Joints Q_near = by_turn ? ideal_joints(now.Q_true, piece.tool_offset) : now.Q_ref;
    pieces_.push_back(now.piece);
    Q_prog_.push_back(path_.joints(now.piece, now.s, machine_.chain.layout, Q_near));
    Q_true_.push_back(now.Q_true);
  }
  return block.size();
}

// Joints of the ideal machine for the actual pose of the tool.
Joints Recorder::Rows::ideal_joints(const Joints& Q_true, int tool_offset) const {
  const auto tip = tips_.find(tool_offset);
  const Eigen::Vector3d p_ST = tip == tips_.end() ? Eigen::Vector3d::Zero() : tip->second;
  return inverse_.nearest(machine_errors_->forward(Q_true, p_ST), p_ST, Q_true).Q;
}

// Computes the poses of the machine with errors for a tip in the spindle nose.
void Recorder::Rows::find_actual(const Eigen::Vector3d& p_ST, std::span<const double> directions,
                                 std::vector<ToolPose>& out) const {
  out.resize(Q_true_.size());
  if (directions.empty()) {
    machine_errors_->poses(Q_true_, p_ST, out);
  } else {
    machine_errors_->poses(Q_true_, p_ST, directions, out);
  }
}

// Finds the directions across the tool axis: where a tip goes that is 1 m farther along X.
void Recorder::Rows::find_sides(std::span<const double> directions) {
  std::vector<ToolPose> beside;
  find_actual(p_ST_ + Eigen::Vector3d::UnitX(), directions, beside);
  side_.clear();
  for (std::size_t i = 0; i < beside.size(); ++i) {
    side_.push_back(beside[i].p_WT - actual_[i].p_WT);
  }
}

// Computes the actual and the nominal pose of the tool.
void Recorder::Rows::find_poses(std::span<const double> directions) {
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
void Recorder::Rows::displace_tip(const Snapshot& now, Eigen::Vector3d& p_WT) const {
  if (cuts_ || bends_) {
    p_WT += plant::linear_jacobian(machine_.chain, now.Q_true) *
            (now.deflection + now.inertial_deflection);
  }
  if (!machine_.heat || !machine_.heat->part) return;
  const model::PartExpansion& part = *machine_.heat->part;
  const double T = temperatures_[static_cast<std::size_t>(part.body)];
  p_WT = part.measured(p_WT, T - machine_.heat->reference);
}

void Recorder::Rows::make_row(const Snapshot& now, std::size_t place, double* to) {
  const ProgramPath::Piece piece = path_.piece(pieces_[place]);
  displace_tip(now, actual_[place].p_WT);
  const ToolPose &nominal = nominal_[place], &actual = actual_[place];
  const auto place_on_path = [&]() -> std::optional<Eigen::Vector3d> {
    if (piece.is_tip) return actual.p_WT;
    const auto Q = plant::inverse_fixed_rotary(machine_.chain, actual.p_WT, Q_prog_[place], p_ST_);
    if (!Q) return std::nullopt;
    return Q->head<3>();
  }();
  const double contour_error = place_on_path ? path_.distance(*place_on_path, pieces_[place])
                                             : (actual.p_WT - nominal.p_WT).norm();

  RowWriter row(to);
  row.put(now.time);
  row.put(now.s / mm);
  row.put(piece.line);
  row.put(piece.section);
  row.put(piece.rapid ? 1.0 : 0.0);
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
  row.put(contour_error / um);
  if (oriented_) row.put(side_[place], 1.0);
  if (!correcting_.empty()) put_residual(place, row);
  put_structure(now, row);
  for (const double T : temperatures_) row.put(celsius(T));
  if (keeping_.thinning) row.put(Q_prog_[place], linear_, mm);
  if (windows_) row.put(now.window);
  if (windows_) row.put(now.in_window);
}

// Force, and how the structure and the bed give way.
void Recorder::Rows::put_structure(const Snapshot& now, RowWriter& row) const {
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

void Recorder::Rows::put_residual(std::size_t place, RowWriter& row) const {
  strategies::Residual sum;
  for (const strategies::Strategy* strategy : correcting_) {
    const auto left = strategy->uncorrectable(Q_prog_[place]).value_or(strategies::Residual{});
    sum.tip += left.tip;
    sum.axis += left.axis;
  }
  row.put(sum.tip / um);
  row.put(sum.axis / urad);
}

Recorder::Recorder(const model::MachineSettings& machine,
                   const plant::VolumetricModel& machine_errors,
                   const plant::VolumetricModel* imposed, const ProgramPath& path,
                   const std::map<int, Eigen::Vector3d>& tips, const model::RecordFormat& format,
                   bool rotary_displaced, std::vector<const strategies::Strategy*> correcting,
                   bool cuts, records::RowKeeping keeping, bool teeth, bool oriented,
                   RecordingWindows windows)
    : rows_(std::make_unique<Rows>(machine, machine_errors, imposed, path, tips, format,
                                   rotary_displaced, std::move(correcting), cuts,
                                   std::move(keeping), teeth, oriented, windows.limited())),
      path_(path),
      windows_(std::move(windows)) {
  filling_.snapshots.reserve(kBlockRows);
  filling_.directions.reserve(kBlockRows * machine_errors.plays().size());
}

Recorder::~Recorder() = default;

void Recorder::expect(std::size_t rows) { rows_->expect(rows); }

void Recorder::record(const Snapshot& now, std::span<const double> directions) {
  if (!windows_.limited()) return add(now, directions);
  const bool inside = windows_.contains(now.piece, now.time);
  if (!inside) count_outside(now.piece);
  if (inside || was_inside_) {  // or it is the first row, or the one after a window
    if (!held_.snapshots.empty()) add_held();
    add(now, directions, inside);
  } else {
    has_gap_ |= !held_.snapshots.empty();
    held_.snapshots.assign(1, now);
    held_.directions.assign(directions.begin(), directions.end());
    held_.machine_errors = filling_.machine_errors;
    held_.temperatures = filling_.temperatures;
  }
  was_inside_ = inside;
}

void Recorder::count_outside(std::size_t piece) {
  left_out_.resize(path_.sections().size());
  if (!path_.is_rapid(piece)) ++left_out_[static_cast<std::size_t>(path_.section(piece))];
}

// Adds the row that is held, with the errors of the machine at its time.
void Recorder::add_held() {
  auto errors_now = filling_.machine_errors;
  auto temperatures_now = filling_.temperatures;
  const bool differs = held_.machine_errors != errors_now;
  if (differs) use(held_.machine_errors, held_.temperatures);
  add(held_.snapshots.front(), held_.directions, false);
  held_.snapshots.clear();
  if (differs) use(std::move(errors_now), std::move(temperatures_now));
}

void Recorder::add(const Snapshot& now, std::span<const double> directions, bool inside) {
  if (has_gap_) window_ += 1.0;
  has_gap_ = false;
  filling_.snapshots.push_back(now);
  filling_.snapshots.back().window = window_;
  filling_.snapshots.back().in_window = inside ? 1.0 : 0.0;
  filling_.directions.insert(filling_.directions.end(), directions.begin(), directions.end());
  if (filling_.snapshots.size() == kBlockRows) hand_over();
}

void Recorder::use(std::shared_ptr<const plant::VolumetricModel> machine_errors,
                   std::vector<double> temperatures) {
  if (!filling_.snapshots.empty()) hand_over();
  filling_.machine_errors = std::move(machine_errors);
  filling_.temperatures = std::move(temperatures);
}

void Recorder::hand_over() {
  background_.wait();
  std::swap(filling_, working_);
  filling_.machine_errors = working_.machine_errors;
  filling_.temperatures = working_.temperatures;
  filling_.snapshots.reserve(kBlockRows);
  filling_.snapshots.clear();
  filling_.directions.reserve(working_.directions.size());
  filling_.directions.clear();
  background_.post([this] { make_rows(working_); });
}

void Recorder::make_rows(const Block& block) {
  if (block.machine_errors) rows_->use(*block.machine_errors, block.temperatures);
  rows_->add(block.snapshots, block.directions);
}

records::Series Recorder::take() {
  if (!held_.snapshots.empty()) add_held();
  background_.wait();
  make_rows(filling_);
  filling_ = {};
  return rows_->take();
}

}  // namespace servomill::sim::engine
