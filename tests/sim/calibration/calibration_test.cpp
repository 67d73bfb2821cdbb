#include "sim/calibration/calibration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/random/uniform_real_distribution.hpp>
#include <cmath>
#include <map>
#include <numbers>

#include "plant/geometry/volumetric.h"
#include "plant/vocabulary/units.h"
#include "sim/calibration/error_effects.h"
#include "sim/calibration/identified_errors.h"
#include "sim/calibration/make_up.h"
#include "sim/calibration/short_waves.h"
#include "tests/number_of.h"
#include "tests/sim/calibration/random_machine.h"
#include "tests/text.h"

namespace servomill::sim::calibration::calibration_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using plant::operator""_err;

// Mean over 0 to 1 m, and slope where the convention takes that away, too.
std::pair<double, double> mean_line(const plant::ErrorFunction& f, bool with_slope) {
  double mean = 0.0, slope = 0.0;
  const int n = 4000;
  for (int i = 0; i < n; ++i) {
    const double s = (i + 0.5) / n;
    mean += f.value(s) / n;
    slope += 12.0 * f.value(s) * (s - 0.5) / n;
  }
  return {mean, with_slope ? slope : 0.0};
}

// Expected values of the kept unknowns: they hold those that are left out.
VectorXd expected_values(const Adjustment& adjustment, const Truth& truth) {
  VectorXd out = truth.values;
  for (const LeftOut& one : adjustment.left_out) {
    for (const auto& part : one.parts) out[part.unknown] += part.factor * truth.values[one.unknown];
    out[one.unknown] = 0.0;
  }
  return out;
}

TEST(Calibration, FindsEveryErrorOfAMachineThatNoInstrumentBlurs) {
  Normal normal(1);
  const readings::Readings empty = shop_readings();
  const Truth truth = random_truth(calibrated(empty).adjustment.unknowns, normal);
  readings::Readings all = empty;
  for (readings::Group& group : all.groups) group.uncertainty = 1e-12;
  all.instruments[0].scale_uncertainty = 1e-12;
  make_up(all, gantry(), truth.errors, 7);
  const Calibration found = calibrated(all);
  EXPECT_TRUE(found.adjustment.left_out.empty()) << unidentifiable_sentences(found).front();
  for (const double y : {0.1, 0.8}) {
    for (const double x : {0.0, 0.33, 1.0}) {
      const Joints Q = (Joints() << x, y, 0.4, 0.0, 0.0).finished();
      const Eigen::Vector3d p_ST(0.02, -0.03, -0.2);
      const auto tip = [&](const plant::ErrorModel& errors) {
        return plant::VolumetricModel(gantry(), errors).error(Q, p_ST).dp_W;
      };
      EXPECT_NEAR((tip(truth.errors) - tip(found.adjustment.errors)).norm(), 0.0, 1e-10);
    }
  }
}

// Tables that are straight between targets, and known to be.
CalibrationSettings straight_between_targets() {
  CalibrationSettings out;
  out.form_linear.number_of_knots = 11;
  return out;
}

// Errors of what was found, over machines and what is looked at.
struct Coverage {
  int inside = 0, all = 0;
  void add(double error, double sigma) {
    inside += std::abs(error) <= 1.96 * sigma ? 1 : 0;
    ++all;
  }
  double percent() const { return 100.0 * inside / all; }
};

// Squared error of the tip over the working volume, and the one that the covariance expects.
struct TipErrors {
  double squares = 0.0, expected = 0.0;

  void add(const Adjustment& found, const Unknowns& unknowns, const plant::ErrorModel& truth) {
    const plant::MachineChain chain = gantry();
    const ErrorEffects effects(chain, unknowns);
    const plant::VolumetricModel actual(chain, truth), adjusted(chain, found.errors);
    const Eigen::Vector3d p_ST(0.0, 0.0, -0.2);
    for (const double x : {0.05, 0.5, 0.95}) {
      for (const double y : {0.05, 0.5, 0.95}) {
        for (const double z : {0.05, 0.5, 0.95}) {
          const Joints Q = (Joints() << x, y, z, 0.0, 0.0).finished();
          squares += (actual.error(Q, p_ST).dp_W - adjusted.error(Q, p_ST).dp_W).squaredNorm();
          expected += tip_covariance(effects, found, Q, p_ST).trace();
        }
      }
    }
  }
};

// Errors and their uncertainties over many machines.
struct Campaign {
  explicit Campaign(plant::MachineChain of) : chain(std::move(of)) {}

  plant::MachineChain chain;
  CalibrationSettings settings;
  double squares = 0.0, rank = 0.0, chi_squares = 0.0, redundancy = 0.0;
  std::map<std::string, Coverage> functions;
  Coverage pooled;
  std::size_t excluded = 0;  // named as determined only in combination

  Calibration calibrated(readings::Readings readings) const {
    return calibrate(std::move(readings), chain, settings);
  }

