// Responses to an offset: the table against the exact response of the loops, and what a structure
// adds.
#include "sim/preparation/offset_response.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "plant/vocabulary/units.h"
#include "sim/frequency/frequency_response.h"
#include "sim/input/read_scenario.h"

namespace servomill::sim::preparation::offset_response_test {
namespace {

using Complex = std::complex<double>;

constexpr double kPi = std::numbers::pi;
constexpr int kX = 0, kY = 1, kZ = 2;
constexpr double kRounding = 1e-12;

const model::MachineSettings& hsm600u() {
  static const model::MachineSettings kMachine =
      input::read_machine_file(SERVOMILL_SOURCE_DIR "/scenarios/machines/hsm600u.toml");
  return kMachine;
}

const OffsetResponses& of_slides() {
  static const OffsetResponses kResponses(hsm600u(), hsm600u().joints(), 0, std::nullopt);
  return kResponses;
}

// Frequencies of the table: 1000 from 0.5 Hz to just below half the rate of the position loop.
double tabulated(int k) {
  const model::LoopPeriods& periods = hsm600u().nc.periods;
  const double highest = 0.499 / periods.seconds(periods.position);
  return 0.5 * std::pow(highest / 0.5, k / 999.0);
}

Complex exact(int joint, double f, frequency::Entry entry = frequency::Entry::offset,
              Tick delay = 0) {
  frequency::FrequencyResponse response(hsm600u(), joint, delay, frequency::PositionLoop::closed);
  return response.at(entry, f)[frequency::index_of(frequency::AxisSignal::position)];
}

TEST(OffsetResponses, OfIdealAxesAreOne) {
  const OffsetResponses ideal;
  for (const double f : {0.0, 1.0, 1e5}) EXPECT_EQ(ideal.at(kZ, f), 1.0);
}

TEST(OffsetResponses, AreThoseOfTheSampledLoopsAtTheirFrequencies) {
  for (const int joint : hsm600u().joints()) {
    for (const int k : {0, 1, 333, 667, 840, 999}) {
      EXPECT_LE(std::abs(of_slides().at(joint, tabulated(k)) - exact(joint, tabulated(k))), 1e-9)
          << joint << ", " << tabulated(k) << " Hz";
    }
  }
}

// The resonances of slides and tables are at 115 to 350 Hz.
TEST(OffsetResponses, FollowTheResonancesOfTheLoops) {
  for (const int joint : hsm600u().joints()) {
    for (double f = 60.0; f < 600.0; f *= 1.0137) {
      const Complex P = exact(joint, f);
      EXPECT_LE(std::abs(of_slides().at(joint, f) - P), 0.02 * std::abs(P)) << joint << ", " << f;
    }
  }
}

// Below the resonances of the loops, which are sharper than the table.
TEST(OffsetResponses, AreWithinThreePerMilleOfTheLoopsBelowTheirResonances) {
  for (const int joint : hsm600u().joints()) {
    for (double f = 0.1; f < 60.0; f *= 1.31) {
      EXPECT_LE(std::abs(of_slides().at(joint, f) - exact(joint, f)), 3e-3) << joint << ", " << f;
    }
  }
}

TEST(OffsetResponses, GoFromOneAtRestToTheLowestFrequencyAndHoldTheHighest) {
  for (const int joint : hsm600u().joints()) {
    EXPECT_EQ(of_slides().at(joint, 0.0), 1.0);
    EXPECT_EQ(of_slides().at(joint, -1.0), 1.0);
    const Complex lowest = of_slides().at(joint, 0.5);
    EXPECT_LE(std::abs(of_slides().at(joint, 0.125) - (0.75 + 0.25 * lowest)), kRounding);
    EXPECT_EQ(of_slides().at(joint, 1e6), of_slides().at(joint, 1.0001 * tabulated(999)));
    EXPECT_LE(std::abs(of_slides().at(joint, 1e6) - exact(joint, tabulated(999))), 1e-9);
  }
}

// Differences over a position period are late by half of it, those of the velocity by all of it.
TEST(OffsetResponses, AreNearlyThoseOfASetpointThatIsFedForward) {
  for (const int joint : {kX, kY, kZ}) {
    for (const double f : {2.0, 20.0}) {
      const Complex path = exact(joint, f, frequency::Entry::setpoint_fed_forward);
      const model::LoopPeriods& periods = hsm600u().nc.periods;
      const double late = 2.0 * kPi * f * periods.seconds(periods.position);
      EXPECT_LE(std::abs(of_slides().at(joint, f) - path), late) << f;
      EXPECT_GT(std::abs(of_slides().at(joint, f) - path), 0.1 * late * late) << f;
    }
  }
}

TEST(OffsetResponses, KnowTheDelayOfTheReading) {
  const Tick delay = hsm600u().nc.periods.position / 2;
  const OffsetResponses late(hsm600u(), hsm600u().joints(), delay, std::nullopt);
  const double f = tabulated(583);
  EXPECT_LE(std::abs(late.at(kY, f) - exact(kY, f, frequency::Entry::offset, delay)), 1e-9);
  EXPECT_GT(std::abs(late.at(kY, f) - of_slides().at(kY, f)), 1e-3);
}

plant::InertialCompliance compliance(int direction, int joint, double gain, double f = 0.0,
                                     double zeta = 0.0) {
  return {.direction = direction,
          .joint = joint,
          .gain = gain,
          .gain_slope = 0.0,
          .along = 0,
          .mode = {.w = 2.0 * kPi * f, .zeta = zeta}};
}

// Tip over slide at a frequency of the table.
Complex tip_over_slide(const std::vector<plant::InertialCompliance>& structure, int joint, double f,
                       const Joints& at = Joints::Zero()) {
  model::MachineSettings machine = hsm600u();
  machine.inertial_compliances = structure;
  return OffsetResponses(machine, machine.joints(), 0, at).at(joint, f) / of_slides().at(joint, f);
}

constexpr double kGain = 1.2 * um;  // per m/s^2

TEST(OffsetResponses, OfATipOnStaticStructureGrowWithTheSquareOfTheFrequency) {
  for (const int k : {0, 500, 833}) {
    const double w = 2.0 * kPi * tabulated(k);
    EXPECT_LE(std::abs(tip_over_slide({compliance(kX, kX, kGain)}, kX, tabulated(k)) -
                       (1.0 + kGain * w * w)),
              1e-9 * (1.0 + kGain * w * w));
  }
}

TEST(OffsetResponses, OfATipOnAModeHaveItsResonance) {
  constexpr double kMode = 45.0, kZeta = 0.04;  // Hz
  const double w_0 = 2.0 * kPi * kMode;
  for (const int k : {0, 50, 62, 63, 70, 119}) {
    const double w = 2.0 * kPi * tabulated(k);
    const Complex G = w_0 * w_0 / Complex(w_0 * w_0 - w * w, 2.0 * kZeta * w_0 * w);
    EXPECT_LE(std::abs(tip_over_slide({compliance(kY, kY, kGain, kMode, kZeta)}, kY, tabulated(k)) -
                       (1.0 + kGain * w * w * G)),
              1e-9)
        << tabulated(k);
  }
}

TEST(OffsetResponses, OfATipAddUpTheModesOfAnAxis) {
  const double f = tabulated(60);
  const auto a = compliance(kY, kY, kGain, 45.0, 0.04), b = compliance(kY, kY, 0.3 * um);
  const Complex sum = tip_over_slide({a, b}, kY, f) - 1.0;
  EXPECT_LE(std::abs(sum - (tip_over_slide({a}, kY, f) - 1.0) - (tip_over_slide({b}, kY, f) - 1.0)),
            1e-9);
}

TEST(OffsetResponses, LeaveOutWhatAnAxisDoesToOthers) {
  const double f = tabulated(60);
  const std::vector<plant::InertialCompliance> across = {compliance(kX, kY, kGain),
                                                         compliance(kZ, kX, kGain)};
  for (const int joint : hsm600u().joints()) {
    EXPECT_EQ(tip_over_slide(across, joint, f), 1.0) << joint;
  }
  EXPECT_EQ(tip_over_slide({compliance(kX, kX, kGain)}, kZ, f), 1.0);
}

TEST(OffsetResponses, OfATipDependOnWhereItIs) {
  plant::InertialCompliance sloping = compliance(kY, kY, kGain);
  sloping.gain_slope = 2.0 * um;  // per m
  sloping.along = kZ;
  const double f = tabulated(60), w = 2.0 * kPi * f;
  EXPECT_LE(std::abs(tip_over_slide({sloping}, kY, f, Joints::Unit(kZ) * 0.2) -
                     (1.0 + (kGain + 0.4 * um) * w * w)),
            1e-9);
}

TEST(OffsetResponses, OfSlidesDoNotSeeTheStructure) {
  model::MachineSettings machine = hsm600u();
  machine.inertial_compliances = {compliance(kX, kX, kGain)};
  const OffsetResponses slides(machine, machine.joints(), 0, std::nullopt);
  EXPECT_EQ(slides.at(kX, tabulated(60)), of_slides().at(kX, tabulated(60)));
}

}  // namespace
}  // namespace servomill::sim::preparation::offset_response_test
