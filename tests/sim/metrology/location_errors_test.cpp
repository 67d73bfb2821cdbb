#include "sim/metrology/location_errors.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "plant/geometry/volumetric.h"
#include "plant/kinematics/inverse.h"
#include "plant/vocabulary/units.h"
#include "tests/plant/kinematics/machine_kinds.h"

namespace servomill::sim::metrology::location_errors_test {
namespace {

using Eigen::Vector3d;
using plant::ErrorModel;
using plant::ErrorName;
using plant::MachineChain;
using plant::VolumetricModel;
using plant::operator""_err;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kWanted = 0.01;     // of every error that can be identified
constexpr double kRounding = 1e-12;  // m, of lengths of 1 m
const Vector3d kTip(0.0, 0.0, -110.0 * mm);
const Vector3d kBall(90.0 * mm, 40.0 * mm, 120.0 * mm);  // in W
const Vector3d kHigherBall(-60.0 * mm, 70.0 * mm, 260.0 * mm);

MachineChain hsm() {
  MachineChain chain = plant::make_chain(plant::parse_structure("[w C' B' X b Y Z t]"));
  chain.at(Axis::B).centre = Vector3d(0.0, 0.0, 50.0 * mm);
  chain.at(Axis::C).centre = Vector3d(0.0, 0.0, 0.0);
  return chain;
}

// Rotary joints (rad) at which a ball is measured: each axis alone, then both at once.
std::vector<Joints> rotary_angles() {
  std::vector<Joints> out;
  const auto add = [&](double one, double other) {
    Joints Q = Joints::Zero();
    Q[3] = one;
    Q[4] = other;
    out.push_back(Q);
  };
  for (int i = 0; i < 24; ++i) add(0.0, kTurn * i / 24);
  for (int i = -6; i <= 6; ++i) add(15.0 * deg * i, 0.0);
  for (int i = 0; i < 24; ++i) add(60.0 * deg * std::sin(kTurn * i / 24), kTurn * i / 24);
  return out;
}

// Three sensors about a ball at p_W that the linear axes follow.
std::vector<SensorReading> r_test(const MachineChain& chain, const Vector3d& p_W,
                                  const std::vector<Joints>& angles, int set_up = 0) {
  std::vector<SensorReading> out;
  for (const Joints& Q_rotary : angles) {
    const auto Q = plant::inverse_fixed_rotary(chain, p_W, Q_rotary, kTip);
    if (!Q) continue;  // two linear axes are parallel there
    for (int i = 0; i < 3; ++i) out.push_back({*Q, kTip, Vector3d::Unit(i), 0.0, set_up});
  }
  return out;
}

void measure(const MachineChain& chain, const ErrorModel& truth,
             std::vector<SensorReading>& readings) {
  const VolumetricModel model(chain, truth);
  for (SensorReading& reading : readings) {
    reading.d = reading.n_W.dot(model.error(reading.Q, reading.p_ST).dp_W);
  }
}

// Typical size of such an error on a machine as built.
double typical(const ErrorName& name) { return is_linear(name.direction) ? 8.0 * um : 25.0 * urad; }

std::vector<std::string> identified(const LocationFit& fit) {
  std::vector<std::string> out;
  for (const LocationEstimate& one : fit.errors) {
    if (one.value) out.push_back(plant::to_string(one.name));
  }
  return out;
}

// DOMAIN facts: with the table turned by R, d = (I - R) e + ((I - R) w) x R p is the ball relative
// to the tip in the axes of the bed; here it is the tip relative to the ball in those of the table.
TEST(RTest, OfATurningTableFollowsTheClosedForm) {
  const MachineChain chain = hsm();
  const Vector3d e(12.0 * um, -7.0 * um, 0.0), w(30.0 * urad, 20.0 * urad, 0.0);
  ErrorModel truth;
  truth.location("EX0C"_err) = e.x();
  truth.location("EY0C"_err) = e.y();
  truth.location("EA0C"_err) = w.x();
  truth.location("EB0C"_err) = w.y();
  const VolumetricModel model(chain, truth);
  constexpr double kSecondOrder = 3e-9;  // m: e times w, w times w times the length of 0.15 m
  for (const Joints& Q_rotary : rotary_angles()) {
    if (Q_rotary[3] != 0.0) continue;
    const Joints Q = *plant::inverse_fixed_rotary(chain, kBall, Q_rotary, kTip);
    const Eigen::Matrix3d R = Eigen::AngleAxisd(-Q[4], Vector3d::UnitZ()).toRotationMatrix();
    const Vector3d d_M = (e - R * e) + (w - R * w).cross(R * kBall);
    const Vector3d d_W = -(R.transpose() * d_M);
    EXPECT_NEAR((model.error(Q, kTip).dp_W - d_W).norm(), 0.0, kSecondOrder) << Q[4] / deg;
    EXPECT_NEAR((model.first_order_error(Q, kTip).dp_W - d_W).norm(), 0.0, kRounding);
  }
}

// With the place of the ball in the spindle and on the table unknown, these remain.
TEST(RTest, IdentifiesEightLocationErrors) {
  const MachineChain chain = hsm();
  const auto fit = observable_locations(chain, r_test(chain, kBall, rotary_angles()), {});
  EXPECT_EQ(identified(fit), (std::vector<std::string>{"EC0Y", "EA0Z", "EB0Z", "EA0C", "EB0C",
                                                       "EA0B", "EC0B", "EX0C"}));
  EXPECT_LT(fit.condition, 300.0);
}

TEST(RTest, SaysAsWhatTheOthersAct) {
  const MachineChain chain = hsm();
  const auto fit = observable_locations(chain, r_test(chain, kBall, rotary_angles()), {});
  std::string text;
  for (const LocationEstimate& one : fit.errors) {
    if (!one.value) text += plant::to_string(one.name) + " " + one.why_not() + "\n";
  }
  EXPECT_EQ(text,
            "EY0C confounded with set-up\n"
            "EX0B confounded with -EX0C and set-up\n"
            "EZ0B confounded with set-up\n"
            "EA0Y confounded with -EA0Z, -EA0C, -EA0B and set-up\n"
            "EB0X confounded with -EB0Z, -EB0C, 0.05 um/urad EX0C and set-up\n"
            "EC0X confounded with -EC0Y, -EC0B and set-up\n");
}

TEST(RTest, RecoversEachOfThemFromTheExactModel) {
  const MachineChain chain = hsm();
  auto readings = r_test(chain, kBall, rotary_angles());
  for (const LocationEstimate& one : observable_locations(chain, readings, {}).errors) {
    if (!one.value) continue;
    ErrorModel truth;
    truth.location(one.name) = typical(one.name);
    measure(chain, truth, readings);
    const LocationFit fit = identify_locations(chain, readings, {});
    const double off = *fit.find(one.name)->value / typical(one.name) - 1.0;
    RecordProperty(plant::to_string(one.name), std::to_string(off));
    EXPECT_NEAR(off, 0.0, kWanted) << plant::to_string(one.name);
  }
}

// Set-up errors of a tenth of a millimetre do not matter.
TEST(RTest, DoesNotSeeHowTheBallWasSetUp) {
  const MachineChain chain = hsm();
  auto readings = r_test(chain, kBall, rotary_angles());
  ErrorModel truth;
  truth.location("EA0C"_err) = 25.0 * urad;
  measure(chain, truth, readings);
  const Vector3d nest(100.0 * um, -50.0 * um, 80.0 * um), ball(-20.0 * um, 90.0 * um, 60.0 * um);
  for (SensorReading& reading : readings) {
    const Vector3d moved = plant::forward(chain, reading.Q, kTip + ball).p_WT -
                           plant::forward(chain, reading.Q, kTip).p_WT;
    reading.d += reading.n_W.dot(moved - nest);
  }
  const LocationFit fit = identify_locations(chain, readings, {});
  EXPECT_NEAR(*fit.find("EA0C"_err)->value, 25.0 * urad, kWanted * 25.0 * urad);
  EXPECT_NEAR(*fit.find("EX0C"_err)->value, 0.0, 1e-9);
}

// A ball that has been adjusted to the spindle also tells where the axes lie to the spindle.
TEST(RTest, TellsMoreWithABallAdjustedToTheSpindle) {
  const MachineChain chain = hsm();
  auto readings = r_test(chain, kBall, rotary_angles());
  const RTestSetUp set_up{.tcp_is_unknown = false};
  ErrorModel truth;
  const auto can_be = observable_locations(chain, readings, set_up);
  EXPECT_EQ(identified(can_be),
            (std::vector<std::string>{"EC0Y", "EA0Z", "EB0Z", "EA0C", "EB0C", "EA0B", "EC0B",
                                      "EX0C", "EY0C", "EX0B", "EZ0B"}));
  for (const LocationEstimate& one : can_be.errors) {
    if (one.value) truth.location(one.name) = typical(one.name);
  }
  measure(chain, truth, readings);
  const LocationFit fit = identify_locations(chain, readings, set_up);
  for (const LocationEstimate& one : fit.errors) {
    if (!one.value) continue;
    EXPECT_NEAR(*one.value, typical(one.name), kWanted * typical(one.name))
        << plant::to_string(one.name);
  }
}

// C alone does not excite B, and sees its own tilts only beside those of the linear axes.
TEST(RTest, OfOneAxisTellsLess) {
  const MachineChain chain = hsm();
  std::vector<Joints> angles = rotary_angles();
  angles.resize(24);
  const auto fit = observable_locations(chain, r_test(chain, kBall, angles), {});
  EXPECT_EQ(identified(fit), (std::vector<std::string>{"EC0Y", "EA0C", "EB0C"}));
  EXPECT_EQ(fit.find("EA0Z"_err)->why_not(), "confounded with set-up");
  EXPECT_EQ(fit.find("EA0B"_err)->why_not(), "has no effect");
}

TEST(RTest, UncertaintyIsThatOfIndependentNoise) {
  const MachineChain chain = hsm();
  auto readings = r_test(chain, kBall, rotary_angles());
  plant::Uniform random(7);
  constexpr double kSigma = 1.0 * um;
  constexpr int kRuns = 100;
  double squares = 0.0, stated = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    for (SensorReading& reading : readings) reading.d = kSigma * std::sqrt(3.0) * random();
    const LocationFit fit = identify_locations(chain, readings, {});
    squares += std::pow(*fit.find("EB0C"_err)->value, 2) / kRuns;
    stated += std::pow(fit.find("EB0C"_err)->uncertainty, 2) / kRuns;
  }
  EXPECT_NEAR(std::sqrt(stated / squares), 1.0, 3.0 / std::sqrt(2.0 * kRuns));  // three sigma
}

// With a rotary axis in the head, one height of the ball leaves the tilt of that axis and of Z
// together: Z goes as the tilted lever does. Unknowns that were kept are as many as there are
// singular values that are not zero.
TEST(LocationErrors, AreEightOnEveryFiveAxisMachine) {
  plant::Uniform random(5);
  for (const plant::Kind& kind : plant::kKinds) {
    const MachineChain chain = plant::random_chain_of(kind, random);
    auto readings = r_test(chain, kBall, rotary_angles());
    const auto higher = r_test(chain, kHigherBall, rotary_angles(), 1);
    readings.insert(readings.end(), higher.begin(), higher.end());
    const auto fit = observable_locations(chain, readings, {});
    EXPECT_EQ(fit.number_identified(), 8) << kind.name;
    EXPECT_EQ(fit.rank, fit.number_identified() + 3 + 2 * 3) << kind.name;
  }
}

// A cone on a wedge (deg): the tip goes around a circle in a plane tilted by `wedge` about Y, the
// tool axis along a cone about its normal.
struct Frustum {
  double wedge, cone;
};

// BK4, a ball bar between the tip and a centre below that of the circle.
std::vector<SensorReading> bk4(const MachineChain& chain, const Vector3d& circle, double bar_height,
                               const Frustum& frustum, int set_up) {
  const double cone = frustum.cone * deg;
  const Eigen::Matrix3d tilt =
      Eigen::AngleAxisd(frustum.wedge * deg, Vector3d::UnitY()).toRotationMatrix();
  const plant::InverseKinematics inverse(chain);
  std::vector<SensorReading> out;
  Joints Q = Joints::Zero();
  for (int i = 0; i < 72; ++i) {
    const Vector3d u(std::cos(kTurn * i / 72), std::sin(kTurn * i / 72), 0.0);
    const Vector3d k = tilt * (std::sin(cone) * u + std::cos(cone) * Vector3d::UnitZ());
    const Vector3d p = circle + tilt * (100.0 * mm * u);
    Q = inverse.nearest({p, k}, kTip, Q).Q;
    const Vector3d bar = tilt * (100.0 * mm * u - bar_height * Vector3d::UnitZ());
    out.push_back({Q, kTip, bar.normalized(), 0.0, set_up});
  }
  return out;
}

// EC0B moves the tip by k x p, with the tool axis k = cos a m + sin a u (normal m of the circle, u
// towards the tip) and p = c + r u. Along a bar whose centre is on m that is a first harmonic of u,
// which a shift of the centre does, too: cone frusta are blind to it, however large.
TEST(BallBar, RecoversAllOfTheEightButOneFromFourCircles) {
  const MachineChain chain = hsm();
  std::vector<SensorReading> readings;
  for (int n = 0; n < 4; ++n) {
    const Vector3d circle =
        n < 2 ? Vector3d(0.0, 0.0, 60.0 * mm) : Vector3d(80.0 * mm, -60.0 * mm, 140.0 * mm);
    const auto one = bk4(chain, circle, n % 2 == 0 ? 0.0 : 150.0 * mm,
                         n < 2 ? Frustum{10.0, 15.0} : Frustum{30.0, 45.0}, n);
    readings.insert(readings.end(), one.begin(), one.end());
  }
  const RTestSetUp set_up{.tcp_is_unknown = true, .length_is_unknown = true};
  const auto fit = observable_locations(chain, readings, set_up);
  EXPECT_EQ(identified(fit),
            (std::vector<std::string>{"EC0Y", "EA0Z", "EB0Z", "EA0C", "EB0C", "EA0B", "EX0C"}));
  EXPECT_EQ(fit.find("EC0B"_err)->why_not(), "confounded with set-up");
  for (const LocationEstimate& one : fit.errors) {
    if (!one.value) continue;
    ErrorModel truth;
    truth.location(one.name) = typical(one.name);
    measure(chain, truth, readings);
    const LocationFit found = identify_locations(chain, readings, set_up);
    const double off = *found.find(one.name)->value / typical(one.name) - 1.0;
    RecordProperty(plant::to_string(one.name), std::to_string(off));
    EXPECT_NEAR(off, 0.0, kWanted) << plant::to_string(one.name);
  }
}

}  // namespace
}  // namespace servomill::sim::metrology::location_errors_test