  void run(const readings::Readings& empty, int machines) {
    const Unknowns unknowns = calibrated(empty).adjustment.unknowns;
    Normal normal(2);
    for (int machine = 0; machine < machines; ++machine) {
      const Truth truth = random_truth(unknowns, normal);
      readings::Readings taken = empty;
      make_up(taken, chain, truth.errors, 100 + std::uint64_t(machine));
      add(calibrated(taken).adjustment, truth);
    }
  }

  void add(const Adjustment& found, const Truth& truth) {
    const Unknowns& unknowns = found.unknowns;
    const VectorXd error = found.values - expected_values(found, truth);
    const int first = unknowns.first_location();
    std::vector<int> kept;
    for (int u = first; u < unknowns.size(); ++u) {
      if (found.covariance(u, u) > 0.0) kept.push_back(u);
    }
    const VectorXd e = error(kept);
    squares += e.dot(MatrixXd(found.covariance(kept, kept)).ldlt().solve(e));
    rank += double(kept.size());
    chi_squares += found.squares;
    redundancy += found.redundancy;
    excluded = 0;
    for (const KnownFunction& known : functions_along_travel(found, 11)) {
      if (is_combined(found, known.name)) {
        ++excluded;
        continue;
      }
      const auto& actual = truth.errors.component(known.name);
      for (std::size_t i = 0; i < known.s.size(); ++i) {
        count(known.name, known.value[i] - actual.value(known.s[i]), known.sigma[i]);
      }
    }
    for (std::size_t k = 0; k < unknowns.locations.size(); ++k) {
      const int u = first + int(k);
      if (found.covariance(u, u) == 0.0) {
        ++excluded;
      } else {
        count(unknowns.locations[k].name, error[u], std::sqrt(found.covariance(u, u)));
      }
    }
  }

  void count(const plant::ErrorName& name, double error, double sigma) {
    functions[to_string(name)].add(error, sigma);
    pooled.add(error, sigma);
  }

  // Four standard deviations of sums of squares and of counts; numbers of one function depend on
  // each other, so that of eleven places about one counts.
  void check(int machines) const {
    EXPECT_NEAR(squares / rank, 1.0, 4.0 * std::sqrt(2.0 / rank));
    EXPECT_NEAR(chi_squares / redundancy, 1.0, 4.0 * std::sqrt(2.0 / redundancy));
    EXPECT_NEAR(pooled.percent(), 95.0,
                400.0 * std::sqrt(0.95 * 0.05 / (double(functions.size()) * machines)));
    double least = 100.0, most = 0.0;
    for (const auto& [name, coverage] : functions) {
      least = std::min(least, coverage.percent());
      most = std::max(most, coverage.percent());
    }
    std::printf(
        "%d machines: whitened %.4f, chi squares %.4f, pooled coverage %.2f %%, %zu functions "
        "%.1f to %.1f %%, %zu not determined\n",
        machines, squares / rank, chi_squares / redundancy, pooled.percent(), functions.size(),
        least, most, excluded);
  }
};

// Normal noise of the stated sizes: the whitened error has as many squares as numbers were found,
// and intervals of 95 % hold 95 % of the errors.
TEST(Calibration, KnowsHowWellItKnowsThreeAxes) {
  const int machines = number_of("SERVOMILL_CALIBRATIONS", 30);
  Campaign campaign(gantry());
  campaign.settings = straight_between_targets();
  campaign.run(shop_readings(), machines);
  campaign.check(machines);
}

TEST(Calibration, KnowsHowWellItKnowsFiveAxes) {
  const int machines = number_of("SERVOMILL_CALIBRATIONS_FIVE", 4);
  Campaign campaign(trunnion());
  campaign.settings.form_linear.degree = 3;
  campaign.settings.form_rotary.periods = {std::numbers::pi, 2.0 * std::numbers::pi / 3.0};
  readings::Readings all = shop_readings();
  add_spheres(all, campaign.chain);
  campaign.run(all, machines);
  campaign.check(machines);
}

// The tip of a machine that was corrected is as far off as the covariance says.
TEST(Calibration, TipIsAsFarOffAsTheCovarianceSays) {
  const int machines = number_of("SERVOMILL_CALIBRATIONS", 30);
  const readings::Readings empty = shop_readings();
  const CalibrationSettings settings = straight_between_targets();
  const Unknowns unknowns = calibrated(empty, settings).adjustment.unknowns;
  Normal normal(3);
  TipErrors tip;
  for (int machine = 0; machine < machines; ++machine) {
    const Truth truth = random_truth(unknowns, normal);
    readings::Readings taken = empty;
    make_up(taken, gantry(), truth.errors, 500 + std::uint64_t(machine));
    tip.add(calibrated(taken, settings).adjustment, unknowns, truth.errors);
  }
  EXPECT_NEAR(tip.squares / tip.expected, 1.0, 4.0 * std::sqrt(2.0 / (9.0 * machines)));
  std::printf("%d machines: mean squared error of the tip %.4f of the bound\n", machines,
              tip.squares / tip.expected);
}

