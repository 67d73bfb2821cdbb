// Lumped bodies that store and conduct heat.
#include "plant/heat/thermal_network.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <random>
#include <unsupported/Eigen/MatrixFunctions>

namespace servomill::plant::thermal_network_test {
namespace {

using Eigen::VectorXd;

constexpr double kPi = std::numbers::pi;
constexpr double kRoom = 293.15;  // K

// One body in a room.
ThermalParams one_body(double C, double G) {
  return {{{"spindle", C}}, {{"room", kRoom}}, {}, {{0, 0, G}}};
}

// --- closed forms -------------------------------------------------------------------------------

TEST(ThermalNetwork, RisesByPowerOverConductanceWithItsTimeConstant) {
  constexpr double C = 8000.0, G = 6.0, P = 150.0;
  ThermalNetwork network(one_body(C, G));
  network.start(VectorXd::Constant(1, kRoom));
  const VectorXd power = VectorXd::Constant(1, P);
  for (int n = 0; n < 360; ++n) {
    network.advance(10.0 * n, 10.0, power);
    const double t = 10.0 * (n + 1);
    EXPECT_NEAR(network.temperatures()[0], kRoom + P / G * (1.0 - std::exp(-G / C * t)), 1e-10);
  }
  EXPECT_NEAR(network.settled(power, 0.0)[0], kRoom + P / G, 1e-10);
  EXPECT_NEAR(network.slowest(), C / G, 1e-9);
}

// The body follows a daily course with 1/sqrt(1 + (w tau)^2) of its amplitude, atan(w tau) later.
TEST(ThermalNetwork, FollowsAPeriodicRoomLater) {
  constexpr double C = 4e6, G = 150.0, kDay = 86400.0, w = 2.0 * kPi / kDay, tau = C / G;
  ThermalParams params = one_body(C, G);
  params.surroundings[0] = {"room", kRoom, 2.0, kDay, 15.0 * 3600.0};
  ThermalNetwork network(params);
  network.start(VectorXd::Constant(1, kRoom));
  const VectorXd none = VectorXd::Zero(1);
  constexpr double h = 10.0;
  const auto settled = static_cast<int>(30.0 * tau / h);
  for (int n = 0; n < settled + 8640; ++n) {
    network.advance(h * n, h, none);
    if (n < settled) continue;
    const double t = h * (n + 1), gain = 1.0 / std::hypot(1.0, w * tau);
    const double expected =
        kRoom + 2.0 * gain * std::cos(w * (t - 15.0 * 3600.0) - std::atan(w * tau));
    EXPECT_NEAR(network.temperatures()[0], expected, 2.0 * 1e-6) << t;
  }
}

// Head and column: the eigenvalues of a symmetric matrix of two, by hand.
TEST(ThermalNetwork, OfTwoBodiesDecaysWithBothTimeConstants) {
  constexpr double C1 = 5e3, C2 = 4e4, G12 = 8.0, G2 = 20.0;
  ThermalNetwork network(
      {{{"head", C1}, {"column", C2}}, {{"room", kRoom}}, {{0, 1, G12}}, {{1, 0, G2}}});
  VectorXd T(2);
  T << kRoom + 10.0, kRoom;
  network.start(T);
  // T1' = -a T1 + a T2, T2' = b T1 - c T2 above the room
  constexpr double a = G12 / C1, b = G12 / C2, c = (G12 + G2) / C2;
  const double root = std::sqrt((a - c) * (a - c) + 4.0 * a * b);
  const double fast = 0.5 * (a + c + root), slow = 0.5 * (a + c - root);
  // T1 = A e^-fast t + B e^-slow t with T1(0) = 10 and T1'(0) = -10 a
  const double A = 10.0 * (a - slow) / (fast - slow), B = 10.0 - A;
  const VectorXd none = VectorXd::Zero(2);
  double t = 0.0;
  for (const double h : {0.1, 1.0, 30.0, 600.0, 1800.0, 7200.0}) {
    network.advance(t, h, none);
    t += h;
    const double T1 = A * std::exp(-fast * t) + B * std::exp(-slow * t);
    const double T2 =
        (A * (a - fast) * std::exp(-fast * t) + B * (a - slow) * std::exp(-slow * t)) / a;
    EXPECT_NEAR(network.temperatures()[0], kRoom + T1, 1e-9) << t;
    EXPECT_NEAR(network.temperatures()[1], kRoom + T2, 1e-9) << t;
  }
}

// --- any network --------------------------------------------------------------------------------

struct Drawn {
  ThermalParams params;
  VectorXd T, power;
};

Drawn drawn(unsigned seed) {
  std::mt19937_64 random(seed);
  const auto between = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  Drawn out;
  const int n = 2 + static_cast<int>(seed % 9);
  for (int i = 0; i < n; ++i) {
    out.params.bodies.push_back(
        {std::string(1, static_cast<char>('a' + i)), std::exp(between(5, 13))});
    if (i > 0) {
      const int other = static_cast<int>(between(0.0, i));
      out.params.links.push_back({i, other, std::exp(between(-1, 5))});
    }
  }
  out.params.surroundings = {{"room", kRoom, between(0, 3), 86400.0, between(0, 86400)},
                             {"coolant", between(288, 298)}};
  out.params.surface_links = {{0, 0, between(1, 30)}, {n - 1, 1, between(1, 30)}};
  out.T = VectorXd::NullaryExpr(n, [&] { return between(280, 340); });
  out.power = VectorXd::NullaryExpr(n, [&] { return between(0, 300); });
  return out;
}

// The same equations as one matrix exponential: (T, 1, t) with surroundings that rise linearly.
VectorXd by_exponential(const Drawn& d, double t, double h) {
  const auto n = static_cast<Eigen::Index>(d.params.bodies.size());
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n + 2, n + 2);
  const auto C = [&](int i) { return d.params.bodies[static_cast<std::size_t>(i)].capacity; };
  const auto conduct = [&](int i, int j, double G) {
    A(i, j) += G / C(i);
    A(i, i) -= G / C(i);
  };
  for (const ThermalLink& link : d.params.links) {
    conduct(link.from, link.to, link.conductance);
    conduct(link.to, link.from, link.conductance);
  }
  for (const ThermalLink& link : d.params.surface_links) {
    const Surroundings& around = d.params.surroundings[static_cast<std::size_t>(link.to)];
    const double begin = around.temperature(t), rate = (around.temperature(t + h) - begin) / h;
    A(link.from, link.from) -= link.conductance / C(link.from);
    A(link.from, n) += link.conductance * begin / C(link.from);
    A(link.from, n + 1) += link.conductance * rate / C(link.from);
  }
  for (int i = 0; i < n; ++i) A(i, n) += d.power[i] / C(i);
  A(n + 1, n) = 1.0;  // the time since t
  VectorXd state(n + 2);
  state << d.T, 1.0, 0.0;
  return ((A * h).exp() * state).head(n);
}

// To the rounding of the exponential at 300 K.
TEST(ThermalNetwork, IsTheMatrixExponential) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    const Drawn d = drawn(seed);
    for (const double h : {0.1, 20.0, 3000.0}) {
      ThermalNetwork network(d.params);
      network.start(d.T);
      network.advance(1000.0, h, d.power);
      EXPECT_LT((network.temperatures() - by_exponential(d, 1000.0, h)).cwiseAbs().maxCoeff(), 1e-8)
          << seed << " " << h;
    }
  }
}

