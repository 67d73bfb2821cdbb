/// The fields of AxisConstants by key, in the order of the file.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "sim/fmu/axis_constants.h"
#include "sim/fmu/error_fields.h"

namespace servomill::sim::fmu {

/// Version of the file: to be raised with every change of the fields.
inline constexpr int kAxisFileVersion = 2;

/// Calls visit(key, field) with a reference to each field; vectors and optional parts are visited
/// after their sizes, which a reader has set by then.
template <class Visit>
class AxisFields {
 public:
  explicit AxisFields(Visit& visit) : visit_(visit) {}

  void all(AxisConstants& axis) {
    visit_("program", axis.program);
    visit_("scenario", axis.scenario);
    visit_("case", axis.case_name);
    visit_("machine", axis.machine.name);
    visit_("axis", axis.axis);
    Count joint{static_cast<std::size_t>(axis.joint), kJoints - 1};
    visit_("joint", joint);
    axis.joint = static_cast<int>(joint.value);
    visit_("reading_delay", axis.reading_delay);
    visit_("record_period", axis.record_period);
    model::LoopPeriods& periods = axis.machine.nc.periods;
    visit_("base_period", periods.base);
    visit_("position_period", periods.position);
    visit_("velocity_period", periods.velocity);
    visit_("current_period", periods.current);
    const std::size_t j = joint.value;
    drive(axis.machine.drives[j]);
    encoder("scale.", axis.machine.scale[j]);
    encoder("motor.", axis.machine.motor[j]);
    marks(axis.machine.marks[j]);
    screw(axis.machine.screw[j]);
    cascade(axis.machine.nc.cascade[j]);
    functions(axis.machine.nc.functions[j]);
  }

 private:
  void drive(plant::FeedDriveParams& p) {
    visit_("drive.kind", p.kind);
    visit_("drive.r", p.r);
    visit_("drive.J", p.J);
    visit_("drive.M", p.M);
    visit_("drive.k", p.k);
    visit_("drive.c", p.c);
    visit_("drive.gap", p.gap);
    visit_("drive.b_motor", p.b_motor);
    visit_("drive.b_load", p.b_load);
    visit_("drive.Kt", p.Kt);
    visit_("drive.i_max", p.i_max);
    visit_("drive.T_i", p.T_i);
    visit_("drive.L", p.L);
    visit_("drive.R", p.R);
    visit_("drive.Ke", p.Ke);
    visit_("drive.F_load", p.F_load);
    visit_("drive.solver_tolerance", p.solver_tolerance);
    friction(p.friction);
    visit_("cogging.T", p.cogging.T);
    visit_("cogging.n", p.cogging.n);
    visit_("cogging.phase", p.cogging.phase);
    visit_("bed.M", p.bed.M);
    visit_("bed.w", p.bed.w);
    visit_("bed.zeta", p.bed.zeta);
  }

  void friction(plant::FrictionParams& f) {
    visit_("friction.kind", f.kind);
    visit_("friction.Fc_positive", f.Fc_positive);
    visit_("friction.Fc_negative", f.Fc_negative);
    visit_("friction.Fs_positive", f.Fs_positive);
    visit_("friction.Fs_negative", f.Fs_negative);
    visit_("friction.b_positive", f.b_positive);
    visit_("friction.b_negative", f.b_negative);
    visit_("friction.vs", f.vs);
    visit_("friction.v0", f.v0);
    visit_("friction.sigma0", f.sigma0);
    visit_("friction.sigma1", f.sigma1);
  }

  void encoder(const std::string& name, plant::Encoder& encoder) {
    plant::EncoderParams p = encoder.params();
    plant::NoiseKey noise = encoder.noise();
    visit_(name + "period", p.period);
    visit_(name + "step", p.step);
    visit_(name + "sine_offset", p.sine_offset);
    visit_(name + "cosine_offset", p.cosine_offset);
    visit_(name + "imbalance", p.imbalance);
    visit_(name + "quadrature_error", p.quadrature_error);
    for (std::size_t n = 0; n < p.harmonic.size(); ++n) {
      const std::string order = name + "harmonic" + std::to_string(n + 1);
      visit_(order + ".amplitude", p.harmonic[n].amplitude);
      visit_(order + ".phase", p.harmonic[n].phase);
    }
    visit_(name + "signal_noise", p.signal_noise);
    visit_(name + "position_noise", p.position_noise);
    visit_(name + "frequency_limit", p.frequency_limit);
    visit_(name + "noise_seed", noise.seed);
    visit_(name + "noise_stream", noise.stream);
    encoder = plant::Encoder(p, noise);
  }

