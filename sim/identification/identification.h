/// Result of an identification.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/identification/bootstrap.h"
#include "sim/identification/experiment.h"
#include "sim/identification/fit.h"
#include "sim/identification/inverse_dynamics.h"
#include "sim/identification/profile.h"
#include "sim/identification/uncertainty.h"

namespace servomill::sim::identification {

/// How far the simulation with the identified values is from one recording.
struct RecordResult {
  const AxisRecord* record = nullptr;
  Simulated simulated;
  double feedback_rms = 0.0;  // m or rad
  double force_rms = 0.0;     // share of the rms of the recorded force; 0: none was recorded
  double effective_samples = 0.0;
  double scale_rms = 0.0;  // m or rad, of the slide less its mean; compared, not fitted; 0: none
  // with the disturbance that was recorded: what its other sign, and none at all, would leave
  std::optional<double> reversed_rms, undisturbed_rms;  // m or rad
};

/// One friction law in the comparison.
struct LawResult {
  std::string name;
  std::size_t parameters = 0;   // estimated, without the starts
  double rms = 0.0;             // m or rad, of all samples that count
  double held_out = 0.0;        // m or rad, of parts that the fit did not see
  double held_out_error = 0.0;  // standard error of that
  double bic = 0.0;             // by effective samples, relative to the least
  std::string refused;          // why it could not be fitted; empty: it was
};

/// Points into the experiment.
struct Identification {
  std::vector<InverseDynamics> inverse_dynamics;  // of the first record: symmetric as in the
                                                  // literature, then symmetric, by direction
  std::vector<Estimate> estimates;                // with the identified values as start
  std::vector<std::string> implausible;           // "axis.X.stiffness = 180 N/m; ..."
  Fit fit;
  Uncertainty uncertainty;
  std::optional<Bootstrap> bootstrap;
  std::vector<Profile> profiles;
  std::vector<RecordResult> estimation, validation;
  std::vector<LawResult> laws;
  std::optional<std::size_t> simplest_law;  // that is not worse than the best
};

}  // namespace servomill::sim::identification
