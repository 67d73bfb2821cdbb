#include "sim/limits/limit_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/units.h"
#include "sim/limits/mean_derivative.h"
#include "sim/limits/path_check.h"
#include "sim/model/machine.h"
#include "sim/system/counted.h"

namespace servomill::sim::limits {
namespace {

constexpr double kFloorShare = 0.05;      // of a limit, that the resolution may take
constexpr double kLongest = 0.1;          // s, a window that is chosen
constexpr double kGap = 1.5;              // sampling intervals
constexpr double kRounding = 1e-3;        // of a limit: digits of logs
constexpr double kIntervalDigits = 1e-9;  // of a window: rounding of the sampling interval
constexpr std::size_t kAtOnce = 1U << 14;

double median_interval(std::span<const double> t) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < t.size(); ++k) steps.push_back(t[k] - t[k - 1]);
  if (steps.empty()) return 0.0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

// A resolution that is worth a word: one that digits of doubles do not explain.
bool is_coarse(const AxisSignal& signal, double quantum) {
  constexpr double kFine = 1e-8;  // m, rad
  return quantum * signal.unit > kFine;
}

// Runs of windows beyond a limit.
class ExcessRuns {
 public:
  ExcessRuns(double limit, double longest_pause) : limit_(limit), pause_(longest_pause) {}

  void add(const MeanDerivative& mean, double value, int line) {
    if (runs_.empty() || mean.time - runs_.back().to > pause_) {
      runs_.push_back({mean.time, mean.time, 0.0, line});
    }
    Excess& run = runs_.back();
    run.to = mean.time;
    if (value / limit_ <= run.factor) return;
    run.factor = value / limit_;
    run.line = line;
  }

  std::vector<Excess> take() {
    std::stable_sort(runs_.begin(), runs_.end(),
                     [](const Excess& a, const Excess& b) { return a.factor > b.factor; });
    return std::move(runs_);
  }

 private:
  double limit_, pause_;
  std::vector<Excess> runs_;
};

// One limit of one axis along its signal.
class LimitWalk {
 public:
  LimitWalk(const AxisSignal& signal, int order, double limit, double period)
      : signal_(signal), derivative_(order - signal.order), period_(period) {
    out_.joint = signal.joint;
    out_.order = order;
    out_.channel = signal.channel;
    out_.limit = limit;
  }

  LimitResult check(double quantum, std::optional<double> window) {
    step_ = window ? std::max<std::size_t>(
                         1, static_cast<std::size_t>(std::lround(*window / nodes() / period_)))
                   : shortest_step(quantum, longest_step());
    out_.window = static_cast<double>(step_) * nodes() * period_;
    ExcessRuns runs(out_.limit, kGap * period_);
    const std::size_t reach = static_cast<std::size_t>(derivative_) * step_;
    for (std::size_t k = 0; k + reach < signal_.t.size(); ++k) {
      if (k % kAtOnce == 0) throw_if_interrupted();
      if (reach > 0 && signal_.t[k + reach] - signal_.t[k] > longest_window()) continue;
      take(mean_derivative(signal_.t, signal_.x, derivative_, step_, k, quantum), k + reach / 2,
           runs);
    }
    out_.excesses = runs.take();
    for (const Excess& one : out_.excesses) out_.time_beyond += one.to - one.from + period_;
    out_.is_resolved = out_.floor < out_.limit;
    return out_;
  }

 private:
  double nodes() const { return std::max(derivative_, 1); }
  double longest_window() const {
    return (static_cast<double>(static_cast<std::size_t>(derivative_) * step_) + kGap - 1.0) *
           period_;
  }

  // The longest window that is chosen, and that fits into the log.
  std::size_t longest_step() const {
    const double samples = std::min(kLongest / period_ * (1.0 + kIntervalDigits),
                                    static_cast<double>(signal_.t.size() - 1));
    return std::max<std::size_t>(1, static_cast<std::size_t>(samples / nodes()));
  }

  // The floor of equal intervals falls with their power.
  std::size_t shortest_step(double quantum, std::size_t longest) const {
    if (derivative_ == 0) return 1;
    std::size_t step = 1;
    constexpr std::array<double, kMaxOrder + 1> kSums = {0.5, 1.0, 2.0, 4.0};  // of (2)
    const double sum = kSums[static_cast<std::size_t>(derivative_)] * quantum * signal_.unit;
    const auto floor = [&](std::size_t n) {
      return sum / std::pow(static_cast<double>(n) * period_, derivative_);
    };
    while (floor(step) > kFloorShare * out_.limit && step < longest) ++step;
    return step;
  }

