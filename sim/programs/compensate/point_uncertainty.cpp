#include "sim/programs/compensate/point_uncertainty.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/input/uncertain_errors.h"
#include "sim/model/machine.h"
#include "sim/model/undetermined_errors.h"
#include "sim/model/unit_error.h"
#include "sim/programs/compensate/compensate.h"
#include "sim/programs/compensate/program_corrector.h"
#include "sim/system/json.h"

namespace servomill::sim::programs {
namespace {

constexpr double kUnmoved = 1e-12;    // m, rad: what rounding leaves of positions
constexpr double kJustBefore = 0.01;  // of a block

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// A number for JSON.
std::string um_text(double value) {
  return std::isnan(value) ? "null" : fmt::format("{:.4f}", value / um);
}

std::string three(const Eigen::Vector3d& v) {
  return fmt::format("[{}, {}, {}]", um_text(v[0]), um_text(v[1]), um_text(v[2]));
}

// "XZ"
std::string letters_of(const std::array<bool, 3>& which) {
  std::string out;
  for (std::size_t i = 0; i < 3; ++i) out += which[i] ? std::string(1, "XYZ"[i]) : "";
  return out;
}

}  // namespace

PointUncertainty::PointUncertainty(const plant::MachineChain& chain,
                                   const plant::ErrorModel& errors,
                                   const model::UncertainErrors& identified, bool keeps)
    : tip_(chain, identified), errors_(chain, errors), layout_(chain.layout), keeps_(keeps) {
  for (const plant::ErrorName& name :
       model::undetermined_errors(errors, identified, chain.layout)) {
    undetermined_.push_back({name, plant::VolumetricModel(chain, model::unit_error(name)), {}});
  }
}

std::array<bool, 3> PointUncertainty::undetermined_at(const Joints& Q,
                                                      const Eigen::Vector3d& p_ST) {
  std::array<bool, 3> out{};
  for (Undetermined& one : undetermined_) {
    const Eigen::Vector3d shift = one.unit.first_order_error(Q, p_ST).dp_W;
    for (std::size_t i = 0; i < 3; ++i) {
      const bool acts = std::abs(shift[Eigen::Index(i)]) > kUnmoved;
      one.acts[i] |= acts;
      out[i] |= acts;
    }
  }
  return out;
}

void PointUncertainty::add(const Step& step, const Correction& correction) {
  const ProgrammedMove& move = step.programmed;
  const bool is_feed = step.is_corrected && step.move->kind != MoveKind::rapid;
  for (const FittedBlock& block : step.blocks) {
    const AxisWords at = move.frame.machine(move.at(block.t_end));
    const double before = block.t_end - kJustBefore * (block.t_end - block.t_begin);
    const AxisWords way = at - move.frame.machine(move.at(before));
    for (int i = 0; i < kAxisWords; ++i) {
      if (std::abs(way[i]) > kUnmoved) directions_[i] = way[i] > 0.0 ? 1.0 : -1.0;
    }
    if (!is_feed) continue;
    add_point(step.move->line, at, correction.tool());
  }
}

void PointUncertainty::add_point(int line, const AxisWords& at, const Eigen::Vector3d& p_ST) {
  const Joints Q = layout_.joints(at);
  const Eigen::Matrix3Xd effects = tip_.effects(Q, p_ST, layout_.joints(directions_));
  const Eigen::Vector3d U = tip_.expanded(effects);
  const Eigen::Vector3d error = errors_.first_order_error(Q, p_ST).dp_W;
  if (count_ == 0) {
    first_effects_ = effects;
    first_error_ = error;
  }
  determination_.add(error - first_error_, tip_.expanded(effects - first_effects_));
  const std::array<bool, 3> undetermined = undetermined_at(Q, p_ST);
  Eigen::Vector3d stated = U;
  for (int i = 0; i < 3; ++i) {
    const auto k = std::size_t(i);
    const bool is_unknown = U[i] == 0.0 && undetermined[k];
    if (is_unknown) stated[i] = kUnknown;
    unknown_[k] |= is_unknown;
    known_[k] += is_unknown ? 0 : 1;
  }
  if (U.maxCoeff() > largest_.maxCoeff() || count_ == 0) largest_line_ = line;
  ++count_;
  largest_ = largest_.cwiseMax(U);
  squares_ += U.cwiseAbs2();
  if (keeps_) points_.push_back({line, at.head<3>(), stated});
}

Eigen::Vector3d PointUncertainty::rms() const {
  Eigen::Vector3d out = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    const std::size_t count = known_[std::size_t(i)];
    if (count > 0) out[i] = std::sqrt(squares_[i] / static_cast<double>(count));
  }
  return out;
}

