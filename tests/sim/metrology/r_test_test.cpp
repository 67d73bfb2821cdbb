#include "sim/metrology/r_test.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>

#include "plant/geometry/volumetric.h"
#include "plant/vocabulary/units.h"

namespace servomill::sim::metrology::r_test_test {
namespace {

using Eigen::Vector3d;
using plant::MachineChain;
using plant::operator""_err;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kRounding = 1e-15;  // m, of displacements of 0.1 mm between places of 0.3 m
const Vector3d kTip(0.0, 0.0, -110.0 * mm);
const Vector3d kBall(90.0 * mm, 40.0 * mm, 120.0 * mm);  // in W

MachineChain hsm() {
  MachineChain chain = plant::make_chain(plant::parse_structure("[w C' B' X b Y Z t]"));
  chain.at(Axis::B).centre = Vector3d(0.0, 0.0, 50.0 * mm);
  return chain;
}

// The tip stands at p_W while the rotary joints take these angles (rad), without errors.
TipPath standing(const MachineChain& chain, const Vector3d& p_W,
                 const std::vector<std::pair<double, double>>& B_C) {
  TipPath path;
  for (const auto& [B, C] : B_C) {
    Joints Q = Joints::Zero();
    Q[chain.at(Axis::B).joint] = B;
    Q[chain.at(Axis::C).joint] = C;
    path.Q.push_back(*plant::inverse_fixed_rotary(chain, p_W, Q, kTip));
    path.nominal.push_back(p_W);
  }
  path.actual = path.nominal;
  return path;
}

std::vector<std::pair<double, double>> C_turns(double B = 0.0, int count = 24) {
  std::vector<std::pair<double, double>> out;
  for (int i = 0; i <= count; ++i) out.emplace_back(B, kTurn * i / count);
  return out;
}

std::vector<std::pair<double, double>> B_turns(double C = 0.0) {
  std::vector<std::pair<double, double>> out;
  for (int i = -6; i <= 6; ++i) out.emplace_back(10.0 * deg * i, C);
  return out;
}

TipPath displaced(TipPath path, const Vector3d& d_W) {
  for (Vector3d& p : path.actual) p += d_W;
  return path;
}

double range(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *high - *low;
}

// With the table turned by R the ball is off by d = (I - R) e + ((I - R) w) x R p, in the axes of
// the bed; sensors that turn with the table read the tip relative to it, -R^T d.
TEST(NestOfSensors, FollowsTheClosedFormOfATurningTable) {
  const MachineChain chain = hsm();
  const Vector3d e(12.0 * um, -7.0 * um, 0.0), w(30.0 * urad, 20.0 * urad, 0.0);
  plant::ErrorModel truth;
  truth.location("EX0C"_err) = e.x();
  truth.location("EY0C"_err) = e.y();
  truth.location("EA0C"_err) = w.x();
  truth.location("EB0C"_err) = w.y();
  const plant::VolumetricModel model(chain, truth);
  TipPath path = standing(chain, kBall, C_turns());
  for (std::size_t n = 0; n < path.Q.size(); ++n) {
    path.actual[n] += model.error(path.Q[n], kTip).dp_W;
  }
  const auto radial = nest_deviation(chain, path, NestDirection::radial);
  const auto axial = nest_deviation(chain, path, NestDirection::axial);
  const auto tangential = nest_deviation(chain, path, NestDirection::tangential);

  const Vector3d r = Vector3d(kBall.x(), kBall.y(), 0.0).normalized(), z = Vector3d::UnitZ();
  constexpr double kSecondOrder = 3e-9;  // m: e times w, w times w times the length of 0.15 m
  for (std::size_t n = 0; n < path.Q.size(); ++n) {
    const Eigen::Matrix3d R =
        Eigen::AngleAxisd(-path.Q[n][chain.at(Axis::C).joint], z).toRotationMatrix();
    const Vector3d d = -(R.transpose() * (e - R * e + (w - R * w).cross(R * kBall)));
    EXPECT_NEAR(radial.d[n], d.dot(r), kSecondOrder);
    EXPECT_NEAR(axial.d[n], d.dot(z), kSecondOrder);
    EXPECT_NEAR(tangential.d[n], d.dot(z.cross(r)), kSecondOrder);
  }
}

// Known by inspection: an axis out of place by e moves the ball by 2 e, one that leans by w lifts a
// ball at the radius r by 2 r w.
TEST(NestOfSensors, ShowsAnOffsetTwiceAndATiltTwiceTheRadius) {
  const MachineChain chain = hsm();
  const double e = 10.0 * um, w = 20.0 * urad, r = std::hypot(kBall.x(), kBall.y());
  plant::ErrorModel offset, tilt;
  offset.location("EX0C"_err) = e;
  tilt.location("EA0C"_err) = w;
  const auto measured = [&](const plant::ErrorModel& truth, NestDirection direction) {
    const plant::VolumetricModel model(chain, truth);
    TipPath path = standing(chain, kBall, C_turns(0.0, 360));
    for (std::size_t n = 0; n < path.Q.size(); ++n) {
      path.actual[n] += model.error(path.Q[n], kTip).dp_W;
    }
    return range(nest_deviation(chain, path, direction).d);
  };
  constexpr double kOfAngles = 1e-4;  // angles a degree apart miss the extremes by half at most
  EXPECT_NEAR(measured(offset, NestDirection::radial) / (2.0 * e), 1.0, kOfAngles);
  EXPECT_NEAR(measured(offset, NestDirection::tangential) / (2.0 * e), 1.0, kOfAngles);
  EXPECT_LT(measured(offset, NestDirection::axial), kRounding);
  EXPECT_NEAR(measured(tilt, NestDirection::axial) / (2.0 * r * w), 1.0, kOfAngles);
}

// B lies along Y of the bed through Z = 50 mm; with C at 90 deg that is -X of the workpiece.
TEST(NestOfSensors, ReadsAlongTheAxisThatTurns) {
  const MachineChain chain = hsm();
  const Vector3d d(3.0 * um, 5.0 * um, -7.0 * um);
  const TipPath path = displaced(standing(chain, kBall, B_turns(90.0 * deg)), d);
  const Vector3d along(-1.0, 0.0, 0.0);
  const Vector3d radial = Vector3d(0.0, 40.0, 120.0 - 50.0).normalized();
  for (const double x : nest_deviation(chain, path, NestDirection::axial).d) {
    EXPECT_NEAR(x, d.dot(along), kRounding);
  }
  for (const double x : nest_deviation(chain, path, NestDirection::radial).d) {
    EXPECT_NEAR(x, d.dot(radial), kRounding);
  }
  for (const double x : nest_deviation(chain, path, NestDirection::tangential).d) {
    EXPECT_NEAR(x, d.dot(along.cross(radial)), kRounding);
  }
}

// An axis that counts as the table turns: away stays away, along and around change sign.
TEST(NestOfSensors, FollowsTheSenseOfTheAxis) {
  MachineChain chain = hsm();
  const TipPath path =
      displaced(standing(chain, kBall, C_turns()), Vector3d(1.0 * um, 2.0 * um, 3.0 * um));
  MachineChain table = chain;
  table.at(Axis::C).sense = plant::Sense::table;
  for (const auto& [direction, sign] :
       {std::pair{NestDirection::radial, 1.0}, std::pair{NestDirection::axial, -1.0},
        std::pair{NestDirection::tangential, -1.0}}) {
    EXPECT_NEAR(nest_deviation(table, path, direction).d[0],
                sign * nest_deviation(chain, path, direction).d[0], kRounding);
  }
}

TEST(NestOfSensors, NeedsOneAxisThatTurnsAndABallBesideIt) {
  const MachineChain chain = hsm();
  const auto why_not = [&](const Vector3d& p, const std::vector<std::pair<double, double>>& B_C) {
    return nest_deviation(chain, standing(chain, p, B_C), NestDirection::radial).why_not;
  };
  EXPECT_EQ(why_not(kBall, C_turns()), "");
  EXPECT_EQ(why_not(kBall, {{0.0, 0.0}, {0.1, 0.2}}), "not exactly one rotary axis moves");
  EXPECT_EQ(why_not(kBall, {{0.1, 0.2}, {0.1, 0.2}}), "not exactly one rotary axis moves");
  EXPECT_EQ(why_not(kBall, {}), "not exactly one rotary axis moves");
  EXPECT_EQ(why_not({0.0, 0.0, 80.0 * mm}, C_turns()), "the ball is on the moving rotary axis");
}

// Tips on a sphere around a centre, as a bar allows them.
TipPath on_sphere(const Vector3d& centre, double radius) {
  const MachineChain chain = hsm();
  TipPath path;
  for (int i = 0; i < 12; ++i) {
    const Vector3d n(std::cos(0.5 * i), std::sin(0.5 * i), 0.2 * i);
    const TipPath one = standing(chain, centre + radius * n.normalized(), {{0.1 * i, 0.2 * i}});
    path.Q.push_back(one.Q[0]);
    path.nominal.push_back(one.nominal[0]);
  }
  path.actual = path.nominal;
  return path;
}

TEST(BallBar, ReadsItsLength) {
  const Vector3d centre(5.0 * mm, -3.0 * mm, 150.0 * mm);
  TipPath path = on_sphere(centre, 100.0 * mm);
  for (Vector3d& p : path.actual) p = centre + 1.0001 * (p - centre);
  for (const double d : bar_deviation(path, centre).d) EXPECT_NEAR(d, 10.0 * um, kRounding);

  path = displaced(on_sphere(centre, 100.0 * mm), Vector3d(0.0, 0.0, 8.0 * um));
  constexpr double kAcross = 8e-6 * 8e-6 / 0.1;  // m: the square of the shift over the length
  const auto found = bar_deviation(path, centre);
  for (std::size_t n = 0; n < found.d.size(); ++n) {
    EXPECT_NEAR(found.d[n], 8.0 * um * (path.nominal[n] - centre).z() / (100.0 * mm), kAcross);
  }
}

TEST(BallBar, NeedsATipThatKeepsItsDistance) {
  const Vector3d centre(5.0 * mm, -3.0 * mm, 150.0 * mm);
  TipPath path = on_sphere(centre, 100.0 * mm);
  path.nominal[3] = centre + 1.000009 * (path.nominal[3] - centre);  // by 0.9 um
  EXPECT_EQ(bar_deviation(path, centre).why_not, "");
  path.nominal[3] = centre + 1.000002 * (path.nominal[3] - centre);  // by 1.1 um
  EXPECT_EQ(bar_deviation(path, centre).why_not,
            "the TCP does not keep its distance from the centre of the bar");
  EXPECT_EQ(bar_readings(hsm(), path, centre, 5).why_not,
            "the TCP does not keep its distance from the centre of the bar");
  EXPECT_EQ(bar_deviation(on_sphere(centre, 0.1 * mm), centre).why_not,
            "the TCP passes through the centre of the bar");
  EXPECT_EQ(bar_deviation({}, centre).why_not, "there are no samples");
}

TEST(Readings, OfANestAreThreeASampleWithASetUpForEachPlace) {
  const MachineChain chain = hsm();
  const Vector3d higher = kBall + Vector3d(0.0, 0.0, 80.0 * mm), d(1.0 * um, 2.0 * um, 3.0 * um);
  TipPath path = standing(chain, kBall, C_turns());
  const TipPath other = standing(chain, higher, C_turns());
  path.Q.insert(path.Q.end(), other.Q.begin(), other.Q.end());
  path.nominal.insert(path.nominal.end(), other.nominal.begin(), other.nominal.end());
  path.actual = path.nominal;
  const BallReadings found = nest_readings(chain, displaced(path, d), 2);
  ASSERT_EQ(found.readings.size(), 3 * path.Q.size());
  for (std::size_t i = 0; i < found.readings.size(); ++i) {
    const SensorReading& one = found.readings[i];
    const auto along = static_cast<Eigen::Index>(i % 3);
    EXPECT_EQ(one.n_W, Vector3d(Vector3d::Unit(along)));
    EXPECT_NEAR(one.d, d[along], kRounding);
    EXPECT_EQ(one.set_up, i < found.readings.size() / 2 ? 0 : 1);
    EXPECT_NEAR((one.p_ST - kTip).norm(), 0.0, kRounding);
  }
  EXPECT_EQ(nest_readings(chain, path, 1).why_not, "the TCP does not stay at rest in its sections");
  EXPECT_EQ(nest_readings(chain, {}, 1).why_not, "there are no samples");
}

// The fit costs with their number; it does not need every sample of a long test.
TEST(Readings, AreAtMostTwentyThousandSamplesEvenly) {
  const MachineChain chain = hsm();
  const TipPath one = standing(chain, kBall, C_turns(0.0, 100));
  TipPath path;
  const auto with_samples = [&](std::size_t count) {
    path.Q.assign(count, one.Q[0]);
    path.Q.back() = one.Q[1];
    path.nominal = path.actual = std::vector<Vector3d>(count, kBall);
    return nest_readings(chain, path, 1).readings;
  };
  EXPECT_EQ(with_samples(19999).size(), 3U * 19999U);
  const auto found = with_samples(49999);
  EXPECT_EQ(found.size(), 3U * 16667U);  // every third
  EXPECT_EQ(found.back().Q, one.Q[1]);
}

TEST(Readings, OfABarAreAlongIt) {
  const Vector3d centre(5.0 * mm, -3.0 * mm, 150.0 * mm);
  const TipPath path = displaced(on_sphere(centre, 100.0 * mm), Vector3d(0.0, 0.0, 8.0 * um));
  const BallReadings found = bar_readings(hsm(), path, centre, 5);
  ASSERT_EQ(found.readings.size(), path.Q.size());
  const std::vector<double> d = bar_deviation(path, centre).d;
  for (std::size_t n = 0; n < d.size(); ++n) {
    EXPECT_NEAR((100.0 * mm * found.readings[n].n_W - (path.nominal[n] - centre)).norm(), 0.0,
                kRounding);
    EXPECT_EQ(found.readings[n].d, d[n]);
    EXPECT_EQ(found.readings[n].set_up, 5);
  }
}

}  // namespace
}  // namespace servomill::sim::metrology::r_test_test
