#include "strategies/inertia.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "plant/structure/mode_step.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"

namespace servomill::strategies {
namespace {

// Gain of a pair, static; k_ij = 0: rigid.
constexpr ParameterSpec gain(std::string_view name, std::string_view help) {
  return {.name = name,
          .help = help,
          .unit = "um s^2/m",
          .default_text = "0",
          .min = -1000.0,
          .max = 1000.0};
}

constexpr ParameterSpec frequency(std::string_view name) {
  return {
      .name = name,
      .help = "natural frequency of the mode that this axis excites; 0: static, filtered at 100 Hz",
      .unit = "Hz",
      .default_text = "0",
      .min = 0.0,
      .max = 1000.0};
}

constexpr ParameterSpec damping(std::string_view name) {
  return {.name = name,
          .help = "damping ratio of that mode",
          .default_text = "0.05",
          .min = 1e-6,
          .max = 0.99};
}

constexpr std::array<ParameterSpec, 15> kSpecs = {{
    gain("XX_um_per_m_s2", "identified deflection along X per acceleration of X"),
    gain("XY_um_per_m_s2", "identified deflection along X per acceleration of Y"),
    gain("XZ_um_per_m_s2", "identified deflection along X per acceleration of Z"),
    gain("YX_um_per_m_s2", "identified deflection along Y per acceleration of X"),
    gain("YY_um_per_m_s2", "identified deflection along Y per acceleration of Y"),
    gain("YZ_um_per_m_s2", "identified deflection along Y per acceleration of Z"),
    gain("ZX_um_per_m_s2", "identified deflection along Z per acceleration of X"),
    gain("ZY_um_per_m_s2", "identified deflection along Z per acceleration of Y"),
    gain("ZZ_um_per_m_s2", "identified deflection along Z per acceleration of Z"),
    frequency("X_frequency_Hz"),
    frequency("Y_frequency_Hz"),
    frequency("Z_frequency_Hz"),
    damping("X_damping"),
    damping("Y_damping"),
    damping("Z_damping"),
}};

// Filter for static gains: the offset needs an acceleration that is smooth.
constexpr plant::Mode kSmoothing = {2.0 * std::numbers::pi * 100.0, 0.7};

constexpr double kPeriodsPerSwing = 20.0;  // position periods in one of a mode with its offset

// Knowledge of the structure.
struct Identified {
  Eigen::Matrix3d K = Eigen::Matrix3d::Zero();   // m per m/s^2
  std::array<plant::Mode, kLinearJoints> modes;  // by accelerating axis
};

// The structure on the path with its offset. Mode j feels r_j - sum_l k_jl eta_l; the term l = j is
// part of its equation,
//   (1 - k_jj w^2) eta'' + 2 zeta w eta' + w^2 eta = -w^2 (r_j - sum_(l != j) k_jl eta_l)''
class TipCorrection final : public SetpointPart {
 public:
  explicit TipCorrection(const Identified& identified) : identified_(identified) {}

  SetpointEntry entry() const override { return {.entry = EntryPoint::before_filter}; }
  Joints offset(const Joints&) const override { return Joints::Zero(); }  // at rest

  Joints advance(const Reading& now) override {
    const double h = has_begun_ ? now.t - t_ : 0.0;
    if (h > 0.0 && h != h_) prepare(h);
    for (std::size_t axis = 0; axis < kLinearJoints; ++axis) {
      const auto j = static_cast<int>(axis);
      double q = now.Q_ref[j], v = now.dQ_ref[j];
      for (std::size_t l = 0; l < kLinearJoints; ++l) {
        if (l == axis) continue;
        q -= identified_.K(j, static_cast<int>(l)) * states_[l].eta;
        v -= identified_.K(j, static_cast<int>(l)) * states_[l].deta;
      }
      if (h > 0.0) {
        states_[axis] = steps_[axis].from(states_[axis], {v - v_[j], (q - q_[j]) - h * v_[j]});
      }
      q_[j] = q;
      v_[j] = v;
    }
    t_ = now.t;
    has_begun_ = true;
    const Eigen::Vector3d eta(states_[0].eta, states_[1].eta, states_[2].eta);
    Joints out = Joints::Zero();
    out.head<kLinearJoints>() = -identified_.K * eta;
    return out;
  }

