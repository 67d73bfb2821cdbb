#include <gtest/gtest.h>

#include <algorithm>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <cmath>
#include <numbers>

#include "plant/geometry/volumetric.h"
#include "sim/calibration/calibration.h"
#include "sim/calibration/make_up.h"
#include "sim/metrology/location_errors.h"
#include "tests/sim/calibration/shop.h"
#include "tests/text.h"

namespace servomill::sim::calibration::point_observations_test {
namespace {

using Eigen::Vector3d;
using plant::operator""_err;
using readings::Kind;

double value_of(const Adjustment& found, const plant::ErrorName& name) {
  const Unknowns& unknowns = found.unknowns;
  for (std::size_t k = 0; k < unknowns.locations.size(); ++k) {
    if (unknowns.locations[k].name == name) {
      return found.values[unknowns.first_location() + int(k)];
    }
  }
  ADD_FAILURE() << to_string(name) << " is not looked for";
  return 0.0;
}

double sigma_of(const Adjustment& found, const plant::ErrorName& name) {
  const Unknowns& unknowns = found.unknowns;
  for (std::size_t k = 0; k < unknowns.locations.size(); ++k) {
    const int u = unknowns.first_location() + int(k);
    if (unknowns.locations[k].name == name) return std::sqrt(found.covariance(u, u));
  }
  return 0.0;
}

// A probe on a trunnion with tilted and shifted rotary axes: where it triggers follows from the
// exact machine, by bisection along the normal.
class Probing : public testing::Test {
 protected:
  Probing() {
    boost::random::mt19937_64 generator(3);
    boost::random::normal_distribution<double> normal;
    for (const plant::ErrorName& name : sought_locations(chain_, {Axis::X, Axis::Y})) {
      const double size = is_linear(name.direction) ? 20e-6 : 40e-6;
      truth_.location(name) = size * normal(generator);
      settings_.errors.push_back(name);
    }
    group_.kind = Kind::touch;
    group_.name = "sphere";
    group_.file = "touches.csv";
    group_.p_ST = {0.0, 0.0, -0.15};
    group_.uncertainty = 1e-9;
    group_.radius = kRadius;
    group_.spheres = {"outer", "inner"};
  }

  // Distance at which the stylus triggers: nominal, less the pre-travel of a probe of three
  // springs.
  double trigger(const Vector3d& n_S) const {
    const double across = std::hypot(n_S.x(), n_S.y());
    return kRadius - 4e-6 - kLobes * across * std::cos(3.0 * std::atan2(n_S.y(), n_S.x()) - 0.4);
  }

  void touch(std::size_t sphere, const Joints& rotary, const Vector3d& n_W) {
    const plant::VolumetricModel machine(chain_, truth_);
    const Vector3d centre = kPlaces[sphere] + Vector3d(40e-6, -30e-6, 20e-6);
    const Vector3d stylus(25e-6, -15e-6, 0.0);
    const auto gap = [&](double distance) {
      const Joints Q = *plant::inverse_fixed_rotary(chain_, kPlaces[sphere] + distance * n_W,
                                                    rotary, group_.p_ST);
      const Eigen::Matrix3d R = metrology::R_WS(chain_, Q);
      const Vector3d arm = plant::forward(chain_, Q, group_.p_ST).p_WT +
                           machine.error(Q, group_.p_ST).dp_W + R * stylus - centre;
      return arm.norm() - trigger(R.transpose() * arm.normalized());
    };
    double low = kRadius - 1e-3, high = kRadius + 1e-3;
    for (int step = 0; step < 60; ++step) {
      const double middle = 0.5 * (low + high);
      (gap(middle) > 0.0 ? high : low) = middle;
    }
    readings::Reading row;
    const double distance = is_nominal_ ? kRadius : low;
    row.Q =
        *plant::inverse_fixed_rotary(chain_, kPlaces[sphere] + distance * n_W, rotary, group_.p_ST);
    row.sphere = sphere;
    row.line = int(group_.rows.size()) + 2;
    group_.rows.push_back(row);
  }

