#include "sim/engine/simulate.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "plant/vocabulary/units.h"
#include "sim/engine/feedback_lanes.h"
#include "sim/engine/last_ticks.h"
#include "sim/engine/recorder.h"
#include "sim/engine/servo_axes.h"
#include "sim/engine/setpoint.h"
#include "sim/model/schedule.h"

namespace servomill::sim {
namespace {

std::vector<Rate> rates_of(const CaseInputs& in) {
  const Tick delay =
      in.machine.scale_delay + (in.hardware.connected ? in.hardware.signal_delay : 0);
  std::vector<Rate> rates = loop_rates(in.machine.nc.periods, delay);
  rates.push_back({kRecord, in.record_period, 0});
  if (in.feedback) rates.push_back({kErrorModel, in.hardware.model_period, 0});
  return rates;
}

double model_period_of(const CaseInputs& in) {
  return in.machine.nc.periods.seconds(in.hardware.model_period);
}

Outcome interrupted(double time) {
  return {false, true, fmt::format("interrupted at {:.4f} s", time), '-', time};
}

// A strategy that cannot go on ends its case.
Outcome failed(std::string_view why, double time, int line) {
  return {false, false, fmt::format("{} at {:.4f} s, line {} of the program", why, time, line), '-',
          time};
}

// The reference of one trajectory some time ago, asked for once at each instant however many runs
// follow and record it.
class Reference {
 public:
  Reference(const controllers::Trajectory& trajectory, double delay)
      : trajectory_(trajectory), delay_(delay) {}
  bool is(const controllers::Trajectory& other, double delay) const {
    return &trajectory_ == &other && delay_ == delay;
  }
  const controllers::Trajectory::Sample& at(double t) {
    if (t != t_) sample_ = trajectory_.at(t - delay_, cursor_);
    t_ = t;
    return sample_;
  }

 private:
  const controllers::Trajectory& trajectory_;
  double delay_;
  controllers::Trajectory::Cursor cursor_;
  double t_ = std::numeric_limits<double>::quiet_NaN();
  controllers::Trajectory::Sample sample_;
};

class References {
 public:
  Reference& of(const controllers::Trajectory& trajectory, double delay) {
    for (const auto& reference : all_) {
      if (reference->is(trajectory, delay)) return *reference;
    }
    return *all_.emplace_back(std::make_unique<Reference>(trajectory, delay));
  }

 private:
  std::vector<std::unique_ptr<Reference>> all_;
};

// The directions in which the axes of the true machine travelled.
class Travel {
 public:
  Travel(const plant::VolumetricModel& machine_errors, const Joints& Q)
      : memory_(machine_errors.plays(), Q), directions_(memory_.size()) {}
  // Nothing has to be remembered on most machines.
  bool matters() const { return !memory_.empty(); }
  void go_to(const Joints& Q) { memory_.travel(Q); }
  // Once at Q, which is not remembered: recording changes nothing.
  std::span<const double> at(const Joints& Q) {
    memory_.directions(Q, directions_);
    return directions_;
  }

 private:
  plant::TravelMemory memory_;
  std::vector<double> directions_;
};

// The cut along the path of a case, felt once a position period.
class Cut {
 public:
  explicit Cut(const CaseInputs& in)
      : in_(in), load_(*in.cutting, in.wear, in.machine.chain, in.machine.structural_compliance) {}

  void start(const controllers::Trajectory::Sample& reference) { load_.start(reference.s); }
  void advance(const controllers::Trajectory::Sample& reference) {
    const NcSettings& nc = in_.machine.nc;
    const int tool = in_.path.tool_offset(in_.pieces[reference.move]);
    if (tool != tool_) p_ST_ = in_.tips.at(tool);
    tool_ = tool;
    load_.advance(reference.s, nc.periods.seconds(nc.periods.position), reference.Q_ref, p_ST_);
  }
  const Joints& load() const { return load_.load(); }
  void note(Snapshot& now) const {
    now.cutting_force = load_.force();
    now.deflection = load_.deflection();
  }

