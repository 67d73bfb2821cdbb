/// The forms of compensation tables.
#include "strategies/table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plant/vocabulary/input_error.h"
#include "strategies/compensation.h"
#include "tests/strategies/beliefs.h"

namespace servomill::strategies::table_test {
namespace {

using Eigen::Vector3d;
using plant::operator""_err;

constexpr double kRounding = 1e-15;  // m, of values of some 100 um

struct Options {
  std::string form = "lattice", axis = "all", output = "all", at_reference = "error";
  double spacing = 50.0 * mm, max_step_ratio = 1.0;
};

Parameters parameters(const Options& o) {
  Parameters p;
  p.set("form", o.form);
  p.set("axis", o.axis);
  p.set("output", o.output);
  p.set("at_reference", o.at_reference);
  p.set("spacing_mm", o.spacing);
  p.set("grid", "free");
  p.set("from_mm", "travel");
  p.set("to_mm", "travel");
  p.set("max_points", "auto");
  p.set("max_step_ratio", o.max_step_ratio);
  p.set("entry", "position_command");
  p.set("response_time_ms", 40.0 * ms);
  p.set("dead_time_ms", 0.0);
  p.set("update_period_ms", 0.0);
  p.set("iterations", "1");
  return p;
}

class Made {
 public:
  Made(const Belief& belief, const Options& options)
      : strategy_(table_entry().make(parameters(options), Sign::generate, belief)),
        part_(strategy_->set_point()),
        belief_(belief) {}
  Vector3d at(double x, double y, double z) const {
    Joints Q = belief_.reference;
    Q.head<3>() << x, y, z;
    return part_->offset(Q).head<3>();
  }
  const SetPointPart& part() const { return *part_; }