  // Nine touches a pose, at the same places of the sphere however the table is turned.
  void touch_all() {
    for (std::size_t sphere = 0; sphere < 2; ++sphere) {
      for (const double a : {-0.5, 0.0, 0.6}) {
        for (int c = 0; c < 6; ++c) {
          Joints rotary = Joints::Zero();
          rotary[3] = a;
          rotary[4] = std::numbers::pi / 3.0 * c;
          touch(sphere, rotary, Vector3d::UnitZ());
          for (const double height : {0.2, 0.9}) {
            for (int k = 0; k < 4; ++k) {
              const double angle = 0.5 * std::numbers::pi * k + 0.3;
              touch(sphere, rotary,
                    {std::cos(height) * std::cos(angle), std::cos(height) * std::sin(angle),
                     std::sin(height)});
            }
          }
        }
      }
    }
  }

  Adjustment adjusted() const {
    readings::Readings all;
    all.groups = {group_};
    return calibrate(all, chain_, settings_).adjustment;
  }

  // Largest error of the locations that the touches determine alone.
  double largest_error(const Adjustment& found) const {
    double most = 0.0;
    int determined = 0;
    for (const plant::ErrorName& name : settings_.errors) {
      if (is_combined(found, name)) continue;
      ++determined;
      most = std::max(most, std::abs(value_of(found, name) - truth_.location(name)));
    }
    EXPECT_EQ(determined, 7);  // all but EX0C, which the stylus hides, and squarenesses
    return most;
  }

  static constexpr double kRadius = 15e-3;  // m, of sphere and stylus
  static constexpr double kLobes = 2e-6;    // m
  const Vector3d kPlaces[2] = {{0.15, 0.0, 0.05}, {-0.05, 0.1, 0.12}};
  plant::MachineChain chain_ = trunnion();
  plant::ErrorModel truth_;
  CalibrationSettings settings_;
  readings::Group group_;
  bool is_nominal_ = false;  // touches stand where they nominally would
};

TEST_F(Probing, FindsTheRotaryAxesFromSingleTouches) {
  touch_all();
  group_.lobes = 3;
  group_.lobe_size = 5e-6;
  const Adjustment found = adjusted();
  EXPECT_LT(largest_error(found), 0.02e-6);
  // the pre-travel of the probe comes out, too: cos 3 and sin 3 of its azimuth
  const std::vector<SetUpUnknown>& set_up = found.unknowns.set_up;
  for (std::size_t u = 0; u < set_up.size(); ++u) {
    if (set_up[u].name == "pre-travel cos 3") {
      EXPECT_NEAR(found.values[Eigen::Index(u)], -kLobes * std::cos(0.4), 0.02e-6);
    } else if (set_up[u].name == "pre-travel sin 3") {
      EXPECT_NEAR(found.values[Eigen::Index(u)], -kLobes * std::sin(0.4), 0.02e-6);
    } else if (set_up[u].name == "radius") {
      EXPECT_NEAR(found.values[Eigen::Index(u)], -4e-6, 0.02e-6);
    }
  }
}

TEST_F(Probing, PreTravelThatNothingAllowsForGoesIntoTheAxes) {
  touch_all();
  EXPECT_GT(largest_error(adjusted()), 0.2e-6);
}

TEST_F(Probing, WantsThreeTouchesAPose) {
  touch(0, Joints::Zero(), Vector3d::UnitZ());
  EXPECT_EQ(fault_messages([&] { adjusted(); }),
            "sphere outer is touched once at these angles of the rotary axes; at least three "
            "touches are required\n");
}

// To second order in what shifts the stylus, over the radius: (20 um)^2 / 30 mm.
TEST_F(Probing, MadeUpTouchesAreFoundAgain) {
  for (const plant::ErrorName& name : settings_.errors) truth_.location(name) *= 0.25;
  is_nominal_ = true;
  touch_all();
  group_.lobes = 3;
  group_.lobe_size = 2e-6;
  readings::Readings all;
  all.groups = {group_};
  make_up(all, chain_, truth_, 5);
  group_ = all.groups[0];
  EXPECT_LT(largest_error(adjusted()), 0.05e-6);
}

// Twenty-five balls over 0.8 m.
readings::Artefact plate() {
  readings::Artefact out;
  out.name = "plate";
  out.file = "plate.csv";
  for (int i = 0; i < 25; ++i) {
    out.balls.push_back({.name = std::to_string(i), .centre = {0.2 * (i % 5), 0.2 * (i / 5), 0.0}});
  }
  return out;
}

// The plate on the table, turned by quarter turns, seen with noise of the group.
readings::Group plate_at(const readings::Artefact& plate, int quarter, double height) {
  readings::Group out;
  out.kind = Kind::sphere;
  out.name = "plate " + std::to_string(quarter) + " at " + std::to_string(height);
  out.file = "plate at.csv";
  out.artefact = 0;
  out.p_ST = {0.0, 0.0, -0.1};
  out.uncertainty = 0.3e-6;
  out.tool_is_known = true;
  const Eigen::AngleAxisd turn(0.5 * std::numbers::pi * quarter, Vector3d::UnitZ());
  for (const readings::Ball& ball : plate.balls) {
    const Vector3d p = turn * (ball.centre - Vector3d(0.4, 0.4, 0.0)) + Vector3d(0.5, 0.5, height);
    readings::Reading row;
    row.Q = *plant::inverse_fixed_rotary(gantry(), p, Joints::Zero(), out.p_ST);
    row.sphere = out.spheres.size();
    row.line = int(out.rows.size()) + 2;
    out.spheres.push_back(ball.name);
    out.rows.push_back(row);
  }
  return out;
}

class BallPlate : public testing::Test {
 protected:
  BallPlate() {
    truth_.location("EC0Y"_err) = 30e-6;
    truth_.component("EXX"_err).polynomial = {-20e-6, 40e-6};
    truth_.component("EYY"_err).polynomial = {5e-6, -10e-6};
    settings_.errors = {"EC0Y"_err, "EXX"_err, "EYY"_err};
    settings_.form_linear.degree = 2;
  }

