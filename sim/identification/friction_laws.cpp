#include "sim/identification/friction_laws.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "plant/vocabulary/progress.h"

namespace servomill::sim::identification {
namespace {

// Units and first values of one axis.
struct AxisUnits {
  std::string axis;  // "axis.X."
  std::string force, damping, velocity, stiffness;
  double coulomb, viscous;
};

Estimate estimate(std::vector<std::string> keys, double start, const std::string& unit,
                  double lower = 0.0) {
  Estimate out;
  out.keys = std::move(keys);
  out.unit = unit;
  out.start = start;
  out.lower = lower;
  return out;
}

// Builds one law out of its parts.
class LawMaker {
 public:
  LawMaker(const AxisUnits& units, std::string name, const std::string& model) : u_(units) {
    law_.name = std::move(name);
    law_.changes.push_back(
        fmt::format("{}friction={{ model = \"{}\", coulomb = 0.0 }}", u_.axis, model));
  }

  LawMaker& viscous() {
    add({key("slide_viscous_friction")}, u_.viscous, u_.damping);
    return *this;
  }
  LawMaker& viscous_by_direction() {
    set("slide_viscous_friction", 0.0, u_.damping);
    add({friction("viscous")}, u_.viscous, u_.damping);
    add({friction("viscous_negative")}, u_.viscous, u_.damping);
    return *this;
  }
  LawMaker& coulomb(bool with_breakaway) {
    std::vector<std::string> keys = {friction("coulomb"), friction("coulomb_negative")};
    if (with_breakaway) {
      keys.push_back(friction("breakaway"));
      keys.push_back(friction("breakaway_negative"));
    }
    add(std::move(keys), u_.coulomb, u_.force);
    law_.estimates.push_back(
        estimate({key("gravity_load")}, 0.0, u_.force, -std::numeric_limits<double>::infinity()));
    return *this;
  }
  LawMaker& coulomb_by_direction(bool with_breakaway) {
    for (const char* side : {"", "_negative"}) {
      std::vector<std::string> keys = {friction(fmt::format("coulomb{}", side))};
      if (with_breakaway) keys.push_back(friction(fmt::format("breakaway{}", side)));
      add(std::move(keys), u_.coulomb, u_.force);
    }
    return *this;
  }
  LawMaker& stribeck() {
    add({friction("breakaway"), friction("breakaway_negative")}, 0.8 * u_.coulomb, u_.force);
    add({friction("stribeck_velocity")}, 15.0, u_.velocity);
    return *this;
  }
  LawMaker& regularised() {
    add({friction("regularisation_velocity")}, 0.5, u_.velocity);
    return *this;
  }
  LawMaker& bristles() {
    const double stiffness = u_.coulomb / 10e-6;  // breaks away within some 10 um
    add({friction("bristle_stiffness")}, stiffness, u_.stiffness);
    set("friction.bristle_damping", std::sqrt(stiffness), u_.damping);
    return *this;
  }
  LawMaker& no_load() {
    set("gravity_load", 0.0, u_.force);
    return *this;
  }
  Law made() { return std::move(law_); }

 private:
  std::string key(const std::string& name) const { return u_.axis + name; }
  std::string friction(const std::string& name) const { return u_.axis + "friction." + name; }
  void set(const std::string& name, double value, const std::string& unit) {
    law_.changes.push_back(fmt::format("{}{}={}", u_.axis, name, written(value, unit)));
  }
  void add(std::vector<std::string> keys, double start, const std::string& unit) {
    law_.estimates.push_back(estimate(std::move(keys), start, unit));
  }

