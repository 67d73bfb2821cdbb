/// Limits of a predictive virtual encoder: the loop that it closes through the identified errors,
/// and the noise of the scales that it feeds back.
///
/// A position error e_j of axis j is seen by the observer, moves the previews of all displacements
/// by the slopes of the errors, and comes back through the position loops:
///
///     x_i = -M_i S_ij e_j,   M_i(w) = |P_i (sum_k h_ik K_k / (1 + alpha_i (1 - z^-1)) + C_i B_i)|
///     K_k = G_p + t_k G_v + t_k^2/2 G_a   (observer_response)
///     B_i = (sigma0 T / (1 - z^-1) + sigma1) G_v,   friction on its bristles where it is
///     compensated
///
/// with S_ij the largest |d d0_i / d Q_j|. Where the spectral radius of the matrix max_w M_i S_ij
/// is less than 1 the loop is stable, whatever its phases are (small gain); only displaced axes
/// close it. Compensated friction is left out: its force is bounded.
/// Source: C. A. Desoer, M. Vidyasagar, Feedback Systems: Input-Output Properties, 1975, chapter 3.
///
/// White noise of the scales with the standard deviations sigma_j leaves the virtual displacement
/// of axis i with sqrt(sum_j (S_ij sigma_j)^2 sum_n g_i(n)^2), g_i the impulse response from a
/// reading to the displacement at slope 1, friction on its bristles included.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "strategies/predictive_encoder.h"

namespace servomill::strategies {

/// Largest |d d0_i / d Q_j| found at kSlopePlaces positions over the travel of each axis j, with
/// the other axes at both ends and in the middle of theirs.
inline constexpr int kSlopePlaces = 400;
Eigen::Matrix<double, kJoints, kJoints> largest_slopes(const IdentifiedMachine& identified,
                                                       const VirtualEncoderParams& params);

/// max over w of M_i, for all frequencies of the identified response.
double loop_gain(const LoopResponse& loop, const Prediction& prediction, int joint,
                 double model_period);

/// Spectral radius of a matrix of numbers >= 0.
double spectral_radius(const Eigen::Matrix<double, kJoints, kJoints>& gains);

/// Factor from white noise of a reading to the virtual displacement of joint i, at slope 1.
double noise_factor(const Prediction& prediction, int joint, double model_period);

/// A sentence on the loop and one on the noise.
/// @throws InputError without a place where the loop may be unstable
std::vector<std::string> check_prediction(const IdentifiedMachine& identified,
                                          const VirtualEncoderParams& params,
                                          const Prediction& prediction);

}  // namespace servomill::strategies
