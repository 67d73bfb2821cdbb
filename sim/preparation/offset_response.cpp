#include "sim/preparation/offset_response.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plant/vocabulary/interrupt.h"
#include "sim/frequency/axis_dynamics.h"
#include "sim/frequency/frequency_response.h"

namespace servomill::sim::preparation {
namespace {

constexpr double kLowest = 0.5;             // Hz; below, an axis follows
constexpr std::size_t kFrequencies = 1000;  // before those where they turn

// Tip over slide, along the axis itself.
std::complex<double> tip_of(const model::MachineSettings& machine, int joint, const Joints& Q,
                            double w) {
  std::complex<double> out = 1.0;
  for (const plant::InertialCompliance& one : machine.inertial_compliances) {
    if (one.joint != joint || one.direction != joint) continue;
    const double k = one.gain_at(Q), w_0 = one.mode.w;
    const std::complex<double> G =
        one.is_static()
            ? 1.0
            : w_0 * w_0 / std::complex<double>(w_0 * w_0 - w * w, 2.0 * one.mode.zeta * w_0 * w);
    out += k * w * w * G;
  }
  return out;
}

}  // namespace

OffsetResponses::OffsetResponses(const model::MachineSettings& machine,
                                 const std::vector<int>& joints, Tick reading_delay,
                                 const std::optional<Joints>& tip_at) {
  const model::LoopPeriods& periods = machine.nc.periods;
  const double nyquist = 0.499 / periods.seconds(periods.position);
  const double ratio = std::pow(nyquist / kLowest, 1.0 / static_cast<double>(kFrequencies - 1));
  for (std::size_t k = 0; k < kFrequencies; ++k) {
    f_.push_back(kLowest * std::pow(ratio, static_cast<double>(k)));
  }
  const auto add = [&](double f) {
    if (f > kLowest && f < nyquist) f_.push_back(f);
  };
  for (const int j : joints) {
    const auto ringing = frequency::ringing_frequencies(machine, j, reading_delay,
                                                        frequency::PositionLoop::closed, nyquist);
    for (const double peak : ringing) {
      for (int k = -4; k <= 4; ++k) add(peak * (1.0 + 0.002 * k));
    }
  }
  for (const plant::InertialCompliance& one : machine.inertial_compliances) {
    constexpr int kAround = 16;  // on each side of a peak, to four times its half width
    const double peak = one.mode.w / (2.0 * std::numbers::pi);
    for (int k = -kAround; k <= kAround; ++k) {
      add(peak * (1.0 + 4.0 * one.mode.zeta * k / kAround));
    }
  }
  std::sort(f_.begin(), f_.end());
  for (const int j : joints) {
    frequency::FrequencyResponse response(machine, j, reading_delay,
                                          frequency::PositionLoop::closed);
    for (const double f : f_) {
      throw_if_interrupted();
      const std::complex<double> slide = response.at(
          frequency::Entry::offset, f)[frequency::index_of(frequency::AxisSignal::position)];
      P_[static_cast<std::size_t>(j)].push_back(
          tip_at ? slide * tip_of(machine, j, *tip_at, 2.0 * std::numbers::pi * f) : slide);
    }
  }
}

std::complex<double> OffsetResponses::at(int joint, double f) const {
  if (f_.empty() || f <= 0.0) return 1.0;
  const auto& P = P_[static_cast<std::size_t>(joint)];
  const auto above = std::lower_bound(f_.begin(), f_.end(), f) - f_.begin();
  const auto n = static_cast<std::size_t>(above);
  if (n == f_.size()) return P.back();
  const std::complex<double> below = n == 0 ? 1.0 : P[n - 1];
  const double from = n == 0 ? 0.0 : f_[n - 1];
  return below + (f - from) / (f_[n] - from) * (P[n] - below);
}

}  // namespace servomill::sim::preparation
