/// First-order propagation of the covariance of identified errors to the tip.
#include "sim/model/tip_uncertainty.h"

#include <gtest/gtest.h>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <cmath>

#include "plant/kinematics/structure.h"
#include "plant/vocabulary/units.h"

namespace servomill::sim::model::tip_uncertainty_test {
namespace {

using plant::operator""_err;
using Eigen::Matrix3d;
using Eigen::Vector3d;

const Joints kNoDirection = Joints::Zero();

plant::MachineChain chain_of(const char* structure) {
  return plant::make_chain(plant::parse_structure(structure));
}

// A number g with deviation s: e = g f.
std::vector<UncertainPart> part(const plant::ErrorName& name, const plant::ErrorFunction& one,
                                double deviation, double g = 0.0) {
  return {{name, scaled(one, g + deviation), scaled(one, g - deviation)}};
}

// EC0Y turns the tip at y: dx = -EC0Y y. EYX = c x^2: dy = c x^2.
TEST(TipUncertainty, OfASquarenessAndABowIsThatByHand) {
  constexpr double kSquareness = 5.0 * urad, kBow = 2.0 * um, kRho = 0.6;  // bow: per dm^2
  UncertainErrors errors{"identified", {}, Eigen::Matrix2d::Identity()};
  errors.parts.push_back(part("EC0Y"_err, plant::constant(1.0), kSquareness));
  errors.parts.push_back(part("EYX"_err, plant::polynomial({0.0, 0.0, 100.0}), kBow));
  errors.correlation(0, 1) = errors.correlation(1, 0) = kRho;
  const TipUncertainty tip(chain_of("[w b X Y Z t]"), errors);
  Joints Q = Joints::Zero();
  Q.head<3>() = Vector3d(0.3, 0.2, -0.1);
  const Vector3d p_ST(0.0, 0.0, -0.05);
  const Matrix3d C = tip.covariance(Q, p_ST, kNoDirection);
  const double dx = -0.2 * kSquareness, dy = 9.0 * kBow;
  constexpr double kRounding = 1e-9 * um * um;
  EXPECT_NEAR(C(0, 0), dx * dx, kRounding);
  EXPECT_NEAR(C(1, 1), dy * dy, kRounding);
  EXPECT_NEAR(C(0, 1), kRho * dx * dy, kRounding);
  EXPECT_NEAR(C(2, 2), 0.0, kRounding);
  const Vector3d U = tip.expanded(Q, p_ST, kNoDirection);
  EXPECT_NEAR(U.x(), 2.0 * um, 1e-9 * um);
  EXPECT_NEAR(U.y(), 36.0 * um, 1e-9 * um);
}

// A value of a grid: half of it where the arguments are half way.
TEST(TipUncertainty, OfAnErrorOverTwoAxesIsThatWhereBothStand) {
  UncertainErrors errors{"identified", {}, Eigen::MatrixXd::Identity(1, 1)};
  const plant::ErrorFunction corner =
      plant::grid({{Axis::X, Axis::Z}, {{0.0, 0.4}, {0.0, 0.2}}, {0.0, 0.0, 0.0, 1.0}, {}});
  errors.parts.push_back(part("EYX"_err, corner, 2.0 * um, 7.0 * um));
  const TipUncertainty tip(chain_of("[w b X Y Z t]"), errors);
  Joints Q = Joints::Zero();
  Q.head<3>() = Vector3d(0.2, 0.0, 0.1);
  const Vector3d U = tip.expanded(Q, Vector3d::Zero(), kNoDirection);
  EXPECT_NEAR(U.y(), 2.0 * 0.25 * 2.0 * um, 1e-9 * um);
}

// Mean m and width w of EXX, correlated: U^2 = 4 (s_m^2 +- r s_m s_w + s_w^2 / 4).
TEST(TipUncertainty, DiffersBetweenBothDirectionsOfTravel) {
  constexpr double kMean = 1.0 * um, kWidth = 1.5 * um, kRho = -0.4;
  UncertainErrors errors{"identified", {}, Eigen::Matrix2d::Identity()};
  errors.parts.push_back(part("EXX"_err, plant::constant(1.0), kMean));
  errors.parts.push_back(part("EXX"_err, plant::reversal({1.0}, 1e-4), kWidth, 3.0 * um));
  errors.correlation(0, 1) = errors.correlation(1, 0) = kRho;
  const TipUncertainty tip(chain_of("[w b X Y Z t]"), errors);
  for (const double direction : {-1.0, 0.0, 1.0}) {
    Joints directions = Joints::Zero();
    directions[0] = direction;
    const double variance = kMean * kMean + direction * kRho * kMean * kWidth +
                            direction * direction * kWidth * kWidth / 4.0;
    const Vector3d U = tip.expanded(Joints::Zero(), Vector3d::Zero(), directions);
    EXPECT_NEAR(U.x(), 2.0 * std::sqrt(variance), 1e-9 * um) << direction;
    EXPECT_NEAR(U.y(), 0.0, 1e-9 * um);
  }
}

class Draws {
 public:
  double operator()() { return distribution_(generator_); }

