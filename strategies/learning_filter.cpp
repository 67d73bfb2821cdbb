#include "strategies/learning_filter.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unsupported/Eigen/FFT>

#include "plant/vocabulary/interrupt.h"

namespace servomill::strategies {
namespace {

using Complex = std::complex<double>;

constexpr double kTail = 4.0;        // periods of the cutoff: what Q sees of a step
constexpr double kHardlyAny = 0.05;  // c: of responses that are not inverted

// A recording that repeats without a step: behind its end it turns smoothly into its beginning.
class Periodic {
 public:
  Periodic(std::size_t rows, double h, double cutoff) : rows_(rows) {
    const auto tail = static_cast<std::size_t>(std::ceil(2.0 * kTail / (cutoff * h)));
    while (length_ < rows + tail) length_ *= 2;
  }

  std::size_t length() const { return length_; }

  template <class Value>
  std::vector<double> extended(const Value& value) const {
    std::vector<double> out(length_);
    for (std::size_t n = 0; n < rows_; ++n) out[n] = value(n);
    const double first = out.front(), last = out[rows_ - 1];
    const double gap = static_cast<double>(length_ - rows_ + 1);
    for (std::size_t n = rows_; n < length_; ++n) {
      const double x = static_cast<double>(n - rows_ + 1) / gap;
      out[n] = last + (first - last) * 0.5 * (1.0 - std::cos(std::numbers::pi * x));
    }
    return out;
  }

 private:
  std::size_t rows_, length_ = 2;
};

}  // namespace

double Q_at(const LearningFilter& filter, double f) {
  const double squared = (f / filter.cutoff) * (f / filter.cutoff);
  return filter.remembering / (1.0 + squared * squared);
}

Complex L_of(const LearningFilter& filter, Complex P) {
  return filter.gain * std::conj(P) / (std::norm(P) + kHardlyAny * kHardlyAny);
}

std::vector<Joints> next_offset(const std::vector<Joints>& u, const std::vector<Joints>& e,
                                double h, const LearningFilter& filter,
                                const std::vector<int>& joints, const OffsetResponse& P) {
  std::vector<Joints> out(u.size(), Joints::Zero());
  if (u.empty()) return out;
  const Periodic periodic(u.size(), h, filter.cutoff);
  const double step = 1.0 / (static_cast<double>(periodic.length()) * h);  // Hz
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  for (const int j : joints) {
    throw_if_interrupted();
    std::vector<Complex> of_u, of_e;
    fft.fwd(of_u, periodic.extended([&](std::size_t n) { return u[n][j]; }));
    fft.fwd(of_e, periodic.extended([&](std::size_t n) { return e[n][j]; }));
    for (std::size_t n = 0; n < of_u.size(); ++n) {
      const double f = static_cast<double>(n) * step;
      of_u[n] = Q_at(filter, f) * (of_u[n] + L_of(filter, P(j, f)) * of_e[n]);
    }
    std::vector<double> next;
    fft.inv(next, of_u, static_cast<Eigen::Index>(periodic.length()));
    for (std::size_t n = 0; n < out.size(); ++n) out[n][j] = next[n];
  }
  return out;
}

double share_left(const LearningFilter& filter, double f, Complex P, Complex P_a) {
  return std::abs(Q_at(filter, f) * (1.0 - L_of(filter, P) * P_a));
}

Complex limit_of_error(const LearningFilter& filter, double f, Complex P, Complex P_a) {
  const double Q = Q_at(filter, f);
  return (1.0 - Q) / (1.0 - Q * (1.0 - L_of(filter, P) * P_a));
}

}  // namespace servomill::strategies
