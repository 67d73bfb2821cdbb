#include "sim/responses/control_response.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "sim/recordings/read_recording.h"
#include "sim/responses/rational_fit.h"
#include "tests/text.h"

namespace servomill::sim::responses::control_response_test {
namespace {

ControlSpectra spectra() {
  ControlSpectra s;
  s.frequency = {0.0, 1.0, 2.0};
  s.input = {1.0, 4.0, 1e-9};
  s.cross = {1.0, {0.0, 8.0}, 1e-9};
  s.output = {1.0, 20.0, 1.0};
  s.averages = 5;
  return s;
}

TEST(ControlResponse, IsTheConjugateCrossSpectrumWithTheVarianceOfItsCoherence) {
  const MeasuredResponse r = control_response(spectra(), "a.xml");
  ASSERT_EQ(r.lines.size(), 1u) << "neither the mean nor lines without excitation";
  EXPECT_EQ(r.lines[0].value, Complex(0.0, -2.0));
  // coherence 64 / 80 = 0.8: 4 (1 - 0.8) / (0.8 4)
  EXPECT_DOUBLE_EQ(r.lines[0].variance, 0.25);
}

TEST(ControlResponse, RefusesOneMeasurementAlone) {
  ControlSpectra one = spectra();
  one.averages = 1;
  EXPECT_EQ(fault_messages([&] { control_response(one, "a.xml"); }),
            "contains spectra of a single measurement: without averaging their noise is unknown\n");
}

const std::string kMeasured =
    std::string(SERVOMILL_SOURCE_DIR) + "/../shared/data/measured/sinumerik_freq_trace.xml";

TEST(ControlResponse, OfARealControlIsFitted) {
  if (!std::filesystem::exists(kMeasured)) GTEST_SKIP() << "no measurement of a Sinumerik";
  const auto recording = recordings::read_recording(kMeasured, "");
  const ControlSpectra s = control_spectra(recording, "62", "61");
  EXPECT_EQ(s.averages, 2u);
  EXPECT_NEAR(s.frequency[1], 3.9082, 1e-4) << "not the control's own 3.914 Hz";
  MeasuredResponse response = control_response(s, "trace.xml");
  std::erase_if(response.lines, [](const ResponseLine& line) { return line.frequency > 300.0; });
  const RationalFit fit = fit_rational(response, {3, 4, true}, "trace.xml");
  EXPECT_LT(fit.median_misfit, 0.2);
  for (const Root& pole : fit.poles) EXPECT_GT(pole.frequency_deviation, 0.0);
}

TEST(ControlResponse, NamesTheSignalsThatThereAre) {
  recordings::Recording empty;
  empty.file = "a.xml";
  empty.channels = {{"signal 61 series 1", "", {}, 0}};
  EXPECT_EQ(fault_messages([&] { control_spectra(empty, "1", "2"); }),
            "contains no response of signal 2 to signal 1 computed by the control; it has signal "
            "61 series 1\n");
}

}  // namespace
}  // namespace servomill::sim::responses::control_response_test