 private:
  boost::random::mt19937_64 generator_{7};
  boost::random::normal_distribution<double> distribution_;
};

// All numbers of a five-axis machine are drawn; the exact machine shows what they do to the tip.
TEST(TipUncertainty, IsThatOfMachinesDrawnAtRandom) {
  constexpr int kDraws = 4000;
  const plant::MachineChain chain = chain_of("[w C' A' X' b Y Z t]");
  const std::vector<std::pair<plant::ErrorName, plant::ErrorFunction>> shapes = {
      {"EXX"_err, plant::polynomial({0.0, 1.0})},
      {"EYX"_err, plant::harmonic(1.0, 0.062)},
      {"EBY"_err, plant::linear_table({-0.2, 0.0, 0.3}, {-1.0, 1.0, 0.5})},
      {"EAZ"_err, plant::polynomial({0.0, 3.0, -5.0})},
      {"ECC"_err, plant::harmonic(1.0, 3.14)},
      {"EXA"_err, plant::polynomial({0.0, 1.0, 0.5})},
      {"EC0Y"_err, plant::constant(1.0)},
      {"EB0C"_err, plant::constant(1.0)},
      {"EY0C"_err, plant::constant(1.0)}};
  Draws draw;
  const auto n = Eigen::Index(shapes.size());
  Eigen::MatrixXd L = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) L(i, j) = draw();
    L.row(i) /= L.row(i).norm();
  }
  constexpr double kDeviation = 10e-6;  // m, rad
  UncertainErrors errors{"identified", {}, L * L.transpose()};
  for (const auto& [name, shape] : shapes) errors.parts.push_back(part(name, shape, kDeviation));
  const TipUncertainty tip(chain, errors);
  Joints Q;
  Q << 0.12, -0.07, 0.2, 0.5, -0.8;
  const Vector3d p_ST(0.01, 0.0, -0.12);
  Matrix3d found = Matrix3d::Zero();
  for (int i = 0; i < kDraws; ++i) {
    Eigen::VectorXd z(n);
    for (double& one : z) one = draw();
    const Eigen::VectorXd g = kDeviation * L * z;
    plant::ErrorModel drawn;
    for (Eigen::Index k = 0; k < n; ++k) {
      const auto& [name, shape] = shapes[std::size_t(k)];
      if (name.is_location) {
        drawn.location(name) = g[k];
      } else {
        drawn.component(name) = scaled(shape, g[k]);
      }
    }
    const Vector3d e = plant::volumetric_error(chain, drawn, Q, p_ST).dp_W;
    found += e * e.transpose() / kDraws;
  }
  const Matrix3d wanted = tip.covariance(Q, p_ST, kNoDirection);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      // of a covariance from so many draws, four standard deviations
      const double spread =
          std::sqrt((wanted(i, i) * wanted(j, j) + wanted(i, j) * wanted(i, j)) / kDraws);
      EXPECT_NEAR(found(i, j), wanted(i, j), 4.0 * spread) << i << j;
    }
  }
}

}  // namespace
}  // namespace servomill::sim::model::tip_uncertainty_test