  void take(const MeanDerivative& mean, std::size_t sample, ExcessRuns& runs) {
    const double value = std::abs(mean.value) * signal_.unit, floor = mean.floor * signal_.unit;
    const int line = signal_.line.empty() ? 0 : signal_.line[sample];
    ++out_.windows;
    out_.floor = std::max(out_.floor, floor);
    if (value > out_.largest) {
      out_.largest = value;
      out_.time = mean.time;
      out_.line = line;
    }
    if (value - floor > (1.0 + kRounding) * out_.limit) runs.add(mean, value, line);
  }

  const AxisSignal& signal_;
  int derivative_;
  double period_;
  std::size_t step_ = 1;
  LimitResult out_;
};

// The recording begins at the position of the machine before the program.
PathReport path_report(const ProgramRequest& request, const LoggedPath& log) {
  const ProgrammedPath program = programmed_path(request, log.at.front());
  PathReport out = check_path(program, log);
  for (const Fault& warning : program.warnings) {
    out.notes.push_back(fmt::format("{}: {}", to_string(warning.place), warning.message));
  }
  return out;
}

}  // namespace

bool LimitReport::is_exceeded() const {
  const bool exceeds = std::any_of(results.begin(), results.end(),
                                   [](const LimitResult& one) { return !one.excesses.empty(); });
  return exceeds || (path && path->lines_beyond() > 0);
}

std::optional<bool> LimitReport::is_within() const {
  if (is_exceeded()) return false;
  const bool is_known = std::all_of(results.begin(), results.end(), [](const LimitResult& one) {
    return one.is_evaluated() && one.is_resolved;
  });
  return is_known ? std::optional(true) : std::nullopt;
}

bool LimitReport::lacks_evaluation() const {
  return std::any_of(results.begin(), results.end(),
                     [](const LimitResult& one) { return !one.is_evaluated(); });
}

LimitReport check_limits(const recordings::Recording& recording,
                         const model::MachineSettings& machine, const LimitRequest& request) {
  LogSignals log = log_signals(recording, machine.chain.layout, request.log);
  LimitReport out;
  out.log = recording.file;
  out.machine = machine.name;
  out.layout = machine.chain.layout;
  out.notes = std::move(log.notes);
  const std::array<const Joints*, 4> limits = {nullptr, &machine.nc.v_max, &machine.nc.a_max,
                                               &machine.nc.j_max};
  for (const AxisSignal& signal : log.signals) {
    if (signal.t.size() < 2) {
      throw InputError({recording.file},
                       fmt::format("channel '{}' has fewer than two samples", signal.channel));
    }
    const double period = median_interval(signal.t);
    out.samples = std::max(out.samples, signal.t.size());
    out.duration = std::max(out.duration, signal.t.back() - signal.t.front());
    out.period = std::max(out.period, period);
    const double quantum =
        request.resolution ? *request.resolution / signal.unit : quantum_of(signal.x);
    if (!request.resolution && is_coarse(signal, quantum)) {
      out.notes.push_back(
          fmt::format("{}: all samples are multiples of {:.6g} {}: treated as their resolution",
                      out.layout.letter_of(signal.joint), quantum, signal.unit_name));
    }
    for (int order = std::max(1, signal.order); order <= 3; ++order) {
      const double limit = (*limits[static_cast<std::size_t>(order)])[signal.joint];
      const std::string name(kLimited[static_cast<std::size_t>(order)]);
      if (!(limit > 0.0)) {
        out.notes.push_back(fmt::format("the machine file has no limit of the {} of {}", name,
                                        out.layout.letter_of(signal.joint)));
        continue;
      }
      const LimitResult& one = out.results.emplace_back(
          LimitWalk(signal, order, limit, period).check(quantum, request.window));
      if (one.is_evaluated()) continue;
      out.notes.push_back(
          fmt::format("{} of {} is not evaluated: no window of {:.4g} ms without missing samples "
                      "fits into its {}",
                      name, out.layout.letter_of(signal.joint), one.window / ms,
                      system::counted(signal.t.size(), "sample")));
    }
  }
  if (request.program) {
    out.path =
        path_report(*request.program, logged_path(recording.file, log.signals, machine.chain.layout,
                                                  request.resolution.value_or(0.0)));
  }
  return out;
}

}  // namespace servomill::sim::limits
