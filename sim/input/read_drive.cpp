#include "sim/input/read_drive.h"

#include <fmt/format.h>

#include <array>
#include <numbers>

#include "plant/vocabulary/units.h"
#include "sim/input/read_machine.h"

namespace servomill::sim::input {
namespace {

constexpr std::array<std::string_view, 3> kDriveKinds = {"two_mass", "rigid", "direct"};
constexpr std::array<std::string_view, 4> kFrictionModels = {"none", "set_valued", "regularised",
                                                             "lugre"};
constexpr std::array<std::string_view, 2> kCurrentLoops = {"lag", "pi"};

// A key that one kind needs and the others may have, so that one word can change the kind.
double needed_if(config::Reader& table, bool needed, std::string_view key, double harmless,
                 config::Quantity quantity, config::Rules rules) {
  return needed ? table.real(key, quantity, rules) : table.real_or(key, harmless, quantity, rules);
}

double read_ratio(config::Reader& axis, bool linear, plant::DriveKind kind) {
  if (linear && kind != plant::DriveKind::direct) {
    return axis.real("lead_mm", config::kLength, {config::above(0.0)}) / (2.0 * std::numbers::pi);
  }
  const double ratio = axis.real_or("ratio", 1.0, config::kNumber, {config::above(0.0)});
  if (kind == plant::DriveKind::direct && ratio != 1.0) {
    axis.fault("ratio", "must be 1 for a direct drive");
  }
  return ratio;
}

void read_friction(config::Reader& axis, const AxisQuantities& q, plant::FrictionKind fallback,
                   plant::FrictionParams& f) {
  using Kind = plant::FrictionKind;
  f.kind = fallback;
  if (!axis.has("friction")) {
    if (f.kind == Kind::none) return;
    axis.fault(
        fmt::format("has no table 'friction'; friction_model = \"{}\" requires one for every axis",
                    kFrictionModels[static_cast<std::size_t>(f.kind)]));
    return;
  }
  config::Reader table = axis.table("friction");
  const std::size_t before = table.faults();
  f.kind = static_cast<Kind>(
      table.choice_or("model", static_cast<std::size_t>(fallback), kFrictionModels));
  f.Fc_positive = table.real("coulomb", q.force, {config::at_least(0.0)});
  f.Fc_negative =
      table.real_or("coulomb_negative", f.Fc_positive, q.force, {config::at_least(0.0)});
  f.Fs_positive = table.real_or("breakaway", f.Fc_positive, q.force, {config::at_least(0.0)});
  f.Fs_negative = table.has("breakaway_negative") || table.has("coulomb_negative")
                      ? table.real("breakaway_negative", q.force, {config::at_least(0.0)})
                      : f.Fs_positive;
  f.b_positive = table.real_or("viscous", 0.0, q.damping, {config::at_least(0.0)});
  f.b_negative =
      table.real_or("viscous_negative", f.b_positive, q.damping, {config::at_least(0.0)});
  const bool constant = f.Fs_positive == f.Fc_positive && f.Fs_negative == f.Fc_negative;
  constexpr double kNoMatter = 1e-6;  // m/s: there is nothing that falls with the speed
  f.vs =
      needed_if(table, !constant, "stribeck_velocity", kNoMatter, q.velocity, {config::above(0.0)});
  f.v0 = needed_if(table, f.kind == Kind::regularised, "regularisation_velocity", 1.0, q.velocity,
                   {config::above(0.0)});
  f.sigma0 = needed_if(table, f.kind == Kind::lugre, "bristle_stiffness", 1.0, q.stiffness,
                       {config::above(0.0)});
  f.sigma1 = needed_if(table, f.kind == Kind::lugre, "bristle_damping", 0.0, q.damping,
                       {config::at_least(0.0)});
  if (table.faults() > before) return;
  if (f.kind != Kind::lugre) return;
  if (f.Fc_positive * f.Fc_negative == 0.0) {
    table.fault("coulomb", "must be > 0 for the model lugre");
  } else if (f.Fs_positive * f.Fs_negative == 0.0) {
    table.fault("breakaway", "must be > 0 for the model lugre");
  }
}

void read_winding(config::Reader& axis, plant::FeedDriveParams& p) {
  const bool pi = axis.choice_or("current_loop", 0, kCurrentLoops) == 1;
  p.T_i = axis.real_or("current_time_constant_ms", 0.0, config::kTime, {config::at_least(0.0)});
  if (!axis.has("winding")) {
    if (pi) axis.fault("current_loop", "needs a table 'winding'");
    return;
  }
  config::Reader winding = axis.table("winding");
  const double L = winding.real("inductance", config::kInductance, {config::above(0.0)});
  const double R = winding.real("resistance", config::kResistance, {config::at_least(0.0)});
  const double Ke = winding.real_or("back_emf", 0.0, config::kBackEmf, {config::at_least(0.0)});
  if (!pi) return;
  p.L = L;
  p.R = R;
  p.Ke = Ke;
}

void read_cogging(config::Reader& axis, plant::FeedDriveParams& p, bool linear) {
  if (!axis.has("cogging")) return;
  config::Reader cogging = axis.table("cogging");
  const config::Quantity force = linear ? config::kForce : config::kTorque,
                         length = linear ? config::kLength : config::kAngle;
  const double amplitude = cogging.real("amplitude", force, {config::at_least(0.0)});
  const double period = cogging.real("period", length, {config::above(0.0)});
  const double phase = cogging.real_or("phase_deg", 0.0, config::kAngle);
  if (p.kind != plant::DriveKind::direct) {
    axis.fault("cogging", "needs drive = \"direct\"");
    return;
  }
  p.cogging = {amplitude, 2.0 * std::numbers::pi / period, phase};
}

}  // namespace

std::span<const std::string_view> friction_models() { return kFrictionModels; }

plant::FeedDriveParams read_drive(config::Reader& axis, bool linear,
                                  plant::FrictionKind friction_model) {
  const AxisQuantities& q = quantities_of(linear);
  plant::FeedDriveParams p;
  const std::size_t before = axis.faults();
  p.kind = static_cast<plant::DriveKind>(axis.choice_or("drive", 0, kDriveKinds));
  // which keys are required is open then: complain about none
  if (axis.faults() > before) p.kind = plant::DriveKind::rigid;
  p.r = read_ratio(axis, linear, p.kind);
  const bool linear_motor = linear && p.kind == plant::DriveKind::direct;  // rad reads m
  p.J = axis.real("motor_inertia", linear_motor ? config::kMass : config::kInertia,
                  {config::above(0.0)});
  p.M = axis.real(linear ? "moving_mass" : "moving_inertia", q.load, {config::above(0.0)});
  const bool elastic = !p.is_rigid();
  p.k = needed_if(axis, elastic, "stiffness", 1.0, q.stiffness, {config::above(0.0)});
  p.c = needed_if(axis, elastic, "damping", 0.0, q.damping, {config::at_least(0.0)});
  p.gap = axis.real_or("backlash", 0.0, q.position, {config::at_least(0.0)});
  if (p.gap > 0.0 && !elastic) axis.fault("backlash", "needs drive = \"two_mass\"");
  p.b_motor = axis.real_or("motor_viscous_friction", 0.0,
                           linear_motor ? config::kDamping : config::kTorsionalDamping,
                           {config::at_least(0.0)});
  p.b_load = axis.real_or("slide_viscous_friction", 0.0, q.damping, {config::at_least(0.0)});
  p.F_load = axis.real_or("gravity_load", 0.0, q.force);
  p.Kt = axis.real("Kt", linear_motor ? config::kForceConstant : config::kTorqueConstant,
                   {config::above(0.0)});
  p.i_max = axis.real("i_max_A", config::kCurrent, {config::above(0.0)});
  read_winding(axis, p);
  read_friction(axis, q, friction_model, p.friction);
  read_cogging(axis, p, linear);
  return p;
}

}  // namespace servomill::sim::input