  Calibration calibrated(double uncertainty, std::vector<int> quarters) const {
    readings::Readings all;
    all.artefacts = {plate()};
    all.artefacts[0].uncertainty = uncertainty;
    for (const int quarter : quarters) all.groups.push_back(plate_at(plate(), quarter, -0.3));
    make_up(all, gantry(), truth_, 11);
    return calibrate(all, gantry(), settings_);
  }

  // Error of EXX over 0.8 m, and its standard uncertainty.
  std::pair<double, double> stretch(const Adjustment& found) const {
    for (const KnownFunction& known : functions_along_travel(found)) {
      if (known.name != "EXX"_err) continue;
      const double length = known.s.back() - known.s.front();
      return {known.value.back() - known.value.front() - 40e-6 * length,
              std::hypot(known.sigma.back(), known.sigma.front())};
    }
    return {1.0, 0.0};
  }

  plant::ErrorModel truth_;
  CalibrationSettings settings_;
};

TEST_F(BallPlate, WhoseCentresAreCalibratedTellsScaleAndSquareness) {
  const Adjustment found = calibrated(0.4e-6, {0}).adjustment;
  EXPECT_FALSE(is_combined(found, "EC0Y"_err));
  EXPECT_LT(std::abs(value_of(found, "EC0Y"_err) - 30e-6), 4.0 * sigma_of(found, "EC0Y"_err));
  EXPECT_LT(sigma_of(found, "EC0Y"_err), 0.8e-6);
  const auto [error, sigma] = stretch(found);
  EXPECT_LT(std::abs(error), 4.0 * sigma);
  EXPECT_LT(sigma, 1e-6);
}

// A plate that nobody has calibrated, turned by a quarter: what turns with it belongs to it.
// Its squareness changes the sign, that of the machine does not; its length stays unknown, and
// with it the mean of the scales.
TEST_F(BallPlate, WhoseCentresAreUnknownTellsSquarenessByReversal) {
  const Adjustment found = calibrated(1e-3, {0, 1}).adjustment;
  EXPECT_LT(sigma_of(found, "EC0Y"_err), 0.8e-6);
  EXPECT_LT(std::abs(value_of(found, "EC0Y"_err) - 30e-6), 4.0 * sigma_of(found, "EC0Y"_err));
  EXPECT_GT(stretch(found).second, 20e-6);
  const Adjustment once = calibrated(1e-3, {0}).adjustment;
  EXPECT_GT(sigma_of(once, "EC0Y"_err), 100e-6);
}

// Walls and holes of a square plate that a machine has cut with EC0Y = 30 urad, as a measuring
// machine sees it: datum, and tool radius, free.
TEST(Part, TellsTheSquarenessOfTheMachineThatHasCutIt) {
  plant::ErrorModel truth;
  truth.location("EC0Y"_err) = 30e-6;
  const plant::VolumetricModel machine(gantry(), truth);
  readings::Group group;
  group.kind = Kind::part;
  group.name = "part";
  group.file = "part.csv";
  group.p_ST = {0.0, 0.0, -0.1};
  group.uncertainty = 0.1e-6;
  const Eigen::AngleAxisd turn(20e-6, Vector3d(0.3, -0.2, 0.9).normalized());
  const auto add = [&](double x, double y, const Vector3d& n) {
    readings::Reading row;
    row.Q.head<3>() << x, y, -0.1;
    row.normal = n;
    const Vector3d e = machine.error(row.Q, group.p_ST).dp_W;
    const Vector3d place(x - 0.4, y - 0.4, 0.0);
    const Vector3d datum = turn * place - place + Vector3d(5e-6, -8e-6, 3e-6);
    row.deviation[0] = n.dot(e + datum) - 12e-6;  // the tool is 12 um thicker than it should be
    row.line = int(group.rows.size()) + 2;
    group.rows.push_back(row);
  };
  for (const double s : {0.2, 0.3, 0.4, 0.5, 0.6}) {
    add(s, 0.2, -Vector3d::UnitY());
    add(s, 0.6, Vector3d::UnitY());
    add(0.2, s, -Vector3d::UnitX());
    add(0.6, s, Vector3d::UnitX());
  }
  readings::Readings all;
  all.groups = {group};
  CalibrationSettings settings;
  settings.errors = {"EC0Y"_err};
  const Adjustment found = calibrate(all, gantry(), settings).adjustment;
  EXPECT_NEAR(value_of(found, "EC0Y"_err), 30e-6, 1e-9);
  for (std::size_t u = 0; u < found.unknowns.set_up.size(); ++u) {
    if (found.unknowns.set_up[u].name == "radius of the tool") {
      EXPECT_NEAR(found.values[Eigen::Index(u)], 12e-6, 1e-9);
    }
  }
}

// A laser 0.2 m before the first target, whose wavelength has changed by k at the last row: that
// row is off by k (0.2 m + 1 m).
TEST(DeadPath, CountsWithTheLengthMeasured) {
  readings::Readings all;
  all.groups = {line(Kind::positioning, Axis::X, Joints::Zero(), Vector3d::Zero(), 1e-6)};
  all.groups[0].dead_path = readings::DeadPath{.length = 0.2, .change = 0.3e-6};
  const Observations found = observations_of(all, gantry());
  ASSERT_EQ(found.set_up.size(), 2u);
  EXPECT_EQ(found.set_up[1].prior, 0.3e-6);
  const auto factor = [](const Observation& one) { return one.set_up.back().factor; };
  EXPECT_NEAR(factor(found.all.front()), 0.0, 1e-15);
  EXPECT_NEAR(factor(found.all[5]), 0.5 * 0.7, 1e-15);
  EXPECT_NEAR(factor(found.all.back()), 1.2, 1e-15);
}

}  // namespace
}  // namespace servomill::sim::calibration::point_observations_test
