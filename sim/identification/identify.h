/// The whole of an identification: starting values, fit, uncertainty, validation, friction laws.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace servomill::sim::identification {

struct Experiment;      // sim/identification/experiment.h
struct Identification;  // sim/identification/identification.h

/// Fewest replicas of which 2.5 % are a number.
inline constexpr int kFewestReplicas = 100;
struct BootstrapSettings {
  std::size_t replicas = 0;
  std::uint64_t seed = 1;
};

/// Intervals that are computed on request, beside those of the covariance.
struct IntervalSettings {
  BootstrapSettings bootstrap;        // no replicas: none
  std::vector<std::size_t> profiles;  // numbers of estimates
};

/// @param threads  0: one a core
/// @throws InputError if the starting values cannot be simulated, or a recording tells nothing
Identification identify(const Experiment& experiment, unsigned threads = 0,
                        const IntervalSettings& intervals = {});

/// The same for callers that need no complete Identification.
std::shared_ptr<const Identification> shared_identification(const Experiment& experiment,
                                                            unsigned threads = 0,
                                                            const IntervalSettings& intervals = {});

}  // namespace servomill::sim::identification
