/// Errors with hysteresis in the volumetric error.
#include <gtest/gtest.h>

#include <numbers>

#include "plant/geometry/volumetric.h"
#include "plant/vocabulary/units.h"
#include "tests/plant/geometry/random_errors.h"

namespace servomill::plant::reversal_test {
namespace {

using Eigen::Vector3d;

constexpr double kRounding = 1e-15;  // m, of an error of a millimetre at 1 m
const Vector3d kTip(0.01, -0.02, -0.11);

// All errors of random_errors, and a random width over one of two distances with each.
ErrorModel with_reversals(Uniform& random, double size) {
  ErrorModel errors = random_errors(random, size);
  int n = 0;
  for (auto& axis : errors.components) {
    for (ErrorFunction& f : axis) {
      const double w0 = size * random(), w1 = size * random();
      f = f + reversal({w0, w1}, n++ % 2 == 0 ? 20 * um : 50 * um);
    }
  }
  return errors;
}

std::vector<double> random_directions(const VolumetricModel& model, Uniform& random) {
  std::vector<double> directions;
  for (std::size_t n = 0; n < model.plays().size(); ++n) directions.push_back(random());
  return directions;
}

// The errors while axes travel in these directions.
ErrorModel frozen(ErrorModel errors, const VolumetricModel& model,
                  const std::vector<double>& directions) {
  for (const ChainAxis& axis : model.chain().axes) {
    for (const Axis direction : kAllAxes) {
      ErrorFunction& f = errors.component({direction, axis.axis, false});
      ErrorFunction sum = travelling(f, 0.0);
      for (const Reversal& r : f.reversals) {
        const Play play{axis.joint, r.distance};
        const auto place =
            std::find(model.plays().begin(), model.plays().end(), play) - model.plays().begin();
        sum = sum + travelling(reversal(r.width, r.distance),
                               directions.at(static_cast<std::size_t>(place)));
      }
      f = sum;
    }
  }
  return errors;
}

TEST(Reversal, IsHalfItsWidthOnEitherSideOfTheMean) {
  const ErrorFunction f = polynomial({3 * um, 1e-5}) + reversal({4 * um, 2e-5}, 20 * um);
  const double s = 0.1;
  EXPECT_NEAR(f.value(s), 4 * um, 1e-20);
  EXPECT_NEAR(f.width(s), 6 * um, 1e-20);
  EXPECT_NEAR(travelling(f, 1.0).value(s), 7 * um, 1e-20);
  EXPECT_NEAR(travelling(f, -1.0).value(s), 1 * um, 1e-20);
  EXPECT_FALSE(reversal({4 * um}, 1.0).is_zero());
  EXPECT_TRUE(reversal({0.0}, 1.0).is_zero());
  EXPECT_NEAR(scaled(f, -2.0).width(s), -12 * um, 1e-20);
  EXPECT_NEAR((f + f).width(s), 12 * um, 1e-20);
}

TEST(VolumetricModel, OfMachinesWithoutReversalsHasNothingToRemember) {
  Uniform random(3);
  const VolumetricModel model(make_chain(parse_structure("[w C' B' X b Y Z t]")),
                              random_errors(random, 1e-4));
  EXPECT_TRUE(model.plays().empty());
}

TEST(VolumetricModel, RemembersEachAxisAndDistanceOnce) {
  Uniform random(3);
  const VolumetricModel model(make_chain(parse_structure("[w C' B' X b Y Z t]")),
                              with_reversals(random, 1e-4));
  EXPECT_EQ(model.plays().size(), 10U);
}

TEST(VolumetricModel, MeansTheMeanOfBothDirectionsWhereNoneIsGiven) {
  Uniform random(5);
  for (const char* text : {"[w C' B' X b Y Z t]", "[w C' X b B Z t]", "[w X' Y' b Z t]"}) {
    const MachineChain chain = make_chain(parse_structure(text));
    const ErrorModel errors = with_reversals(random, 1e-4);
    ErrorModel means = errors;
    for (auto& axis : means.components) {
      for (ErrorFunction& f : axis) f.reversals.clear();
    }
    const VolumetricModel model(chain, errors), mean(chain, means);
    const std::vector<double> middle(model.plays().size(), 0.0);
    for (int n = 0; n < 50; ++n) {
      const Joints Q = random_joints(chain, random);
      const ToolPose P = model.forward(Q, kTip);
      EXPECT_EQ(P.p_WT, model.forward(Q, kTip, middle).p_WT);
      EXPECT_LE((P.p_WT - mean.forward(Q, kTip).p_WT).norm(), kRounding);
      EXPECT_EQ(model.joint_offset(Q, kTip), mean.joint_offset(Q, kTip));
    }
  }
}

TEST(VolumetricModel, IsThatOfTravellingErrorsInGivenDirections) {
  Uniform random(11);
  const auto structures = {"[w C' B' X b Y Z t]", "[w C' X b B Z t]", "[w b X Y Z B C t]"};
  for (const char* text : structures) {
    const MachineChain chain = random_inclined_chain(parse_structure(text), random);
    const ErrorModel errors = with_reversals(random, 1e-4);
    const VolumetricModel model(chain, errors);
    for (int n = 0; n < 50; ++n) {
      const std::vector<double> directions = random_directions(model, random);
      const VolumetricModel same(chain, frozen(errors, model, directions));
      const Joints Q = random_joints(chain, random);
      const ToolPose P = model.forward(Q, kTip, directions), expected = same.forward(Q, kTip);
      EXPECT_LE((P.p_WT - expected.p_WT).norm(), kRounding) << text;
      EXPECT_LE((P.k_W - expected.k_W).norm(), kRounding) << text;
      EXPECT_LE((model.error(Q, kTip, directions).dp_W - same.error(Q, kTip).dp_W).norm(),
                kRounding);
      EXPECT_LE(
          (model.first_order_error(Q, kTip, directions).dp_W - same.first_order_error(Q, kTip).dp_W)
              .norm(),
          kRounding);
    }
  }
}

TEST(VolumetricModel, GivesTheSamePosesTogetherAsAlone) {
  Uniform random(13);
  const MachineChain chain = make_chain(parse_structure("[w C' B' X b Y Z t]"));
  const VolumetricModel model(chain, with_reversals(random, 1e-4));
  std::vector<Joints> Q;
  std::vector<double> all;
  for (int n = 0; n < 11; ++n) {
    Q.push_back(random_joints(chain, random));
    for (const double direction : random_directions(model, random)) all.push_back(direction);
  }
  std::vector<ToolPose> poses(Q.size());
  model.poses(Q, kTip, all, poses);
  const std::size_t each = model.plays().size();
  for (std::size_t n = 0; n < Q.size(); ++n) {
    const ToolPose one = model.forward(Q[n], kTip, std::span(all).subspan(n * each, each));
    EXPECT_EQ(one.p_WT, poses[n].p_WT);
    EXPECT_EQ(one.k_W, poses[n].k_W);
  }
}

// A circle, counter-clockwise from (R, 0): X goes down until 180 deg and then up, so that behind
// each quadrant point the reversals of an axis have changed over, within half a degree here.
TEST(VolumetricModel, ShowsTheStepsOfACircleWithReversals) {
  const MachineChain chain = make_chain(parse_structure("[w b X Y Z t]"));
  constexpr double R = 0.05, kDistance = 5 * um;
  constexpr double kWidth_X = 4 * um, kWidth_Y = -6 * um, kSlope_Y = 20 * um;
  ErrorModel errors;
  errors.component("EXX"_err) = reversal({kWidth_X}, kDistance);
  errors.component("EYY"_err) = reversal({kWidth_Y, kSlope_Y}, kDistance);
  const VolumetricModel model(chain, errors);
  const auto at = [](double degrees) {
    const double t = degrees * deg;
    return Joints(R * std::cos(t), R * std::sin(t), 0.0, 0.0, 0.0);
  };
  ReversalMemory memory(model.plays(), at(-90.0));
  std::vector<double> directions(memory.size());
  constexpr double kClear = 1.0;  // deg: R (1 - cos) is 7.6 um there
  for (double degrees = -89.9; degrees < 360.0; degrees += 0.1) {
    const Joints Q = at(degrees);
    memory.travel(Q);
    memory.directions(Q, directions);
    const double off_X = std::abs(std::remainder(degrees, 180.0));
    const double off_Y = std::abs(std::remainder(degrees - 90.0, 180.0));
    if (off_X < kClear || off_Y < kClear) continue;
    const double up_X = std::sin(degrees * deg) < 0.0 ? 1.0 : -1.0;
    const double up_Y = std::cos(degrees * deg) > 0.0 ? 1.0 : -1.0;
    const Vector3d expected(0.5 * up_X * kWidth_X, 0.5 * up_Y * (kWidth_Y + kSlope_Y * Q[1]), 0.0);
    const Vector3d found = model.error(Q, Vector3d::Zero(), directions).dp_W;
    EXPECT_LE((found - expected).norm(), 1e-3 * nm) << degrees;
  }
}

}  // namespace
}  // namespace servomill::plant::reversal_test
