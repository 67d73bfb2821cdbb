/// Update of an offset of the setpoints from what a run with it has shown.
///
///     u_(k+1) = Q (u_k + L e_k),   L = g P* / (|P|^2 + c^2) (1)
///
/// with the error e_k of run k (wanted minus actual), the offset u, the response P from an offset
/// to what is seen as it is known, a gain g, and a low-pass Q. L is 1/P where the axis follows, and
/// small where it hardly does. Both filters act on the whole recording at once, forwards and
/// backwards in time: a run is over when it is learnt from. With the actual response P_a the error
/// of a repeatable run obeys
///
///     e_(k+1) = Q (1 - L P_a) e_k + (1 - Q) e_0                                                (2)
///
/// at each frequency, so that it converges, monotonically, where |Q (1 - L P_a)| < 1, to
///
///     e = (1 - Q) / (1 - Q (1 - L P_a)) e_0                                                    (3)
///
/// Source: Bristow, Tharayil, Alleyne, A survey of iterative learning control, IEEE Control Systems
/// Magazine 26 (2006) 96-114.
#pragma once

#include <complex>
#include <functional>
#include <vector>

#include "plant/vocabulary/axes.h"

namespace servomill::strategies {

struct LearningFilter {
  double cutoff = 0.0;       // Hz, where Q has fallen to half of its value at rest
  double gain = 1.0;         // g
  double remembering = 1.0;  // Q at rest; less than 1 forgets
};

/// Q at a frequency (Hz), real: a Butterworth low-pass of order 2 forwards and backwards.
double Q_at(const LearningFilter& filter, double f);

/// L of a response P.
std::complex<double> L_of(const LearningFilter& filter, std::complex<double> P);

/// Response of a joint to an offset of its setpoint, as it is known (1; f in Hz).
using OffsetResponse = std::function<std::complex<double>(int joint, double f)>;

/// Offset for the next run by (1). Both ends of the recording are standstills: what lies before and
/// behind is taken to go on from its last row.
/// @param u, e    row after row (5; m, rad), as many of one as of the other
/// @param h       s, between two rows
/// @param joints  that are offset; others stay 0
std::vector<Joints> next_offset(const std::vector<Joints>& u, const std::vector<Joints>& e,
                                double h, const LearningFilter& filter,
                                const std::vector<int>& joints, const OffsetResponse& P);

/// |Q (1 - L P_a)| at a frequency: the share of an error that the next run has.
/// @param P, P_a  response as it is known, actual response
double share_left(const LearningFilter& filter, double f, std::complex<double> P,
                  std::complex<double> P_a);

/// (3) without e_0.
std::complex<double> limit_of_error(const LearningFilter& filter, double f, std::complex<double> P,
                                    std::complex<double> P_a);

}  // namespace servomill::strategies
