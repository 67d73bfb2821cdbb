#include "sim/input/read_machine.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "plant/drives/drive_rates.h"
#include "plant/kinematics/structure.h"
#include "plant/vocabulary/units.h"
#include "sim/input/machine_description.h"
#include "sim/input/machine_document.h"
#include "sim/input/read_bed.h"
#include "sim/input/read_drive.h"
#include "sim/input/read_encoder.h"
#include "sim/input/read_errors.h"
#include "sim/input/read_heat.h"
#include "sim/input/read_inertial_deflection.h"
#include "sim/input/read_loop_periods.h"
#include "sim/input/read_program.h"
#include "sim/input/read_servo.h"
#include "sim/input/read_structural_modes.h"
#include "sim/model/scenario.h"

namespace servomill::sim::input {
namespace {

constexpr std::array<std::string_view, 2> kIntegrators = {"exact", "cvode"};
constexpr std::array<std::string_view, 2> kSenses = {"tool", "table"};

constexpr std::string_view kRetractKey = "retract_mm";

constexpr double kFinestSolver = 1e-14;  // m; what rounding leaves of a position of 1 m is 1e-16
constexpr double kCoarsestSolver = 1 * um;

// SI; far from any machine, and near enough that a path can be planned with them.
constexpr double kMinLimit = 1e-6, kMaxLimit = 1e7;

void read_dynamic_limits(config::Reader& axis, bool linear, int j, model::NcSettings& nc) {
  const AxisQuantities& q = quantities_of(linear);
  nc.v_max[j] =
      axis.real("v_max", q.velocity, {config::at_least(kMinLimit), config::at_most(kMaxLimit)});
  nc.a_max[j] =
      axis.real("a_max", q.acceleration, {config::at_least(kMinLimit), config::at_most(kMaxLimit)});
  nc.j_max[j] =
      axis.real("j_max", q.jerk, {config::at_least(kMinLimit), config::at_most(kMaxLimit)});
}

void read_travel(config::Reader& axis, bool linear, int j, model::NcSettings& nc) {
  const AxisQuantities& q = quantities_of(linear);
  const std::string_view key = linear ? "travel_mm" : "travel_deg";
  nc.lower[j] = -std::numeric_limits<double>::infinity();
  nc.upper[j] = std::numeric_limits<double>::infinity();
  if (!axis.has(key)) return;  // endless
  const std::size_t before = axis.faults();
  const auto travel = axis.reals(key, q.position);
  if (axis.faults() > before) return;
  if (travel.size() != 2 || !(travel[0] < travel[1])) {
    axis.fault(key, "must be [lower, upper] with lower < upper");
    return;
  }
  nc.lower[j] = travel[0];
  nc.upper[j] = travel[1];
}

// Lengths of which the square is a number.
constexpr double kMinDirection = 1e-100, kMaxDirection = 1e100;

// Settings that all axes of the machine share.
struct Common {
  CommonServo servo;
  Place Kv_place;
  plant::FrictionKind friction_model = plant::FrictionKind::none;
  std::uint64_t noise_seed = 0;
};

Place winding_place(config::Reader& axis) {
  return axis.has("winding") ? axis.table("winding").place("bandwidth") : Place{};
}

// An axis begins at rest, with the current that its load needs.
void refuse_unbearable_load(config::Reader& axis, const plant::FeedDriveParams& drive,
                            const controllers::CascadeParams& cascade, bool linear) {
  const double most = std::min(cascade.i_max * drive.Kt, cascade.tau_max) / drive.r;
  if (!(std::abs(drive.F_load) > most)) return;
  axis.fault("gravity_load", fmt::format("must be <= {:g} {}, the maximum at the current limit",
                                         most, linear ? "N" : "Nm"));
}

void read_direction(config::Reader& axis, plant::ChainAxis& chain_axis) {
  if (!axis.has("direction")) return;
  const std::size_t before = axis.faults();
  const auto direction = axis.reals("direction", config::kNumber);
  if (axis.faults() > before) return;
  if (is_linear(chain_axis.axis)) {
    axis.fault("direction", "must not be given: only rotary axes can be inclined");
    return;
  }
  const Eigen::Vector3d d =
      direction.size() == 3 ? Eigen::Vector3d(direction.data()) : Eigen::Vector3d::Zero();
  if (d.norm() >= kMinDirection && d.norm() <= kMaxDirection) {
    plant::incline(chain_axis, d);
  } else {
    axis.fault("direction", "must be [x, y, z], not all 0; the length is irrelevant");
  }
}

// Direction and offset of the axis.
void read_axis_geometry(config::Reader& axis, int j, model::MachineSettings& machine) {
  const auto lane = static_cast<std::size_t>(j);
  const bool linear = j < kLinearJoints;
  if (axis.has(kRetractKey))
    axis.real(kRetractKey, config::kLength);  // of programs, not of a simulation
  auto& chain_axis = machine.chain.at(*machine.chain.layout.axis[lane]);
  if (!linear) {
    chain_axis.sense = static_cast<plant::Sense>(axis.choice_or("sense", 0, kSenses));
  }
  read_direction(axis, chain_axis);
  if (axis.has("centre_mm")) {
    const std::size_t before = axis.faults();
    const auto centre = axis.reals("centre_mm", config::kLength);
    if (axis.faults() > before) return;
    if (centre.size() == 3) {
      chain_axis.centre << centre[0], centre[1], centre[2];
    } else {
      axis.fault("centre_mm", "must be [x, y, z]");
    }
  }
}

void read_axis(config::Reader& axis, const Common& common, int j, model::MachineSettings& machine) {
  const auto lane = static_cast<std::size_t>(j);
  const bool linear = j < kLinearJoints;
  const std::size_t before_drive = axis.faults();
  plant::FeedDriveParams& drive = machine.drives[lane];
  drive = read_drive(axis, linear, common.friction_model);
  read_bed(axis, linear, machine.nc.periods.base, drive);
  const bool in_sub_steps =
      machine.integrator == model::Integrator::exact && (!drive.is_linear() || drive.on_bed());
  if (axis.faults() == before_drive && in_sub_steps) {
    const double base = machine.nc.periods.base;
    for (const std::string& why : plant::unrepresentable(drive, base)) {
      axis.fault(why + "; reduce it, shorten base_period_us or use integrator = \"cvode\"");
    }
  }
  if (linear && axis.has("structural_stiffness")) {
    const double stiffness =
        axis.real("structural_stiffness", config::kStiffness, {config::above(0.0)});
    if (stiffness > 0.0) machine.structural_compliance[j] = 1.0 / stiffness;
  }
  read_servo(axis, common.servo, j, machine);
  machine.nc.gain_place[lane] = {axis.has("Kv") ? axis.place("Kv") : common.Kv_place,
                                 axis.place("velocity_bandwidth"), winding_place(axis)};
  refuse_unbearable_load(axis, drive, machine.nc.cascade[lane], linear);
  read_dynamic_limits(axis, linear, j, machine.nc);
  read_travel(axis, linear, j, machine.nc);
  read_axis_geometry(axis, j, machine);
  read_encoders(axis, j, common.noise_seed, machine);  // marks lie within the travel
}

plant::MachineChain read_chain(config::Reader& machine) {
  const std::size_t before = machine.faults();
  const std::string text = machine.text("structure");
  if (machine.faults() > before) return {};
  try {
    return plant::make_chain(plant::parse_structure(text, machine.place("structure")));
  } catch (const InputError& error) {
    for (const Fault& fault : error.faults()) machine.fault("structure", fault.message);
    return {};
  }
}

}  // namespace

const AxisQuantities& quantities_of(bool linear) {
  static constexpr AxisQuantities kLinear = {
      config::kLength, config::kVelocity, config::kAcceleration, config::kJerk,
      config::kForce,  config::kMass,     config::kStiffness,    config::kDamping};
  static constexpr AxisQuantities kRotary = {config::kAngle,
                                             config::kAngularVelocity,
                                             config::kAngularAcceleration,
                                             config::kAngularJerk,
                                             config::kTorque,
                                             config::kInertia,
                                             config::kTorsionalStiffness,
                                             config::kTorsionalDamping};
  return linear ? kLinear : kRotary;
}

AxisWords read_words(config::Reader& table, const JointLayout& layout) {
  AxisWords words = AxisWords::Zero();
  for (const Axis axis : kAllAxes) {
    if (!layout.joint_of(axis)) continue;
    const bool linear = is_linear(axis);
    const std::string key = fmt::format("{}_{}", letter(axis), linear ? "mm" : "deg");
    words[index_of(axis)] = table.real_or(key, 0.0, linear ? config::kLength : config::kAngle);
  }
  return words;
}

namespace {

using ErrorModels = std::map<std::string, plant::ErrorModel>;

void read_models(config::Reader& table, const model::MachineSettings& machine,
                 ErrorModels* errors) {
  if (!table.has("errors")) return;
  config::Reader models = table.table("errors");
  auto read = read_error_models(models, MachineAxes(machine));
  if (errors != nullptr) *errors = std::move(read);
}

// Keys that every drive needs: a file with one of them is that of a machine to simulate.
bool describes_drives(const config::Document& machine) {
  constexpr std::array<std::string_view, 5> kNeeded = {"Kt", "moving_mass", "moving_inertia",
                                                       "motor_inertia", "i_max_A"};
  const config::Value* axes = machine.root().find("axis");
  if (axes == nullptr) return false;
  return std::any_of(axes->children.begin(), axes->children.end(), [&](const config::Value& axis) {
    return std::any_of(kNeeded.begin(), kNeeded.end(),
                       [&](std::string_view key) { return axis.find(key) != nullptr; });
  });
}

// For machines whose axes are not known, and for those without drives.
void skip_structure(config::Reader& table) {
  for (const char* key : {"inertial_deflection", "heat"}) table.raw(key);
}

std::optional<model::SpindleDrive> read_spindle(config::Reader& nc) {
  if (!nc.has("spindle")) return std::nullopt;
  config::Reader table = nc.table("spindle");
  model::SpindleDrive out;
  out.acceleration =
      table.real("acceleration_rpm_per_s", config::kAngularAcceleration, {config::above(0.0)});
  if (table.has("Kv")) out.Kv = table.real("Kv", config::kRate, {config::above(0.0)});
  out.velocity_feed_forward = table.real_or("velocity_feed_forward", 0.0, config::kNumber,
                                            {config::at_least(0.0), config::at_most(1.0)});
  return out;
}

// The reading and planning of programs.
void read_planning(config::Reader& nc, model::NcSettings& out) {
  out.program_reader =
      static_cast<controllers::Reader>(nc.choice_or("reader", 0, controllers::kReaders));
  out.decimal_point = static_cast<controllers::DecimalPoint>(
      nc.choice_or("decimal_point", 0, controllers::kDecimalPoints));
  out.ignored_codes = read_ignored_codes(nc, {});
  out.path_tolerance =
      nc.real_or("path_tolerance_um", 10 * um, config::kLength, {config::above(0.0)});
  out.rotary_tolerance =
      nc.real_or("rotary_tolerance_urad", 100 * urad, config::kAngle, {config::above(0.0)});
  out.block_time = nc.real_or("block_processing_time_ms", 0.0, config::kTime,
                              {config::at_least(0.0), config::at_most(kLongestPeriod)});
  if (nc.has("tool_change_time_s")) {
    out.tool_change_time = nc.real("tool_change_time_s", config::kTime, {config::at_least(0.0)});
  }
  if (nc.has("spindle_time_s")) {
    out.spindle_time = nc.real("spindle_time_s", config::kTime, {config::at_least(0.0)});
  }
  out.spindle = read_spindle(nc);
}

// A machine file without drives: structure, travel, limits, errors.
model::MachineSettings read_geometry(config::Reader& table, ErrorModels* errors) {
  model::MachineSettings machine;
  machine.name = table.text_or("name", "unnamed machine");
  table.text_or("source", "");
  machine.chain = read_chain(table);
  config::Reader nc = table.table_or_empty("nc");
  read_planning(nc, machine.nc);
  for (const std::string& key : nc.keys()) nc.raw(key);  // those of the loops
  skip_structure(table);
  machine.structural_modes = read_structural_modes(table, 0.0);
  if (machine.chain.layout == JointLayout{}) {  // a faulty structure: its axes are not known
    table.raw("axis");
    table.raw("errors");
    return machine;
  }
  machine.nc.lower.setConstant(-std::numeric_limits<double>::infinity());
  machine.nc.upper.setConstant(std::numeric_limits<double>::infinity());
  config::Reader axes = table.table_or_empty("axis");
  for (int j = 0; j < kJoints; ++j) {
    const std::string name(1,
                           machine.chain.layout.has(j) ? machine.chain.layout.letter_of(j) : ' ');
    if (!axes.has(name)) continue;
    config::Reader axis = axes.table(name);
    const std::array<std::string_view, 3> limits = {"v_max", "a_max", "j_max"};
    const AxisQuantities& q = quantities_of(j < kLinearJoints);
    const std::array<config::Quantity, 3> of = {q.velocity, q.acceleration, q.jerk};
    Joints* const into[] = {&machine.nc.v_max, &machine.nc.a_max, &machine.nc.j_max};
    for (std::size_t k = 0; k < limits.size(); ++k) {
      if (!axis.has(limits[k])) continue;
      (*into[k])[j] =
          axis.real(limits[k], of[k], {config::at_least(kMinLimit), config::at_most(kMaxLimit)});
    }
    read_travel(axis, j < kLinearJoints, j, machine.nc);
    read_axis_geometry(axis, j, machine);
  }
  read_models(table, machine, errors);
  return machine;
}

// Delay from the scale to the position feedback of the NC (ticks).
Tick read_scale_delay(config::Reader& nc, double base) {
  const double delay = nc.real_or("scale_delay_us", 0.0, config::kTime,
                                  {config::at_least(0.0), config::at_most(kLongestPeriod)});
  const auto delay_ticks = whole_ticks(delay, base);
  if (!delay_ticks) {
    nc.fault("scale_delay_us",
             fmt::format("must be an integer multiple of base_period_us = {:g}", base / us));
  }
  return delay_ticks.value_or(0);
}

}  // namespace

MachineDescription read_machine_description(const std::string& path,
                                            const std::vector<std::string>& changes) {
  InputFiles files;
  config::Document document = machine_document(path, files).document;
  for (const std::string& change : changes) document.set(change);
  return described(document);
}

MachineDescription described(const config::Document& document) {
  config::Reader root(document);
  MachineDescription out;
  out.has_drives = describes_drives(document);
  const auto machine = std::make_shared<const model::MachineSettings>(
      out.has_drives ? read_machine(root, &out.errors) : read_geometry(root, &out.errors));
  out.machine = machine;
  const bool has_axes = machine->chain.layout != JointLayout{};  // not with a faulty structure
  if (has_axes && root.has("axis") && root.table("axis").has("Z")) {
    config::Reader Z = root.table("axis").table("Z");
    if (Z.has(kRetractKey)) out.retract_Z = Z.real(kRetractKey, config::kLength);
  }
  root.finish();
  return out;
}

model::MachineSettings read_machine(config::Reader& table, ErrorModels* errors) {
  model::MachineSettings machine;
  machine.name = table.text_or("name", "unnamed machine");
  table.text_or("source", "");
  machine.chain = read_chain(table);
  config::Reader nc = table.table("nc");
  machine.nc.periods = read_periods(nc);
  machine.nc.filter = read_filter(nc, machine.nc.periods);
  read_planning(nc, machine.nc);
  machine.nc.check_stability = nc.boolean_or("check_stability", true);
  machine.scale_delay = read_scale_delay(nc, machine.nc.periods.base);

  machine.structural_modes = read_structural_modes(table, machine.nc.periods.base);
  machine.integrator =
      static_cast<model::Integrator>(table.choice_or("integrator", 0, kIntegrators));
  const double solver_tolerance =
      table.real_or("solver_tolerance_nm", plant::kSolverTolerance, config::kLength,
                    {config::at_least(kFinestSolver), config::at_most(kCoarsestSolver)});
  Common common;
  common.servo = read_common_servo(nc);
  common.Kv_place = nc.place("Kv");
  common.friction_model =
      static_cast<plant::FrictionKind>(table.choice_or("friction_model", 0, friction_models()));
  common.noise_seed =
      static_cast<std::uint64_t>(table.integer_or("noise_seed", 0, {config::at_least(0.0)}));

  if (machine.chain.layout == JointLayout{}) {  // a faulty structure: its axes are not known
    for (const char* key : {"axis", "errors"}) table.raw(key);
    skip_structure(table);
    return machine;
  }
  config::Reader axes = table.table("axis");
  for (int j = 0; j < kJoints; ++j) {
    if (!machine.chain.layout.has(j)) continue;
    config::Reader axis = axes.table(std::string(1, machine.chain.layout.letter_of(j)));
    read_axis(axis, common, j, machine);
    machine.drives[static_cast<std::size_t>(j)].solver_tolerance = solver_tolerance;
  }
  machine.inertial_compliances = read_inertial_deflection(table, machine);
  machine.heat = read_heat(table, machine);
  read_models(table, machine, errors);
  return machine;
}

}  // namespace servomill::sim::input
