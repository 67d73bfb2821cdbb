/// An identification in words and tables.
#pragma once

#include <string>
#include <vector>

namespace servomill::sim::identification {

struct Experiment;      // sim/identification/experiment.h
struct Identification;  // sim/identification/identification.h

/// Everything that `servomill identify` prints.
std::string report(const Experiment& experiment, const Identification& result);

/// Parameters with U (k = 2), recordings, friction laws and warnings as one JSON object.
std::string report_json(const Identification& result);

/// Sentences on what the recordings do not tell: parameters without effect, and those of which only
/// combinations can be identified.
std::vector<std::string> unidentifiable_sentences(const Identification& result);

/// Sentences on why the values are none of a machine: a fit that did not converge, a simulation
/// that explains nothing of the motion, a covariance that is not finite. Empty: they may be used.
std::vector<std::string> faults(const Identification& result);

/// A value is where its bound is, not where the recordings have it.
bool has_value_at_bound(const Identification& result);

/// Sentences on what should make a user doubt: a loop that is not the recording's, values at their
/// bounds, a fit that did not converge.
std::vector<std::string> warnings(const Identification& result);

}  // namespace servomill::sim::identification
