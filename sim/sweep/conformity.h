/// Conformity of sampled quantities with their tolerances.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "sim/model/tolerance.h"

namespace servomill::sim::sweep {

/// Statement on conformity. Source: ISO 14253-1:2017, which asks for a probability of 95 %.
enum class Statement : std::uint8_t { conforms, does_not_conform, neither };

/// "conforms", "does not", "unproven"
std::string_view name_of(Statement statement);

/// Probability that a quantity lies within its limits, from samples of it.
struct Conformity {
  double probability = 0.0;      // share of the samples within the limits; NaN: no samples
  double low = 0.0, high = 1.0;  // its interval of 95 % for so many samples
  double guard_band = 0.0;       // kGuardFactor standard deviations, in the quantity's unit
  Statement statement = Statement::neither;
};

/// Guard band between a limit and the zone of acceptance in standard uncertainties: a normal value
/// that far inside one limit lies within it with a probability of 95 %.
inline constexpr double kGuardFactor = 1.65;

/// Conformity of the finite ones of some values. The interval of the share k / n is Wilson's, with
/// z = 1.96:
///     (k + z^2/2 +- z sqrt(k (n - k)/n + z^2/4)) / (n + z^2)
/// A quantity conforms where all of it lies above 95 %, and does not where all of it lies below 5
/// %; of samples that all lie within the limits 73 prove it. Source: E. B. Wilson, Probable
/// inference, the law of succession, and statistical inference, J. Amer. Statist. Assoc. 22 (1927)
/// 209-212.
Conformity conformity_of(std::span<const double> values, const model::Tolerance& tolerance);

}  // namespace servomill::sim::sweep