  const AxisUnits& u_;
  Law law_;
};

// Contiguous parts, of which each fit leaves out every kFolds-th. None leaves out the first:
// position and speed at the start are parameters too and act on the first samples alone, as the
// loop settles within some ms; without these samples they run away by metres. Parts of a ninth took
// a short recording its only reversal.
constexpr std::size_t kFolds = 3, kParts = 1 + 18;

bool in_fold(std::size_t sample, std::size_t size, std::size_t fold) {
  const std::size_t part = sample * kParts / size;
  return part > 0 && (part - 1) % kFolds == fold;
}

Mask masked(const Mask& all, std::size_t fold, bool held_out) {
  Mask out = all;
  for (auto& record : out) {
    for (std::size_t k = 0; k < record.size(); ++k) {
      if (in_fold(k, record.size(), fold) != held_out) record[k] = 0;
    }
  }
  return out;
}

std::size_t counting(const Mask& mask) {
  std::size_t count = 0;
  for (const auto& record : mask) {
    count += static_cast<std::size_t>(std::count(record.begin(), record.end(), char{1}));
  }
  return count;
}

// Keys that belong to the law, not to the experiment.
bool is_of_law(const Estimate& one, const std::string& axis) {
  return std::any_of(one.keys.begin(), one.keys.end(), [&](const std::string& key) {
    return key.starts_with(axis + "friction.") || key == axis + "slide_viscous_friction" ||
           key == axis + "gravity_load";
  });
}

struct FittedLaw {
  LawResult result;
  double effective = 0.0;  // samples
};

FittedLaw fit_law(const Experiment& experiment, const std::vector<const AxisRecord*>& records,
                  const Law& law, const std::string& axis, unsigned threads) {
  FittedLaw out;
  out.result.name = law.name;
  config::Document document = experiment.document;
  for (const std::string& change : law.changes) document.set("machine." + change);
  std::vector<Estimate> estimates;
  for (const Estimate& one : experiment.estimates) {
    if (!is_of_law(one, axis)) estimates.push_back(one);
  }
  estimates.insert(estimates.end(), law.estimates.begin(), law.estimates.end());
  out.result.parameters = estimates.size();
  const Prediction prediction(document, estimates, records, threads);
  const Mask all = prediction.all_samples();
  const Fit whole = fit(prediction, prediction.start(), all);
  out.result.rms = rms(whole.residual, all);
  out.effective = uncertainty_of(whole.jacobian, whole.residual, all).effective_samples;
  double sum = 0.0;
  std::size_t count = 0;
  Stage folds("folds", kFolds);
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    const Fit part = fit(prediction, whole.values, masked(all, fold, false));
    const Mask unseen = masked(all, fold, true);
    const auto signals = prediction.simulate({&part.values, 1});
    sum += prediction.residual(*signals.front(), unseen).squaredNorm();
    count += counting(unseen);
    folds.advance();
  }
  out.result.held_out = std::sqrt(sum / static_cast<double>(count));
  // of a root mean square of so many independent samples
  out.result.held_out_error = out.result.held_out / std::sqrt(2.0 * out.effective);
  return out;
}

std::optional<std::size_t> simplest(const std::vector<LawResult>& laws) {
  constexpr double kDecisive = 10.0;  // of BIC (Kass and Raftery 1995: very strong)
  const LawResult* best = nullptr;
  for (const LawResult& law : laws) {
    if (law.refused.empty() && (best == nullptr || law.held_out < best->held_out)) best = &law;
  }
  std::optional<std::size_t> chosen;
  for (std::size_t k = 0; k < laws.size(); ++k) {
    const LawResult& law = laws[k];
    if (!law.refused.empty() || law.bic > kDecisive) continue;
    if (law.held_out > best->held_out + 2.0 * best->held_out_error) continue;
    if (!chosen || law.parameters < laws[*chosen].parameters) chosen = k;
  }
  return chosen;
}

}  // namespace

