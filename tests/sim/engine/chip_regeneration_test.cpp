/// Growth and decay of vibrations of teeth in the cut, against the model of small vibrations.
#include "sim/engine/chip_regeneration.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <numbers>

#include "plant/cutting/stability_lobes.h"
#include "plant/kinematics/structure.h"
#include "plant/vocabulary/units.h"
#include "sim/engine/cutting_load.h"
#include "sim/engine/engaged_teeth.h"
#include "sim/frequency/lobes.h"

namespace servomill::sim::engine::chip_regeneration_test {
namespace {

using Complex = std::complex<double>;
using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;
constexpr double kFeed = 50 * um;  // per tooth

const plant::CuttingCoefficients& steel() { return plant::find_material("42CrMo4")->typical; }

const std::vector<plant::StructuralMode> kNormal = {
    {.direction = Vector3d::UnitY(), .compliance = 1.0 / 20e6, .mode = {2.0 * kPi * 500.0, 0.03}}};
const std::vector<plant::StructuralMode> kTwo = {
    {.direction = Vector3d::UnitX(), .compliance = 1.0 / 24e6, .mode = {2.0 * kPi * 620.0, 0.035}},
    kNormal.front()};

const std::vector<plant::StructuralMode> kRigid;

plant::FlankEngagement slot(int teeth = 4) {
  return {.coefficients = steel(), .teeth = teeth, .from = 0.0, .to = kPi};
}

// A cut along X: the depth grows over 500 tooth passages from 0, so that its vibration begins
// small, then it is constant.
class Cut {
 public:
  static constexpr int kRamp = 500;  // passages

  // @param step  of the teeth, as a share of a tooth passage
  Cut(const plant::FlankEngagement& cut, const std::vector<plant::StructuralMode>& modes,
      double depth, double turns, double step, int ramp = kRamp,
      const Vector3d& compliance = Vector3d::Zero())
      : passage_(1.0 / (turns * cut.teeth)),
        dt_(step * passage_),
        teeth_(cut.coefficients, true),
        chain_(plant::make_chain(plant::parse_structure("[w b X Y Z t]"))),
        compliance_(compliance) {
    const plant::Cutter cutter{
        .radius = 5 * mm, .length = 50 * mm, .teeth = cut.teeth, .helix = cut.helix};
    const plant::EngagedArc arc{
        .width = depth, .height = 0.5 * depth, .from = cut.from, .to = cut.to};
    const int number = teeth_.add(1, cutter, {Eigen::Matrix3d::Identity(), {}}, {&arc, 1}, turns);
    const double chip = passage_;
    const auto row = [&](double s, int teeth) {
      return CuttingTable::Row{.s = s, .chip = chip, .turns = turns, .teeth = teeth};
    };
    table_ = CuttingTable({row(0.0, -1), row(ramp * kFeed, number), row(1.0, number)});
    regeneration_.emplace(modes, dt_, passage_, compliance.asDiagonal());
    load_.emplace(table_, wear_, chain_, compliance_, &teeth_, nullptr, kRigid, &*regeneration_);
    load_->start(0.0);
  }

  // Displacement along X and Y (m) at equal times, so many a tooth passage.
  std::vector<Eigen::Vector2d> run(int passages, int samples) {
    std::vector<Eigen::Vector2d> out;
    const double every = passage_ / samples;
    double time = 0.0;  // of the step
    Joints Q = Joints::Zero();
    for (int n = 0; n < passages * samples; ++n) {
      const double at = n * every;
      while (time + dt_ <= at || n == 0) {
        if (n > 0) time += dt_;
        const double s = time / passage_ * kFeed;
        load_->advance(s + kFeed * dt_ / passage_, dt_, Q, Vector3d::Zero());
        load_->turn(dt_);
        if (n == 0) break;
      }
      out.emplace_back(load_->deflection(at - time).head<2>());
    }
    return out;
  }

