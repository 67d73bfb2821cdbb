#include "plant/geometry/error_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "plant/kinematics/structure.h"
#include "tests/plant/geometry/random_errors.h"

namespace servomill::plant::error_model_test {
namespace {

const JointLayout kHsm600u = parse_structure("[w C' B' X b Y Z (C1) t]").layout();
const JointLayout kThreeAxis = parse_structure("[w X b Y Z t]").layout();

std::string message(std::string_view text, const JointLayout& layout = kHsm600u) {
  try {
    parse_error_name(text, layout, {"m.toml", 7, 1});
  } catch (const InputError& e) {
    return e.what();
  }
  return "accepted";
}

TEST(ErrorName, DirectionComesFirstAndTheAxisLast) {
  EXPECT_EQ(error_name_of("EYX"), (ErrorName{Axis::Y, Axis::X, false}));
  EXPECT_EQ(error_name_of("EC0Y"), (ErrorName{Axis::C, Axis::Y, true}));
  EXPECT_EQ("EX0C"_err, (ErrorName{Axis::X, Axis::C, true}));
}

TEST(ErrorName, EveryOneIsReadAsItIsPrinted) {
  for (const bool location : {false, true}) {
    for (const Axis axis : kAllAxes) {
      for (const Axis direction : kAllAxes) {
        const ErrorName name{direction, axis, location};
        EXPECT_EQ(error_name_of(to_string(name)), name) << to_string(name);
      }
    }
  }
}

TEST(ErrorName, AnythingElseIsNone) {
  for (const char* text : {"", "E", "EX", "EXU", "eyx", "DYX", "EY1X", "EYXX", "EC00Y", "E0YX"}) {
    EXPECT_EQ(error_name_of(text), std::nullopt) << text;
  }
}

// ISO 230-1 and -7: 30 component errors; location errors 2 of each linear axis (of which 3 are
// squareness once the reference is chosen) and 4 of each rotary one.
TEST(ErrorName, FiveAxisMachineHas30ComponentAnd14LocationErrors) {
  int components = 0;
  std::string locations;
  for (const Axis axis : kAllAxes) {
    for (const Axis direction : kAllAxes) {
      components += !why_meaningless({direction, axis, false}, kHsm600u);
      const ErrorName location{direction, axis, true};
      if (!why_meaningless(location, kHsm600u)) locations += to_string(location) + " ";
    }
  }
  EXPECT_EQ(components, 30);
  EXPECT_EQ(locations, "EB0X EC0X EA0Y EC0Y EA0Z EB0Z EX0B EZ0B EA0B EC0B EX0C EY0C EA0C EB0C ");
}

TEST(ErrorName, FaultsSayWhatIsWrong) {
  EXPECT_EQ(message("EYX"), "accepted");
  EXPECT_EQ(message("EY X"),
            "m.toml:7:1: error: 'EY X' is not an error of ISO 230-1; expected a name such as EYX "
            "or EC0Y; did you "
            "mean 'EYX'?");
  EXPECT_EQ(message("straightness"),
            "m.toml:7:1: error: 'straightness' is not an error of ISO 230-1; expected a name such "
            "as EYX or EC0Y");
  EXPECT_EQ(message("EXA"),
            "m.toml:7:1: error: EXA is an error of axis A; the machine has X Y Z B C");
  EXPECT_EQ(message("EXB", kThreeAxis),
            "m.toml:7:1: error: EXB is an error of axis B; the machine has X Y Z");
  EXPECT_EQ(message("EX0Y"), "m.toml:7:1: error: EX0Y has no effect on the motion of Y");
  EXPECT_EQ(message("EB0Y"), "m.toml:7:1: error: EB0Y has no effect on the motion of Y");
  EXPECT_EQ(message("EZ0C"), "m.toml:7:1: error: EZ0C has no effect on the motion of C");
  EXPECT_EQ(message("EX0X"),
            "m.toml:7:1: error: EX0X has no effect on the motion of X; a zero position is a "
            "constant EXX");
  EXPECT_EQ(message("EC0C"),
            "m.toml:7:1: error: EC0C has no effect on the motion of C; a zero position is a "
            "constant ECC");
}

TEST(ErrorModel, IsEmptyAtFirst) {
  EXPECT_TRUE(ErrorModel().is_zero());
  ErrorModel errors;
  errors.location("EC0Y"_err) = 1e-300;
  EXPECT_FALSE(errors.is_zero());
  ErrorModel straightness;
  straightness.component("EYX"_err) = constant(1e-300);
  EXPECT_FALSE(straightness.is_zero());
}

TEST(ErrorModel, SumsAndMultiplesActOnEveryError) {
  Uniform random(11);
  const ErrorModel a = random_errors(random, 1e-4), b = random_errors(random, 1e-4);
  const ErrorModel sum = a + scaled(b, 2.0);
  for (const Axis axis : kAllAxes) {
    for (const Axis direction : kAllAxes) {
      const ErrorName function{direction, axis, false}, constant{direction, axis, true};
      const double s = random();
      EXPECT_NEAR(sum.component(function).value(s),
                  a.component(function).value(s) + 2.0 * b.component(function).value(s), 1e-18);
      EXPECT_EQ(sum.location(constant), a.location(constant) + 2.0 * b.location(constant));
    }
  }
  EXPECT_EQ(scaled(a, 1.0), a);
  EXPECT_TRUE(scaled(a, 0.0).is_zero());
}

}  // namespace
}  // namespace servomill::plant::error_model_test
