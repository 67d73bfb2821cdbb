// Days with temperature compensation and datums in between: one body that warms up, closed forms.
#include "sim/run/day_correction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "sim/run/day_course.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::run::day_correction_test {
namespace {

constexpr double kTau = 2000.0, kRise = 10.0;  // s; K, of a pump of 100 W at 10 W/K
constexpr double kGrowth = 2.0 * um;           // m/K

const char* const kPart = "G17 G21 G90 G94 G64 P0.001\nG1 X50 F6000\nG4 P9.0\nG1 X0\nM30\n";

std::string machine(const std::string& sensor) {
  return "[machine_override.heat]\nstart_degC = 20.0\n"
         "[machine_override.heat.surroundings.room]\nmean_degC = 20.0\n"
         "[machine_override.heat.body.head]\ncapacity_J_per_K = 20000.0\n"
         "conductance_W_per_K = { room = 10.0 }\n"
         "errors_per_K = { EZZ = { constant_um = -2.0 } }\n"
         "[machine_override.heat.source]\n"
         "pump = { body = \"head\", kind = \"constant\", power_W = 100.0 }\n"
         "[machine_override.heat.sensor]\nram = { body = \"head\"" +
         sensor + " }\n";
}

const std::string kExact = ", errors_per_K = { EZZ = { constant_um = -2.0 } }";

struct Setting {
  std::string strategy = {};
  std::string sensor = kExact;
  std::string day = {};  // keys
  int cycles = 300;
  std::string quantities = {};
};

CaseOutput run_of(const Setting& setting) {
  const std::string toml =
      setting.quantities + "[[case]]\nname = \"one\"\n" + setting.strategy +
      "[day]\nsample_min = 1.0\n" + setting.day +
      "[[day.place]]\nname = \"centre\"\nat = { X_mm = 0.0, Y_mm = 0.0, Z_mm = 100.0, B_deg = 0.0, "
      "C_deg = 0.0 }\ntool_length_mm = 100.0\n[[day.phase]]\nactivity = \"program\"\ncycles = " +
      std::to_string(setting.cycles) + "\n" + machine(setting.sensor);
  return run_named_case(small_scenario(kPart, toml), "one");
}

DayCourse day_of(const Setting& setting) { return *run_of(setting).day; }

std::string thermal(const std::string& keys) {
  return "[[case.strategy]]\ntype = \"thermal\"\n" + keys + "\n";
}

double rise(double t) { return kRise * (1.0 - std::exp(-t / kTau)); }

std::string every(const std::string& minutes, const std::string& duration) {
  return "remeasure = { place = \"centre\", every_min = " + minutes +
         ", duration_min = " + duration + " }\n";
}

// --- datums -------------------------------------------------------------------------------------

// From one datum to the next the error is what the body has warmed up by:
// k P/G e^(-t_d/tau) (1 - e^(-(t - t_d)/tau)), largest in the first interval.
TEST(Remeasuring, LeavesWhatTheMachineWarmsUpByBetweenDatums) {
  for (const std::string minutes : {"5", "20", "40"}) {
    const DayCourse day = day_of({.day = every(minutes, "0")});
    ASSERT_FALSE(day.datums.empty());
    EXPECT_EQ(day.measuring, 0.0);
    for (const DayCycle& cycle : day.cycles) {
      const auto next = std::upper_bound(day.datums.begin(), day.datums.end(), cycle.begin);
      const double last = next == day.datums.begin() ? 0.0 : *(next - 1);
      const double wanted = kGrowth * (rise(cycle.begin) - rise(last));
      EXPECT_NEAR(cycle.rms, wanted, 1e-10);
      EXPECT_NEAR(cycle.most, wanted, 1e-10);
    }
    const double most = kGrowth * rise(day.datums.front());
    EXPECT_LT(figures_of(day).largest, most);
    EXPECT_GT(figures_of(day).largest, 0.95 * most);  // of the last cycle before it
  }
}

TEST(Remeasuring, ComesBeforeTheFirstCycleThatIsLater) {
  const DayCourse day = day_of({.day = every("10", "0")});
  double last = 0.0;
  for (const double datum : day.datums) {
    EXPECT_GE(datum - last, 600.0);
    EXPECT_LT(datum - last, 600.0 + 13.0);  // a cycle takes less
    last = datum;
  }
}

// The axes stand meanwhile, so that a day of as many parts lasts longer.
TEST(Remeasuring, TakesItsTime) {
  const DayCourse without = day_of({}), with = day_of({.day = every("10", "2")});
  EXPECT_NEAR(with.measuring, 120.0 * static_cast<double>(with.datums.size()), 1e-9);
  EXPECT_NEAR(with.time.back(), without.time.back() + with.measuring, 1e-6);
}

// Datums with noise: what is left at the datum itself is that noise.
TEST(Remeasuring, HasTheNoiseOfTheProbe) {
  const DayCourse day = day_of({.strategy = thermal("filter_s = 0.0"),
                                .day = every("0.2", "0") + "probe_noise_um = 0.5\n",
                                .cycles = 2000});
  double squares = 0.0;
  for (std::size_t n = 1; n < day.cycles.size(); ++n) {
    squares += day.cycles[n].rms * day.cycles[n].rms;
  }
  const double sigma = std::sqrt(squares / static_cast<double>(day.cycles.size() - 1) / 3.0);
  ASSERT_GT(day.datums.size(), 900U);
  EXPECT_NEAR(sigma, 0.5 * um, 0.03 * um);
}

// --- temperature compensation -------------------------------------------------------------------

TEST(DayCorrection, OfExactTemperaturesLeavesNothing) {
  for (const char* temperatures : {"sensors", "network"}) {
    const DayCourse day =
        day_of({.strategy = thermal(std::string("filter_s = 0.0\ntemperatures = \"") +
                                    temperatures + "\"")});
    EXPECT_LT(figures_of(day).largest, 1e-12) << temperatures;
    EXPECT_LT(day.ranges[0].whole[2], 1e-12) << "the drift of the tip is that with the offset";
  }
}

// Behind a filter with tau_f the error is k P/G tau_f/(tau - tau_f) (e^(-t/tau) - e^(-t/tau_f)).
TEST(DayCorrection, LagsBehindByItsFilter) {
  constexpr double kFilter = 300.0;
  const DayCourse day = day_of({.strategy = thermal("filter_s = 300.0")});
  for (const DayCycle& cycle : day.cycles) {
    const double lag = kGrowth * kRise * kFilter / (kTau - kFilter) *
                       (std::exp(-cycle.begin / kTau) - std::exp(-cycle.begin / kFilter));
    EXPECT_NEAR(cycle.most, lag, 2e-3 * kGrowth);  // steps of 1 s, linear in between
  }
}

// A sensor's error per kelvin that is wrong by a fifth leaves a fifth.
TEST(DayCorrection, LeavesTheShareThatItsErrorsAreWrongBy) {
  const DayCourse day = day_of({.strategy = thermal("filter_s = 0.0"),
                                .sensor = ", errors_per_K = { EZZ = { constant_um = -1.6 } }"});
  for (const DayCycle& cycle : day.cycles) {
    EXPECT_NEAR(cycle.most, 0.2 * kGrowth * rise(cycle.begin), 1e-11);
  }
}

// A network with another conductance settles at another temperature.
TEST(DayCorrection, ComputesTheNetworkThatItKnows) {
  const DayCourse day = day_of(
      {.strategy = thermal(
           "filter_s = 0.0\ntemperatures = \"network\"\nmachine = { heat = { body = { head = "
           "{ conductance_W_per_K = { room = 12.5 } } } } }")});
  for (const DayCycle& cycle : day.cycles) {
    const double known = 8.0 * (1.0 - std::exp(-cycle.begin / 1600.0));
    EXPECT_NEAR(cycle.most, kGrowth * std::abs(rise(cycle.begin) - known), 1e-11);
  }
}

// Readings of a cycle are means over a second: noise / sqrt(10), and the filter takes
// sqrt(h / (2 tau_f)) of that.
TEST(DayCorrection, FiltersTheNoiseOfItsSensors) {
  const DayCourse day = day_of({.strategy = thermal("filter_s = 20.0"),
                                .sensor = kExact + ", noise_K = 0.5",
                                .cycles = 3000});
  double squares = 0.0;
  int count = 0;
  for (const DayCycle& cycle : day.cycles) {
    if (cycle.begin < 8.0 * kTau) continue;  // warm, no lag
    squares += cycle.most * cycle.most;
    ++count;
  }
  ASSERT_GT(count, 1000);
  const double a = std::exp(-1.0 / 20.0);
  // first-order hold: response of the filter to one reading among zeros
  const double g = 20.0 * (1.0 - a);
  double variance = (1.0 - g) * (1.0 - g);
  double value = 1.0 - g;
  value = a * value - (a * 1.0) + g;  // the reading falls back to 0
  for (int n = 0; n < 2000; ++n, value *= a) variance += value * value;
  EXPECT_NEAR(std::sqrt(squares / count), kGrowth * 0.5 / std::sqrt(10.0) * std::sqrt(variance),
              0.1 * kGrowth * 0.5 / std::sqrt(10.0) * std::sqrt(variance));
}

TEST(DayCorrection, EndsTheDayBeyondItsLargestOffset) {
  const DayCourse day = day_of({.strategy = thermal("filter_s = 0.0\nmax_um = 10.0")});
  EXPECT_NE(day.stopped.find("strategy thermal: offset of Z by 10."), std::string::npos)
      << day.stopped;
  EXPECT_NE(day.stopped.find("must be <= max_um = 10"), std::string::npos) << day.stopped;
}

TEST(DayCorrection, IsAskedForByQuantities) {
  const std::string quantities =
      "[[quantity]]\nname = \"thermal_deviation_rms\"\ncases = [\"one\"]\n"
      "[[quantity]]\nname = \"thermal_deviation_max\"\ncases = [\"one\"]\n"
      "[[quantity]]\nname = \"measuring_time\"\ncases = [\"one\"]\n";
  const CaseOutput out = run_of({.day = every("10", "2"), .quantities = quantities});
  const evaluation::CaseData data = out.data();
  ASSERT_TRUE(data.day);
  EXPECT_EQ(data.day->rms, figures_of(*out.day).rms);
  EXPECT_EQ(data.day->measuring, out.day->measuring);
}

// --- in a run -----------------------------------------------------------------------------------

// A machine that stands warm: the tip is where it would be on a cold one.
TEST(ThermalRun, OffsetsTheSetpoint) {
  const auto tip_of = [](const std::string& strategy, const char* servo) {
    std::string warm = machine(kExact);
    warm.replace(warm.find("start_degC = 20.0"), 17, "start_degC = 30.0");
    const CaseOutput out =
        run_named_case(small_scenario(kPart, std::string("[[case]]\nname = \"one\"\nservo = \"") +
                                                 servo + "\"\n" + strategy + warm),
                       "one");
    const records::Series& servo_rows = out.result.servo;
    const std::size_t z = servo_rows.column("tool_deviation", 'Z').value();
    double largest = 0.0;
    for (std::size_t n = 0; n < servo_rows.rows(); ++n) {
      largest = std::max(largest, std::abs(servo_rows.at(n, z)));
    }
    return largest;
  };
  for (const char* servo : {"cascade", "ideal"}) {
    EXPECT_NEAR(tip_of("", servo), 20.0, 0.1) << servo;  // um
    for (const char* temperatures : {"sensors", "network"}) {
      const std::string keys =
          std::string("filter_s = 0.0\ntemperatures = \"") + temperatures + "\"";
      EXPECT_LT(tip_of(thermal(keys), servo), 0.02) << servo << " " << temperatures;
    }
  }
}

// --- wrong input --------------------------------------------------------------------------------

std::string refusal(const std::string& toml) {
  try {
    preparation::prepare_cases(small_scenario(kPart, toml));
  } catch (const InputError& error) {
    return error.faults().front().message;
  }
  return "";
}

TEST(ThermalInput, NeedsAMachineWithHeat) {
  EXPECT_EQ(refusal("[[case]]\nname = \"one\"\n" + thermal("")),
            "case one: strategy thermal: the machine of the case has no [heat]");
}

TEST(ThermalInput, NeedsSensorsThatTheMachineHas) {
  EXPECT_EQ(
      refusal("[[case]]\nname = \"one\"\n" +
              thermal("machine = { heat = { sensor = { oil = { body = \"head\", errors_per_K = "
                      "{ EZZ = { constant_um = 1.0 } } } } } }") +
              machine(kExact)),
      "case one: strategy thermal: machine has errors_per_K of a sensor 'oil' that the "
      "machine of the case lacks; it has ram");
}

TEST(ThermalInput, IsOneInACase) {
  EXPECT_EQ(refusal("[[case]]\nname = \"one\"\n" + thermal("") + thermal("") + machine(kExact)),
            "case one: strategy thermal appears twice; each would correct the whole");
}

TEST(ThermalInput, QuantitiesNeedADay) {
  EXPECT_EQ(refusal("[[quantity]]\nname = \"thermal_deviation_rms\"\ncases = [\"one\"]\n"
                    "[[case]]\nname = \"one\"\n" +
                    machine(kExact)),
            "quantity[0].name = \"thermal_deviation_rms\"; needs [day]");
}

}  // namespace
}  // namespace servomill::sim::run::day_correction_test