 private:
  const CaseInputs& in_;
  CuttingLoad load_;
  int tool_ = 0;
  Eigen::Vector3d p_ST_ = Eigen::Vector3d::Zero();
};

// Parts of one case among those that run in lockstep: setpoint, feedback hardware, recorder.
class CaseRun {
 public:
  CaseRun(CaseInputs& in, ServoAxes& axes, FeedbackLanes& feedback, std::size_t run,
          References& references)
      : in_(in),
        nc_(in.machine.nc),
        axes_(axes),
        feedback_(feedback),
        run_(run),
        setpoint_(nc_, in.reference, std::move(in.setpoints)),
        reference_(references.of(in.reference, 0.0)),
        recorded_(references.of(in.reference, setpoint_.delay())),
        recorder_(in.machine, in.machine_errors, in.imposed, in.path, in.tips, in.format,
                  in.program_displaces_rotary, in.recorded_corrections, in.cutting != nullptr,
                  in.keeping),
        travel_(in.machine_errors, Joints::Zero()),
        last_ticks_(in.machine.joints()) {
    end_ =
        static_cast<Tick>(std::ceil((in.reference.duration() + in.settle_time) / nc_.periods.base));
    recorder_.expect(static_cast<std::size_t>(end_ / in.record_period + 1));
    settle();
  }

  Tick end() const { return end_; }
  bool goes_on_at(Tick n) const { return n <= end_ && result_.outcome.finished; }

  // False if a strategy cannot go on.
  bool interpolate(Tick n) {
    const double t = nc_.periods.seconds(n);
    const auto& reference = reference_.at(t);
    set_ = setpoint_.advance(reference, t, axes_.Q_fb(run_));
    if (in_.feedback) feedback_.set_reference(run_, set_, reference.s);
    last_ticks_.keep(nc_.periods.seconds(n), set_.Q_cmd, axes_.Q_fb(run_), axes_.Q_true(run_),
                     axes_.current(run_));
    axes_.follow(set_, run_);
    if (cut_) feel_cut(n);
    std::string_view failure = setpoint_.failure();
    if (failure.empty() && in_.feedback) failure = feedback_.failure(run_);
    if (!failure.empty())
      result_.outcome = failed(failure, t, in_.path.line(in_.pieces[reference.move]));
    return result_.outcome.finished;
  }

  // False if the machine stops.
  bool supervise(Tick n) {
    const auto fault = axes_.supervise(run_);
    if (!fault || !result_.outcome.finished) return result_.outcome.finished;
    Outcome& outcome = result_.outcome;
    outcome.finished = false;
    outcome.axis = in_.machine.chain.layout.letter_of(fault->joint);
    outcome.time = nc_.periods.seconds(n);
    outcome.reason =
        fmt::format("axis {}: {} at {:.4f} s", outcome.axis, fault->reason, outcome.time);
    return false;
  }

  void record(Tick n) {
    // The reference of this very instant: between position periods the held one is older than
    // Q_true.
    const auto& reference = recorded_.at(nc_.periods.seconds(n));
    Snapshot now;
    now.time = nc_.periods.seconds(n);
    now.s = reference.s;
    now.piece = in_.pieces[reference.move];
    now.Q_ref = reference.Q_ref;
    now.Q_cmd = set_.Q_cmd;
    now.Q_fb = axes_.Q_fb(run_);
    now.Q_meas = axes_.Q_meas(run_);
    now.Q_true = axes_.Q_true(run_);
    now.dQ_true = axes_.dQ_true(run_);
    now.current = axes_.current(run_);
    for (const int j : axes_.joints()) {
      now.torque[j] = in_.machine.drives[static_cast<std::size_t>(j)].Kt * now.current[j];
    }
    if (cut_) cut_->note(now);
    recorder_.record(now, travel_.at(now.Q_true));
  }

  bool remembers_travel() const { return travel_.matters(); }
  void remember_travel() { travel_.go_to(axes_.Q_true(run_)); }

  void interrupt(Tick n) { result_.outcome = interrupted(nc_.periods.seconds(n)); }

