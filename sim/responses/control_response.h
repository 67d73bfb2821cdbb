/// Frequency responses that a control has computed itself, from its averaged spectra.
#pragma once

#include <span>
#include <string>

#include "sim/recordings/recording.h"
#include "sim/responses/period_response.h"

namespace servomill::sim::responses {

/// Averaged spectra of two signals at the same lines, as a control stores them.
struct ControlSpectra {
  std::vector<double> frequency;      // Hz
  std::vector<Complex> cross;         // mean of input conj(output)
  std::vector<double> input, output;  // auto spectra
  std::size_t averages = 1;
};

/// Spectra of a Sinumerik frequency measurement, by the numbers of its signals ("61"), on the
/// frequencies of the transform: the frequency axis of that control is off (sim/recordings).
/// @throws InputError with the signals that there are
ControlSpectra control_spectra(const recordings::Recording& recording, const std::string& input,
                               const std::string& output);

/// Response of output to input: conj(cross) / input auto spectrum. The variance follows from the
/// coherence g^2 = |cross|^2 / (input output) of n averages:
///
///   var G = |G|^2 (1 - g^2) / (g^2 (n - 1))
///
/// Lines where the input has less than `excited` of its strongest are left out.
/// Source: Bendat and Piersol, Random Data (2010), chapter 9.
/// @throws InputError if fewer than two were averaged (nothing tells the noise), or nothing is
///         excited
MeasuredResponse control_response(const ControlSpectra& spectra, const std::string& name,
                                  double excited = 1e-4);

}  // namespace servomill::sim::responses