  void marks(std::optional<model::MarkSettings>& marks) {
    bool there = marks.has_value();
    visit_("marks", there);
    if (!there) return;
    if (!marks) marks.emplace();
    visit_("marks.period", marks->params.period);
    visit_("marks.N", marks->params.N);
    visit_("marks.intervals", marks->params.intervals);
    visit_("marks.first", marks->params.first);
    visit_("marks.closed", marks->params.closed);
    visit_("marks.allowed", marks->allowed);
  }

  void screw(plant::ScrewError& screw) {
    ErrorFields<Visit>(visit_).function("screw", screw.lead);
    visit_("screw.growth.alpha", screw.growth.alpha);
    visit_("screw.growth.x_fixed", screw.growth.x_fixed);
    visit_("screw.growth.dT_end", screw.growth.dT_end);
    visit_("screw.growth.tau", screw.growth.tau);
  }

  void cascade(controllers::CascadeParams& c) {
    visit_("cascade.Kv", c.Kv);
    visit_("cascade.kvf", c.kvf);
    visit_("cascade.kaf", c.kaf);
    visit_("cascade.Kp", c.Kp);
    visit_("cascade.Ki", c.Ki);
    visit_("cascade.r", c.r);
    visit_("cascade.Kt", c.Kt);
    visit_("cascade.J", c.J);
    visit_("cascade.i_max", c.i_max);
    visit_("cascade.Tv", c.Tv);
    visit_("cascade.v_max", c.v_max);
    visit_("cascade.tau_max", c.tau_max);
    visit_("cascade.di_max", c.di_max);
    Count filters{c.filters.count, controllers::kMaxSections};
    visit_("filters", filters);
    c.filters.count = filters.value;
    for (std::size_t n = 0; n < c.filters.count; ++n) {
      const std::string name = "filters." + std::to_string(n);
      controllers::Biquad& section = c.filters.sections[n];
      visit_(name + ".b0", section.b0);
      visit_(name + ".b1", section.b1);
      visit_(name + ".b2", section.b2);
      visit_(name + ".a1", section.a1);
      visit_(name + ".a2", section.a2);
    }
  }

  void functions(model::AxisFunctions& f) {
    visit_("current_loop.Kp", f.current_loop.Kp);
    visit_("current_loop.Ki", f.current_loop.Ki);
    visit_("current_loop.u_max", f.current_loop.u_max);
    visit_("current_loop.Ti", f.current_loop.Ti);
    visit_("position_feedback.kind", f.position_feedback.kind);
    visit_("position_feedback.gain", f.position_feedback.gain);
    visit_("friction_compensation.tau_plus", f.friction.tau_plus);
    visit_("friction_compensation.tau_minus", f.friction.tau_minus);
    visit_("friction_compensation.v_switch", f.friction.v_switch);
    visit_("friction_compensation.tau_pulse", f.friction.tau_pulse);
    visit_("friction_compensation.reversal_pulse_time", f.friction.reversal_pulse_time);
    visit_("friction_compensation.reversal_pulse_distance", f.friction.reversal_pulse_distance);
    visit_("friction_compensation.Tv", f.friction.Tv);
    visit_("backlash_compensation.width", f.backlash.width);
    visit_("backlash_compensation.time", f.backlash.time);
    visit_("backlash_compensation.hysteresis", f.backlash.hysteresis);
    visit_("backlash_compensation.Tp", f.backlash.Tp);
    visit_("supervision.following_error", f.supervision.following_error);
    visit_("supervision.standstill", f.supervision.standstill);
    visit_("supervision.standstill_delay", f.supervision.standstill_delay);
    visit_("supervision.standstill_speed", f.supervision.standstill_speed);
    visit_("supervision.encoder_difference", f.supervision.encoder_difference);
    visit_("supervision.Tp", f.supervision.Tp);
  }

  Visit& visit_;
};

}  // namespace servomill::sim::fmu
