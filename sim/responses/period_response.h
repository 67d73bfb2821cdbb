/// Frequency responses of real axes from periodic excitation, with the uncertainty of every line.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace servomill::sim::responses {

using Complex = std::complex<double>;

/// One line of a measured frequency response.
struct ResponseLine {
  double frequency = 0.0;           // Hz
  Complex value = {};               // output over input
  double variance = 0.0;            // of the complex, circular noise: E |value - expectation|^2
  Complex input = {}, output = {};  // means over the periods, of the discrete Fourier transform
  /// Radius of the circle in the complex plane that holds the response with 95 %.
  double radius_95 = 0.0;
};

struct MeasuredResponse {
  std::vector<ResponseLine> lines;
  std::size_t periods = 0;          // that were averaged
  double lines_per_estimate = 1.0;  // neighbours that share samples: so many carry as much as one
  std::size_t unexcited = 0;        // lines within the range of the others that hold no excitation
};

/// Periods of a record.
struct PeriodSettings {
  std::size_t samples = 0;  // of one period
  std::size_t skip = 1;     // periods at the beginning, in which the transient has not ended
  double rate = 1.0;        // Hz, of the samples
  /// Lines count as excited where the input is that share of its greatest line, and ten standard
  /// deviations of its mean.
  double excited = 0.05;
};

/// Maximum-likelihood response of periodic excitation: the mean of the output's transforms over
/// that of the input's. Its variance follows from how both scatter from period to period, together:
///   var G = |G|^2 (varY/|Y|^2 + varU/|U|^2 - 2 Re(covYU / (Y conj U)))
/// of the means. Source: Pintelon and Schoukens, System Identification (2012), equations (2-31) ff.
/// @pre both have the same number of samples
/// @throws InputError if fewer than two periods remain, or nothing is excited
MeasuredResponse maximum_likelihood(std::span<const double> input, std::span<const double> output,
                                    const PeriodSettings& settings, const std::string& name);

/// Quantile for 95 % of Fisher's distribution with 2 and 2 n degrees of freedom: of |error|^2 over
/// an estimated variance with n complex degrees of freedom.
double fisher_95(double n);

/// Frequencies at which the amplitude is least and greatest between neighbours, refined by a
/// parabola through the logarithms of three lines; the most marked first (Hz).
struct Extreme {
  double frequency = 0.0;
  double prominence = 0.0;  // ratio to the least (of a maximum) on the way to a higher one
  bool is_maximum = false;
};
std::vector<Extreme> extremes(const MeasuredResponse& response);

}  // namespace servomill::sim::responses
