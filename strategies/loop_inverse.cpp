#include "strategies/loop_inverse.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cassert>
#include <cmath>
#include <numbers>

namespace servomill::strategies {
namespace {

using Complex = std::complex<double>;

constexpr double kTwoPi = 2.0 * std::numbers::pi;

// 1 - z^-1
Complex difference(double w, double period) { return 1.0 - std::polar(1.0, -w * period); }

// Real unknowns of complex equations by least squares, through normal equations whose columns are
// scaled to length 1.
template <int n>
class RealFit {
 public:
  using Row = std::array<Complex, n>;

  void add(const Row& row, Complex value, double weight) {
    for (int i = 0; i < n; ++i) {
      const Complex left = std::conj(row[static_cast<std::size_t>(i)]) * weight * weight;
      for (int k = 0; k < n; ++k) A_(i, k) += (left * row[static_cast<std::size_t>(k)]).real();
      b_[i] += (left * value).real();
    }
  }
  // @param unknowns  the first of them; the others are 0
  Eigen::Matrix<double, n, 1> solve(int unknowns) const {
    Eigen::Matrix<double, n, n> A = Eigen::Matrix<double, n, n>::Identity();
    Eigen::Matrix<double, n, 1> b = Eigen::Matrix<double, n, 1>::Zero(), scale = b;
    for (int i = 0; i < unknowns; ++i) scale[i] = 1.0 / std::sqrt(A_(i, i));
    for (int i = 0; i < unknowns; ++i) {
      b[i] = b_[i] * scale[i];
      for (int k = 0; k < unknowns; ++k) A(i, k) = A_(i, k) * scale[i] * scale[k];
    }
    return A.ldlt().solve(b).cwiseProduct(scale);
  }

 private:
  Eigen::Matrix<double, n, n> A_ = Eigen::Matrix<double, n, n>::Zero();
  Eigen::Matrix<double, n, 1> b_ = Eigen::Matrix<double, n, 1>::Zero();
};

// Visits the frequencies (rad/s) of the fit, with the index of each.
template <class Visit>
void in_band(const LoopResponse& loop, Visit visit) {
  const double last = kBand / (kTwoPi * lag_of(loop));
  for (std::size_t k = 0; k < loop.f.size() && loop.f[k] <= last; ++k) visit(k, kTwoPi * loop.f[k]);
}

// Response of y += share (u - y).
Complex low_pass(double share, double w, double period) {
  return share / (1.0 - (1.0 - share) * std::polar(1.0, -w * period));
}

}  // namespace

double lag_of(const LoopResponse& loop) {
  assert(!loop.f.empty());
  return (-1.0 / loop.displacement.front()).imag() / (kTwoPi * loop.f.front());
}

LoopInverse inverse_of(const LoopResponse& loop, const PreviewTimes& times, double period) {
  const double lag = lag_of(loop);
  // unknown h_1 and h_2; alpha follows from the lag
  RealFit<2> fit;
  in_band(loop, [&](std::size_t k, double w) {
    const Complex P = -loop.displacement[k], per_time = difference(w, period) / period;
    fit.add({P * (std::polar(1.0, w * times[1]) - 1.0) - times[1] * per_time,
             P * (std::polar(1.0, w * times[2]) - 1.0) - times[2] * per_time},
            1.0 - P - lag * per_time, 1.0 / (w * w));
  });
  const auto h = fit.solve(2);
  const double alpha = (h[0] * times[1] + h[1] * times[2] - lag) / period;
  if (alpha >= 0.0) return {{1.0 - h[0] - h[1], h[0], h[1]}, 1.0 / (1.0 + alpha)};
  // without a pole: unknown h_2, and h_1 follows
  RealFit<1> plain;
  in_band(loop, [&](std::size_t k, double w) {
    const Complex P = -loop.displacement[k], first = std::polar(1.0, w * times[1]) - 1.0;
    plain.add({P * (std::polar(1.0, w * times[2]) - 1.0 - times[2] / times[1] * first)},
              1.0 - P - lag / times[1] * P * first, 1.0 / (w * w));
  });
  const double h_2 = plain.solve(1)[0], h_1 = (lag - h_2 * times[2]) / times[1];
  return {{1.0 - h_1 - h_2, h_1, h_2}, 1.0};
}

ForceInverse force_inverse_of(const LoopResponse& loop, double period) {
  ForceInverse out;
  out.smooth = -std::expm1(-period / kSmooth);
  RealFit<4> fit;
  in_band(loop, [&](std::size_t k, double w) {
    const Complex s = difference(w, period);
    const Complex C = -loop.force[k] / (loop.displacement[k] * low_pass(out.smooth, w, period));
    fit.add({1.0, s, s * s, -s * C}, C, 1.0 / std::abs(C));
  });
  const auto x = fit.solve(4);
  if (x[3] > 0.0) {
    out.k1 = x[2] / x[3];
    out.k0 = (x[1] - out.k1) / x[3];
    out.k2 = x[0] - out.k0;
    out.share = 1.0 / (1.0 + x[3]);
  } else {
    const auto plain = fit.solve(2);
    out.k0 = plain[0];
    out.k1 = plain[1];
  }
  return out;
}

std::complex<double> response(const LoopInverse& H, const PreviewTimes& times, double period,
                              double w) {
  Complex sum = 0.0;
  for (std::size_t k = 0; k < kPreviews; ++k) sum += H.weight[k] * std::polar(1.0, w * times[k]);
  return sum * low_pass(H.share, w, period);
}

std::complex<double> response(const ForceInverse& C, double period, double w) {
  return low_pass(C.smooth, w, period) *
         (C.k0 + C.k1 * difference(w, period) + C.k2 * low_pass(C.share, w, period));
}

}  // namespace servomill::strategies
