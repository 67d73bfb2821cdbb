#include "sim/recordings/sinumerik_frequency.h"

#include <gtest/gtest.h>

#include <complex>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "sim/recordings/fourier.h"
#include "sim/recordings/read_recording.h"
#include "tests/text.h"

namespace servomill::sim::recordings::sinumerik_frequency_test {
namespace {

using Complex = std::complex<double>;

const std::string kFile =
    std::string(SERVOMILL_SOURCE_DIR) + "/../shared/data/measured/sinumerik_freq_trace.xml";
// of the greatest response; the control rounds small ones to as many digits as its largest line
constexpr double kEqual = 1e-12;

class SinumerikFile : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kFile)) GTEST_SKIP() << kFile << " is not there";
    recording_ = read_recording(kFile);
  }
  const std::vector<double>& samples(const std::string& name) const {
    for (const Channel& one : recording_.channels) {
      if (one.name == name) return one.samples;
    }
    throw std::runtime_error(name);
  }
  Recording recording_;
};

TEST_F(SinumerikFile, SeriesAndSpectraAreDecoded) {
  EXPECT_EQ(recording_.channels.size(), 8u);
  for (const char* name :
       {"signal 61 series 1", "signal 61 series 2", "signal 62 series 1", "signal 62 series 2"}) {
    EXPECT_EQ(samples(name).size(), 2047u);
  }
  for (const char* name : {"signal 61 auto spectrum", "signal 62 auto spectrum",
                           "signal 61 62 cross spectrum re", "signal 61 62 cross spectrum im"}) {
    EXPECT_EQ(samples(name).size(), 1023u);
  }
  ASSERT_EQ(recording_.bases.size(), 2u);
  EXPECT_EQ(recording_.bases[1].unit, "Hz");
  EXPECT_DOUBLE_EQ(recording_.bases[0].values.back(), 0.25575);
}

TEST_F(SinumerikFile, ResponsesEqualTheTransformOfTheSeriesAtEqualLine) {
  const auto X1 = fourier_lines(samples("signal 61 series 1"), 1023);
  const auto X2 = fourier_lines(samples("signal 61 series 2"), 1023);
  const auto Y1 = fourier_lines(samples("signal 62 series 1"), 1023);
  const auto Y2 = fourier_lines(samples("signal 62 series 2"), 1023);
  const auto& S_yy = samples("signal 62 auto spectrum");
  const auto& re = samples("signal 61 62 cross spectrum re");
  const auto& im = samples("signal 61 62 cross spectrum im");
  const double scale = 4.0 / (2.0 * 2047.0 * 2047.0);
  double difference = 0.0, greatest = 0.0;
  for (std::size_t k = 0; k < 1023; ++k) {
    const double input = scale * (std::norm(Y1[k]) + std::norm(Y2[k]));
    const Complex cross = scale * (std::conj(X1[k]) * Y1[k] + std::conj(X2[k]) * Y2[k]);
    const Complex of_control = std::conj(Complex(re[k], im[k])) / S_yy[k];
    greatest = std::max(greatest, std::abs(of_control));
    difference = std::max(difference, std::abs(std::conj(cross) / input - of_control));
    // the scaling, too: spectra as they are, of which the input's are nowhere small
    EXPECT_NEAR(input / S_yy[k], 1.0, kEqual) << k;
  }
  EXPECT_NEAR(greatest, 1.0735, 1e-4);
  EXPECT_LE(difference, kEqual * greatest);
}

TEST_F(SinumerikFile, ErrorOfTheFrequencyAxisIsReported) {
  ASSERT_GE(recording_.notes.size(), 2u);
  EXPECT_EQ(
      recording_.notes[0],
      "the frequency axis of the control has 3.9139 Hz per line; the transform of 2047 samples "
      "at 125 us has 3.9082 Hz: +0.147 %");
  EXPECT_EQ(
      recording_.notes[1].find("response of signal 61 to 62: the transform of the series differs"),
      0u);
}

TEST_F(SinumerikFile, FilesThatAreCutOrDamagedAreRefused) {
  std::ifstream in(kFile, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  for (const double share : {0.1, 0.5, 0.99}) {
    const auto size = static_cast<std::size_t>(share * static_cast<double>(text.size()));
    EXPECT_TRUE(fault_messages([&] {
                  parse_sinumerik_frequency(text.substr(0, size), "a.xml");
                }).starts_with("is not complete XML: "))
        << share;
  }
  std::string shorter = text;
  shorter.replace(shorter.find(">2047<"), 6, ">2046<");
  EXPECT_EQ(fault_messages([&] { parse_sinumerik_frequency(shorter, "a.xml"); }),
            "<NumericArray>: array 'm_ValueVector' has 2047 numbers for a length of 2046\n");
}

TEST(SinumerikFrequency, WithoutSeriesHoldsNoChannel) {
  const std::string text = "<?xml version=\"1.0\"?>\n<ResponseTestCustom>\n</ResponseTestCustom>\n";
  EXPECT_TRUE(is_sinumerik_frequency(text));
  EXPECT_FALSE(is_sinumerik_frequency("<traceData/>"));
  EXPECT_EQ(fault_messages([&] { parse_sinumerik_frequency(text, "a.xml"); }),
            "contains no channel\n");
}

}  // namespace
}  // namespace servomill::sim::recordings::sinumerik_frequency_test
