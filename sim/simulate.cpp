#include "sim/simulate.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <utility>

#include "plant/vocabulary/units.h"
#include "sim/recorder.h"
#include "sim/schedule.h"
#include "sim/servo_axes.h"
#include "sim/set_point.h"

namespace servomill::sim {
namespace {

constexpr std::size_t kLastTicks = 2000;  // position periods kept of a case that stops

std::vector<Rate> rates_of(const CaseInputs& in) {
  const Tick delay =
      in.machine.scale_delay + (in.hardware.connected ? in.hardware.signal_delay : 0);
  std::vector<Rate> rates = loop_rates(in.machine.nc.periods, delay);
  rates.push_back({kRecord, in.record_period, 0});
  if (in.feedback) rates.push_back({kErrorModel, in.hardware.model_period, 0});
  return rates;
}

Outcome interrupted(double time) {
  return {false, true, fmt::format("interrupted at {:.4f} s", time), '-', time};
}

// The last position periods, kept in a ring so that a case that stops can be looked into.
class LastTicks {
 public:
  explicit LastTicks(std::vector<int> joints) : present_(std::move(joints)) {
    ring_.resize(kLastTicks * kPerRow);
  }
  void keep(double time, const Joints& Q_cmd, const Joints& Q_read, const Joints& Q_true,
            const Joints& current) {
    double* row = ring_.data() + (count_++ % kLastTicks) * kPerRow;
    *row++ = time;
    for (const Joints* Q : {&Q_cmd, &Q_read, &Q_true, &current}) {
      for (int j = 0; j < kJoints; ++j) *row++ = (*Q)[j];
    }
  }
  Series series(const JointLayout& layout) const {
    std::string letters;
    for (const int j : present_) letters += layout.letter_of(j);
    Series out({{"time", "s", "time since the start of the program", "", ""},
                {"cmd", "m or rad", "set point", letters, "axis"},
                {"read", "m or rad", "position that the NC reads", letters, "axis"},
                {"true", "m or rad", "position of the slide or table", letters, "axis"},
                {"current", "A", "torque-forming current", letters, "axis"}});
    const std::size_t rows = std::min(count_, kLastTicks);
    for (std::size_t n = count_ - rows; n < count_; ++n) {
      const double* from = ring_.data() + (n % kLastTicks) * kPerRow;
      double* to = out.add_row();
      *to++ = *from;
      for (std::size_t block = 0; block < 4; ++block) {
        for (const int j : present_)
          *to++ = from[1 + block * kJoints + static_cast<std::size_t>(j)];
      }
    }
    return out;
  }

 private:
  static constexpr std::size_t kPerRow = 1 + 4 * kJoints;
  std::vector<int> present_;
  std::vector<double> ring_;
  std::size_t count_ = 0;
};

// One machine with its loops, stepped from instant to instant of the static schedule.
class CaseRun {
 public:
  explicit CaseRun(CaseInputs& in)
      : in_(in),
        nc_(in.machine.nc),
        schedule_(make_schedule(rates_of(in))),
        axes_(in.machine, in.machine.joints(), schedule_),
        set_point_(nc_, in.reference, std::move(in.set_points)),
        recorder_(in.machine, in.truth, in.imposed, in.path, in.tips),
        last_ticks_(in.machine.joints()) {
    end_ =
        static_cast<Tick>(std::ceil((in.reference.duration() + in.settle_time) / nc_.periods.base));
    recorder_.reserve(static_cast<std::size_t>(end_ / in.record_period + 1));
    settle();
  }

  CaseResult run(const StopFlag& stop, std::atomic<float>& progress) {
    CaseResult result;
    Outcome& outcome = result.outcome;
    Tick n = 0;
    while (n <= end_ && outcome.finished) {
      progress.store(static_cast<float>(n) / static_cast<float>(end_), std::memory_order_relaxed);
      if (stop.load(std::memory_order_relaxed)) outcome = interrupted(nc_.periods.seconds(n));
      for (const Instant& instant : schedule_) {
        if (n > end_ || !outcome.finished) break;
        if (instant.due & kErrorModel) evaluate_error_model();
        if (instant.due & kSample) axes_.take_reading(d_now_);
        if (instant.due & kPositionLoop) run_position_loops(n, outcome);
        if (instant.due & kCurrentLoop) axes_.run_current_loops();
        if (instant.due & kVelocityLoop) axes_.run_velocity_loops();
        if (instant.due & kRecord) record(n);
        axes_.advance(instant.step);
        n += instant.step;
      }
    }
    result.simulated_time = nc_.periods.seconds(n);
    result.servo = recorder_.take();
    if (!result.outcome.finished) result.last_ticks = last_ticks_.series(in_.machine.chain.layout);
    return result;
  }

 private:
  // The machine has stood at the start for long: readings agree with the set point.
  void settle() {
    set_ = set_point_.settle();
    Joints Q = set_.Q_cmd;
    if (in_.feedback) {
      for (int n = 0; n < 50; ++n) {  // Q + d(Q) = Q_cmd, a contraction by the slope of the errors
        d_now_ = in_.feedback->settle(Q);
        Q = set_.Q_cmd;
        Q.head<3>() -= d_now_;
      }
      d_next_ = d_now_;
    }
    axes_.settle(Q, d_now_);
  }