 private:
  std::unique_ptr<Strategy> strategy_;
  std::unique_ptr<SetPointPart> part_;
  const Belief& belief_;
};

Vector3d wanted(const Belief& belief, double x, double y, double z) {
  Joints Q = belief.reference;
  Q.head<3>() << x, y, z;
  return set_point_displacement(belief, Sign::generate, Iterations::one, Q);
}

// Three axes of +-200 mm, which is a multiple of the spacings used here.
Belief three_axes(const plant::ErrorModel& errors) { return belief_in(errors, "[w b X Y Z t]"); }

// Linear functions of x, y, z, and their products by the lever of angles.
plant::ErrorModel trilinear_errors() {
  plant::ErrorModel errors;
  errors.component("EXX"_err) = plant::polynomial({2 * um, 30e-6});
  errors.component("EYX"_err) = plant::polynomial({0.0, -20e-6});
  errors.component("EZY"_err) = plant::polynomial({-1 * um, 25e-6});
  errors.component("ECX"_err) = plant::polynomial({0.0, 2e-6});
  errors.component("EAY"_err) = plant::polynomial({0.0, -3e-6});
  errors.component("EBZ"_err) = plant::polynomial({0.0, 1e-6});
  return errors;
}

constexpr double kSquaredAngles = 1e-12;  // m: (3e-6 x 0.2 m)^2 0.3 m and the like

TEST(Lattice, IsExactForTrilinearErrors) {
  const Belief belief = three_axes(trilinear_errors());
  const Made lattice(belief, {.spacing = 100 * mm}), lines(belief, {.form = "lines"});
  plant::Uniform random(3);
  double lines_miss = 0.0;
  for (int n = 0; n < 500; ++n) {
    const double x = 0.2 * random(), y = 0.2 * random(), z = 0.2 * random();
    EXPECT_LE((lattice.at(x, y, z) - wanted(belief, x, y, z)).norm(), kSquaredAngles);
    lines_miss = std::max(lines_miss, (lines.at(x, y, z) - wanted(belief, x, y, z)).norm());
  }
  EXPECT_GT(lines_miss, 50 * nm);  // the products stand on no line
}

TEST(Lattice, HoldsTheErrorsAtItsPointsAndTheirConstantBeyond) {
  const Belief belief = three_axes(trilinear_errors());
  const Made lattice(belief, {});
  for (const double x : {-0.2, -0.05, 0.2}) {
    for (const double y : {-0.2, 0.1, 0.2}) {
      EXPECT_LE((lattice.at(x, y, 0.15) - wanted(belief, x, y, 0.15)).norm(), kRounding);
    }
  }
  EXPECT_EQ(lattice.at(0.3, -0.9, 0.0), lattice.at(0.2, -0.2, 0.0));
}

// A sine is missed most at a crest in the middle of a cell: A (1 - cos(w h / 2)), of second order.
TEST(Lattice, ConvergesWithTheSquareOfItsSpacing) {
  constexpr double kAmplitude = 20 * um, kPeriod = 400 * mm;
  constexpr double kOmega = 2.0 * std::numbers::pi / kPeriod;
  double before = 0.0;
  for (const double h : {40 * mm, 20 * mm, 10 * mm}) {
    plant::ErrorModel errors;
    // crests at +-h/2 are in the middle of the cells beside 0
    const double phase = 0.5 * std::numbers::pi - kOmega * 0.5 * h;
    errors.component("EXX"_err) = plant::harmonic(kAmplitude, kPeriod, phase);
    errors.component("EXY"_err) = plant::harmonic(kAmplitude, kPeriod, phase);
    const Belief belief = three_axes(errors);
    const Made plane(belief, {.axis = "XY", .spacing = h});
    double most = 0.0;
    for (int i = 0; i <= 10; ++i) {
      for (int k = 0; k <= 10; ++k) {
        const double x = 0.1 * i * h, y = 0.1 * k * h;
        most = std::max(most, (plane.at(x, y, 0.0) - wanted(belief, x, y, 0.0)).norm());
      }
    }
    EXPECT_NEAR(most, 2.0 * kAmplitude * (1.0 - std::cos(0.5 * kOmega * h)), 1e-13) << h;
    if (before > 0.0) {
      EXPECT_NEAR(before / most, 4.0, 0.1);
    }
    before = most;
  }
}

// EYX, EZX: straightness of X, the sag table of X over Y and Z.
TEST(Table, MovesTheAxesThatItIsAskedToMove) {
  const Belief belief = three_axes(trilinear_errors());
  plant::Uniform random(5);
  const auto made = [&](const char* axis, const char* output, const char* at_reference = "error") {
    return Made(belief, {.form = "lines",
                         .axis = axis,
                         .output = output,
                         .at_reference = at_reference,
                         .spacing = 100 * mm});
  };
  const Made all = made("all", "all"), own = made("all", "own"), others = made("all", "others");
  const Made Y_over_X = made("X", "Y"), Y_over_Z = made("Z", "Y", "zero"), Y = made("XZ", "Y");
  const Joints& from = belief.reference;
  for (int n = 0; n < 100; ++n) {
    const double x = 0.2 * random(), y = 0.2 * random(), z = 0.2 * random();
    // each axis over itself
    EXPECT_NEAR(own.at(x, y, z).x(), wanted(belief, x, from[1], from[2]).x(), kSquaredAngles);
    EXPECT_NEAR(own.at(x, y, z).y(), wanted(belief, from[0], y, from[2]).y(), kSquaredAngles);
    // one axis over another
    const Vector3d sag = Y_over_X.at(x, y, z);
    EXPECT_NEAR(sag.y(), wanted(belief, x, from[1], from[2]).y(), kSquaredAngles);
    EXPECT_EQ(sag.x(), 0.0);
    EXPECT_EQ(sag.z(), 0.0);
    // tables of one axis sum up
    EXPECT_LE((sag + Y_over_Z.at(x, y, z) - Y.at(x, y, z)).norm(), kRounding);
  }
  // what stands at the reference is held once, however the work is divided
  const Vector3d there = wanted(belief, from[0], from[1], from[2]);
  for (const Made* made_of_all : {&all, &own, &others}) {
    EXPECT_LE((made_of_all->at(from[0], from[1], from[2]) - there).norm(), kSquaredAngles);
  }
  EXPECT_LE(Y_over_Z.at(0.0, 0.0, from[2]).norm(), kSquaredAngles);
}

TEST(Lattice, EntersTheNcAsOtherTablesDo) {
  const Belief belief = three_axes(trilinear_errors());
  const Made lattice(belief, {});
  EXPECT_EQ(lattice.part().entry().entry, EntryPoint::position_command);
  EXPECT_EQ(lattice.part().entry().response_time, 40.0 * ms);
}

std::string fault_of(const Belief& belief, const Options& options) {
  try {
    const Made made(belief, options);
  } catch (const InputError& error) {
    return error.faults().front().message;
  }
  return "none";
}

TEST(Table, RefusesWhatTheNcWouldRefuse) {
  const Belief belief = three_axes(trilinear_errors());
  EXPECT_EQ(fault_of(belief, {.spacing = 10 * mm}),
            "lattice over X, Y, Z: 41 x 41 x 41 = 68921 points; the NC accepts at most 15625 "
            "(max_points); use a larger spacing_mm or from_mm and to_mm");
  EXPECT_EQ(fault_of(belief, {.form = "lines", .spacing = 1 * mm}),
            "table over X: 401 points; the NC accepts at most 256 (max_points); use a larger "
            "spacing_mm or from_mm and to_mm");
  EXPECT_EQ(fault_of(belief, {.output = "own"}),
            "output = \"own\" belongs to form = \"lines\"; a lattice runs over several axes");
  EXPECT_EQ(fault_of(belief, {.max_step_ratio = 20e-6}),
            "lattice over X, Y, Z: slope 0.03 um/mm at X = -200.000 mm; the NC accepts at most "
            "0.02 um/mm (max_step_ratio)");
  const Belief plane = belief_in({}, "[w X' b Z t]");
  EXPECT_EQ(fault_of(plane, {.axis = "XY"}), "axis = \"XY\"; the machine has no such axis");
  EXPECT_EQ(fault_of(plane, {.output = "Y"}), "output = \"Y\"; the machine has no such axis");
}

TEST(Table, KnowsWhereItEnds) {
  const Belief belief = three_axes(trilinear_errors());
  const auto strategy =
      table_entry().make(parameters({.form = "lines", .axis = "XZ", .spacing = 150.0 * mm}),
                         Sign::generate, belief);  // travel of +-200 mm: three intervals
  const auto ends = [&](double x, double y, double z) {
    Joints Q = belief.reference;
    Q.head<3>() << x * mm, y * mm, z * mm;
    std::vector<std::pair<int, double>> out;
    for (const BeyondTable& end : strategy->beyond_tables(Q)) out.emplace_back(end.joint, end.end);
    return out;
  };
  using Ends = std::vector<std::pair<int, double>>;
  EXPECT_EQ(ends(-200.0, 300.0, 250.0), Ends{});  // no table runs over Y
  const double first = belief.lower[0], last = belief.lower[2] + 3 * (150.0 * mm);
  EXPECT_EQ(ends(-200.001, 0.0, 250.001), (Ends{{0, first}, {2, last}}));
}

}  // namespace
}  // namespace servomill::strategies::table_test