  CaseResult finish(Tick n) {
    if (in_.feedback) result_.saturations = feedback_.drop(run_);
    axes_.end(run_);
    result_.simulated_time = nc_.periods.seconds(n);
    result_.servo = recorder_.take();
    if (!result_.outcome.finished)
      result_.last_ticks = last_ticks_.series(in_.machine.chain.layout);
    return std::move(result_);
  }

 private:
  void feel_cut(Tick n) {
    cut_->advance(recorded_.at(nc_.periods.seconds(n)));
    axes_.load(cut_->load(), run_);
  }

  // The machine has stood at the start for long: readings agree with the setpoint.
  void settle() {
    set_ = setpoint_.settle();
    Joints Q = set_.Q_cmd;
    Joints d = Joints::Zero();
    if (in_.feedback) {
      feedback_.add(run_, *in_.feedback, model_period_of(in_));
      feedback_.set_reference(run_, set_, reference_.at(0.0).s);
      for (int n = 0; n < 50; ++n) {  // Q + d(Q) = Q_cmd, a contraction by the slope of the errors
        d = feedback_.settle(run_, Q);
        Q = set_.Q_cmd - d;
      }
    }
    axes_.settle(Q, d, run_);
    if (in_.cutting != nullptr) cut_.emplace(in_).start(recorded_.at(0.0));
    travel_ = {in_.machine_errors, axes_.Q_true(run_)};
  }

  CaseInputs& in_;
  const NcSettings& nc_;
  ServoAxes& axes_;
  FeedbackLanes& feedback_;
  std::size_t run_;
  Setpoint setpoint_;
  Reference &reference_, &recorded_;
  Recorder recorder_;
  Travel travel_;
  LastTicks last_ticks_;
  std::optional<Cut> cut_;
  Tick end_ = 0;
  AxisSetpoint set_;
  CaseResult result_;
};

// Machines with their loops, stepped together from instant to instant of one static schedule.
class Lockstep {
 public:
  Lockstep(std::span<CaseInputs* const> together, plant::PreparedDrives* kept)
      : schedule_(make_schedule(rates_of(*together.front()))),
        axes_(machines_of(together), together.front()->machine.joints(), schedule_, kept) {
    for (std::size_t first = 0; first < together.size(); first += kLaneWidth) {
      feedbacks_.emplace_back(axes_, first);
    }
    for (std::size_t run = 0; run < together.size(); ++run) {
      CaseInputs& in = *together[run];
      runs_.push_back(
          std::make_unique<CaseRun>(in, axes_, feedbacks_[run / kLaneWidth], run, references_));
      longest_ = std::max(longest_, runs_.back()->end());
      any_remembers_travel_ |= runs_.back()->remembers_travel();
    }
  }

  std::vector<CaseResult> run(const StopFlag& stop, std::atomic<float>& progress) {
    std::vector<CaseResult> results(runs_.size());
    for (Tick n = 0;;) {  // until the last has ended
      progress.store(static_cast<float>(n) / static_cast<float>(longest_),
                     std::memory_order_relaxed);
      if (stop.load(std::memory_order_relaxed)) {
        each([&](CaseRun& run) { run.interrupt(n); });
        next_end_ = n;
      }
      for (const Instant& instant : schedule_) {
        if (end_those_done(n, results)) return results;
        visit(instant.due, n);
        axes_.advance(instant.step, [&] { advance_feedback(); });
        n += instant.step;
      }
    }
  }

 private:
  static std::vector<const MachineSettings*> machines_of(std::span<CaseInputs* const> together) {
    std::vector<const MachineSettings*> machines;
    for (const CaseInputs* in : together) machines.push_back(&in->machine);
    return machines;
  }

  void visit(std::uint8_t due, Tick n) {
    if (due & (kErrorModel | kRecord)) axes_.read_scales();
    if (due & kErrorModel) advance_feedback();
    if (due & kSample) {
      for (FeedbackLanes& feedback : feedbacks_) feedback.act();
      axes_.take_readings();
    }
    if (due & kPositionLoop) {
      each([&](CaseRun& run) {
        if (!run.interpolate(n)) next_end_ = n;
      });
      axes_.run_position_loops();
      if (!axes_.all_well()) supervise(n);
    }
    if (due & kCurrentLoop) axes_.run_current_loops();
    if (due & kVelocityLoop) {
      axes_.run_velocity_loops();
      if (any_remembers_travel_) each([](CaseRun& run) { run.remember_travel(); });
    }
    if (due & kRecord) each([&](CaseRun& run) { run.record(n); });
  }