  // Feedback hardware: the model evaluated one period ago acts now, the next one is begun.
  void evaluate_error_model() {
    d_now_ = d_next_;
    d_next_ = in_.feedback->evaluate(axes_.scale_reading());
  }

  void run_position_loops(Tick n, Outcome& outcome) {
    const double time = nc_.periods.seconds(n);
    set_ = set_point_.advance(time);
    last_ticks_.keep(time, set_.Q_cmd, axes_.Q_read(), axes_.Q_true(), axes_.current());
    axes_.run_position_loops(set_);
    for (const int j : axes_.joints()) {
      if (const auto reason = axes_.supervise(j, set_)) halt(outcome, j, *reason, time);
    }
  }

  void record(Tick n) {
    // The reference of this very instant: between position periods the held one is older than
    // Q_true.
    const double t = nc_.periods.seconds(n) - set_point_.delay();
    const auto reference = in_.reference.at(t, record_cursor_);
    Snapshot now;
    now.time = nc_.periods.seconds(n);
    now.s = reference.s;
    now.Q_ref = reference.Q_ref;
    now.Q_cmd = set_.Q_cmd;
    now.Q_read = axes_.Q_read();
    now.Q_meas = axes_.scale_reading();
    now.Q_true = axes_.Q_true();
    now.dQ_true = axes_.dQ_true();
    now.current = axes_.current();
    for (const int j : axes_.joints()) {
      now.torque[j] = in_.machine.drives[static_cast<std::size_t>(j)].Kt * now.current[j];
    }
    recorder_.record(now);
  }

  void halt(Outcome& outcome, int joint, const std::string& reason, double time) const {
    if (!outcome.finished) return;
    outcome.finished = false;
    outcome.axis = in_.machine.chain.layout.letter_of(joint);
    outcome.time = time;
    outcome.reason = fmt::format("axis {}: {} at {:.4f} s", outcome.axis, reason, time);
  }

  CaseInputs& in_;
  const NcSettings& nc_;
  std::vector<Instant> schedule_;
  ServoAxes axes_;
  SetPoint set_point_;
  Recorder recorder_;
  LastTicks last_ticks_;
  Tick end_ = 0;

  AxisSetPoint set_;
  controllers::Trajectory::Cursor record_cursor_;
  Eigen::Vector3d d_now_ = Eigen::Vector3d::Zero(), d_next_ = Eigen::Vector3d::Zero();
};

// Axes that stand where the NC wants them: what remains is the strategy's own error.
class IdealRun {
 public:
  explicit IdealRun(CaseInputs& in)
      : in_(in),
        periods_(in.machine.nc.periods),
        set_point_(in.machine.nc, in.reference, std::move(in.set_points)),
        recorder_(in.machine, in.truth, in.imposed, in.path, in.tips) {}

  CaseResult run(const StopFlag& stop, std::atomic<float>& progress) {
    CaseResult result;
    const double end = in_.reference.duration() + in_.settle_time;
    Tick n = 0;
    AxisSetPoint set = set_point_.settle();
    for (; periods_.seconds(n) <= end; n += periods_.position) {
      progress.store(static_cast<float>(periods_.seconds(n) / end), std::memory_order_relaxed);
      if (stop.load(std::memory_order_relaxed)) {
        result.outcome = interrupted(periods_.seconds(n));
        break;
      }
      set = set_point_.advance(periods_.seconds(n));
      if (n % in_.record_period == 0) record(n, set);
    }
    result.simulated_time = periods_.seconds(n);
    result.servo = recorder_.take();
    return result;
  }

 private:
  void record(Tick n, const AxisSetPoint& set) {
    Snapshot now;
    now.time = periods_.seconds(n);
    now.s = in_.reference.at(now.time - set_point_.delay(), record_cursor_).s;
    now.Q_ref = set.Q_ref;
    now.Q_cmd = now.Q_read = now.Q_true = set.Q_cmd;
    for (int k = 0; in_.feedback && k < 50; ++k) {  // Q_true + d(Q_true) = Q_cmd
      now.Q_true.head<3>() = set.Q_cmd.head<3>() - in_.feedback->settle(now.Q_true);
    }
    now.Q_meas = now.Q_true;
    now.dQ_true = set.dQ_ff;
    recorder_.record(now);
  }

  CaseInputs& in_;
  const LoopPeriods& periods_;
  SetPoint set_point_;
  Recorder recorder_;
  controllers::Trajectory::Cursor record_cursor_;
};

}  // namespace

CaseResult simulate(CaseInputs& inputs, const StopFlag& stop, std::atomic<float>& progress) {
  const auto begin = std::chrono::steady_clock::now();
  CaseResult result = inputs.servo == ServoModel::ideal ? IdealRun(inputs).run(stop, progress)
                                                        : CaseRun(inputs).run(stop, progress);
  result.wall_time =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

}  // namespace servomill::sim
