/// Perfect identification and ideal axes: what remains is the error of the strategy's own
/// approximation.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numbers>

#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "sim/run/run_output.h"
#include "strategies/registry.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::perfect_identification_test {
namespace {

constexpr double kResidualTol = 1e-3;  // um: 1 nm

// Sag of X that depends on the ram, pitch of Y that depends on the table.
std::string grid_of(char direction, char axis) {
  if (direction == 'Z' && axis == 'X') {
    return ", grid = { axes = \"XZ\", interpolation = \"cubic\", at_mm = [[-900, 0, 900], [-900, "
           "0, "
           "900]], value_um = [[0, 5, 20], [-30, -8, 0], [10, 0, 5]] }";
  }
  if (direction == 'A' && axis == 'Y') {
    return ", grid = { axes = \"CY\", at_mm_deg = [[-180, 40, 180], [-900, 900]], value_urad = "
           "[[30, -20], [0, 10], [30, -20]] }";
  }
  return "";
}

// All 18 component errors of X, Y, Z and their 3 squareness errors: some 60 um and 60 urad at 200
// mm, each another cubic, two of them also functions of other axes.
std::string twenty_one_errors() {
  std::string out =
      "[errors.machine]\nEC0Y = \"50 urad\"\nEA0Z = \"40 urad\"\nEB0Z = \"20 urad\"\n";
  int n = 0;
  for (const char axis : std::string("XYZ")) {
    for (const char direction : std::string("XYZABC")) {
      const bool linear = direction >= 'X';
      const double a = std::sin(1.0 + n), b = std::cos(2.0 * n), c = std::sin(3.0 * n);
      ++n;
      out += fmt::format("E{}{} = {{ polynomial_{} = [0.0, {:.5f}, {:.8f}, {:.11f}]{} }}\n",
                         direction, axis, linear ? "um" : "urad", 0.3 * a, 5e-4 * b, 2e-6 * c,
                         grid_of(direction, axis));
    }
  }
  return out;
}

// A spatial line, an arc, a helix; the tool is 110 mm long. The first move is a rapid: programs are
// displaced from its end on.
constexpr const char* kSpatialProgram =
    "G17 G21 G40 G90 G94 G64 P0.00001\nT1 M6\nG43 H1\n"
    "G0 X10 Y-20 Z-100\n"
    "G1 X40 Y-10 Z-95 F3000\n"
    "G3 X60 Y10 I0 J20\n"
    "G2 X80 Y30 Z-90 I10 J10\n"
    "M30\n";

std::string spatial_case(const std::string& strategy, const std::string& action,
                         const std::string& more) {
  return (action == "compensate" ? "machine_errors = \"machine\"\n" : "") +
         std::string("imposed = \"machine\"\n") + twenty_one_errors() +
         "[[program.tool]]\nnumber = 1\nlength_mm = 110.0\n"
         "[[case]]\nname = \"one\"\nservo = \"ideal\"\n"
         "work_offset = { B_deg = 20.0, C_deg = 30.0 }\n"
         "[[case.strategy]]\ntype = \"" +
         strategy + "\"\nmodel = \"machine\"\naction = \"" + action +
         "\"\niterations = \"converged\"\n" + more;
}

// Distances of the tool to where it should be, and the size of the errors at play (um).
struct Residual {
  double largest = 0.0, error = 0.0;
};
Residual residual_of(const model::Scenario& scenario, const records::Series& series,
                     const std::string& action) {
  Residual out;
  Joints Q = Joints::Zero();
  Q.tail<2>() << 20.0 * deg, 30.0 * deg;
  const Eigen::Matrix3d J = plant::linear_jacobian(scenario.machine.chain, Q);
  for (const std::size_t n : rows_within(series, -1000.0, 1000.0)) {
    const auto vector = [&](const char* name) {
      Eigen::Vector3d v;
      for (int i = 0; i < 3; ++i) v[i] = series.at(n, series.column(name, "XYZ"[i]).value());
      return v;
    };
    const Eigen::Vector3d imposed = J * vector("imposed_linear");
    Eigen::Vector3d off = vector("tool_deviation");
    if (action == "impose") off -= imposed;
    out.largest = std::max(out.largest, off.norm());
    out.error = std::max(out.error, imposed.norm());
  }
  testing::Test::RecordProperty("error_um_" + action, fmt::format("{:.3f}", out.error));
  testing::Test::RecordProperty("residual_nm_" + action, fmt::format("{:.5f}", out.largest * 1e3));
  return out;
}

records::Series run(const model::Scenario& scenario) {
  run::RunControl control;
  control.threads = 1;
  run::RunOutput out = run::run_scenario(scenario, control);
  return std::move(out.cases.at(0).result.servo);
}

Residual residual_of(const std::string& program, const std::string& strategy,
                     const std::string& action, const std::string& more) {
  const model::Scenario scenario = small_scenario(program, spatial_case(strategy, action, more));
  return residual_of(scenario, run(scenario), action);
}

// The true tool is where the program wants it, to 1 nm, on a line, an arc and a helix.
TEST(PerfectIdentification, FeedbackLeavesNothing) {
  for (const std::string action : {"compensate", "impose"}) {
    for (const std::string prediction : {"lag", "loop", "observer"}) {
      const Residual r =
          residual_of(kSpatialProgram, "feedback", action,
                      fmt::format("max_um = 1000.0\nprediction = \"{}\"\n", prediction));
      EXPECT_GT(r.error, 10.0);
      EXPECT_LT(r.largest, kResidualTol) << action << ", " << prediction;
    }
  }
}

// On a line, blocks of 0.2 mm are chords of an error of some 1e-3 um/mm^2: h^2 E''/8 = 0.01 nm, far
// below the chord tolerance, which cannot be set below 1 nm. What remains is the print, 1e-7 mm,
// and G64 P, by which a corner between blocks may be rounded.
TEST(PerfectIdentification, RewrittenLinesLeaveTheirPrint) {
  constexpr double kPrint = 0.87e-4;  // um: half of 1e-7 mm on each of three axes
  constexpr double kChord = 0.2e-4;   // um
  constexpr double kCorner = 1e-4;    // um: P0.0000001
  const std::string program =
      "G17 G21 G40 G90 G94 G64 P0.0000001\nT1 M6\nG43 H1\nG0 X10 Y-20 Z-100\n"
      "G1 X30 Y-10 Z-95 F3000\nM30\n";
  for (const std::string action : {"compensate", "impose"}) {
    const Residual r =
        residual_of(program, "gcode", action, "tolerance_um = 0.001\nmax_block_mm = 0.2\n");
    EXPECT_GT(r.error, 10.0);
    EXPECT_LT(r.largest, kPrint + kChord + kCorner) << action;
  }
}

// Arcs become chords: the blocks are halved until the chord tolerance holds.
TEST(PerfectIdentification, RewrittenArcsKeepTheChordTolerance) {
  constexpr double kChord = 0.1, kCorner = 0.1, kPrint = 1e-4;  // um
  std::string program = kSpatialProgram;
  program.replace(program.find("P0.00001"), 8, "P0.0001");
  for (const std::string action : {"compensate", "impose"}) {
    const Residual r =
        residual_of(program, "gcode", action, "tolerance_um = 0.1\nmax_block_mm = 1.0\n");
    EXPECT_LT(r.largest, kChord + kCorner + kPrint) << action;
    EXPECT_GT(r.largest, 0.25 * kChord) << action << ": the tolerance is used, not undercut";
  }
}

// A table is linear between points: of a sine A sin(2 pi x / L) with points h apart there remains
// h^2/8 A (2 pi / L)^2, reached where the sine has its crests.
TEST(PerfectIdentification, TableLeavesItsInterpolationError) {
  constexpr double kAmplitude = 150.0, kPeriod = 62.0;                                  // um, mm
  const double curvature = kAmplitude * std::pow(2.0 * std::numbers::pi / kPeriod, 2);  // um/mm^2
  for (const double h : {1.6384, 3.2768}) {
    const double bound = h * h / 8.0 * curvature;
    for (const std::string action : {"compensate", "impose"}) {
      const std::string toml = fmt::format(
          "{}imposed = \"machine\"\n[errors.machine]\n"
          "EYX = {{ harmonic = {{ amplitude_um = {}, period_mm = {} }} }}\n"
          "EZX = {{ harmonic = {{ amplitude_um = 15.0, period_mm = 62.0, phase_deg = 90.0 }} }}\n"
          "[[case]]\nname = \"one\"\nservo = \"ideal\"\n[[case.strategy]]\ntype = \"table\"\n"
          "model = \"machine\"\naction = \"{}\"\niterations = \"converged\"\nbase_axis = \"X\"\n"
          "from_mm = -100.0\nto_mm = 100.0\nspacing_mm = {}\n",
          action == "compensate" ? "machine_errors = \"machine\"\n" : "", kAmplitude, kPeriod,
          action, h);
      const records::Series series = run(small_scenario("G0 X-40\nG1 X40 F6000\nM30\n", toml));
      const auto rows = rows_within(series, -40.0, 40.0);
      double largest = 0.0;
      for (const std::size_t n : rows) {
        const double y = action == "compensate"
                             ? series.at(n, *series.column("tool_deviation", 'Y'))
                             : 1e3 * series.at(n, *series.column("true_linear", 'Y')) -
                                   series.at(n, *series.column("imposed_linear", 'Y'));
        largest = std::max(largest, std::abs(y));
      }
      RecordProperty(fmt::format("residual_nm_{}_{}", action, h), std::to_string(largest * 1e3));
      // the turn of a unit tool axis and the rounding of mm are far below a nanometre
      EXPECT_LE(largest, bound + kResidualTol) << action << " " << h;
      EXPECT_GE(largest, 0.5 * bound) << action << " " << h;
    }
  }
}

}  // namespace
}  // namespace servomill::sim::perfect_identification_test
