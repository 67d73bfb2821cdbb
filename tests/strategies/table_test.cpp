/// The forms of compensation tables.
#include "strategies/table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plant/vocabulary/input_error.h"
#include "strategies/axis_displacement.h"
#include "tests/strategies/identified_machines.h"

namespace servomill::strategies::table_test {
namespace {

using Eigen::Vector3d;
using plant::operator""_err;

constexpr double kRounding = 1e-15;  // m, of values of some 100 um

struct Options {
  std::string layout = "grid", base_axis = "all", compensated_axis = "all",
              zero_at_reference = "false", points = "equidistant", max_points = "auto";
  double spacing = 50.0 * mm, max_step_ratio = 1.0, shift = 0.0;
};

Parameters parameters(const Options& o) {
  Parameters p;
  p.set("layout", o.layout);
  p.set("base_axis", o.base_axis);
  p.set("compensated_axis", o.compensated_axis);
  p.set("zero_at_reference", o.zero_at_reference);
  p.set("spacing_mm", o.spacing);
  p.set("spacing_rule", "free");
  p.set("from_mm", "travel");
  p.set("to_mm", "travel");
  p.set("points", o.points);
  if (o.max_points == "auto") {
    p.set("max_points", o.max_points);
  } else {
    p.set("max_points", std::stod(o.max_points));
  }
  p.set("max_step_ratio", o.max_step_ratio);
  p.set("injection_point", "position_command");
  p.set("time_constant_ms", 40.0 * ms);
  p.set("dead_time_ms", 0.0);
  p.set("update_period_ms", 0.0);
  p.set("shift_mm", o.shift);
  p.set("iterations", "1");
  return p;
}

class Made {
 public:
  Made(const IdentifiedMachine& identified, const Options& options)
      : strategy_(table_entry().make(parameters(options), Action::impose, identified)),
        part_(strategy_->setpoint()),
        identified_(identified) {}
  Vector3d at(double x, double y, double z) const {
    Joints Q = identified_.reference;
    Q.head<3>() << x, y, z;
    return part_->offset(Q).head<3>();
  }
  const SetpointPart& part() const { return *part_; }