  void advance_feedback() {
    for (FeedbackLanes& feedback : feedbacks_) feedback.advance();
  }

  void supervise(Tick n) {
    each([&](CaseRun& run) {
      if (!run.supervise(n)) next_end_ = n;
    });
  }

  template <class Do>
  void each(Do what) {
    for (auto& run : runs_) {
      if (run) what(*run);
    }
  }

  // Takes out the runs that end before n; whether none is left.
  bool end_those_done(Tick n, std::vector<CaseResult>& results) {
    if (n < next_end_) return false;
    next_end_ = std::numeric_limits<Tick>::max();
    bool none_left = true;
    for (std::size_t run = 0; run < runs_.size(); ++run) {
      if (!runs_[run]) continue;
      if (runs_[run]->goes_on_at(n)) {
        next_end_ = std::min(next_end_, runs_[run]->end() + 1);
        none_left = false;
        continue;
      }
      results[run] = runs_[run]->finish(n);
      runs_[run].reset();
    }
    return none_left;
  }

  std::vector<Instant> schedule_;
  ServoAxes axes_;
  References references_;
  std::vector<std::unique_ptr<CaseRun>> runs_;
  std::vector<FeedbackLanes> feedbacks_;  // of eight runs each
  bool any_remembers_travel_ = false;
  Tick longest_ = 0;
  Tick next_end_ = 0;  // until then none of them ends
};

// Axes that stand where the NC wants them: what remains is the strategy's own error.
class IdealRun {
 public:
  explicit IdealRun(CaseInputs& in)
      : in_(in),
        periods_(in.machine.nc.periods),
        setpoint_(in.machine.nc, in.reference, std::move(in.setpoints)),
        feedback_(in.feedback ? in.feedback->feedback(model_period_of(in)) : nullptr),
        recorder_(in.machine, in.machine_errors, in.imposed, in.path, in.tips, in.format,
                  in.program_displaces_rotary, in.recorded_corrections, in.cutting != nullptr,
                  in.keeping),
        travel_(in.machine_errors, Joints::Zero()) {}

  CaseResult run(const StopFlag& stop, std::atomic<float>& progress) {
    CaseResult result;
    const double end = in_.reference.duration() + in_.settle_time;
    recorder_.expect(static_cast<std::size_t>(end / periods_.seconds(in_.record_period) + 1.0));
    Tick n = 0;
    AxisSetpoint set = setpoint_.settle();
    travel_ = {in_.machine_errors, Q_true_of(set)};
    if (in_.cutting != nullptr) cut_.emplace(in_).start(reference_at(0));
    for (; periods_.seconds(n) <= end; n += periods_.position) {
      progress.store(static_cast<float>(periods_.seconds(n) / end), std::memory_order_relaxed);
      if (stop.load(std::memory_order_relaxed)) {
        result.outcome = interrupted(periods_.seconds(n));
        break;
      }
      const double t = periods_.seconds(n);
      const auto sample = in_.reference.at(t, cursor_);
      set = setpoint_.advance(sample, t, set.Q_cmd);
      now_ = {t, sample.s, set.Q_ref, set.dQ_ff, set.ddQ_ff};
      if (!goes_on(in_.path.line(in_.pieces[sample.move]), result.outcome)) break;
      if (cut_) cut_->advance(reference_at(n));
      const bool is_recorded = n % in_.record_period == 0;
      if (!is_recorded && !travel_.matters()) continue;
      const Joints Q_true = Q_true_of(set);
      travel_.go_to(Q_true);
      if (is_recorded) record(n, set, Q_true);
    }
    result.simulated_time = periods_.seconds(n);
    result.servo = recorder_.take();
    result.saturations = std::move(saturations_);
    return result;
  }