 private:
  void prepare(double h) {
    for (std::size_t axis = 0; axis < kLinearJoints; ++axis) {
      steps_[axis] = plant::mode_step(identified_.modes[axis], h);
    }
    h_ = h;
  }

  Identified identified_;
  bool has_begun_ = false;
  double t_ = 0.0, h_ = 0.0;  // s, of the last period and of the steps
  Eigen::Vector3d q_ = Eigen::Vector3d::Zero(), v_ = Eigen::Vector3d::Zero();  // m, m/s
  std::array<plant::ModeState, kLinearJoints> states_{};
  std::array<plant::ModeStep, kLinearJoints> steps_{};
};

class Inertia final : public Strategy {
 public:
  explicit Inertia(const Identified& identified) : identified_(identified) {}
  std::unique_ptr<SetpointPart> setpoint() const override {
    return std::make_unique<TipCorrection>(identified_);
  }

 private:
  Identified identified_;
};

// Mode of the path with its own offset.
// @param period  s, of the interpolation
plant::Mode mode_of(double frequency, double zeta, double k, const std::string& axis,
                    double period) {
  if (frequency == 0.0) {
    // the offset itself accelerates the tip, which it does not know
    const double largest = 1.0 / (kSmoothing.w * kSmoothing.w);
    if (std::abs(k) <= largest) return kSmoothing;
    throw InputError({},
                     fmt::format("{0}{0}_um_per_m_s2 must be within {1:.2f} um per m/s2 without "
                                 "{0}_frequency_Hz: larger static offsets move the tip by their "
                                 "own acceleration",
                                 axis, largest * 1e6));
  }
  const double w = 2.0 * std::numbers::pi * frequency;
  const double free = 1.0 - k * w * w;
  if (!(free > zeta * zeta)) {
    throw InputError({}, axis + axis + "_um_per_m_s2 is beyond what a mode of " + axis +
                             "_frequency_Hz can have, (1 - damping^2) / w^2");
  }
  const double own = w / std::sqrt(free);
  const double swings = own / (2.0 * std::numbers::pi), largest = 1.0 / (kPeriodsPerSwing * period);
  if (swings > largest) {
    throw InputError({},
                     fmt::format("{0}{0}_um_per_m_s2 with {0}_frequency_Hz moves with its offset "
                                 "at {1:.0f} Hz; must be at most {2:.0f} Hz, 20 position periods "
                                 "of {3:g} ms in each of its own",
                                 axis, swings, largest, period / ms));
  }
  return {own, zeta / std::sqrt(free)};
}

// An axis may bend others that bend none of the axes before: else offsets excite one another in a
// circle, which is not solved for.
void refuse_circles(const Eigen::Matrix3d& K) {
  const auto bends = [&](int i, int j) { return K(i, j) != 0.0; };
  const bool pair =
      (bends(0, 1) && bends(1, 0)) || (bends(0, 2) && bends(2, 0)) || (bends(1, 2) && bends(2, 1));
  const bool ring =
      (bends(0, 1) && bends(1, 2) && bends(2, 0)) || (bends(1, 0) && bends(2, 1) && bends(0, 2));
  if (pair || ring) {
    throw InputError({},
                     "gains across axes lead back to the axis where they begin (XY and YX, for "
                     "example); leave one of them out");
  }
}

std::unique_ptr<Strategy> make(const Parameters& p, Action, const IdentifiedMachine& machine) {
  Identified identified;
  for (int j = 0; j < kLinearJoints; ++j) {
    const std::string axis(1, "XYZ"[j]);
    for (int i = 0; i < kLinearJoints; ++i) {
      identified.K(i, j) = p.number("XYZ"[i] + axis + "_um_per_m_s2");
    }
    identified.modes[static_cast<std::size_t>(j)] =
        mode_of(p.number(axis + "_frequency_Hz"), p.number(axis + "_damping"), identified.K(j, j),
                axis, machine.position_period);
  }
  refuse_circles(identified.K);
  return std::make_unique<Inertia>(identified);
}

}  // namespace

Entry inertia_entry() {
  Entry entry = {
      "inertia",
      "offsets the setpoint against the deflection of the tip under acceleration, as CTC does",
      kSpecs, make};
  entry.once = true;
  entry.corrects_following = true;
  entry.corrects_inertia = true;
  entry.reads_errors = false;
  return entry;
}

}  // namespace servomill::strategies