 private:
  std::unique_ptr<Strategy> strategy_;
  std::unique_ptr<SetpointPart> part_;
  const IdentifiedMachine& identified_;
};

Vector3d wanted(const IdentifiedMachine& identified, double x, double y, double z) {
  Joints Q = identified.reference;
  Q.head<3>() << x, y, z;
  return setpoint_displacement(identified, Action::impose, Iterations::one, Q);
}

// Three axes of +-200 mm, which is a multiple of the spacings used here.
IdentifiedMachine three_axes(const plant::ErrorModel& errors) {
  return identified_with(errors, "[w b X Y Z t]");
}

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

TEST(GridLayout, IsExactForTrilinearErrors) {
  const IdentifiedMachine identified = three_axes(trilinear_errors());
  const Made grid(identified, {.spacing = 100 * mm}), lines(identified, {.layout = "axis_tables"});
  plant::Uniform random(3);
  double lines_miss = 0.0;
  for (int n = 0; n < 500; ++n) {
    const double x = 0.2 * random(), y = 0.2 * random(), z = 0.2 * random();
    EXPECT_LE((grid.at(x, y, z) - wanted(identified, x, y, z)).norm(), kSquaredAngles);
    lines_miss = std::max(lines_miss, (lines.at(x, y, z) - wanted(identified, x, y, z)).norm());
  }
  EXPECT_GT(lines_miss, 50 * nm);  // the products stand on no line
}

TEST(GridLayout, HoldsTheErrorsAtItsPointsAndTheirConstantBeyond) {
  const IdentifiedMachine identified = three_axes(trilinear_errors());
  const Made grid(identified, {});
  for (const double x : {-0.2, -0.05, 0.2}) {
    for (const double y : {-0.2, 0.1, 0.2}) {
      EXPECT_LE((grid.at(x, y, 0.15) - wanted(identified, x, y, 0.15)).norm(), kRounding);
    }
  }
  EXPECT_EQ(grid.at(0.3, -0.9, 0.0), grid.at(0.2, -0.2, 0.0));
}

// A sine is missed most at a crest in the middle of a cell: A (1 - cos(w h / 2)), of second order.
TEST(GridLayout, ConvergesWithTheSquareOfItsSpacing) {
  constexpr double kAmplitude = 20 * um, kPeriod = 400 * mm;
  constexpr double kOmega = 2.0 * std::numbers::pi / kPeriod;
  double before = 0.0;
  for (const double h : {40 * mm, 20 * mm, 10 * mm}) {
    plant::ErrorModel errors;
    // crests at +-h/2 are in the middle of the cells beside 0
    const double phase = 0.5 * std::numbers::pi - kOmega * 0.5 * h;
    errors.component("EXX"_err) = plant::harmonic(kAmplitude, kPeriod, phase);
    errors.component("EXY"_err) = plant::harmonic(kAmplitude, kPeriod, phase);
    const IdentifiedMachine identified = three_axes(errors);
    const Made plane(identified, {.base_axis = "XY", .spacing = h});
    double most = 0.0;
    for (int i = 0; i <= 10; ++i) {
      for (int k = 0; k <= 10; ++k) {
        const double x = 0.1 * i * h, y = 0.1 * k * h;
        most = std::max(most, (plane.at(x, y, 0.0) - wanted(identified, x, y, 0.0)).norm());
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
  const IdentifiedMachine identified = three_axes(trilinear_errors());
  plant::Uniform random(5);
  const auto made = [&](const char* axis, const char* output,
                        const char* zero_at_reference = "false") {
    return Made(identified, {.layout = "axis_tables",
                             .base_axis = axis,
                             .compensated_axis = output,
                             .zero_at_reference = zero_at_reference,
                             .spacing = 100 * mm});
  };
  const Made all = made("all", "all"), own = made("all", "own"), others = made("all", "others");
  const Made Y_over_X = made("X", "Y"), Y_over_Z = made("Z", "Y", "true"), Y = made("XZ", "Y");
  const Joints& from = identified.reference;
  for (int n = 0; n < 100; ++n) {
    const double x = 0.2 * random(), y = 0.2 * random(), z = 0.2 * random();
    // each axis over itself
    EXPECT_NEAR(own.at(x, y, z).x(), wanted(identified, x, from[1], from[2]).x(), kSquaredAngles);
    EXPECT_NEAR(own.at(x, y, z).y(), wanted(identified, from[0], y, from[2]).y(), kSquaredAngles);
    // one axis over another
    const Vector3d sag = Y_over_X.at(x, y, z);
    EXPECT_NEAR(sag.y(), wanted(identified, x, from[1], from[2]).y(), kSquaredAngles);
    EXPECT_EQ(sag.x(), 0.0);
    EXPECT_EQ(sag.z(), 0.0);
    // tables of one axis sum up
    EXPECT_LE((sag + Y_over_Z.at(x, y, z) - Y.at(x, y, z)).norm(), kRounding);
  }
  // what stands at the reference is held once, however the work is divided
  const Vector3d there = wanted(identified, from[0], from[1], from[2]);
  for (const Made* made_of_all : {&all, &own, &others}) {
    EXPECT_LE((made_of_all->at(from[0], from[1], from[2]) - there).norm(), kSquaredAngles);
  }
  EXPECT_LE(Y_over_Z.at(0.0, 0.0, from[2]).norm(), kSquaredAngles);
}

TEST(GridLayout, EntersTheNcAsOtherTablesDo) {
  const IdentifiedMachine identified = three_axes(trilinear_errors());
  const Made grid(identified, {});
  EXPECT_EQ(grid.part().entry().entry, EntryPoint::position_command);
  EXPECT_EQ(grid.part().entry().time_constant, 40.0 * ms);
}

std::string fault_of(const IdentifiedMachine& identified, const Options& options) {
  try {
    const Made made(identified, options);
  } catch (const InputError& error) {
    return error.faults().front().message;
  }
  return "none";
}

TEST(Table, RefusesWhatTheNcWouldRefuse) {
  const IdentifiedMachine identified = three_axes(trilinear_errors());
  EXPECT_EQ(fault_of(identified, {.spacing = 10 * mm}),
            "grid over X, Y, Z: 41 x 41 x 41 = 68921 points; the NC accepts at most 15625 "
            "(max_points); use a larger spacing_mm or from_mm and to_mm");
  EXPECT_EQ(fault_of(identified, {.layout = "axis_tables", .spacing = 1 * mm}),
            "table over X: 401 points; the NC accepts at most 256 (max_points); use a larger "
            "spacing_mm or from_mm and to_mm");
  EXPECT_EQ(
      fault_of(identified, {.compensated_axis = "own"}),
      "compensated_axis = \"own\" requires layout = \"axis_tables\"; a grid has several base axes");
  EXPECT_EQ(fault_of(identified, {.max_step_ratio = 20e-6}),
            "grid over X, Y, Z: slope 0.03 um/mm at X = -200.000 mm; the NC accepts at most "
            "0.02 um/mm (max_step_ratio)");
  const IdentifiedMachine plane = identified_with({}, "[w X' b Z t]");
  EXPECT_EQ(fault_of(plane, {.base_axis = "XY"}),
            "base_axis = \"XY\"; the machine has no such axis");
  EXPECT_EQ(fault_of(plane, {.compensated_axis = "Y"}),
            "compensated_axis = \"Y\"; the machine has no such axis");
}

TEST(Table, HoldsItsPointsWhereTheErrorBends) {
  plant::ErrorModel errors;  // a guideway that is straight but for 80 mm
  errors.component("EYX"_err) =
      plant::linear_table({-200 * mm, -40 * mm, -20 * mm, 0.0, 20 * mm, 40 * mm, 200 * mm},
                          {0.0, 0.0, 3 * um, 12 * um, 3 * um, 0.0, 0.0});
  const IdentifiedMachine identified = three_axes(errors);
  const Options fine = {.layout = "axis_tables", .base_axis = "X", .spacing = 2.0 * mm};
  Options equidistant = fine, optimal = fine;
  equidistant.spacing = 400.0 / 6.0 * mm;
  optimal.points = "optimal";
  optimal.max_points = "7";
  const Made wanted(identified, fine), seven(identified, equidistant), best(identified, optimal);
  double left = 0.0, of_seven = 0.0;
  for (double x = -250 * mm; x <= 250 * mm; x += 0.7 * mm) {
    left = std::max(left, std::abs(best.at(x, 0, 0)[1] - wanted.at(x, 0, 0)[1]));
    of_seven = std::max(of_seven, std::abs(seven.at(x, 0, 0)[1] - wanted.at(x, 0, 0)[1]));
  }
  EXPECT_LT(left, 1e-12) << "its seven kinks are points, and it is constant beyond its ends";
  EXPECT_GT(of_seven, 3 * um);
  EXPECT_EQ(fault_of(identified, {.points = "optimal"}),
            "points = \"optimal\" requires layout = \"axis_tables\"");
  optimal.spacing = 0.01 * mm;
  EXPECT_EQ(fault_of(identified, optimal),
            "table over X: 40001 points to choose from; at most 10000: use a larger spacing_mm or "
            "from_mm and to_mm");
}

// At the feed v a delay T reads the table v T too late: each point holds the error v T ahead.
TEST(Table, HoldsTheErrorAheadWhereItIsShifted) {
  plant::ErrorModel errors;
  errors.component("EYX"_err) = plant::harmonic(20.0 * um, 60.0 * mm, 0.4);
  const IdentifiedMachine identified = three_axes(errors);
  const Options plain = {.layout = "axis_tables", .base_axis = "X", .spacing = 2.0 * mm};
  Options shifted = plain;
  shifted.shift = 6.0 * mm;  // three points
  const Made before(identified, plain), ahead(identified, shifted);
  for (const double x : {-100.0, -3.1, 0.0, 77.7}) {
    EXPECT_NEAR(ahead.at(x * mm, 0, 0)[1], before.at((x + 6.0) * mm, 0, 0)[1], kRounding) << x;
    EXPECT_GT(std::abs(ahead.at(x * mm, 0, 0)[1] - before.at(x * mm, 0, 0)[1]), 1e-7);
  }
  EXPECT_EQ(fault_of(identified, {.layout = "axis_tables", .shift = 1.0 * mm}),
            "shift_mm requires one base_axis: on several, feeds and delays differ");
  EXPECT_EQ(fault_of(identified, {.layout = "continuous", .base_axis = "X", .shift = 1.0 * mm}),
            "shift_mm requires layout = \"axis_tables\"");
}

TEST(Table, KnowsWhereItEnds) {
  const IdentifiedMachine identified = three_axes(trilinear_errors());
  const auto strategy = table_entry().make(
      parameters({.layout = "axis_tables", .base_axis = "XZ", .spacing = 150.0 * mm}),
      Action::impose, identified);  // travel of +-200 mm: three intervals
  const auto ends = [&](double x, double y, double z) {
    Joints Q = identified.reference;
    Q.head<3>() << x * mm, y * mm, z * mm;
    std::vector<std::pair<int, double>> out;
    for (const BeyondTable& end : strategy->beyond_tables(Q)) out.emplace_back(end.joint, end.end);
    return out;
  };
  using Ends = std::vector<std::pair<int, double>>;
  EXPECT_EQ(ends(-200.0, 300.0, 250.0), Ends{});  // no table runs over Y
  const double first = identified.lower[0], last = identified.lower[2] + 3 * (150.0 * mm);
  EXPECT_EQ(ends(-200.001, 0.0, 250.001), (Ends{{0, first}, {2, last}}));
}

}  // namespace
}  // namespace servomill::strategies::table_test