// Errors with waves shorter than the spacing of the targets, which nobody has announced: intervals
// hold between the targets, too.
// Standard uncertainty of a table with short waves at s, from the numbers of the file.
double sigma_in_file(const input::IdentifiedValues& file, const SoughtFunction& function,
                     double s) {
  const std::string prefix = "errors.m." + plant::to_string(function.name) + ".";
  const std::vector<double>& knots = function.basis.form().knots;
  const ShortWaves waves = short_waves_of(function.basis, 4);
  Eigen::VectorXd J = Eigen::VectorXd::Zero(Eigen::Index(file.keys.size()));
  std::size_t knot = 0, wave = 0;
  for (std::size_t k = 0; k < file.keys.size(); ++k) {
    if (!file.keys[k].starts_with(prefix)) continue;
    if (file.keys[k].find("table") != std::string::npos) {
      std::vector<double> hat(knots.size(), 0.0);
      hat[knot++] = 1.0;
      J[Eigen::Index(k)] = plant::linear_table(knots, hat).value(s) * um;
    } else if (file.keys[k].find("harmonic") != std::string::npos) {
      const double phase = wave % 2 == 0 ? 0.0 : 0.5 * std::numbers::pi;
      J[Eigen::Index(k)] = plant::harmonic(1.0, waves.periods[wave / 2], phase).value(s) * um;
      ++wave;
    }
  }
  EXPECT_EQ(wave, 8U);
  return std::sqrt(J.dot(file.covariance * J));
}

TEST(Calibration, UncertaintyHoldsBetweenTargets) {
  const int machines = number_of("SERVOMILL_CALIBRATIONS", 30);
  const readings::Readings empty = shop_readings();
  Normal normal(5);
  boost::random::mt19937_64 generator(6);
  boost::random::uniform_real_distribution<double> frequency(10.5, 29.5), phase(0.0, 6.28);
  Coverage between, in_file;
  for (int machine = 0; machine < machines; ++machine) {
    plant::ErrorModel truth;
    for (const Axis axis : {Axis::X, Axis::Y, Axis::Z}) {
      for (const Axis direction : kAllAxes) {
        const plant::ErrorName name{direction, axis, false};
        truth.component(name) =
            plant::polynomial({0.0, 0.0, normal(20e-6), normal(20e-6)}) +
            plant::harmonic(6e-6, 1.0 / frequency(generator), phase(generator)) +
            plant::harmonic(4e-6, 1.0 / frequency(generator), phase(generator));
      }
    }
    readings::Readings taken = empty;
    make_up(taken, gantry(), truth, 900 + std::uint64_t(machine));
    const Calibration calibration = calibrated(taken);
    const Adjustment& found = calibration.adjustment;
    const input::IdentifiedValues file = identified_errors(calibration, "m").values;
    for (const KnownFunction& known : functions_along_travel(found, 71)) {
      const plant::ErrorFunction& actual = truth.component(known.name);
      const bool sloped =
          is_linear(known.name.direction) && known.name.direction != known.name.axis;
      const auto [mean, slope] = mean_line(actual, sloped);
      for (std::size_t i = 0; i < known.s.size(); ++i) {
        const double s = known.s[i];
        const double off = known.value[i] - (actual.value(s) - mean - slope * (s - 0.5));
        between.add(off, known.sigma[i]);
        if (i % 5 != 2) continue;  // enough of them
        const auto function =
            std::find_if(found.unknowns.functions.begin(), found.unknowns.functions.end(),
                         [&](const SoughtFunction& one) { return one.name == known.name; });
        in_file.add(off, sigma_in_file(file, *function, s));
      }
    }
  }
  std::printf("%d machines, short waves: coverage along the travel %.2f %%\n", machines,
              between.percent());
  EXPECT_GT(between.percent(), 93.0);
  EXPECT_LT(between.percent(), 97.0);
  std::printf("in the file %.2f %%\n", in_file.percent());
  EXPECT_GT(in_file.percent(), 93.0);
  EXPECT_LT(in_file.percent(), 97.0);
}

TEST(Calibration, TakesTheFrameThatIsAskedFor) {
  const auto names = [](std::array<Axis, 2> frame) {
    std::string out;
    for (const auto& name : sought_locations(gantry(), frame)) out += to_string(name) + " ";
    return out;
  };
  EXPECT_EQ(names({Axis::X, Axis::Y}), "EC0Y EB0Z EA0Z ");
  EXPECT_EQ(names({Axis::Z, Axis::X}), "EB0X EA0Y EC0Y ");
}

}  // namespace
}  // namespace servomill::sim::calibration::calibration_test
