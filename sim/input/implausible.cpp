#include "sim/input/implausible.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "controllers/servo/cascade.h"
#include "controllers/servo/current_loop.h"
#include "plant/drives/feed_drive.h"
#include "plant/drives/friction.h"
#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"

namespace servomill::sim::input {
namespace {

constexpr double kMinKv = 8.0;  // 1/s; 0.5 m/min/mm. Smaller numbers are meant in m/min/mm
constexpr double kAny = std::numeric_limits<double>::infinity();

// A value as its key has it, and the range outside which it is not that of a machine tool. 0 stands
// for "none" and infinity for "no limit": both are never implausible.
struct Plausible {
  const char* key;
  double value, min, max;
  const char* unit;
  const char* meant;  // with a unit that is easily forgotten
};
using Rows = std::vector<Plausible>;

double inverse(double x) { return x == 0.0 ? 0.0 : 1.0 / x; }

// Values with the same bounds on linear and rotary axes.
void add_common(const model::MachineSettings& machine, std::size_t j, Rows& rows) {
  const plant::FeedDriveParams& drive = machine.drives[j];
  const controllers::CascadeParams& cascade = machine.nc.cascade[j];
  const controllers::CurrentLoopParams& current = machine.nc.functions[j].current_loop;
  const double bandwidth = drive.has_winding() ? current.Kp / drive.L : 0.0;
  rows.insert(rows.end(),
              {{"Kv", cascade.Kv, kMinKv, 1e4, "1/s", "5 m/min/mm"},
               {"velocity_bandwidth", cascade.Kp / cascade.J, 0.5, 1e5, "rad/s", "200 rad/s"},
               {"torque_max", cascade.tau_max, 1e-3, 1e5, "Nm", "30 Nm"},
               {"i_max_A", drive.i_max, 1e-2, 1e4, "A", "50 A"},
               {"winding.inductance", drive.L, 1e-7, 1.0, "H", "4 mH"},
               {"winding.resistance", drive.R, 1e-4, 1e3, "ohm", "0.6 ohm"},
               {"winding.back_emf", drive.Ke, 1e-4, 1e3, "V s/rad", "1.6 V s/rad"},
               {"winding.bandwidth", bandwidth, 10.0, 1e6, "rad/s", "3000 rad/s"}});
}

void add_friction(const model::MachineSettings& machine, std::size_t j, bool linear, Rows& rows) {
  const plant::FrictionParams& f = machine.drives[j].friction;
  if (f.kind == plant::FrictionKind::none) return;
  const bool is_lugre = f.kind == plant::FrictionKind::lugre;
  const bool is_regularised = f.kind == plant::FrictionKind::regularised;
  const bool falls = f.Fs_positive != f.Fc_positive || f.Fs_negative != f.Fc_negative;
  const char* const force = linear ? "N" : "Nm";
  const char* const speed = linear ? "m/s" : "rad/s";
  const char* const slow = linear ? "2 mm/s" : "0.5 rpm";
  const double v_max = linear ? 1.0 : 100.0;
  rows.insert(
      rows.end(),
      {{"friction.coulomb", f.Fc_positive, 1e-2, 1e6, force, linear ? "450 N" : "8 Nm"},
       {"friction.breakaway", f.Fs_positive, 1e-2, 1e6, force, linear ? "560 N" : "9 Nm"},
       {"friction.viscous", std::max(f.b_positive, f.b_negative), 1e-3, 1e8,
        linear ? "N s/m" : "Nms/rad", linear ? "1.5 N s/mm" : "5 Nms/rad"},
       {"friction.stribeck_velocity", falls ? f.vs : 0.0, 1e-7, v_max, speed, slow},
       {"friction.regularisation_velocity", is_regularised ? f.v0 : 0.0, 1e-9, v_max, speed, slow},
       {"friction.bristle_stiffness", is_lugre ? f.sigma0 : 0.0, linear ? 1e4 : 1.0, 1e13,
        linear ? "N/m" : "Nm/rad", linear ? "50 N/um" : "0.1 Nm/urad"}});
}

void add_linear(const model::MachineSettings& machine, int joint, Rows& rows) {
  const auto j = static_cast<std::size_t>(joint);
  const plant::FeedDriveParams& drive = machine.drives[j];
  const model::NcSettings& nc = machine.nc;
  const model::AxisFunctions& functions = nc.functions[j];
  const bool is_elastic = !drive.is_rigid();
  const bool is_linear_motor = drive.kind == plant::DriveKind::direct;
  const double lead_mm = is_linear_motor ? 0.0 : drive.r * 2.0 * std::numbers::pi / mm;
  rows.insert(
      rows.end(),
      {{"stiffness", is_elastic ? drive.k : 0.0, 1e5, 1e13, "N/m", "180 N/um"},
       {"damping", is_elastic ? drive.c : 0.0, 1.0, 1e9, "N s/m", "40 N s/mm"},
       {"structural_stiffness", inverse(machine.structural_compliance[joint]), 1e5, 1e13, "N/m",
        "50 N/um"},
       {"backlash", drive.gap, 0.0, 1e-3, "m", "5 um"},
       {"moving_mass", drive.M, 1e-2, 1e5, "kg", "500 kg"},
       {"machine_bed.mass", drive.bed.M, 1.0, 1e6, "kg", "10000 kg"},
       {"lead_mm", lead_mm, 0.1, 500.0, "mm", "20 mm"},
       {"slide_viscous_friction", drive.b_load, 1e-3, 1e8, "N s/m", "1.5 N s/mm"},
       {"gravity_load", std::abs(drive.F_load), 1e-3, 1e6, "N", "2 kN"},
       {"v_max", nc.v_max[joint], 1e-4, 20.0, "m/s", "60 m/min"},
       {"a_max", nc.a_max[joint], 1e-3, 1000.0, "m/s^2", "5000 mm/s^2"},
       {"j_max", nc.j_max[joint], 1e-2, 1e6, "m/s^3", "100000 mm/s^3"},
       {"velocity_command_max", nc.cascade[j].v_max, 1e-4, 20.0, "m/s", "60 m/min"},
       {"following_error_limit", functions.supervision.following_error, 1e-7, 1.0, "m", "10 mm"},
       {"standstill_limit", functions.supervision.standstill, 1e-8, 0.1, "m", "50 um"},
       {"encoder_difference_limit", functions.supervision.encoder_difference, 1e-8, 0.1, "m",
        "0.2 mm"},
       {"backlash_compensation.width", std::abs(functions.backlash.width), 0.0, 1e-3, "m", "5 um"},
       {"friction_compensation.switch_velocity", functions.friction.v_switch, 0.0, 1.0, "m/s",
        "0.5 mm/s"},
       {"scale_step", machine.scale[j].step(), 1e-13, 1e-4, "m", "100 nm"},
       {"scale.period", inverse(machine.scale[j].signal_frequency(1.0)), 1e-8, 0.1, "m", "20 um"},
       {"screw.expansion", machine.screw[j].growth.alpha, 0.0, 1e-4, "1/K", "11.5 um/m/K"},
       {"screw.fixed_at", std::abs(machine.screw[j].growth.x_fixed), 0.0, 100.0, "m", "500 mm"}});
  if (is_linear_motor) {
    rows.insert(rows.end(), {{"motor_inertia", drive.J, 1e-3, 1e4, "kg", "5 kg"},
                             {"Kt", drive.Kt, 1e-2, 1e4, "N/A", "80 N/A"}});
    return;
  }
  rows.insert(rows.end(),
              {{"motor_inertia", drive.J, 1e-9, 10.0, "kg m^2", "0.0096 kg m^2"},
               {"motor_viscous_friction", drive.b_motor, 1e-9, 100.0, "Nms/rad", "0.01 Nms/rad"},
               {"Kt", drive.Kt, 1e-3, 1e3, "Nm/A", "1.6 Nm/A"},
               {"motor_step", machine.motor[j].step(), 1e-10, 0.1, "rad", "0.75 urad"}});
}

void add_rotary(const model::MachineSettings& machine, int joint, Rows& rows) {
  const auto j = static_cast<std::size_t>(joint);
  const plant::FeedDriveParams& drive = machine.drives[j];
  const model::NcSettings& nc = machine.nc;
  const model::AxisFunctions& functions = nc.functions[j];
  const bool is_elastic = !drive.is_rigid();
  rows.insert(rows.end(),
              {{"stiffness", is_elastic ? drive.k : 0.0, 10.0, 1e12, "Nm/rad", "5 Nm/urad"},
               {"damping", is_elastic ? drive.c : 0.0, 1e-6, 1e8, "Nms/rad", "500 Nms/rad"},
               {"backlash", drive.gap, 0.0, 0.02, "rad", "20 urad"},
               {"moving_inertia", drive.M, 1e-7, 1e5, "kg m^2", "5 kg m^2"},
               {"ratio", drive.r, 1e-5, 100.0, "", ""},
               {"motor_inertia", drive.J, 1e-9, 1e4, "kg m^2", "0.002 kg m^2"},
               {"Kt", drive.Kt, 1e-3, 1e4, "Nm/A", "1.2 Nm/A"},
               {"gravity_load", std::abs(drive.F_load), 1e-3, 1e6, "Nm", "50 Nm"},
               {"v_max", nc.v_max[joint], 1e-4, 1e3, "rad/s", "100 rpm"},
               {"a_max", nc.a_max[joint], 1e-3, 1e5, "rad/s^2", "50 rad/s^2"},
               {"j_max", nc.j_max[joint], 1e-2, 1e7, "rad/s^3", "1000 rad/s^3"},
               {"following_error_limit", functions.supervision.following_error, 1e-7, 3.2, "rad",
                "0.5 deg"},
               {"backlash_compensation.width", std::abs(functions.backlash.width), 0.0, 0.02, "rad",
                "20 urad"},
               {"scale_step", machine.scale[j].step(), 1e-11, 0.02, "rad", "0.1 urad"},
               {"scale.period", inverse(machine.scale[j].signal_frequency(1.0)), 1e-6, 6.3, "rad",
                "72 urad"}});
}

bool is_plausible(const Plausible& p) {
  const bool says_nothing = p.value == 0.0 || p.value == kAny;
  return says_nothing || (p.value >= p.min && p.value <= p.max);
}

}  // namespace

std::vector<std::string> implausible_values(const model::MachineSettings& machine, int joint) {
  Rows rows;
  joint < kLinearJoints ? add_linear(machine, joint, rows) : add_rotary(machine, joint, rows);
  add_common(machine, static_cast<std::size_t>(joint), rows);
  add_friction(machine, static_cast<std::size_t>(joint), joint < kLinearJoints, rows);
  std::vector<std::string> out;
  for (const Plausible& p : rows) {
    if (is_plausible(p)) continue;
    const std::string key = fmt::format("axis.{}.{}", machine.chain.layout.letter_of(joint), p.key);
    const bool has_unit = *p.unit != '\0';
    out.push_back(has_unit
                      ? fmt::format("{} = {:g} {} is implausible for a machine tool; bare numbers "
                                    "are in {}; for other units write, for example, \"{}\"",
                                    key, p.value, p.unit, p.unit, p.meant)
                      : fmt::format("{} = {:g}, which is implausible for a machine tool; it is the "
                                    "axis motion per motor motion",
                                    key, p.value));
  }
  return out;
}

std::vector<std::string> implausible_values(const model::MachineSettings& machine) {
  std::vector<std::string> out;
  for (const int joint : machine.joints()) {
    for (std::string& value : implausible_values(machine, joint)) out.push_back(std::move(value));
  }
  return out;
}

}  // namespace servomill::sim::input
