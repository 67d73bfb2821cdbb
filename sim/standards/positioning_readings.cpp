#include "sim/standards/positioning_readings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "plant/vocabulary/units.h"

namespace servomill::sim::standards {
namespace {

constexpr double kSameTarget = 1e-9;    // m, rad: rounding of what was written
constexpr double kSameReading = 1e-15;  // m, rad
constexpr double kNotKnown = std::numeric_limits<double>::quiet_NaN();

std::string_view direction_name(int direction) { return direction > 0 ? "forward" : "backward"; }

std::string target_text(double target, bool angular) {
  return angular ? fmt::format("{:.9g} deg", target / deg) : fmt::format("{:.9g} mm", target / mm);
}

// Targets that differ by more than rounding, rising.
std::vector<double> distinct_targets(const std::vector<TargetReading>& readings) {
  std::vector<double> all;
  all.reserve(readings.size());
  for (const TargetReading& one : readings) all.push_back(one.target);
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end(),
                        [](double a, double b) { return std::abs(a - b) <= kSameTarget; }),
            all.end());
  return all;
}

class Arrangement {
 public:
  Arrangement(const std::vector<TargetReading>& readings, bool angular)
      : readings_(readings), angular_(angular), targets_(distinct_targets(readings)) {}

  PositioningTest test() {
    check_order();
    PositioningTest out;
    out.angular = angular_;
    out.targets = Eigen::Map<const Eigen::ArrayXd>(targets_.data(), count());
    fill(1, out.up, out.time_up);
    fill(-1, out.down, out.time_down);
    if (targets_.size() < 2) {
      faults_.push_back({readings_.front().place, "has one target; a test needs at least two"});
    }
    if (!faults_.empty()) throw InputError(std::move(faults_));
    set_times(out);
    return out;
  }

 private:
  Eigen::Index count() const { return static_cast<Eigen::Index>(targets_.size()); }

  Eigen::Index index_of(double target) const {
    const auto found = std::lower_bound(targets_.begin(), targets_.end(), target - kSameTarget);
    return found - targets_.begin();
  }

  // Targets of one run and direction follow each other in one sense.
  void check_order() {
    struct Last {
      const TargetReading* reading = nullptr;
      double sense = 0.0;
    };
    std::map<std::pair<int, int>, Last> last;
    std::set<int> lines;  // a line of several runs is faulty once
    for (const TargetReading& one : readings_) {
      Last& before = last[{one.run, one.direction}];
      if (before.reading != nullptr) {
        const double step = one.target - before.reading->target;
        if (before.sense == 0.0) before.sense = step;
        if (step * before.sense < 0.0 && lines.insert(one.place.line).second) {
          faults_.push_back(
              {one.place, fmt::format("target {} after {} (line {}), {}: targets of a run must {}; "
                                      "put the rows in the order of the approaches",
                                      target_text(one.target, angular_),
                                      target_text(before.reading->target, angular_),
                                      before.reading->place.line, direction_name(one.direction),
                                      before.sense > 0.0 ? "rise" : "fall")});
        }
      }
      before.reading = &one;
    }
  }

  // Deviations of one direction; a reading that is missing or there twice is a fault.
  void fill(int direction, Eigen::ArrayXXd& deviations, Eigen::ArrayXXd& times) {
    int runs = 0;
    const TargetReading* any = nullptr;
    for (const TargetReading& one : readings_) {
      if (one.direction != direction) continue;
      runs = std::max(runs, one.run + 1);
      any = &one;
    }
    if (any == nullptr) return;
    deviations = Eigen::ArrayXXd::Constant(count(), runs, kNotKnown);
    times = deviations;
    std::map<std::pair<Eigen::Index, int>, int> line_of;
    std::set<int> lines;
    for (const TargetReading& one : readings_) {
      if (one.direction != direction) continue;
      const Eigen::Index i = index_of(one.target);
      const auto [before, is_new] = line_of.insert({{i, one.run}, one.place.line});
      if (!is_new && lines.insert(one.place.line).second) {
        faults_.push_back(
            {one.place, fmt::format("target {}, {}, run {} appears twice, first on line {}; number "
                                    "the runs, or remove one of them",
                                    target_text(one.target, angular_), direction_name(direction),
                                    one.run + 1, before->second)});
      }
      deviations(i, one.run) = one.deviation;
      times(i, one.run) = one.time;
    }
    report_missing(direction, runs, line_of, any->place.file);
  }

