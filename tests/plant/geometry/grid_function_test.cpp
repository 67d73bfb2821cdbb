/// Errors over several axes: what defines the interpolation, its derivatives, and faults.
#include "plant/geometry/grid_function.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "plant/geometry/error_function.h"
#include "plant/vocabulary/units.h"
#include "tests/plant/geometry/random_errors.h"

namespace servomill::plant::grid_function_test {
namespace {

using Formula = std::function<double(double, double, double)>;

// Samples of e(x, y, c) on an uneven grid.
GridFunction sampled(const Formula& e, GridInterpolation interpolation,
                     std::vector<std::vector<double>> at = {{-0.3, -0.1, 0.0, 0.25, 0.3},
                                                            {0.0, 0.1, 0.15, 0.4},
                                                            {-1.0, 0.2, 0.5, 2.0, 3.0, 3.5}}) {
  GridPoints points{{Axis::X, Axis::Y, Axis::C}, at, {}, interpolation};
  for (const double x : at[0]) {
    for (const double y : at[1]) {
      for (const double c : at[2]) points.error.push_back(e(x, y, c));
    }
  }
  return GridFunction(points);
}

double value(const GridFunction& grid, double x, double y, double c) {
  return grid.value(std::array{x, y, c});
}

struct Place {
  double x, y, c;
};

std::vector<Place> places_within(Uniform& random) {
  std::vector<Place> out;
  for (int n = 0; n < 200; ++n) {
    out.push_back({0.3 * random(), 0.2 + 0.2 * random(), 1.25 + 2.25 * random()});
  }
  return out;
}

constexpr double kRounding = 1e-13;  // of values of about 1, a solution of small systems among it

TEST(GridFunction, TakesTheValuesOfItsPoints) {
  const Formula e = [](double x, double y, double c) { return std::sin(9 * x + c) + 7 * y * c; };
  for (const auto interpolation : {GridInterpolation::linear, GridInterpolation::cubic}) {
    const GridFunction grid = sampled(e, interpolation);
    std::size_t n = 0;
    for (const double x : grid.points().at[0]) {
      for (const double y : grid.points().at[1]) {
        for (const double c : grid.points().at[2]) {
          EXPECT_NEAR(value(grid, x, y, c), grid.points().error[n++], 10 * kRounding);
        }
      }
    }
  }
}

TEST(GridFunction, LinearIsExactForProductsOfLines) {
  const Formula e = [](double x, double y, double c) {
    return 1 + 2 * x - 3 * y + 0.5 * c + 4 * x * y - 0.2 * x * c + y * c - 2 * x * y * c;
  };
  const GridFunction grid = sampled(e, GridInterpolation::linear);
  Uniform random(1);
  for (const auto& [x, y, c] : places_within(random)) {
    EXPECT_NEAR(value(grid, x, y, c), e(x, y, c), kRounding);
  }
}

// The bilinear formula of a control's table, written out.
TEST(GridFunction, LinearOfTwoAxesIsBilinearWithinEachCell) {
  const GridFunction grid(
      GridPoints{{Axis::Z, Axis::X}, {{0.0, 0.1}, {0.0, 0.01, 0.04}}, {1, 2, 4, 3, -1, 0}, {}});
  const double z = 0.025, x = 0.03, u = z / 0.1, v = (x - 0.01) / 0.03;
  EXPECT_NEAR(grid.value(std::array{z, x}),
              (1 - u) * ((1 - v) * 2 + v * 4) + u * ((1 - v) * -1 + v * 0), kRounding);
}

TEST(GridFunction, CubicIsExactForProductsOfCubics) {
  const auto p = [](double s) { return 0.4 - s + 2 * s * s - 1.5 * s * s * s; };
  const Formula e = [&](double x, double y, double c) { return p(x) * p(2 * y) * p(0.3 * c); };
  const GridFunction grid = sampled(e, GridInterpolation::cubic);
  Uniform random(2);
  for (const auto& [x, y, c] : places_within(random)) {
    EXPECT_NEAR(value(grid, x, y, c), e(x, y, c), kRounding);
  }
}

TEST(GridFunction, CubicOfThreeAndTwoPositionsIsAParabolaAndALine) {
  const Formula e = [](double x, double y, double c) {
    return (1 + x - 5 * x * x) * (2 - 3 * y) + c;
  };
  const GridFunction grid =
      sampled(e, GridInterpolation::cubic, {{-0.3, 0.1, 0.3}, {0.0, 0.4}, {-1.0, 0.0, 1.0, 3.5}});
  Uniform random(3);
  for (const auto& [x, y, c] : places_within(random)) {
    EXPECT_NEAR(value(grid, x, y, c), e(x, y, c), kRounding);
  }
}

// A not-a-knot spline is defined by its values and this: slope and curvature are continuous, the
// third derivative is across the second and the last but one position.
TEST(GridFunction, CubicIsTheNotAKnotSpline) {
  const std::vector<double> at = {0.0, 0.1, 0.25, 0.3, 0.5, 0.6, 0.8};
  const GridFunction spline(
      GridPoints{{Axis::X}, {at}, {1, -2, 0, 3, 1, 1, -1}, GridInterpolation::cubic});
  // a cubic's divided differences over four places on one side of a knot
  const auto derivatives = [&](double from, double h) {
    std::array<double, 4> f;
    for (int i = 0; i < 4; ++i) f[std::size_t(i)] = spline.value(std::array{from + i * h});
    const double third = (f[3] - 3 * f[2] + 3 * f[1] - f[0]) / (h * h * h);
    const double second = (f[2] - 2 * f[1] + f[0]) / (h * h) - third * h;
    const double first = (f[1] - f[0]) / h - second * h / 2 - third * h * h / 6;
    return std::array{first, second, third};
  };
  for (std::size_t i = 1; i + 1 < at.size(); ++i) {
    const auto above = derivatives(at[i], 0.01), below = derivatives(at[i], -0.01);
    EXPECT_NEAR(above[0], below[0], 1e-9);
    EXPECT_NEAR(above[1], below[1], 1e-7);
    const bool is_knot = i > 1 && i + 2 < at.size();
    EXPECT_EQ(std::abs(above[2] - below[2]) > 1.0, is_knot) << i;
  }
}

TEST(GridFunction, CubicConvergesWithTheFourthPowerOfTheSpacing) {
  const auto miss = [](int intervals) {
    GridPoints points{{Axis::X, Axis::Y}, {{}, {}}, {}, GridInterpolation::cubic};
    const auto e = [](double x, double y) { return std::sin(3 * x) * std::exp(y); };
    for (int i = 0; i <= intervals; ++i) {
      points.at[0].push_back(double(i) / intervals);
      points.at[1].push_back(double(i) / intervals);
    }
    for (const double x : points.at[0]) {
      for (const double y : points.at[1]) points.error.push_back(e(x, y));
    }
    const GridFunction grid(points);
    double worst = 0.0;
    for (int i = 0; i < 2 * intervals; ++i) {  // at quarters of each cell
      for (int j = 0; j < 2 * intervals; ++j) {
        const double x = (i + 0.5) / (2 * intervals), y = (j + 0.5) / (2 * intervals);
        worst = std::max(worst, std::abs(grid.value(std::array{x, y}) - e(x, y)));
      }
    }
    return worst;
  };
  const double coarse = miss(50), fine = miss(100);
  EXPECT_NEAR(std::log2(coarse / fine), 4.0, 0.25);
}

TEST(GridFunction, DerivativeIsTheLimitOfDifferences) {
  const Formula e = [](double x, double y, double c) { return std::sin(9 * x + c) + 7 * y * c; };
  constexpr double h = 1e-6;
  Uniform random(4);
  for (const auto interpolation : {GridInterpolation::linear, GridInterpolation::cubic}) {
    const GridFunction grid = sampled(e, interpolation);
    for (const auto& [x, y, c] : places_within(random)) {
      for (std::size_t by = 0; by < 3; ++by) {
        std::array at{x, y, c}, up = at, down = at;
        up[by] += h;
        down[by] -= h;
        ASSERT_NEAR(grid.derivative(at, by), (grid.value(up) - grid.value(down)) / (2 * h), 1e-6);
      }
    }
  }
}

TEST(GridFunction, IsConstantBeyondItsEnds) {
  const Formula e = [](double x, double y, double c) { return x * y + c * c; };
  for (const auto interpolation : {GridInterpolation::linear, GridInterpolation::cubic}) {
    const GridFunction grid = sampled(e, interpolation);
    EXPECT_EQ(value(grid, 0.7, 0.2, 1.0), value(grid, 0.3, 0.2, 1.0));
    EXPECT_EQ(value(grid, -9.0, -1.0, 4.0), value(grid, -0.3, 0.0, 3.5));
    EXPECT_EQ(grid.derivative(std::array{0.7, 0.2, 1.0}, 0), 0.0);
    EXPECT_NE(grid.derivative(std::array{0.7, 0.2, 1.0}, 1), 0.0);
  }
}

// Over an endless rotary axis the errors repeat with every turn, up and down.
TEST(GridFunction, RepeatsOverAnEndlessAxis) {
  constexpr double kTurn = 360 * deg;
  for (const auto interpolation : {GridInterpolation::linear, GridInterpolation::cubic}) {
    const GridFunction grid({{Axis::X, Axis::C},
                             {{0, 1}, {-90 * deg, 0, 120 * deg, 200 * deg, 270 * deg}},
                             {1, 4, -2, 0, 1, 3, 5, 7, -6, 3},
                             interpolation,
                             {false, true}});
    for (const double c : {-89.0, -1.0, 17.0, 133.0, 269.9}) {
      for (const double x : {-0.5, 0.0, 0.4, 1.5}) {
        const std::array q = {x, c * deg};
        for (const int turns : {-1000, -2, -1, 1, 3, 110}) {
          const std::array there = {x, c * deg + turns * kTurn};
          EXPECT_NEAR(grid.value(there), grid.value(q), 1e-10) << c << " " << turns;
          EXPECT_NEAR(grid.derivative(there, 1), grid.derivative(q, 1), 1e-10) << c << " " << turns;
        }
      }
    }
    EXPECT_NEAR(grid.value(std::array{0.0, 270 * deg + 1e-9}), 1.0, 1e-7);
    EXPECT_NEAR(grid.value(std::array{0.0, 630 * deg}), 1.0, 1e-9);
  }
}

TEST(GridFunction, OfACubicAtItsLastPositionHasTheSlopeFromWithin) {
  const GridFunction square(
      GridPoints{{Axis::X}, {{0, 1, 2, 3}}, {0, 1, 4, 9}, GridInterpolation::cubic});
  EXPECT_NEAR(square.derivative(std::array{3.0}, 0), 6.0, kRounding);
}

TEST(GridFunction, ReadsItsArgumentsFromTheCoordinatesOfAllAxes) {
  const GridFunction grid =
      sampled([](double x, double y, double c) { return x + 10 * y + 100 * c; }, {});
  AxisWords q;
  q << 0.1, 0.2, 9.0, 9.0, 9.0, 0.3;
  EXPECT_NEAR(grid.value(q), 32.1, 1e-12);
  EXPECT_TRUE(grid.depends_on(Axis::C));
  EXPECT_FALSE(grid.depends_on(Axis::Z));
}

// --- as a part of an error ----------------------------------------------------------------------

TEST(ErrorFunction, AddsItsGrids) {
  const ErrorFunction f =
      polynomial({1.0, 2.0}) + grid({{Axis::X, Axis::Y}, {{0, 1}, {0, 1}}, {0, 1, 2, 3}, {}});
  AxisWords q = AxisWords::Zero();
  q[0] = 0.5;
  q[1] = 0.25;
  EXPECT_DOUBLE_EQ(f.value(0.5, q), 2.0 + 1.25);
  EXPECT_DOUBLE_EQ(scaled(f, -2.0).value(0.5, q), -2.0 * 3.25);
  EXPECT_EQ(f.grid_axes(), (std::vector{Axis::X, Axis::Y}));
  EXPECT_EQ((f + f).grids.size(), 2U);
  EXPECT_FALSE(f.is_zero());
  EXPECT_TRUE(scaled(f, 0.0).is_zero());
  EXPECT_FALSE(f == polynomial({1.0, 2.0}));
}

// --- faults -------------------------------------------------------------------------------------

std::string fault_of(const GridPoints& points) {
  const std::vector<double> units(6, mm);
  return grid_fault(points, units).value_or("none");
}

TEST(GridFault, NamesTheRuleThatIsBroken) {
  const GridPoints good{{Axis::X, Axis::Y}, {{0, 0.1}, {0, 0.1}}, {0, 1, 2, 3}, {}};
  EXPECT_EQ(fault_of(good), "none");
  GridPoints bad = good;
  bad.axes = {Axis::X};
  EXPECT_EQ(fault_of(bad), "has positions of 2 axes and names 1 axes; the numbers must be equal");
  bad = good;
  bad.axes = {};
  EXPECT_EQ(fault_of(bad), "names 0 axes; must name 1 to 5");
  bad = good;
  bad.axes = {Axis::X, Axis::X};
  EXPECT_EQ(fault_of(bad), "names axis X twice");
  bad = good;
  bad.at[1] = {0.1};
  EXPECT_EQ(fault_of(bad), "has 1 positions of Y; must have at least 2");
  bad = good;
  bad.at[0] = {0.1, 0.1};
  EXPECT_EQ(fault_of(bad), "100 follows 100 among the positions of X; positions must increase");
  bad = good;
  bad.at[0][1] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(fault_of(bad), "has a position of X that is not finite");
  bad = good;
  bad.error.pop_back();
  EXPECT_EQ(fault_of(bad), "has 3 errors for 4 combinations of positions; must have one for each");
  bad = good;
  bad.error[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(fault_of(bad), "has an error that is not finite");
  bad = good;
  bad.axes[1] = Axis::C;
  bad.error = {1 * um, 1 * um, 2 * um, 3 * um};
  EXPECT_EQ(fault_of(bad), "none");
  bad.repeats = {false, true};
  EXPECT_EQ(
      fault_of(bad),
      "ends at 3 um or urad where it begins at 2 um or urad; over C, which repeats, both must "
      "be equal");
  bad.error = {1 * um, 1 * um, 2 * um, 2 * um};
  EXPECT_EQ(fault_of(bad), "none");
}

}  // namespace
}  // namespace servomill::plant::grid_function_test