TEST(ThermalNetwork, StoresWhatFlowsIn) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Drawn d = drawn(seed);
    ThermalNetwork network(d.params);
    network.start(d.T);
    const double before = network.stored();
    double heat = 0.0, t = 0.0;
    constexpr double h = 0.05;
    for (int n = 0; n < 20000; ++n) {
      const double inflow = network.inflow(t);
      network.advance(t, h, d.power);
      t += h;
      heat += h * (d.power.sum() + 0.5 * (inflow + network.inflow(t)));
    }
    EXPECT_NEAR(network.stored() - before, heat, 1e-6 * std::abs(heat)) << seed;
  }
}

TEST(ThermalNetwork, WithoutPowerStaysBetweenTheExtremes) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    const Drawn d = drawn(seed);
    ThermalNetwork network(d.params);
    network.start(d.T);
    const VectorXd none = VectorXd::Zero(d.T.size());
    for (int n = 0; n < 200; ++n) {
      network.advance(60.0 * n, 60.0, none);
      EXPECT_GE(network.temperatures().minCoeff(), 280.0 - 1e-9);
      EXPECT_LE(network.temperatures().maxCoeff(), 340.0 + 1e-9);
    }
  }
}

// Settled, temperatures swing with the room; the steps take that as linear in each.
TEST(ThermalNetwork, StaysSettled) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Drawn d = drawn(seed);
    d.params.surroundings[0].period = 600.0;
    ThermalNetwork network(d.params);
    network.start(network.settled(d.power, 0.0));
    constexpr double h = 0.25;
    for (int n = 0; n < 4800; ++n) network.advance(h * n, h, d.power);
    EXPECT_LT((network.temperatures() - network.settled(d.power, 1200.0)).cwiseAbs().maxCoeff(),
              1e-5)
        << seed;
  }
}

TEST(ThermalNetwork, Settles) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Drawn d = drawn(seed);
    d.params.surroundings[0].amplitude = 0.0;
    ThermalNetwork network(d.params);
    network.start(d.T);
    const double h = network.slowest();
    for (int n = 0; n < 60; ++n) network.advance(h * n, h, d.power);
    EXPECT_LT((network.temperatures() - network.settled(d.power, 0.0)).cwiseAbs().maxCoeff(), 1e-8)
        << seed;
  }
}

// --- rules --------------------------------------------------------------------------------------

TEST(ThermalNetwork, MustBePassiveAndConnected) {
  const ThermalParams good = {{{"head", 1.0}, {"column", 1.0}, {"bed", 2.0}},
                              {{"room", kRoom}},
                              {{0, 1, 1.0}, {2, 1, 0.5}},
                              {{1, 0, 1.0}}};
  using Faults = std::vector<std::string>;
  EXPECT_EQ(implausible(good), Faults());
  ThermalParams bad = good;
  bad.bodies[2].capacity = 0.0;
  EXPECT_EQ(implausible(bad), Faults({"bed must have a capacity > 0"}));
  bad = good;
  bad.links[0].conductance = -1.0;
  EXPECT_EQ(
      implausible(bad),
      Faults({"head to column must have a conductance >= 0",
              "head must be connected with the surroundings, directly or through other bodies"}));
  bad = good;
  bad.surface_links[0].conductance = 0.0;
  EXPECT_EQ(implausible(bad).size(), 3U);
  bad = good;
  bad.links.pop_back();
  EXPECT_EQ(
      implausible(bad),
      Faults({"bed must be connected with the surroundings, directly or through other bodies"}));
}

}  // namespace
}  // namespace servomill::plant::thermal_network_test
