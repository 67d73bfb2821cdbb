/// Runs of a program for tests of strategies that learn from them: what they show is invented.
#pragma once

#include <algorithm>
#include <complex>
#include <functional>
#include <memory>
#include <vector>

#include "plant/vocabulary/units.h"
#include "sim/frequency/axis_signals.h"
#include "strategies/trial_runs.h"
#include "tests/strategies/identified_machines.h"

namespace servomill::strategies::fake_runs {

using Complex = std::complex<double>;

inline constexpr double kH = 0.2 * ms;
inline constexpr std::size_t kEvery = 5, kRows = 400;
inline constexpr double kRounding = 1e-12;

inline Complex follows(int, double) { return 1.0; }

// A machine without dynamics whose runs deviate by what a function says.
class FakeRuns final : public TrialRuns {
 public:
  using Response = std::function<Complex(int, double)>;
  using Deviation = std::function<Joints(int run, std::size_t row, const Joints& offset)>;

  explicit FakeRuns(Deviation deviation) : deviation_(std::move(deviation)) {
    PathTimes times{.h = kH, .s = {}, .every = kEvery};
    for (std::size_t n = 0; n < kRows * kEvery; ++n) {
      times.s.push_back(static_cast<double>(n) * 50.0 * um);
    }
    times_ = std::make_shared<const PathTimes>(std::move(times));
  }

  std::shared_ptr<const PathTimes> times() const override { return times_; }
  const std::vector<bool>& in_feed() const override { return feed; }
  const std::vector<int>& joints() const override { return offset_joints; }
  Complex known_response(int joint, double f) const override { return known(joint, f); }
  Complex response(int joint, double f) const override { return actual(joint, f); }
  std::vector<Joints> admissible(std::vector<Joints> offset) const override {
    asked.push_back(offset);
    for (Joints& one : offset) one = one.cwiseMin(admitted).cwiseMax(-admitted);
    return offset;
  }
  TrialRun run(const std::shared_ptr<const PathOffset>& offset) override {
    runs.push_back(offset);
    const int number = static_cast<int>(runs.size());
    TrialRun out;
    if (number == stops_in) {
      out.stopped = "axis Y: following error beyond 0.1 mm at 0.3 s";
      return out;
    }
    for (std::size_t n = 0; n < kRows; ++n) {
      out.deviation.push_back(deviation_(number, n, offset->offset.at(n)));
    }
    return out;
  }

  Response known = follows, actual = follows;
  std::vector<bool> feed = std::vector<bool>(kRows, true);
  std::vector<int> offset_joints = {0, 1, 2};
  int stops_in = 0;
  double admitted = 1.0;                           // m, rad
  mutable std::vector<std::vector<Joints>> asked;  // whether they are admissible
  std::vector<std::shared_ptr<const PathOffset>> runs;

 private:
  std::shared_ptr<const PathTimes> times_;
  Deviation deviation_;
};

// Each run deviates along Y by the next number (um); the last one goes on.
inline FakeRuns deviating_by(std::vector<double> sizes) {
  return FakeRuns([sizes = std::move(sizes)](int run, std::size_t, const Joints&) {
    return Joints(Joints::Unit(1) *
                  sizes[std::min(static_cast<std::size_t>(run), sizes.size()) - 1] * um);
  });
}

inline const IdentifiedMachine& machine() {
  static const IdentifiedMachine kMachine = identified_with({});
  return kMachine;
}
inline const JointLayout& layout() { return machine().layout; }

inline std::vector<double> rms_um(const Lesson& lesson) {
  std::vector<double> out;
  for (const TrialFigures& one : lesson.trials) out.push_back(one.rms / um);
  return out;
}

}  // namespace servomill::strategies::fake_runs
