#include "plant/sensing/encoder.h"

#include <gtest/gtest.h>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <cmath>
#include <numbers>

#include "plant/vocabulary/units.h"
#include "tests/counting_new.h"

namespace servomill::plant::encoder_test {
namespace {

using std::numbers::pi;

constexpr double kPeriod = 20 * um;      // LS 486C
constexpr double kRounding = 1e-18;      // m, of errors below 1 um near coordinate 0
constexpr double kReadRounding = 2e-16;  // m, of coordinates below 1 m

EncoderParams scale() {
  EncoderParams params;
  params.period = kPeriod;
  return params;
}

EncoderParams with(double EncoderParams::*cause, double value) {
  EncoderParams params = scale();
  params.*cause = value;
  return params;
}

// Fourier coefficient of the error over a period: error = sum of a_k exp(i k theta), so that an
// amplitude A sin(k theta + phase) shows as 2 a_k = -i A exp(i phase).
std::complex<double> order(const Encoder& encoder, int k) {
  constexpr int kPoints = 256;
  std::complex<double> sum;
  for (int n = 0; n < kPoints; ++n) {
    const double theta = 2.0 * pi * n / kPoints;
    sum += encoder.period_error(kPeriod * n / kPoints) * std::polar(1.0, -k * theta);
  }
  return (k == 0 ? 1.0 : 2.0) * sum / static_cast<double>(kPoints);
}

void expect_order(const Encoder& encoder, int k, std::complex<double> expected) {
  EXPECT_NEAR(order(encoder, k).real(), expected.real(), kRounding) << "order " << k;
  EXPECT_NEAR(order(encoder, k).imag(), expected.imag(), kRounding) << "order " << k;
}

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double operator()(double from, double to) {
    return boost::random::uniform_real_distribution<double>(from, to)(engine_);
  }

