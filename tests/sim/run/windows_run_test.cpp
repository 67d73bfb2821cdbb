// Runs whose recording has windows, against those of all rows.

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/model/scenario.h"
#include "sim/preparation/estimate.h"
#include "sim/records/row_thinning.h"
#include "sim/run/run_output.h"
#include "sim/run/store.h"
#include "sim/run/stored_run.h"
#include "tests/sim/run/compared_cases.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::run::windows_run_test {
namespace {

// Ten parts, each a line and a circle; both directions of the circle in every part.
constexpr const char* kParts = R"(G21 G90 G94 F3000
O1 REPEAT [10]
(MSG, line)
G1 X40 Y5
G4 P0.05
X0 Y0
(MSG, circle)
G2 X0 Y0 I10 J0
G1 X1
G1 X0
O1 ENDREPEAT
M2
)";

std::string quantity(const std::string& name, const std::string& keys) {
  return "[[quantity]]\nname = \"" + name + "\"\n" + keys;
}

std::string line_quantities(const std::string& more) {
  std::string out;
  for (const std::string statistic : {"max", "rms", "mean", "range"}) {
    const std::string keys = "statistic = \"" + statistic + "\"\n" + more;
    out += quantity("following_error", "axis = \"X\"\n" + keys);
    out += quantity("tcp_deviation", keys);
    out += quantity("tool_difference", "baseline = \"as_it_is\"\ncases = [\"feedback\"]\n" + keys);
    out += quantity("imposed_error_residual",
                    "axis = \"Y\"\nbaseline = \"as_it_is\"\ncases = [\"feedback\"]\n" + keys);
  }
  const std::string base = "axis = \"Y\"\nbaseline = \"as_it_is\"\ncases = [\"feedback\"]\n" + more;
  return out + quantity("lag_time", base) + quantity("realised_ratio", base);
}

model::Scenario scenario(const std::string& record, const std::string& quantities = "") {
  return small_scenario(
      kParts, "machine_errors = \"measured\"\nimposed = \"measured\"\n[record]\n" + record +
                  kComparedCases + quantities);
}

// Compares every column of rows of one recording with those at the same time of another.
// Returns how many rows it found.
std::size_t same_bits(const records::Series& some, const records::Series& all, double period) {
  const std::size_t time = *some.column("time");
  for (std::size_t row = 0; row < some.rows(); ++row) {
    const auto other = static_cast<std::size_t>(std::llround(some.at(row, time) / period));
    for (const records::Signal& signal : all.signals()) {
      const std::size_t mine = some.find(signal.name)->offset;
      for (std::size_t c = 0; c < signal.columns(); ++c) {
        if (std::bit_cast<std::uint64_t>(some.at(row, mine + c)) ==
            std::bit_cast<std::uint64_t>(all.at(other, signal.offset + c))) {
          continue;
        }
        ADD_FAILURE() << signal.name << " in row " << row;
        return row;
      }
    }
  }
  return some.rows();
}

const records::Series& servo(const RunOutput& of, std::size_t number) {
  return of.cases[number].result.servo;
}

class WindowsRun : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const std::string of_line = line_quantities("sections = [\"line\"]\n");
    all = new RunOutput(run_scenario(scenario("period_ms = 1.0\n", of_line), {}));
  }
  static void TearDownTestSuite() { delete all; }
  static inline const RunOutput* all = nullptr;
};

TEST_F(WindowsRun, HasTheSameBitsInside) {
  const RunOutput some = run_scenario(
      scenario(
          "period_ms = 1.0\nwindows = { sections = [\"line\"], time_s = [[0.5, 0.75]], every = "
          "4 }\n"),
      {});
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_LT(servo(some, i).rows(), servo(*all, i).rows() / 2);
    EXPECT_EQ(same_bits(servo(some, i), servo(*all, i), 1e-3), servo(some, i).rows());
  }
}

// Errors and temperatures change every 0.1 s: the row before a window has those of its own time.
TEST(WindowsOfAWarmMachine, HaveTheSameBitsInside) {
  const auto run = [](const std::string& windows) {
    const std::string heat =
        "[machine_override.heat]\nstart_degC = 20.0\n"
        "[machine_override.heat.surroundings.room]\nmean_degC = 20.0\n"
        "[machine_override.heat.body.head]\ncapacity_J_per_K = 20.0\n"
        "conductance_W_per_K = { room = 10.0 }\nerrors_per_K = { EZZ = { constant_um = -2.0 } }\n"
        "[machine_override.heat.source]\n"
        "pump = { body = \"head\", kind = \"constant\", power_W = 100.0 }\n";
    return run_named_case(small_scenario(kParts, "[record]\nperiod_ms = 1.0\n" + windows +
                                                     "[[case]]\nname = \"one\"\n" + heat),
                          "one");
  };
  const CaseOutput all = run(""),
                   some = run("windows.time_s = [[0.3, 0.35], [0.5, 0.55], [0.601, 0.7]]\n");
  const records::Series& servo = some.result.servo;
  EXPECT_EQ(same_bits(servo, all.result.servo, 1e-3), servo.rows());
  const std::size_t T = *servo.column("temperature_head");
  EXPECT_GT(servo.at(servo.rows() - 1, T), servo.at(1, T) + 1.0);
}