 private:
  controllers::Trajectory::Sample reference_at(Tick n) {
    return in_.reference.at(periods_.seconds(n) - setpoint_.delay(), record_cursor_);
  }

  // False if a strategy cannot go on.
  bool goes_on(int line, Outcome& outcome) const {
    std::string_view failure = setpoint_.failure();
    if (failure.empty() && feedback_) failure = feedback_->failure(0);
    if (!failure.empty()) outcome = failed(failure, now_.t, line);
    return failure.empty();
  }

  // Adds the saturations of a recorded instant.
  void add_saturations(double time) {
    if (!feedback_) return;
    for (const strategies::Saturation& now : feedback_->saturations(0)) {
      auto known = std::find_if(saturations_.begin(), saturations_.end(),
                                [&](const auto& one) { return one.joint == now.joint; });
      if (known == saturations_.end()) {
        known = saturations_.insert(known, now);
        known->first = time;
        known->time = 0.0;
      }
      known->time += periods_.seconds(in_.record_period);
    }
  }

  void record(Tick n, const AxisSetpoint& set, const Joints& Q_true) {
    Snapshot now;
    now.time = periods_.seconds(n);
    const auto reference = reference_at(n);
    now.s = reference.s;
    now.piece = in_.pieces[reference.move];
    now.Q_ref = set.Q_ref;
    now.Q_cmd = now.Q_fb = set.Q_cmd;
    now.Q_meas = now.Q_true = Q_true;
    now.dQ_true = set.dQ_ff;
    if (cut_) cut_->note(now);
    recorder_.record(now, travel_.at(now.Q_true));
    add_saturations(now.time);
  }

  // Q_true + d(Q_true) = Q_cmd
  Joints Q_true_of(const AxisSetpoint& set) {
    Joints Q_true = set.Q_cmd;
    for (int k = 0; feedback_ && k < 50; ++k) {
      const Joints before = Q_true;
      if (feedback_->observes()) {
        now_.Q_fb = before;
        feedback_->observe(now_, 0);
      }
      Q_true = set.Q_cmd - feedback_->settle(before);
      if (Q_true == before) break;
    }
    return Q_true;
  }

  CaseInputs& in_;
  const LoopPeriods& periods_;
  Setpoint setpoint_;
  std::unique_ptr<strategies::FeedbackPart> feedback_;
  strategies::Reading now_;
  Recorder recorder_;
  Travel travel_;
  std::optional<Cut> cut_;
  std::vector<strategies::Saturation> saturations_;
  controllers::Trajectory::Cursor cursor_, record_cursor_;
};

}  // namespace

bool share_lanes(const CaseInputs& a, const CaseInputs& b) {
  const auto same_rate = [](const Rate& one, const Rate& other) {
    return one.due == other.due && one.period == other.period && one.phase == other.phase;
  };
  const std::vector<Rate> of_a = rates_of(a), of_b = rates_of(b);
  return a.servo == ServoModel::cascade && b.servo == ServoModel::cascade &&
         a.machine.integrator == b.machine.integrator &&
         a.machine.nc.periods.base == b.machine.nc.periods.base &&
         a.machine.joints() == b.machine.joints() &&
         std::equal(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(), same_rate);
}

std::vector<CaseResult> simulate(std::span<CaseInputs* const> together, const StopFlag& stop,
                                 std::atomic<float>& progress, plant::PreparedDrives* kept) {
  const auto begin = std::chrono::steady_clock::now();
  std::vector<CaseResult> results;
  if (together.front()->servo == ServoModel::ideal) {
    results.push_back(IdealRun(*together.front()).run(stop, progress));
  } else {
    results = Lockstep(together, kept).run(stop, progress);
  }
  const double wall_time =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  for (CaseResult& result : results) result.wall_time = wall_time;
  return results;
}

CaseResult simulate(CaseInputs& inputs, const StopFlag& stop, std::atomic<float>& progress) {
  CaseInputs* const alone[] = {&inputs};
  return std::move(simulate(alone, stop, progress).front());
}

}  // namespace servomill::sim