  void report_missing(int direction, int runs,
                      const std::map<std::pair<Eigen::Index, int>, int>& line_of,
                      const std::string& file) {
    for (Eigen::Index i = 0; i < count(); ++i) {
      std::vector<int> missing;
      for (int run = 0; run < runs; ++run) {
        if (!line_of.contains({i, run})) missing.push_back(run + 1);
      }
      if (missing.empty()) continue;
      const std::string target = target_text(targets_[static_cast<std::size_t>(i)], angular_);
      const bool all = missing.size() == static_cast<std::size_t>(runs);
      faults_.push_back(
          {{file},
           all ? fmt::format("target {} is not approached {}; each target needs the same "
                             "directions: measure it, or remove the target",
                             target, direction_name(direction))
               : fmt::format("run {} is missing at target {}, {}; measure it, or remove the run at "
                             "all targets",
                             fmt::join(missing, ", "), target, direction_name(direction))});
    }
  }

  // Instants as shares of the test.
  void set_times(PositioningTest& out) const {
    const bool known = std::none_of(readings_.begin(), readings_.end(),
                                    [](const auto& one) { return std::isnan(one.time); });
    std::set<int> lines;
    for (const TargetReading& one : readings_) lines.insert(one.place.line);
    if (!known && lines.size() < readings_.size()) {
      set_cycle(out);
    } else if (!known) {
      for (std::size_t k = 0; k < readings_.size(); ++k) {
        const TargetReading& one = readings_[k];
        auto& times = one.direction > 0 ? out.time_up : out.time_down;
        times(index_of(one.target), one.run) = static_cast<double>(k);
      }
    }
    double first = std::numeric_limits<double>::infinity(), last = -first;
    for (const auto* times : {&out.time_up, &out.time_down}) {
      if (times->size() == 0) continue;
      first = std::min(first, times->minCoeff());
      last = std::max(last, times->maxCoeff());
    }
    const double length = last > first ? last - first : 1.0;
    for (auto* times : {&out.time_up, &out.time_down}) *times = (*times - first) / length;
  }

  void set_cycle(PositioningTest& out) const {
    const Eigen::Index n = count();
    const bool both = out.bidirectional();
    const double run_length = static_cast<double>(both ? 2 * n : n);
    for (auto* times : {&out.time_up, &out.time_down}) {
      for (Eigen::Index run = 0; run < times->cols(); ++run) {
        for (Eigen::Index i = 0; i < n; ++i) {
          const bool up = times == &out.time_up;
          const auto step = up ? i : (both ? n : 0) + n - 1 - i;
          (*times)(i, run) = run_length * static_cast<double>(run) + static_cast<double>(step);
        }
      }
    }
  }

  const std::vector<TargetReading>& readings_;
  bool angular_;
  std::vector<double> targets_;
  std::vector<Fault> faults_;
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

constexpr std::size_t kFewestRuns = 3;  // that tell which of them is off

double standard_deviation(const std::vector<double>& values) {
  const Eigen::Map<const Eigen::ArrayXd> x(values.data(), static_cast<Eigen::Index>(values.size()));
  return std::sqrt((x - x.mean()).square().sum() / static_cast<double>(values.size() - 1));
}

// Median of the standard deviations of all targets and directions, which a few outliers do not
// move. Where most runs repeat exactly, the smallest difference that there is stands for it: a step
// of the display; if only one target differs, nothing does.
template <typename Groups>
double usual_deviation(const Groups& groups) {
  std::vector<double> all;
  std::size_t differ = 0;
  double smallest = std::numeric_limits<double>::infinity();
  for (const auto& [key, values] : groups) {
    if (values.size() < kFewestRuns) continue;
    all.push_back(standard_deviation(values));
    const double middle = median(values);
    bool has_difference = false;
    for (const double value : values) {
      if (std::abs(value - middle) <= kSameReading) continue;
      smallest = std::min(smallest, std::abs(value - middle));
      has_difference = true;
    }
    differ += has_difference ? 1 : 0;
  }
  if (all.empty()) return 0.0;
  const double s = median(all);
  return differ > 1 ? std::max(s, smallest) : s;
}

// Lengths are taken back to 20 degC; a standard evaluates the rest as it was read.
void correct(const readings::Group& group, std::vector<TargetReading>& all,
             std::vector<std::string>& remarks) {
  constexpr double kReference = 20.0;  // degC
  if (group.expansion) {
    std::size_t without = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const double T = group.rows[i].temperature;
      if (std::isnan(T)) ++without;
      if (std::isnan(T)) continue;
      all[i].deviation -=
          group.expansion->coefficient * (T - kReference) * (all[i].target - all[0].target);
    }
    remarks.push_back(fmt::format("readings are taken back to 20 degC with {:.3g} um/m/K{}",
                                  group.expansion->coefficient / 1e-6,
                                  without == 0 ? ""
                                               : fmt::format("; {} rows have no temperature and "
                                                             "are not",
                                                             without)));
  }
  if (group.drifts) {
    remarks.emplace_back(
        "drift is not removed: the standard evaluates readings as they were taken");
  }
  if (group.dead_path) {
    remarks.emplace_back("dead_path has no effect on the parameters; it belongs to their U");
  }
}

}  // namespace

