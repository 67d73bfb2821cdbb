/// Friction laws compared on the same recordings: by parts that the fit did not see, and by the
/// information criterion of Bayes with the number of samples that coloured residuals are worth.
#pragma once

#include <vector>

#include "sim/identification/experiment.h"
#include "sim/identification/identification.h"
#include "sim/identification/identify.h"

namespace servomill::sim::identification {

/// The laws that are compared, from the simplest to the richest, of one axis.
/// @param axis  "X"
std::vector<Law> friction_laws(char axis, bool linear, const InverseDynamics* start);

/// Fits every law to the records for estimation and fills in the table of `out`. The law that wins
/// is the one with the fewest parameters among those that are not worse than the best: error of the
/// parts held out within two standard errors of the best one's, BIC within 10 of the least.
void compare_laws(const Experiment& experiment, Identification& out, unsigned threads);

}  // namespace servomill::sim::identification
