/// Position encoders as the NC reads them, linear (m) and rotary (rad).
#pragma once

#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <string>
#include <vector>

#include "plant/sensing/noise.h"
#include "plant/sensing/quantise.h"
#include "plant/vocabulary/ticks.h"

namespace servomill::plant {

/// amplitude sin(k theta + phase), k its order, theta the phase of the encoder's signal.
struct PeriodHarmonic {
  double amplitude = 0.0;  // m or rad
  double phase = 0.0;      // rad
};

/// Constant description of an incremental encoder. Zeros describe an ideal one.
///
/// The scanning head gives two signals over the phase theta = 2 pi x / period, with amplitudes of
/// mean 1:
///
///     s = (1 + imbalance/2) sin(theta - quadrature_error/2) + sine_offset
///     c = (1 - imbalance/2) cos(theta + quadrature_error/2) + cosine_offset
///
/// The electronics counts periods and interpolates within one by atan2(s, c). What the signals lack
/// becomes an error that repeats with each period; to first order, with P = period:
///
///     cause                order   amplitude             1 % (or 10 mrad) at P = 20 um
///     sine_offset o          1     o P / (2 pi)          32 nm, as a cosine
///     cosine_offset o        1     o P / (2 pi)          32 nm, as a negative sine
///     imbalance a            2     a P / (4 pi)          16 nm, as a sine
///     quadrature_error e     2     e P / (4 pi)          16 nm, as a negative cosine
///
/// The +-1 % of a period that makers state (0.2 um at 20 um) are of the position, not of a signal:
/// an offset of 6.3 %, or `harmonic` directly. The constant part of the error is left out, as it
/// belongs to the datum that homing finds. Errors longer than a period (graduation, eccentricity of
/// a rotary encoder) belong to the geometry of the axis: EXX, ECC.
struct EncoderParams {
  double period = 0.0;         // m or rad, of the signal; 0: unknown, no errors within it
  double step = 0.0;           // m or rad, measuring step: period / subdivision; 0: no quantising
  double sine_offset = 0.0;    // 1
  double cosine_offset = 0.0;  // 1
  double imbalance = 0.0;      // 1, difference of the amplitudes over their mean
  double quadrature_error = 0.0;           // rad, by which the cosine leads the sine more than pi/2
  std::array<PeriodHarmonic, 2> harmonic;  // orders 1 and 2, added to what the signals cause
  double signal_noise = 0.0;               // 1, rms of each signal, white from reading to reading
  double position_noise = 0.0;             // m or rad, rms, the same
  double frequency_limit = std::numeric_limits<double>::infinity();  // Hz, input of the NC
};

/// Signal period and measuring step (rad) of a rotary encoder, otherwise ideal.
/// @param subdivision  measuring steps per period; 0: no quantising
EncoderParams from_periods_per_revolution(double periods, double subdivision = 0.0);

/// Rules of physics that the values break, each as "KEY RULE" in SI ("step must be <= period").
/// Empty for a possible encoder.
std::vector<std::string> implausible(const EncoderParams& params);

/// An encoder prepared for the hot loop. Ideal and merely quantising ones cost a branch and a
/// rounding. Laws:
/// 1. read(x) = q round((x + period_error(x)) / q); q = step, without the rounding if q = 0.
/// 2. period_error(x + period) = period_error(x), and its mean over a period is 0.
/// 3. |reading before rounding - x| < period / 2 without noise: the counter never loses a period.
///    (A real one does when the signals come too fast: see too_fast.)
/// 4. read(x, n) with noise is a function of x, n and the key: it does not matter who reads when.
class Encoder {
 public:
  /// Ideal.
  Encoder() = default;
  /// @pre implausible(params) is empty
  explicit Encoder(const EncoderParams& params, const NoiseKey& key = {});
  /// Quantises to whole measuring steps and nothing else (20 um / 1024 = 19.5 nm); 0: ideal.
  /// @param measuring_step  m or rad, >= 0
  static Encoder with_step(double measuring_step);

  /// Reading without noise (m or rad).
  double read(double position) const {
    return quantised(disturbed_ ? position + period_error(position) : position);
  }

  /// Reading with the noise of base tick `now` (m or rad).
  double read(double position, Tick now) const {
    return noisy_ ? quantised(with_noise(position, now)) : read(position);
  }

  /// Error within one signal period (m or rad), without noise and quantising.
  double period_error(double position) const;

  /// Frequency of the signals (Hz) at a velocity in m/s or rad/s; 0 if the period is unknown.
  double signal_frequency(double velocity) const { return std::abs(velocity) * periods_per_unit_; }
  /// The NC's input cannot follow the signals.
  bool too_fast(double velocity) const { return signal_frequency(velocity) > frequency_limit_; }

  /// Velocity (m/s or rad/s) up to which it can; infinite without a limit.
  double fastest() const {
    return periods_per_unit_ > 0.0 ? frequency_limit_ / periods_per_unit_
                                   : std::numeric_limits<double>::infinity();
  }

  /// The same encoder with the noise of another run; run 0: its own.
  Encoder in_run(std::uint64_t run) const;
  std::uint64_t seed() const { return key_.seed; }
  /// Description and noise from which an equal encoder can be made.
  const EncoderParams& params() const { return params_; }
  const NoiseKey& noise() const { return key_; }

  double step() const { return step_; }
  double frequency_limit() const { return frequency_limit_; }
  bool is_noisy() const { return noisy_; }
  /// True if it only quantises.
  bool is_plain() const { return !disturbed_ && !noisy_; }

 private:
  double quantised(double position) const { return plant::quantised(step_, per_step_, position); }
  double with_noise(double position, Tick now) const;
  double interpolation_error(double position, std::complex<double> noise) const;

  double step_ = 0.0, per_step_ = 0.0;
  bool disturbed_ = false, noisy_ = false;
  double periods_per_unit_ = 0.0, period_per_radian_ = 0.0;
  std::complex<double> ellipse_, centre_;  // (c + i s) / (its part that turns with theta)
  std::complex<double> harmonic_[2];       // amplitude exp(i phase)
  double signal_noise_ = 0.0, position_noise_ = 0.0;
  double frequency_limit_ = std::numeric_limits<double>::infinity();
  NoiseKey key_;
  EncoderParams params_;
};

}  // namespace servomill::plant