PositioningFile positioning_of(const readings::Group& group, const JointLayout& layout) {
  // unit vector of the motion: the axis, or the line to the row farthest from the first
  Joints path = Joints::Zero();
  const bool angular = group.axis && !is_linear(*group.axis);
  if (group.axis) {
    path[*layout.joint_of(*group.axis)] = 1.0;
  } else {
    for (const readings::Reading& one : group.rows) {
      const Joints away = one.Q - group.rows.front().Q;
      if (away.norm() > path.norm()) path = away;
    }
    path.normalize();
  }
  const Joints origin = group.axis ? Joints(Joints::Zero()) : group.rows.front().Q;
  std::vector<TargetReading> all;
  std::vector<Fault> faults;
  for (const readings::Reading& one : group.rows) {
    const Place place{group.file, one.line};
    double sense = 0.0;
    for (int j = 0; j < kJoints; ++j) sense += path[j] * one.direction[static_cast<std::size_t>(j)];
    if (sense == 0.0) {
      faults.push_back({place, "has no direction; a positioning test needs forward or backward"});
    }
    all.push_back({path.dot(one.Q - origin), sense > 0.0 ? 1 : -1, one.run, one.deviation[0],
                   one.time, place});
  }
  if (!faults.empty()) throw InputError(std::move(faults));
  PositioningFile out;
  out.name = group.name;
  correct(group, all, out.remarks);
  out.test = arrange(all, angular);
  const auto off = outliers(all, angular);
  out.remarks.insert(out.remarks.end(), off.begin(), off.end());
  return out;
}

PositioningTest arrange(const std::vector<TargetReading>& readings, bool angular) {
  return Arrangement(readings, angular).test();
}

std::vector<std::string> outliers(const std::vector<TargetReading>& readings, bool angular) {
  constexpr double kFar = 10.0;  // standard deviations
  const std::vector<double> targets = distinct_targets(readings);
  const auto key = [&](const TargetReading& one) {
    return std::pair(std::lower_bound(targets.begin(), targets.end(), one.target - kSameTarget) -
                         targets.begin(),
                     one.direction);
  };
  std::map<std::pair<std::ptrdiff_t, int>, std::vector<double>> groups;
  for (const TargetReading& one : readings) groups[key(one)].push_back(one.deviation);
  std::vector<std::string> out;
  const double s = usual_deviation(groups);
  for (const TargetReading& one : readings) {
    const auto& group = groups.at(key(one));
    if (group.size() < kFewestRuns) continue;
    const double off = one.deviation - median(group);
    if (std::abs(off) <= kFar * s) continue;
    out.push_back(
        fmt::format("{}: target {}, {}, run {} is {:.4g} {} off the other runs, whose standard "
                    "deviation is typically {:.2g}; it is evaluated: check it at the machine",
                    to_string(one.place), target_text(one.target, angular),
                    direction_name(one.direction), one.run + 1, off / (angular ? urad : um),
                    angular ? "urad" : "um", s / (angular ? urad : um)));
  }
  return out;
}

}  // namespace servomill::sim::standards