 private:
  boost::random::mt19937_64 engine_;
};

// With signals that do not vanish, but nearly.
EncoderParams random_errors(Random& random) {
  EncoderParams params = scale();
  params.sine_offset = random(-0.4, 0.4);
  params.cosine_offset = random(-0.4, 0.4);
  params.imbalance = random(-0.4, 0.4);
  params.quadrature_error = random(-0.3, 0.3);
  return params;
}

TEST(IdealEncoder, ReadsThePositionBitForBit) {
  for (const double x : {0.0, -0.0, 1.0 / 3.0, -0.123456789, 1e-300}) {
    EXPECT_EQ(Encoder().read(x), x);
    EXPECT_EQ(Encoder::with_step(0.0).read(x, 7), x);
    EXPECT_EQ(Encoder(scale()).read(x, 7), x);
  }
}

TEST(QuantisingEncoder, RoundsToWholeStepsBitForBit) {
  const double q = kPeriod / 1024;
  const double inverse = 1.0 / q;
  EncoderParams params = scale();
  params.step = q;
  Random random(1);
  for (int n = 0; n < 1000; ++n) {
    const double x = random(-0.5, 0.5);
    EXPECT_EQ(Encoder::with_step(q).read(x), q * std::nearbyint(x * inverse));
    EXPECT_EQ(Encoder(params).read(x, n), q * std::nearbyint(x * inverse));
  }
}

// arg(1 + z exp(-i theta)) = sum of (-1)^(n+1) |z|^n / n sin(n (arg z - theta)): exact at any size.
TEST(SineOffset, GivesItsFirstHarmonicAsACosine) {
  const double o = 0.05;
  const Encoder encoder(with(&EncoderParams::sine_offset, o));
  expect_order(encoder, 1, o * kPeriod / (2 * pi));
  expect_order(encoder, 2, {0.0, o * o / 2 * kPeriod / (2 * pi)});
}

TEST(CosineOffset, GivesItsFirstHarmonicAsANegativeSine) {
  const double o = 0.05;
  const Encoder encoder(with(&EncoderParams::cosine_offset, o));
  expect_order(encoder, 1, {0.0, o * kPeriod / (2 * pi)});
  expect_order(encoder, 2, {0.0, -o * o / 2 * kPeriod / (2 * pi)});
}

TEST(Imbalance, GivesItsSecondHarmonicAsASine) {
  const double a = 0.08;
  const Encoder encoder(with(&EncoderParams::imbalance, a));
  expect_order(encoder, 1, 0.0);
  expect_order(encoder, 2, {0.0, -a * kPeriod / (4 * pi)});
  expect_order(encoder, 4, {0.0, -a * a / 8 * kPeriod / (2 * pi)});
}

TEST(QuadratureError, GivesItsSecondHarmonicAsANegativeCosine) {
  const double e = 0.06;
  const Encoder encoder(with(&EncoderParams::quadrature_error, e));
  expect_order(encoder, 1, 0.0);
  expect_order(encoder, 2, -std::tan(e / 2) * kPeriod / (2 * pi));
  EXPECT_NEAR(std::tan(e / 2) / (2 * pi), e / (4 * pi), 1e-4 * e);  // what the table says
}

TEST(Harmonic, IsAddedAsItIsGiven) {
  EncoderParams params = scale();
  params.harmonic = {{{0.2 * um, 0.3}, {30 * nm, -1.0}}};
  const Encoder encoder(params);
  for (const double x : {0.0, 3 * um, -7.3 * um}) {
    const double theta = 2 * pi * x / kPeriod;
    EXPECT_NEAR(encoder.period_error(x),
                0.2 * um * std::sin(theta + 0.3) + 30 * nm * std::sin(2 * theta - 1.0), 1e-21);
  }
}

// +-1 % of the signal period, the typical statement of makers: 0.2 um. As an offset of a signal it
// takes 2 pi % of the amplitude; 1 % of offset gives 32 nm only.
TEST(OnePerCent, OfThePeriodIsNotOnePerCentOfOffset) {
  const auto largest = [](double offset) {
    const Encoder encoder(with(&EncoderParams::cosine_offset, offset));
    double error = 0.0;
    for (int n = 0; n < 1000; ++n) {
      error = std::max(error, std::abs(encoder.period_error(n * kPeriod / 1000)));
    }
    return error;
  };
  EXPECT_NEAR(largest(0.02 * pi), 0.2 * um, 0.001 * 0.2 * um);  // asin(o) - o = 0.07 % of it
  EXPECT_NEAR(largest(0.01), 31.8 * nm, 0.1 * nm);
}

TEST(PeriodError, HasNoMean) {
  Random random(2);
  for (int n = 0; n < 100; ++n) {
    EncoderParams params = random_errors(random);
    params.sine_offset *= 0.5;  // or 256 points are too few for the high orders
    params.cosine_offset *= 0.5;
    params.harmonic = {{{0.5 * um, 0.4}, {-0.3 * um, 1.0}}};
    ASSERT_TRUE(implausible(params).empty());
    expect_order(Encoder(params), 0, 0.0);
  }
}

TEST(PeriodError, RepeatsWithThePeriod) {
  Random random(3);
  const Encoder encoder(random_errors(random));
  for (int n = -20; n < 20; ++n) {
    const double x = random(0.0, kPeriod);
    EXPECT_NEAR(encoder.period_error(x + n * 1000 * kPeriod), encoder.period_error(x), 1e-16);
  }
}

// A real encoder takes atan2 of the two signals, and counts the periods.
TEST(PeriodError, IsThatOfAtan2AndACounter) {
  Random random(4);
  for (int n = 0; n < 1000; ++n) {
    const EncoderParams p = random_errors(random);
    if (!implausible(p).empty()) continue;
    const Encoder encoder(p);
    // datum: the mean of the error, by which the two may differ
    const double half = p.quadrature_error / 2;
    const double datum = std::atan2(-p.imbalance / 2 * std::sin(half), std::cos(half));
    const double x = random(-10 * kPeriod, 10 * kPeriod);
    const double theta = 2 * pi * x / kPeriod;
    const double s = (1 + p.imbalance / 2) * std::sin(theta - half) + p.sine_offset;
    const double c = (1 - p.imbalance / 2) * std::cos(theta + half) + p.cosine_offset;
    const double within = kPeriod / (2 * pi) * (std::atan2(s, c) - datum);
    const double counted = within + kPeriod * std::round((x - within) / kPeriod);
    EXPECT_NEAR(encoder.read(x), counted, 1e-17) << n;  // a few rounded angles of up to 60 rad
  }
}

TEST(PeriodError, NeverMiscountsAPeriod) {
  Random random(5);
  double largest = 0.0;
  for (int n = 0; n < 200; ++n) {
    EncoderParams params = random_errors(random);
    params.harmonic[0].amplitude = 0.24 * kPeriod;
    if (!implausible(params).empty()) continue;
    const Encoder encoder(params);
    for (int k = 0; k < 200; ++k) {
      largest = std::max(largest, std::abs(encoder.period_error(k * kPeriod / 200)));
    }
  }
  EXPECT_LT(largest, kPeriod / 2);
  EXPECT_GT(largest, 0.3 * kPeriod);  // it was put to the test
}

TEST(Encoder, RoundsWhatItInterpolated) {
  EncoderParams params = with(&EncoderParams::sine_offset, 0.06);
  const Encoder fine(params);
  params.step = kPeriod / 1024;
  const Encoder coarse(params);
  for (const double x : {0.0, 0.1234567, -0.3}) {
    EXPECT_EQ(coarse.read(x), params.step * std::nearbyint(fine.read(x) * (1.0 / params.step)));
  }
}

double rms_of_noise(const EncoderParams& params, int count) {
  const Encoder encoder(params, {5, 0});
  double sum = 0.0;
  for (Tick n = 0; n < count; ++n) sum += std::pow(encoder.read(0.1, n) - encoder.read(0.1), 2);
  return std::sqrt(sum / count);
}

TEST(Noise, HasTheRmsThatIsGiven) {
  constexpr int kCount = 100000;
  const double tolerance = 5.0 / std::sqrt(2.0 * kCount);  // five sigmas of an rms
  EXPECT_NEAR(rms_of_noise(with(&EncoderParams::position_noise, 3 * nm), kCount) / (3 * nm), 1.0,
              tolerance);
  // of the signals: that across the pointer turns it
  const double sigma = 0.002;
  EXPECT_NEAR(rms_of_noise(with(&EncoderParams::signal_noise, sigma), kCount) /
                  (sigma * kPeriod / (2 * pi)),
              1.0, tolerance);
}

// A large offset, so that both numbers of the signals' noise turn the pointer.
TEST(Noise, OfSignalsAndPositionIsIndependent) {
  constexpr int kCount = 100000;
  EncoderParams signals = with(&EncoderParams::sine_offset, 0.9), position = signals;
  signals.signal_noise = 0.002;
  position.position_noise = 4 * nm;
  EncoderParams both = signals;
  both.position_noise = position.position_noise;
  const double sum = std::hypot(rms_of_noise(signals, kCount), rms_of_noise(position, kCount));
  // each rms has 1 / sqrt(2 kCount); the noises nearly cancel in part, or add, if they are one
  EXPECT_NEAR(rms_of_noise(both, kCount) / sum, 1.0, 5.0 / std::sqrt(kCount));
}

TEST(Noise, DoesNotDependOnWhoReadsWhen) {
  const Encoder encoder(with(&EncoderParams::position_noise, 3 * nm), {5, 0});
  const Encoder other(with(&EncoderParams::position_noise, 3 * nm), {5, 1});
  const double later = encoder.read(0.1, 1000), sooner = encoder.read(0.1, 10);
  for (Tick n = 0; n < 50; ++n) other.read(0.1, n);
  EXPECT_EQ(encoder.read(0.1, 10), sooner);
  EXPECT_EQ(encoder.read(0.1, 1000), later);
  EXPECT_NE(sooner, later);
  EXPECT_NE(other.read(0.1, 10), sooner);
  EXPECT_NE(Encoder(with(&EncoderParams::position_noise, 3 * nm), {6, 0}).read(0.1, 10), sooner);
}

TEST(Noise, IsLeftOutOfAReadingWithoutTime) {
  const Encoder encoder(with(&EncoderParams::position_noise, 3 * nm));
  EXPECT_EQ(encoder.read(0.1), 0.1);
}

TEST(Noise, OfTheSignalsIsLargerWhereTheSignalsAreSmall) {
  EncoderParams params = with(&EncoderParams::cosine_offset, 0.5);
  params.signal_noise = 0.001;
  const Encoder encoder(params, {7, 0});
  const auto power = [&](double x) {
    double sum = 0.0;
    for (Tick n = 0; n < 20000; ++n) sum += std::pow(encoder.read(x, n) - encoder.read(x), 2);
    return sum;
  };
  // pointer of length 1.5 at theta = 0, 0.5 at theta = pi; 5 sigmas of the ratio are 7 %
  EXPECT_NEAR(std::sqrt(power(kPeriod / 2) / power(0.0)), 3.0, 0.07 * 3.0);
}

// DOMAIN: 23.2 mm/s over 20 um are 1.16 kHz.
TEST(SignalFrequency, IsVelocityOverPeriod) {
  EXPECT_NEAR(Encoder(scale()).signal_frequency(-23.2 * mm), 1160.0, 1e-9);
  EXPECT_EQ(Encoder::with_step(20 * nm).signal_frequency(1.0), 0.0);
}

TEST(TooFast, IsBeyondTheInputFrequency) {
  const Encoder encoder(with(&EncoderParams::frequency_limit, 50e3));
  EXPECT_FALSE(encoder.too_fast(-0.999999));  // m/s
  EXPECT_TRUE(encoder.too_fast(1.000001));
  EXPECT_TRUE(encoder.too_fast(-1.000001));
  EXPECT_FALSE(Encoder(scale()).too_fast(1e9));
}

// Motor encoder ERN 1387: 2048 periods, subdivision 4096.
TEST(RotaryEncoder, IsGivenByItsPeriodsPerRevolution) {
  const EncoderParams params = from_periods_per_revolution(2048, 4096);
  EXPECT_NEAR(params.step, 0.7490 * urad, 0.0001 * urad);
  EXPECT_EQ(params.period, 2 * pi / 2048);
  EXPECT_EQ(from_periods_per_revolution(2048).step, 0.0);
  EXPECT_NEAR(Encoder(params).read(0.5), 0.5, params.step / 2);
  EXPECT_NEAR(Encoder(params).signal_frequency(2 * pi), 2048.0, 1e-9);
}

TEST(Implausible, NamesWhatNoEncoderCanBe) {
  const auto fault = [](double EncoderParams::*key, double value) {
    const auto faults = implausible(with(key, value));
    return faults.size() == 1 ? faults[0] : std::to_string(faults.size()) + " faults";
  };
  EXPECT_EQ(fault(&EncoderParams::period, -1e-6), "period must be >= 0");
  EXPECT_EQ(fault(&EncoderParams::step, -1e-9), "step must be >= 0");
  EXPECT_EQ(fault(&EncoderParams::step, 21 * um), "step must be <= period");
  EXPECT_EQ(fault(&EncoderParams::signal_noise, 0.3), "signal_noise must be in [0, 0.2]");
  EXPECT_EQ(fault(&EncoderParams::position_noise, -1e-9), "position_noise must be >= 0");
  EXPECT_EQ(fault(&EncoderParams::frequency_limit, 0.0), "frequency_limit must be > 0");
  const char* kSignal =
      "offsets, imbalance and quadrature_error must leave a non-zero signal over the whole period";
  EXPECT_EQ(fault(&EncoderParams::sine_offset, 1.0), kSignal);
  EXPECT_EQ(fault(&EncoderParams::sine_offset, 0.999), "0 faults");
  EXPECT_EQ(fault(&EncoderParams::imbalance, 2.0), kSignal);
  EXPECT_EQ(fault(&EncoderParams::imbalance, std::nan("")), kSignal);
  EncoderParams params = scale();
  params.harmonic[1].amplitude = -5 * um;
  EXPECT_EQ(implausible(params)[0], "harmonic must add up to less than period / 4");
  params = with(&EncoderParams::sine_offset, 0.01);
  params.period = 0.0;
  EXPECT_EQ(implausible(params)[0],
            "period must be > 0 for errors, noise and frequency of the signals");
  EXPECT_TRUE(implausible(EncoderParams{}).empty());
}

TEST(Encoder, DoesNotAllocate) {
  EncoderParams params = with(&EncoderParams::sine_offset, 0.06);
  params.signal_noise = 0.001;
  params.position_noise = 1 * nm;
  const Encoder encoder(params);
  const std::size_t before = allocations;
  double sum = 0.0;
  for (Tick n = 0; n < 100; ++n) sum += encoder.read(0.1, n);
  EXPECT_EQ(allocations, before);
  EXPECT_GT(sum, 0.0);
}

// Runs of one program have noise of their own, each the same whenever it is asked for.
TEST(EncoderInARun, HasTheNoiseOfThatRun) {
  const Encoder one(with(&EncoderParams::position_noise, 3 * nm), {.seed = 5, .stream = 2});
  EXPECT_EQ(one.in_run(0).read(0.1, 9), one.read(0.1, 9));
  EXPECT_EQ(one.in_run(3).read(0.1, 9), one.in_run(3).read(0.1, 9));
  EXPECT_NE(one.in_run(3).read(0.1, 9), one.read(0.1, 9));
  EXPECT_NE(one.in_run(3).read(0.1, 9), one.in_run(4).read(0.1, 9));
  EXPECT_EQ(one.in_run(3).read(0.1), one.read(0.1));
}

}  // namespace
}  // namespace servomill::plant::encoder_test