 private:
  double passage_, dt_;
  EngagedTeeth teeth_;
  plant::MachineChain chain_;
  model::CuttingWear wear_{.initial = 1.0};
  Vector3d compliance_;
  CuttingTable table_;
  std::optional<ChipRegeneration> regeneration_;
  std::optional<CuttingLoad> load_;
};

// Multiplier from tooth to tooth of what is not periodic, d(t) = x(t + T) - x(t): least squares of
// d(t + 2 T) = p d(t + T) + s d(t) over passages [first, last).
Complex multiplier(const std::vector<Eigen::Vector2d>& x, int samples, int first, int last) {
  const auto n = static_cast<std::size_t>(samples);
  const auto d = [&](std::size_t i) { return (x[i + n] - x[i]).eval(); };
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (std::size_t i = n * static_cast<std::size_t>(first); i < n * static_cast<std::size_t>(last);
       ++i) {
    const Eigen::Vector2d d0 = d(i), d1 = d(i + n), d2 = d(i + 2 * n);
    const double size = d0.squaredNorm() + d1.squaredNorm() + 1e-40;
    normal(0, 0) += d1.dot(d1) / size;
    normal(0, 1) += d1.dot(d0) / size;
    normal(1, 1) += d0.dot(d0) / size;
    right += Eigen::Vector2d(d1.dot(d2), d0.dot(d2)) / size;
  }
  normal(1, 0) = normal(0, 1);
  const Eigen::Vector2d ps = normal.inverse() * right;
  const Complex root = std::sqrt(Complex(0.25 * ps[0] * ps[0] + ps[1]));
  const Complex a = 0.5 * ps[0] + root, b = 0.5 * ps[0] - root;
  return std::abs(a) >= std::abs(b) ? a : b;
}

std::vector<plant::ChatterMode> across(const std::vector<plant::StructuralMode>& modes) {
  return frequency::modes_across(modes, Vector3d::UnitX(), Vector3d::UnitY());
}

// Steps of a tooth passage that are as coarse as a run may have them, 20 in a period of the fastest
// mode.
int coarsest_steps(const std::vector<plant::StructuralMode>& modes, double passage) {
  double fastest = 0.0;
  for (const auto& mode : modes) fastest = std::max(fastest, mode.mode.w / (2.0 * kPi));
  return static_cast<int>(std::ceil(20.0 * fastest * passage));
}

constexpr double kMultiplierTol = 2e-3;  // of 1; 1 % of depth changes it by 1e-3 to 1e-2
constexpr double kPhaseTol = 4e-3;       // rad a tooth passage, 0.04 to 0.1 Hz

// 3 % below the limit vibrations decay, 3 % above they grow, as fast as the model predicts.
TEST(ChipRegeneration, grows_on_one_side_of_the_limit_and_decays_on_the_other) {
  for (const auto& modes : {kNormal, kTwo}) {
    for (const double turns : {80.0, 108.0, 150.0}) {
      const auto limit = plant::zeroth_order_limit(slot(), across(modes), turns);
      const int steps = 2 * coarsest_steps(modes, 1.0 / (4.0 * turns));
      for (const double share : {0.97, 1.03}) {
        const double depth = share * limit.depth;
        const auto model_of = plant::ChatterAnalysis(across(modes)).of(slot().at(depth, turns));
        const auto x = Cut(slot(), modes, depth, turns, 1.0 / steps).run(Cut::kRamp + 70, steps);
        const Complex found = multiplier(x, steps, Cut::kRamp + 20, Cut::kRamp + 60);
        EXPECT_EQ(std::abs(found) > 1.0, share > 1.0) << turns;
        EXPECT_NEAR(std::abs(found), std::abs(model_of.multiplier), kMultiplierTol) << turns;
        EXPECT_NEAR(std::abs(std::arg(found)), std::arg(model_of.multiplier), kPhaseTol) << turns;
      }
    }
  }
}

// Halving the step quarters the error of the multiplier.
TEST(ChipRegeneration, is_of_second_order_in_the_step) {
  constexpr double kTurns = 80.0;
  const auto limit = plant::zeroth_order_limit(slot(), across(kNormal), kTurns);
  const auto found = [&](int steps) {
    const auto x =
        Cut(slot(), kNormal, limit.depth, kTurns, 1.0 / steps).run(Cut::kRamp + 80, steps);
    return multiplier(x, steps, Cut::kRamp + 20, Cut::kRamp + 70);
  };
  const Complex a = found(20), b = found(40), c = found(80);
  EXPECT_NEAR(std::abs(b - c) / std::abs(a - b), 0.25, 0.06);
}

// Teeth that leave the cut: it neither dies out nor grows for ever.
TEST(ChipRegeneration, far_beyond_the_limit_ends_in_a_bounded_vibration) {
  constexpr double kTurns = 80.0;
  const auto limit = plant::zeroth_order_limit(slot(), across(kNormal), kTurns);
  const auto x = Cut(slot(), kNormal, 1.5 * limit.depth, kTurns, 1.0 / 40.0).run(800, 40);
  const auto range = [&](std::size_t first, std::size_t last) {
    double low = 1.0, high = -1.0;
    for (std::size_t i = first * 40; i < last * 40; ++i) {
      low = std::min(low, x[i].y());
      high = std::max(high, x[i].y());
    }
    return high - low;
  };
  EXPECT_GT(range(600, 700), 0.2 * kFeed);
  EXPECT_LT(range(600, 700), 20.0 * kFeed);
  EXPECT_NEAR(range(700, 800), range(600, 700), 0.1 * range(600, 700));
}

// The same where it is real: least squares of d(t + T) = m d(t).
double real_multiplier(const std::vector<Eigen::Vector2d>& x, int samples, int first, int last) {
  const auto n = static_cast<std::size_t>(samples);
  double product = 0.0, square = 0.0;
  for (std::size_t i = n * static_cast<std::size_t>(first); i < n * static_cast<std::size_t>(last);
       ++i) {
    const Eigen::Vector2d d0 = x[i + n] - x[i], d1 = x[i + 2 * n] - x[i + n];
    product += d0.dot(d1) / d0.squaredNorm();
    square += 1.0;
  }
  return product / square;
}

// Up milling with 12.8 deg of immersion, between two lobes: two teeth a period of chatter.
TEST(ChipRegeneration, flips_where_the_model_flips) {
  const plant::FlankEngagement cut{
      .coefficients = steel(), .teeth = 2, .from = 0.0, .to = 12.8 * deg};
  constexpr int kSteps = 200;
  constexpr double kFlipTol = 4e-3;  // of 1; 1 % of depth changes it by 3e-3 to 5e-3
  for (const double turns : {174.0, 180.0}) {
    const auto limit = plant::limit_of_stability(cut, across(kNormal), turns, 100 * mm);
    ASSERT_EQ(limit.kind, plant::Chatter::flip);
    for (const double share : {0.95, 1.05}) {
      const double depth = share * limit.depth;
      const auto model_of = plant::ChatterAnalysis(across(kNormal)).of(cut.at(depth, turns));
      const auto x = Cut(cut, kNormal, depth, turns, 1.0 / kSteps).run(Cut::kRamp + 30, kSteps);
      const double found = real_multiplier(x, kSteps, Cut::kRamp + 5, Cut::kRamp + 25);
      EXPECT_EQ(found<-1.0, share> 1.0) << turns;
      EXPECT_NEAR(found, model_of.multiplier.real(), kFlipTol) << turns;
    }
  }
}

// A slot cut by four straight teeth without edge forces: F_y = (K_tc c - K_rc (y(t) - y(t - T))) a.
// A structure with the stiffness k is in balance with it at each instant: with mu = K_rc a / k,
// y_n = (1 - (mu / (1 + mu))^(n + 1)) K_tc a c / k after n passages. K_tc is small, so that no
// tooth leaves the cut where its chip begins.
TEST(ChipRegeneration, of_a_static_structure_takes_up_its_deflection_geometrically) {
  plant::FlankEngagement cut = slot();
  cut.coefficients.Kte = cut.coefficients.Kre = cut.coefficients.Kae = 0.0;
  cut.coefficients.Ktc = 1e-3 * cut.coefficients.Krc;
  const double depth = 2 * mm, k = 3e6;  // N/m
  for (const double steps : {20.0, 31.0}) {
    Cut run(cut, kRigid, depth, 80.0, 1.0 / steps, 0, Vector3d(0.0, 1.0 / k, 0.0));
    const double mu = cut.coefficients.Krc * depth / k;
    const double end = cut.coefficients.Ktc * depth * kFeed / k;
    const std::vector<Eigen::Vector2d> x = run.run(12, 2);
    ASSERT_GT(mu, 0.1);
    for (int n = 0; n < 11; ++n) {
      const double wanted = end * (1.0 - std::pow(mu / (1.0 + mu), n + 1));
      const double middle = std::abs(x[static_cast<std::size_t>(2 * n + 1)].y());
      EXPECT_NEAR(middle, wanted, 1e-5 * end) << n << " passages, " << steps << " steps";
    }
  }
}

}  // namespace
}  // namespace servomill::sim::engine::chip_regeneration_test
