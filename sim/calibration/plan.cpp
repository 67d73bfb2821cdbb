#include "sim/calibration/plan.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/progress.h"
#include "plant/vocabulary/units.h"
#include "sim/calibration/error_effects.h"
#include "sim/calibration/information.h"
#include "sim/calibration/measurable.h"
#include "sim/calibration/plan_candidates.h"
#include "sim/model/machine.h"
#include "sim/system/json.h"
#include "sim/system/text_table.h"

namespace servomill::sim::calibration {
namespace {

using Eigen::MatrixXd;
using plant::ErrorName;

// Sizes that are expected before anything is measured: typical ones of machine tools.
constexpr double kLength = 10e-6, kAngle = 20e-6;                  // m, rad; component errors
constexpr double kLocationLength = 20e-6, kLocationAngle = 50e-6;  // m, rad
constexpr int kDegree = 3;
constexpr double kSeen = 0.005e-6;  // m; smaller uncertainties print as 0
constexpr double kCorner = 0.05;    // of the travel, between its ends and the tips that count

bool is_endless(const model::MachineSettings& machine, int j) {
  const double travel = machine.nc.upper[j] - machine.nc.lower[j];
  return !(travel > 0.0) || !std::isfinite(travel);
}

FunctionForm form_of(const model::MachineSettings& machine, int j) {
  FunctionForm form;
  const bool endless = is_endless(machine, j);
  form.lower = endless ? 0.0 : machine.nc.lower[j];
  form.upper = endless ? 2.0 * std::numbers::pi : machine.nc.upper[j];
  if (j < kLinearJoints || !endless) {
    form.degree = kDegree;
  } else {
    form.periods = {std::numbers::pi, 2.0 * std::numbers::pi / 3.0};
  }
  return form;
}

Unknowns unknowns_of(const model::MachineSettings& machine) {
  Unknowns out;
  for (const ErrorName& name : sought_locations(machine.chain, {Axis::X, Axis::Y})) {
    out.locations.push_back({name, is_linear(name.direction) ? kLocationLength : kLocationAngle});
  }
  int first = out.first_function();
  for (const Axis axis : kAllAxes) {
    const auto joint = machine.chain.layout.joint_of(axis);
    if (!joint) continue;
    for (const Axis direction : kAllAxes) {
      const ErrorName name{direction, axis, false};
      if (plant::why_meaningless(name, machine.chain.layout)) continue;
      const bool sloped = is_linear(axis) && is_linear(direction) && direction != axis;
      SoughtFunction function{.name = name,
                              .basis = FunctionBasis(form_of(machine, *joint), sloped),
                              .size = is_linear(direction) ? kLength : kAngle,
                              .first = first};
      first += function.basis.size();
      out.functions.push_back(std::move(function));
    }
  }
  return out;
}

// Joints at the corners of the working volume, rotary axes at either of two angles, and its centre.
std::vector<Joints> places_of(const model::MachineSettings& machine) {
  const std::vector<int> joints = machine.joints();
  const auto at = [&](int j, double share) {
    const bool endless = is_endless(machine, j);
    const double lower = endless ? 0.0 : machine.nc.lower[j];
    const double upper = endless ? 2.0 * std::numbers::pi : machine.nc.upper[j];
    return lower + share * (upper - lower);
  };
  std::vector<Joints> out;
  for (unsigned corner = 0; corner < 1U << joints.size(); ++corner) {
    Joints Q = Joints::Zero();
    for (std::size_t k = 0; k < joints.size(); ++k) {
      Q[joints[k]] = at(joints[k], (corner >> k & 1U) != 0U ? 1.0 - kCorner : kCorner);
    }
    out.push_back(Q);
  }
  Joints centre = Joints::Zero();
  for (const int j : joints) centre[j] = at(j, 0.5);
  out.push_back(centre);
  return out;
}

std::vector<MatrixXd> tips_of(const model::MachineSettings& machine, const PlanSettings& settings,
                              const ErrorEffects& effects) {
  std::vector<MatrixXd> out;
  for (const Joints& Q : places_of(machine)) {
    for (const double length : settings.tool_lengths) {
      MatrixXd K(3, effects.size());
      for (int k = 0; k < 3; ++k) {
        Pose pose;
        pose.Q = Q;
        pose.p_ST = {0.0, 0.0, -length};
        pose.n_W = Eigen::Vector3d::Unit(k);
        K.row(k) = effects.row(pose);
      }
      out.push_back(std::move(K));
    }
  }
  return out;
}

// Errors of whose variance the set-ups can tell less than half.
std::vector<std::string> untold_errors(const Unknowns& unknowns, const MatrixXd& known,
                                       const MatrixXd& beyond) {
  constexpr double kShare = 0.5;
  const Eigen::VectorXd all =
      known.llt().solve(MatrixXd::Identity(known.rows(), known.cols())).diagonal();
  const Eigen::VectorXd rest = beyond.cwiseAbs2().rowwise().sum();
  std::vector<std::string> out;
  for (int u = 0; u < all.size(); ++u) {
    const std::string name = unknowns.name(u, {});
    const bool is_new = std::find(out.begin(), out.end(), name) == out.end();
    if (rest[u] > kShare * all[u] && is_new) out.push_back(name);
  }
  return out;
}

double worst_beyond(const std::vector<MatrixXd>& tips, const MatrixXd& beyond) {
  double most = 0.0;
  if (beyond.cols() == 0) return most;
  for (const MatrixXd& K : tips) {
    most = std::max(most, (K * beyond).rowwise().norm().maxCoeff());
  }
  return most;
}

double worst_of(const std::vector<double>& variances) {
  return std::sqrt(*std::max_element(variances.begin(), variances.end()));
}

// Lines through the middle of the travel, in turn, as long as there is time.
std::vector<double> usual_counts(const std::vector<PlannedSetUp>& set_ups, double time) {
  std::vector<double> out(set_ups.size(), 0.0);
  for (bool added = true; added;) {
    added = false;
    for (std::size_t i = 0; i < set_ups.size(); ++i) {
      if (!set_ups[i].through_the_middle || set_ups[i].time > time) continue;
      out[i] += 1.0;
      time -= set_ups[i].time;
      added = true;
    }
  }
  return out;
}

void require_travel(const model::MachineSettings& machine) {
  for (int j = 0; j < kLinearJoints; ++j) {
    if (!machine.chain.layout.has(j) || !is_endless(machine, j)) continue;
    throw InputError({fmt::format("axis.{}", machine.chain.layout.letter_of(j))},
                     "has no travel_mm in the machine file; a plan needs it");
  }
}

void require_time(const std::vector<PlannedSetUp>& set_ups, double time) {
  double shortest = set_ups.front().time;
  for (const PlannedSetUp& one : set_ups) shortest = std::min(shortest, one.time);
  if (shortest <= time) return;
  constexpr double kHour = 60.0 * minute;
  const double hours = std::ceil(100.0 * shortest / kHour) / 100.0;  // two digits, rounded up
  throw InputError({"--hours"},
                   fmt::format("must be at least {:g}: the shortest set-up of these instruments "
                               "takes {:g} min",
                               hours, shortest / minute));
}

[[noreturn]] void refuse_without_gain() {
  throw InputError({"--hours"},
                   "no set-up of these instruments lowers the uncertainty of the TCP in this time; "
                   "raise it or add --instruments");
}

}  // namespace

Plan plan_calibration(const model::MachineSettings& machine, const PlanSettings& settings,
                      const readings::Readings* taken) {
  require_travel(machine);
  Plan out;
  out.set_ups = plan_candidates(machine, settings);
  if (out.set_ups.empty()) {
    throw InputError({"--instruments"}, "none of them applies to this machine");
  }
  require_time(out.set_ups, settings.time);
  const Unknowns unknowns = unknowns_of(machine);
  const ErrorEffects effects(machine.chain, unknowns);
  MatrixXd known = MatrixXd::Zero(effects.size(), effects.size());
  for (int u = 0; u < effects.size(); ++u) {
    const double size = *unknowns.prior(u);
    known(u, u) = 1.0 / (size * size);
  }
  if (taken != nullptr) known += information_of(*taken, machine.chain, effects);
  Stage parts("parts", 3.0, Steps::unlike);  // what a set-up tells, shares of time, whole numbers
  std::vector<Candidate> candidates;
  {
    Stage stage("set-ups", static_cast<double>(out.set_ups.size()));
    for (const PlannedSetUp& one : out.set_ups) {
      throw_if_interrupted();
      readings::Readings single;
      single.groups = {one.group};
      candidates.push_back({information_of(single, machine.chain, effects), one.time});
      stage.advance();
    }
  }
  parts.advance();
  std::vector<MatrixXd> tips = tips_of(machine, settings, effects);
  const Measurable parted = measurable(candidates, known, settings.time);
  // readings that say more already than all set-ups can in the time leave the search no variance
  if (parted.beyond.cols() == effects.size()) refuse_without_gain();
  out.beyond = worst_beyond(tips, parted.beyond);
  out.untold = untold_errors(unknowns, known, parted.beyond);
  for (MatrixXd& K : tips) K = K * parted.projector;
  const DesignProblem problem(std::move(candidates), known, std::move(tips));
  const Design relaxed = problem.relaxed(settings.time);
  parts.advance();
  const Design whole = problem.whole(relaxed, settings.time);
  for (std::size_t i = 0; i < out.set_ups.size(); ++i) {
    out.set_ups[i].count = static_cast<int>(std::lround(whole.counts[i]));
  }
  if (planned_readings(out).groups.empty()) refuse_without_gain();
  out.before = worst_of(problem.variances(std::vector<double>(out.set_ups.size(), 0.0)));
  out.usual = worst_of(problem.variances(usual_counts(out.set_ups, settings.time)));
  out.after = std::sqrt(whole.worst);
  out.bound = std::sqrt(whole.bound);
  out.efficiency = whole.efficiency();
  return out;
}

std::string report(const Plan& plan, const PlanSettings& settings) {
  std::vector<std::vector<std::string>> lines = {{"set-up", "times", "minutes"}};
  double spent = 0.0;
  for (const PlannedSetUp& one : plan.set_ups) {
    if (one.count == 0) continue;
    spent += one.count * one.time;
    lines.push_back({one.group.name, std::to_string(one.count),
                     fmt::format("{:.0f}", one.count * one.time / minute)});
  }
  std::string out = system::text_table(std::move(lines), 0, {1, 2});
  out += fmt::format("\n{:.1f} h of {:.1f} h; {} set-ups were considered\n\n", spent / 3600.0,
                     settings.time / 3600.0, plan.set_ups.size());
  out += fmt::format(
      "worst uncertainty of the TCP in the working volume (k = 2):\n"
      "  before                                     {:8.2f} um\n"
      "  lines through the middle, in the same time {:8.2f} um\n"
      "  this plan                                  {:8.2f} um\n"
      "  lower bound for all plans of these set-ups {:8.2f} um, efficiency {:.1f} %\n",
      2.0 * plan.before / um, 2.0 * plan.usual / um, 2.0 * plan.after / um, 2.0 * plan.bound / um,
      100.0 * plan.efficiency);
  if (plan.beyond > kSeen) {
    out += fmt::format(
        "  errors that none of these set-ups determines   {:8.2f} um, not included above{}\n",
        2.0 * plan.beyond / um,
        plan.untold.empty() ? "" : fmt::format(": {}", fmt::join(plan.untold, ", ")));
  }
  if (plan.after > 0.98 * plan.usual) out += "no gain over the usual set-ups\n";
  return out;
}

std::string report_json(const Plan& plan, const PlanSettings& settings) {
  std::vector<std::string> set_ups;
  double spent = 0.0;
  for (const PlannedSetUp& one : plan.set_ups) {
    if (one.count == 0) continue;
    spent += one.count * one.time;
    set_ups.push_back(system::JsonObject()
                          .text("set_up", one.group.name)
                          .text("kind", readings::kKinds[static_cast<std::size_t>(one.group.kind)])
                          .integer("times", one.count)
                          .number("time_min", one.count * one.time / minute)
                          .line());
  }
  return system::JsonObject()
      .raw("set_ups", system::json_list(set_ups))
      .integer("considered", plan.set_ups.size())
      .number("time_h", spent / 3600.0)
      .number("available_h", settings.time / 3600.0)
      .number("U_before_um", 2.0 * plan.before / um)
      .number("U_usual_um", 2.0 * plan.usual / um)
      .number("U_plan_um", 2.0 * plan.after / um)
      .number("U_bound_um", 2.0 * plan.bound / um)
      .number("efficiency", plan.efficiency)
      .number("U_beyond_um", 2.0 * plan.beyond / um)
      .raw("untold", system::json_texts(plan.untold))
      .line();
}

readings::Readings planned_readings(const Plan& plan) {
  readings::Readings out;
  for (const PlannedSetUp& one : plan.set_ups) {
    for (int k = 1; k <= one.count; ++k) {
      readings::Group group = one.group;
      if (one.count > 1) group.name += fmt::format(" ({})", k);
      out.groups.push_back(std::move(group));
    }
  }
  return out;
}

}  // namespace servomill::sim::calibration
