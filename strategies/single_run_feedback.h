/// A feedback strategy that is written for one run, made into the eight lanes of a FeedbackPart:
/// the same bits alone and among others.
#pragma once

#include <array>
#include <cassert>
#include <exception>
#include <string>
#include <utility>

#include "strategies/strategy.h"

namespace servomill::strategies {

/// @tparam Law  constant, and may be shared by runs:
///     using State = ...;                                  of one run
///     Joints settle(const Reading&, State&) const         has stood for long; begins anew
///     Joints displacement(const Reading&, State&) const   one model period later
/// Both return what is added to the reading of the scales (5; m, rad): the axis moves by its
/// negative. A displacement acts one model period after its reading. Where one of them throws, or
/// returns what is not finite, the run cannot go on (failure()), and its displacement stays.
template <class Law>
class SingleRunFeedback final : public FeedbackPart {
 public:
  using State = typename Law::State;

  /// @param name  of the strategy, for messages
  SingleRunFeedback(std::string name, Law law, double model_period)
      : name_(std::move(name)), law_(std::move(law)), period_(model_period) {}

  bool observes() const override { return true; }
  void observe(const Reading& now, std::size_t lane) override {
    Run& run = runs_[lane];
    assert(run.count < kLaneWidth);
    run.seen[run.count++] = now;
  }

  Joints settle(const Joints& Q_meas, std::size_t lane) override {
    Run& run = runs_[lane];
    const Reading now = run.count > 0 ? run.seen[run.count - 1] : Reading{.Q_fb = Q_meas};
    run.count = 0;
    run.periods = 0;
    find(run, "settle", [&] { return law_.settle(now, run.state); });
    return run.acting = run.next;
  }

  Joints advance(const JointLanes& Q_meas, std::size_t periods, std::size_t lane) override {
    Run& run = runs_[lane];
    assert(run.count == 0 || run.count == periods);
    for (std::size_t n = 0; n < periods; ++n) step(run, Q_meas, n, n);
    run.count = 0;
    return run.acting;
  }

  const JointLanes& advance(const JointLanes& Q_meas, const LaneFlags& lanes) override {
    for (std::size_t lane = 0; lane < kLaneWidth; ++lane) {
      if (!lanes[lane]) continue;
      Run& run = runs_[lane];
      step(run, Q_meas, lane, 0);
      run.count = 0;
      for (int j = 0; j < kJoints; ++j) out_[j][lane] = run.acting[j];
    }
    return out_;
  }

  std::string_view failure(std::size_t lane) const override { return runs_[lane].failure; }

 private:
  struct Run {
    State state{};
    Joints next = Joints::Zero();  // found, acts a period later
    Joints acting = Joints::Zero();
    std::array<Reading, kLaneWidth> seen = {};
    std::size_t count = 0;    // of these
    std::size_t periods = 0;  // since it was settled
    std::string failure;
  };

  void step(Run& run, const JointLanes& Q_meas, std::size_t lane, std::size_t n) {
    Reading now;
    if (run.count > n) {
      now = run.seen[n];
    } else {  // nobody has observed
      now.t = static_cast<double>(run.periods) * period_;
      for (int j = 0; j < kJoints; ++j) now.Q_fb[j] = Q_meas[j][lane];
    }
    ++run.periods;
    run.acting = run.next;
    find(run, "displacement", [&] { return law_.displacement(now, run.state); });
  }

  template <class Find>
  void find(Run& run, const char* function, Find find_it) {
    if (!run.failure.empty()) return;
    try {
      const Joints d = find_it();
      if (d.allFinite()) {
        run.next = d;
        return;
      }
      run.failure = "strategy " + name_ + ": " + function + " returned a value that is not finite";
    } catch (const std::exception& error) {
      run.failure = "strategy " + name_ + ": " + function + ": " + error.what();
    } catch (...) {
      run.failure = "strategy " + name_ + ": " + function + ": an exception of unknown type";
    }
  }

  std::string name_;
  Law law_;
  double period_;  // s
  std::array<Run, kLaneWidth> runs_{};
  JointLanes out_{};
};

}  // namespace servomill::strategies