std::vector<std::string> PointUncertainty::undetermined_names() const {
  std::vector<std::string> out;
  for (const Undetermined& one : undetermined_) {
    if (!letters_of(one.acts).empty()) out.push_back(plant::to_string(one.name));
  }
  return out;
}

void PointUncertainty::refuse_undetermined(const std::string& file,
                                           const std::array<bool, 3>& left) const {
  const auto i = determination_.undetermined(left);
  if (!i) return;
  const model::Determination& of = determination_.of(*i);
  throw InputError(
      {file}, fmt::format("the correction of {0} would change by up to {1:.3g} um over the program "
                          "with an uncertainty of up to {2:.3g} um (k = 2): not determined by the "
                          "calibration; leave {0} as programmed with --leave {0}, or take the "
                          "measurements that servomill calibrate names",
                          "XYZ"[*i], of.largest() / um, of.uncertainty() / um));
}

std::vector<std::string> PointUncertainty::report() const {
  const Eigen::Vector3d mean = rms();
  std::string out = "uncertainty of the corrected points (k = 2):";
  for (int i = 0; i < 3; ++i) {
    out += fmt::format("{} {} ", i == 0 ? "" : ",", "XYZ"[i]);
    out += is_unknown(i) ? "unknown"
                         : fmt::format("{:.2f} um (rms {:.2f})", largest_[i] / um, mean[i] / um);
  }
  std::vector<std::string> lines = {out + fmt::format("; largest in line {}", largest_line_)};
  std::vector<std::string> names;
  for (const Undetermined& one : undetermined_) {
    const std::string letters = letters_of(one.acts);
    if (letters.empty()) continue;
    names.push_back(fmt::format("{} ({})", plant::to_string(one.name), letters));
  }
  if (!names.empty()) {
    lines.push_back(
        fmt::format("not determined by the calibration, neither corrected nor in this "
                    "uncertainty: {}",
                    fmt::join(names, ", ")));
  }
  return lines;
}

std::string PointUncertainty::json() const {
  Eigen::Vector3d largest = largest_, mean = rms();
  for (int i = 0; i < 3; ++i) {
    if (is_unknown(i)) largest[i] = mean[i] = kUnknown;
  }
  return system::JsonObject(system::JsonSpacing::none)
      .raw("largest_um", three(largest))
      .raw("rms_um", three(mean))
      .integer("line", largest_line_)
      .integer("points", count_)
      .raw("undetermined", system::json_texts(undetermined_names()))
      .line();
}

std::string PointUncertainty::csv() const {
  std::string out = "line,X_mm,Y_mm,Z_mm,U_X_um,U_Y_um,U_Z_um\n";
  for (const Point& point : points_) {
    out += fmt::format("{},{:.6f},{:.6f},{:.6f}", point.line, point.machine[0] / mm,
                       point.machine[1] / mm, point.machine[2] / mm);
    for (const double U : point.expanded) {
      out += std::isnan(U) ? "," : fmt::format(",{:.4f}", U / um);
    }
    out += "\n";
  }
  return out;
}

std::shared_ptr<PointUncertainty> uncertainty_of(const CompensateRequest& request,
                                                 const plant::MachineChain& chain,
                                                 const std::string& model,
                                                 const plant::ErrorModel& errors) {
  const std::string& file = request.file_of_errors();
  const auto identified = input::uncertain_errors_of_file(file, model, chain.layout);
  if (identified) {
    return std::make_shared<PointUncertainty>(chain, errors, *identified,
                                              request.lists_uncertainty);
  }
  if (!request.lists_uncertainty) return nullptr;
  throw InputError({file}, fmt::format("has no covariance of the error model '{}' ([identified]); "
                                       "servomill calibrate -o writes it",
                                       model));
}

}  // namespace servomill::sim::programs
