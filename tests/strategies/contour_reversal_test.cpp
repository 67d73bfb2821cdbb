// Cross-coupled control where an axis reverses: friction displaces it by the compliance of its
// loops, which the added gain changes at each frequency in its own way.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include "plant/vocabulary/units.h"
#include "sim/frequency/frequency_response.h"
#include "sim/model/scenario.h"
#include "tests/sim/small_scenario.h"

namespace servomill::strategies::contour_reversal_test {
namespace {

using Complex = std::complex<double>;
using sim::frequency::AxisSignal;

constexpr double kGain = 50.0;        // 1/s, added to Kv
constexpr double kPeriod = 0.2 * ms;  // of the rows

// A circle at 6 m/min. Friction is small, so that the bristles are bent alike with and without the
// added gain: the force is the same function of time.
const char* const kCircle = "G17 G21 G90 G94 G64 P0.001\nG1 X50 F6000\nG3 I-50\nG3 I-50\nM2\n";
const std::string kMachine =
    "[record]\nperiod_ms = 0.2\nresolution_nm = 0.0\n[machine_override]\nfriction_model = "
    "\"lugre\"\n[machine_override.nc]\nvelocity_feed_forward = 0.0\nacceleration_feed_forward = "
    "0.0\n[machine_override.axis.X.friction]\ncoulomb = \"45 N\"\nbreakaway = \"56 N\"\n"
    "[machine_override.axis.Y.friction]\ncoulomb = \"45 N\"\nbreakaway = \"56 N\"\n";
const std::string kContour = "[[case.strategy]]\ntype = \"contour\"\ngain_per_s = 50.0\n";
const std::string kNoFriction = "machine_override = { friction_model = \"none\" }\n";

std::string one_case(const std::string& name, const std::string& keys) {
  return "[[case]]\nname = \"" + name + "\"\n" + keys;
}

sim::model::Scenario scenario() {
  return sim::small_scenario(kCircle, kMachine + one_case("plain", "") +
                                          one_case("plain_free", kNoFriction) +
                                          one_case("contour", kContour) +
                                          one_case("contour_free", kNoFriction + kContour));
}

// Displacement of Y by friction (um) from 0.1 s before its reversal at the top of the second turn
// to 0.3 s after it.
std::vector<double> glitch(const sim::model::Scenario& scenario, const std::string& name) {
  const sim::records::Series with = sim::run_named_case(scenario, name).result.servo,
                             without = sim::run_named_case(scenario, name + "_free").result.servo;
  const std::size_t y = *with.column("true_linear", 'Y'), ref = *with.column("ref_linear", 'Y');
  const std::size_t s = *with.column("s");
  std::size_t reversal = 0;
  for (std::size_t n = 0; n < with.rows(); ++n) {
    const bool second = with.at(n, s) > 50.0 + 100.0 * 3.1416;
    if (second && (reversal == 0 || with.at(n, ref) > with.at(reversal, ref))) reversal = n;
  }
  std::vector<double> out;
  for (std::size_t n = reversal - 500; n < reversal + 1500; ++n) {
    out.push_back((with.at(n, y) - without.at(n, y)) * mm / um);
  }
  return out;
}

// Spectrum of its steps from row to row: it begins and ends displaced.
Complex spectrum(const std::vector<double>& x, double f) {
  Complex sum = 0.0;
  for (std::size_t n = 1; n < x.size(); ++n) {
    sum += (x[n] - x[n - 1]) *
           std::polar(1.0, -2.0 * std::numbers::pi * f * static_cast<double>(n) * kPeriod);
  }
  return sum;
}

// Slide per force, of the exact sampled loops.
Complex compliance(const sim::model::Scenario& scenario, double added_gain, double f) {
  sim::model::MachineSettings machine = scenario.machine;
  machine.nc.cascade[1].Kv += added_gain;
  const Tick delay = scenario.reading_delay_of(scenario.cases.front());
  sim::frequency::FrequencyResponse response(machine, 1, delay,
                                             sim::frequency::PositionLoop::closed);
  return response.at(sim::frequency::Entry::force, f)[index_of(AxisSignal::position)];
}

double height(const std::vector<double>& x) {
  const auto [least, greatest] = std::minmax_element(x.begin(), x.end());
  return *greatest - *least;
}

// The normal of the path is Y where Y reverses, so that its loop has the gain Kv + C. Below 25 Hz
// that leaves less of the glitch, down to Kv / (Kv + C); from there to 60 Hz it leaves more.
TEST(ContourReversal, IsThatOfTheCompliancesAtEachFrequency) {
  const sim::model::Scenario of = scenario();
  const std::vector<double> plain = glitch(of, "plain"), contour = glitch(of, "contour");
  for (const double f : {3.0, 5.0, 8.0, 10.0, 15.0, 20.0, 30.0, 40.0, 50.0}) {
    const Complex measured = spectrum(contour, f) / spectrum(plain, f);
    const Complex exact = compliance(of, kGain, f) / compliance(of, 0.0, f);
    EXPECT_NEAR(std::abs(measured - exact), 0.0, 0.03) << f << " Hz";
  }
  EXPECT_NEAR(std::abs(compliance(of, kGain, 1.0) / compliance(of, 0.0, 1.0)), 83.333 / 133.333,
              0.005);
  EXPECT_GT(std::abs(compliance(of, kGain, 40.0) / compliance(of, 0.0, 40.0)), 1.2);
  // of the largest value that leaves more than the 63 % of slow glitches
  EXPECT_NEAR(height(contour) / height(plain), 0.81, 0.03);
}

}  // namespace
}  // namespace servomill::strategies::contour_reversal_test
