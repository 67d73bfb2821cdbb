/// Frequency response from one record of any excitation (chirp, pseudo-random binary, one
/// multisine) by the local polynomial method, with the uncertainty of every line.
#pragma once

#include <span>
#include <string>

#include "sim/responses/period_response.h"

namespace servomill::sim::responses {

struct LocalPolynomialSettings {
  double rate = 1.0;           // Hz, of the samples
  int order = 2;               // of the polynomials
  std::size_t half_width = 6;  // lines on either side
  double excited = 0.02;  // share of the strongest neighbourhood below which lines are left out
  double from = 0.0;      // Hz; lines below and above are left out
  double to = 1e300;
};

/// Around each line k the response and the transient of the record are polynomials:
///
///   Y(k + r) = (G + g1 r + g2 r^2) U(k + r) + t0 + t1 r + t2 r^2 + V,   |r| <= half_width
///
/// solved by least squares; what is left gives the variance of V, and with it that of G. The input
/// is taken as exact. Estimates of neighbouring lines share their samples:
/// MeasuredResponse::lines_per_estimate of them carry as much as one.
/// Source: Pintelon and Schoukens, System Identification (2012), section 7.2.
/// @pre both have the same number of samples
/// @throws InputError if the record is too short, or nothing is excited
MeasuredResponse local_polynomial(std::span<const double> input, std::span<const double> output,
                                  const LocalPolynomialSettings& settings, const std::string& name);

}  // namespace servomill::sim::responses
