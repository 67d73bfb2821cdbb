/// What a run will take, known before it begins.
#pragma once

#include <span>
#include <string>

#include "sim/preparation/prepared_case.h"

namespace servomill::sim {

/// Of all cases together.
struct RunEstimate {
  double motion = 0.0;     // s, simulated
  double rows = 0.0;       // recorded
  double size = 0.0;       // bytes of the recorded signals, as they are held until the end
  double computing = 0.0;  // s, on so many threads; by the speed of one core of a desktop computer
};

/// @param motions  of the cases, s
/// @param threads  that share the cases; 0: one a core
RunEstimate estimate(const Scenario& scenario, std::span<const double> motions, unsigned threads);
RunEstimate estimate(const Scenario& scenario, std::span<const PreparedCase> cases,
                     unsigned threads);

/// "373 s of motion, 3.7e+05 rows, 0.2 GB of signals, about 4 s of computing"
std::string to_string(const RunEstimate& estimate);

/// Whether the user should know before the work begins: above a minute or a gigabyte.
bool is_worth_telling(const RunEstimate& estimate);

/// @throws InputError if the signals are larger than the scenario allows, or than the memory of
///     this process
void refuse_too_large(const Scenario& scenario, const RunEstimate& estimate);

}  // namespace servomill::sim