// The rows that are there are those of the definition: recorded sections and times, one row on both
// sides of each window, the first and the last.
TEST_F(WindowsRun, RecordsThePassesAndTimesAndTheRowsAroundThem) {
  const RunOutput some = run_scenario(
      scenario(
          "period_ms = 1.0\nwindows = { sections = [\"line\"], time_s = [[0.5, 0.75]], every = "
          "4 }\n"),
      {});
  const records::Series& every = servo(*all, 1);
  const std::size_t section = *every.column("section"), time = *every.column("time");
  const std::vector<std::string>& names = all->cases[1].sections;
  std::vector<bool> inside(every.rows());
  int pass = 0;
  for (std::size_t row = 0; row < every.rows(); ++row) {
    const bool is_line = names[static_cast<std::size_t>(every.at(row, section))] == "line";
    if (is_line && (row == 0 || every.at(row, section) != every.at(row - 1, section))) ++pass;
    const double t = every.at(row, time);
    inside[row] = (is_line && pass % 4 == 1) || (t > 0.4999 && t < 0.7501);
  }
  EXPECT_EQ(pass, 10);
  std::vector<double> wanted;
  std::size_t left_out = 0;
  for (std::size_t row = 0; row < every.rows(); ++row) {
    const bool is_edge = row == 0 || row + 1 == every.rows() || inside[row - 1] || inside[row + 1];
    if (inside[row] || is_edge) wanted.push_back(every.at(row, time));
    if (!inside[row]) ++left_out;
  }
  const records::Series& found = servo(some, 1);
  ASSERT_EQ(found.rows(), wanted.size());
  const std::size_t window = *found.column("window"), in_window = *found.column("in_window");
  for (std::size_t row = 0; row < found.rows(); ++row) {
    ASSERT_EQ(found.at(row, time), wanted[row]);
    const auto of_all = static_cast<std::size_t>(std::llround(wanted[row] / 1e-3));
    ASSERT_EQ(found.at(row, in_window), inside[of_all] ? 1.0 : 0.0);
    if (row == 0) continue;
    const bool goes_on = found.at(row, time) - found.at(row - 1, time) < 1.5e-3;
    ASSERT_EQ(found.at(row, window), found.at(row - 1, window) + (goes_on ? 0.0 : 1.0));
  }
  std::size_t sum = 0;
  for (const std::size_t rows : some.cases[1].result.left_out) sum += rows;
  EXPECT_EQ(sum, left_out);  // none of its moves is rapid
}

// A section that is recorded whole is compared as without windows, bit for bit, with no note.
TEST_F(WindowsRun, ComparesACompleteSectionAsWithoutWindows) {
  const RunOutput some = run_scenario(scenario("period_ms = 1.0\nwindows.sections = [\"line\"]\n",
                                               line_quantities("sections = [\"line\"]\n")),
                                      {});
  ASSERT_EQ(some.comparison.size(), all->comparison.size());
  for (std::size_t i = 0; i < some.comparison.size(); ++i) {
    SCOPED_TRACE(some.comparison[i].case_name + " " + some.comparison[i].quantity + " " +
                 some.comparison[i].statistic);
    EXPECT_TRUE(std::isfinite(some.comparison[i].value));
    EXPECT_EQ(some.comparison[i].value, all->comparison[i].value);
    EXPECT_EQ(some.comparison[i].note, all->comparison[i].note);
  }
}

TEST_F(WindowsRun, SaysThatAValueIsOfWindows) {
  const RunOutput some = run_scenario(
      scenario("period_ms = 1.0\nwindows.time_s = [[0.5, 0.75], [3, 3.1]]\n", line_quantities("")),
      {});
  for (const evaluation::ComparisonRow& row : some.comparison) {
    EXPECT_TRUE(row.note.starts_with("inside record.windows")) << row.quantity << ": " << row.note;
    EXPECT_TRUE(std::isfinite(row.value)) << row.quantity;
  }
}

