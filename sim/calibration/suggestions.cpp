#include "sim/calibration/suggestions.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>

#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/progress.h"
#include "plant/vocabulary/units.h"
#include "sim/calibration/information.h"
#include "sim/calibration/plan_candidates.h"
#include "sim/model/machine.h"
#include "sim/numerics/dense_solver.h"

namespace servomill::sim::calibration {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kDetermined =
    0.2;  // of its standard uncertainty is left of an error that counts as determined
constexpr double kOpen = 0.5;       // of what is expected of an error: less is known of it
constexpr double kAsGood = 1.5;     // times the least uncertainty: the shorter set-up is taken
constexpr int kMaxUnknowns = 800;   // above, one candidate takes seconds
constexpr std::size_t kTried = 24;  // candidates that promise most, tried in full

// An error that the readings leave open: its unknowns.
struct Open {
  plant::ErrorName name;
  int first = 0, size = 1;
  double before = 0.0;  // m or rad, root of the sum of variances
};

double sigma_of(const Open& open, const MatrixXd& covariance) {
  return std::sqrt(covariance.diagonal().segment(open.first, open.size).sum());
}

// The errors alone: set-ups belong to their readings.
Unknowns without_set_up(const Unknowns& unknowns) {
  Unknowns out = unknowns;
  out.set_up.clear();
  for (SoughtFunction& function : out.functions) function.first -= unknowns.first_location();
  for (SoughtGrid& grid : out.grids) grid.first -= unknowns.first_location();
  return out;
}

class Suggestions {
 public:
  Suggestions(const Calibration& calibration, const model::MachineSettings& machine)
      : calibration_(calibration),
        machine_(machine),
        unknowns_(without_set_up(calibration.adjustment.unknowns)),
        effects_(machine.chain, unknowns_) {}

  std::vector<std::string> all() {
    find_known();
    const std::vector<Open> open = open_errors();
    if (open.empty()) return {};
    add_candidates();
    Stage stage("errors", static_cast<double>(open.size()));
    for (const Open& one : open) {
      throw_if_interrupted();
      suggest(one);
      stage.advance();
    }
    return sentences();
  }

 private:
  void find_known() {
    readings::Readings readings = calibration_.readings;
    for (std::size_t g = 0; g < readings.groups.size(); ++g) {
      readings.groups[g].uncertainty = calibration_.adjustment.groups[g].uncertainty;
    }
    known_ = information_of(readings, machine_.chain, effects_);
    for (int u = 0; u < effects_.size(); ++u) {
      const double size = *unknowns_.prior(u);
      known_(u, u) += 1.0 / (size * size);
    }
    covariance_ = numerics::inverse_of_definite(known_);
  }

  std::vector<Open> open_errors() const {
    std::vector<Open> out;
    const auto add = [&](Open one, double expected) {
      one.before = sigma_of(one, covariance_);
      const bool combined = is_combined(calibration_.adjustment, one.name);
      if (one.before > kOpen * expected || (combined && one.before > kDetermined * expected)) {
        out.push_back(one);
      }
    };
    for (std::size_t k = 0; k < unknowns_.locations.size(); ++k) {
      add({.name = unknowns_.locations[k].name, .first = int(k)}, unknowns_.locations[k].size);
    }
    for (const SoughtFunction& function : unknowns_.functions) {
      add({.name = function.name, .first = function.first, .size = function.basis.size()},
          function.size * std::sqrt(double(function.basis.size())));
    }
    return out;
  }

  void add_candidates() {
    PlanSettings settings;
    for (std::size_t k = 0; k < kPlanInstruments.size(); ++k) {
      settings.instruments.push_back(static_cast<PlanInstrument>(k));
    }
    candidates_ = plan_candidates(machine_, settings);
    Stage stage("set-ups", static_cast<double>(candidates_.size()));
    for (const PlannedSetUp& one : candidates_) {
      throw_if_interrupted();
      readings::Readings single;
      single.groups = {one.group};
      information_.push_back(information_of(single, machine_.chain, effects_));
      stage.advance();
    }
  }

  // By what a candidate says along the direction in which the error is open, the best are tried.
  void suggest(const Open& open) {
    std::vector<std::pair<double, std::size_t>> promise;
    const MatrixXd w = covariance_.middleCols(open.first, open.size);
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      promise.emplace_back(-(w.transpose() * information_[i] * w).trace(), i);
    }
    std::sort(promise.begin(), promise.end());
    promise.resize(std::min(promise.size(), kTried));
    std::vector<std::pair<double, std::size_t>> left;
    for (const auto& [gain, i] : promise) {
      left.emplace_back(sigma_of(open, numerics::inverse_of_definite(known_ + information_[i])), i);
    }
    const auto best = std::min_element(left.begin(), left.end());
    if (best == left.end() || best->first > kDetermined * open.before) {
      undetermined_.push_back(plant::to_string(open.name));
      return;
    }
    auto chosen = *best;
    for (const auto& one : left) {
      if (one.first <= kAsGood * best->first &&
          candidates_[one.second].time < candidates_[chosen.second].time) {
        chosen = one;
      }
    }
    determined_[chosen.second].push_back(plant::to_string(open.name));
  }

  std::vector<std::string> sentences() const {
    std::vector<std::string> out;
    for (const auto& [i, names] : determined_) {
      out.push_back(fmt::format("{} by {} ({:.0f} min)", fmt::join(names, ", "),
                                candidates_[i].group.name, candidates_[i].time / minute));
    }
    if (!undetermined_.empty()) {
      out.push_back(
          fmt::format("{} by no single set-up of laser, level, square, ball bar or probe; "
                      "servomill plan-calibration finds a combination",
                      fmt::join(undetermined_, ", ")));
    }
    return out;
  }

  const Calibration& calibration_;
  const model::MachineSettings& machine_;
  Unknowns unknowns_;
  ErrorEffects effects_;
  MatrixXd known_, covariance_;
  std::vector<PlannedSetUp> candidates_;
  std::vector<MatrixXd> information_;
  std::map<std::size_t, std::vector<std::string>> determined_;  // by candidate
  std::vector<std::string> undetermined_;
};

}  // namespace

std::vector<std::string> suggestions(const Calibration& calibration,
                                     const model::MachineSettings& machine) {
  if (calibration.adjustment.unknowns.size() > kMaxUnknowns) return {};
  return Suggestions(calibration, machine).all();
}

}  // namespace servomill::sim::calibration