std::vector<Law> friction_laws(char axis, bool linear, const InverseDynamics* start) {
  AxisUnits u;
  u.axis = fmt::format("axis.{}.", axis);
  u.force = linear ? "N" : "Nm";
  u.damping = linear ? "N s/m" : "Nms/rad";
  u.velocity = linear ? "mm/s" : "mrad/s";
  u.stiffness = linear ? "N/m" : "Nm/rad";
  u.viscous = start != nullptr ? std::max(start->values[1], 0.0) : 0.0;
  u.coulomb = start != nullptr && start->values[2] > 0.0 ? start->values[2] : 1.0;
  std::vector<Law> laws;
  const auto law = [&](const std::string& name, const std::string& model) {
    return LawMaker(u, name, model);
  };
  laws.push_back(law("viscous", "none").viscous().made());
  laws.push_back(law("Coulomb, viscous, offset", "set_valued").viscous().coulomb(true).made());
  laws.push_back(law("regularised Coulomb, viscous", "regularised")
                     .no_load()
                     .viscous()
                     .coulomb_by_direction(true)
                     .regularised()
                     .made());
  laws.push_back(law("Stribeck, Coulomb by direction", "set_valued")
                     .no_load()
                     .viscous()
                     .coulomb_by_direction(false)
                     .stribeck()
                     .made());
  laws.push_back(law("all by direction", "set_valued")
                     .no_load()
                     .viscous_by_direction()
                     .coulomb_by_direction(true)
                     .made());
  laws.push_back(law("all by direction, Stribeck", "set_valued")
                     .no_load()
                     .viscous_by_direction()
                     .coulomb_by_direction(false)
                     .stribeck()
                     .made());
  laws.push_back(law("LuGre by direction", "lugre")
                     .no_load()
                     .viscous_by_direction()
                     .coulomb_by_direction(true)
                     .bristles()
                     .made());
  laws.push_back(law("LuGre by direction, Stribeck", "lugre")
                     .no_load()
                     .viscous_by_direction()
                     .coulomb_by_direction(false)
                     .stribeck()
                     .bristles()
                     .made());
  return laws;
}

void compare_laws(const Experiment& experiment, Identification& out, unsigned threads) {
  std::vector<const AxisRecord*> records;
  for (const AxisRecord& one : experiment.records) {
    if (!one.record.validation) records.push_back(&one);
  }
  const int joint = records.front()->joint;
  const char letter = letter_of(experiment, joint);
  const std::string axis = fmt::format("axis.{}.", letter);
  std::erase_if(records, [&](const AxisRecord* one) { return one->joint != joint; });
  const InverseDynamics* start = out.inverse_dynamics.empty() ? nullptr : &out.inverse_dynamics[1];
  std::vector<double> effective;
  const std::vector<Law> laws = friction_laws(letter, joint < kLinearJoints, start);
  Stage stage("friction laws", static_cast<double>(laws.size()), Steps::unlike);
  for (const Law& law : laws) {
    FittedLaw fitted;
    try {
      fitted = fit_law(experiment, records, law, axis, threads);
    } catch (const InputError& error) {
      fitted.result.name = law.name;
      fitted.result.refused = error.faults().front().message;
    }
    out.laws.push_back(fitted.result);
    effective.push_back(fitted.effective);
    stage.advance();
  }
  // the number of samples of the law that leaves least: what the others leave is model error
  const LawResult* best = nullptr;
  double n = 0.0;
  for (std::size_t k = 0; k < out.laws.size(); ++k) {
    if (!out.laws[k].refused.empty() || (best != nullptr && out.laws[k].rms >= best->rms)) continue;
    best = &out.laws[k];
    n = effective[k];
  }
  if (best == nullptr) return;
  double least = std::numeric_limits<double>::infinity();
  for (LawResult& law : out.laws) {
    if (!law.refused.empty()) continue;
    law.bic = 2.0 * n * std::log(law.rms) + static_cast<double>(law.parameters) * std::log(n);
    least = std::min(least, law.bic);
  }
  for (LawResult& law : out.laws) law.bic -= law.refused.empty() ? least : 0.0;
  out.simplest_law = simplest(out.laws);
}

}  // namespace servomill::sim::identification