// Cases of different duration are elsewhere at the same time: what one of them has left out is not
// interpolated.
TEST(WindowsOfCases, AreComparedWhereBothHaveRows) {
  const std::string cases = R"([[case]]
name = "slow"
[case.machine_override.nc]
[case.machine_override.axis.X]
a_max = 0.3
[[case]]
name = "fast"
)";
  const std::string asked =
      quantity("trajectory_difference", "axis = \"X\"\nbaseline = \"slow\"\ncases = [\"fast\"]\n");
  const auto run = [&](const std::string& record) {
    return run_scenario(
        small_scenario(kParts, "[record]\nperiod_ms = 1.0\n" + record + cases + asked), {});
  };
  const RunOutput all = run(""), none = run("windows.time_s = [[0.5, 1.5]]\n");
  const evaluation::ComparisonRow& row = none.comparison.front();
  EXPECT_LE(std::abs(row.value), std::abs(all.comparison.front().value));
  EXPECT_NE(row.note.find(" rows are not compared: slow has no rows there"), std::string::npos)
      << row.note;
}

TEST_F(WindowsRun, SaysThatNothingIsLeft) {
  const RunOutput some = run_scenario(
      scenario("period_ms = 1.0\nwindows.sections = [\"circle\"]\n",
               quantity("contour_error", "sections = [\"line\"]\nstatistic = \"max\"\n") +
                   quantity("cycle_time", "")),
      {});
  for (const evaluation::ComparisonRow& row : some.comparison) {
    const bool is_of_program = row.quantity == "cycle_time";
    EXPECT_EQ(std::isfinite(row.value), is_of_program);
    EXPECT_EQ(row.note, is_of_program ? "" : "record.windows leave out every row");
  }
}

TEST_F(WindowsRun, AreReadFromTheFileAsTheyWere) {
  const model::Scenario of =
      scenario("period_ms = 1.0\nwindows.time_s = [[0.5, 0.75], [3, 3.1]]\n", line_quantities(""));
  const RunOutput some = run_scenario(of, {});
  const std::string path = testing::TempDir() + "/windows_run_test.h5";
  RunStore store(path, true, of, 1);
  for (const CaseOutput& one : some.cases) store.add(one);
  store.commit(some.comparison);
  const StoredRun stored = read_run(path);
  const auto again = evaluation::compare(stored.quantities, stored.cases);
  ASSERT_EQ(again.size(), some.comparison.size());
  for (std::size_t i = 0; i < again.size(); ++i) {
    EXPECT_EQ(again[i].value, some.comparison[i].value);
    EXPECT_EQ(again[i].note, some.comparison[i].note);
  }
}

// Rows and memory follow the windows, not the duration.
TEST(WindowsOfALongProgram, KeepTheRecordingOfOneCycle) {
  const auto rows = [](int parts, const std::string& every) {
    std::string program = kParts;
    program.replace(program.find("[10]"), 4, "[" + std::to_string(parts) + "]");
    const model::Scenario of =
        small_scenario(program,
                       "[record]\nperiod_ms = 1.0\nwindows = { sections = [\"line\", "
                       "\"circle\"], every = " +
                           every + " }\n[[case]]\nname = \"one\"\n");
    return run_named_case(of, "one").result.servo.rows();
  };
  const std::size_t of_one = rows(1, "1");
  for (const int parts : {10, 40}) {
    // one cycle without its settling, a row after it and the last one
    EXPECT_NEAR(static_cast<double>(rows(parts, std::to_string(parts))),
                static_cast<double>(of_one) - 100.0, 3.0);
  }
}

// The size of a run is that of its windows, to a look every 10 ms.
TEST(WindowsOfALongProgram, AreEstimated) {
  const std::string small = "period_ms = 1.0\nmax_size_GB = 0.001\n";
  EXPECT_THROW(check_scenario(scenario(small)), InputError);
  const preparation::RunEstimate takes =
      check_scenario(scenario(small + "windows.time_s = [[0.5, 0.75]]\n"));
  EXPECT_NEAR(takes.rows, 2 * 250.0, 2 * 20.0);
  EXPECT_FALSE(takes.is_thinned);
  EXPECT_FALSE(check_scenario(scenario("max_size_GB = 1\nextremes = true\n")).is_thinned);
}

std::string refusal(const std::string& record, const std::string& more) {
  try {
    check_scenario(scenario(record, more));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// Quantities of a shape need every row.
TEST(RefusedWindows, LeaveOutACircle) {
  const std::string circle = quantity("circular_error", "sections = [\"circle\"]\n");
  const std::string needs =
      "circular_error needs every row of section 'circle': list it in record.windows.sections, "
      "without every";
  EXPECT_NE(refusal("windows.sections = [\"line\"]\n", circle).find(needs), std::string::npos);
  EXPECT_NE(refusal("windows.time_s = [[0, 100]]\n", circle).find(needs), std::string::npos);
  EXPECT_NE(refusal("windows = { sections = [\"circle\"], every = 2 }\n", circle).find(needs),
            std::string::npos);
  EXPECT_NE(refusal("windows.sections = [\"lin\"]\n", "").find("no section 'lin'"),
            std::string::npos);
}

}  // namespace
}  // namespace servomill::sim::run::windows_run_test
