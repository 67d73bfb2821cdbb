/// The quantities of the probed part of one case. The points are the means of all repetitions; with
/// a base case, the nominal points moved by what they differ from the same points of it.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/evaluation/comparison.h"
#include "sim/metrology/probing_plan.h"

namespace servomill::sim {

/// QuantityInfo::probes of a quantity of any number of features, unless named of all.
inline constexpr int kEveryProbe = 1000;

/// Kinds of features that a quantity is of.
/// @pre quantity_info(quantity).probes > 0
std::span<const FeatureKind> kinds_of(std::string_view quantity);

/// Deviations (um) of the points that were met, and what there is to say: how many were not.
struct ProbedDeviations {
  std::vector<double> d;
  std::string note;
};

/// Deviations for quantities with a statistic. Points at which one of the cases met nothing are
/// left out.
/// @param base  nullptr: none
/// @pre spec.part; both cases finished
ProbedDeviations probed_deviations(const QuantitySpec& spec, const CaseData& one,
                                   const CaseData* base);

/// In the unit of quantity_info; NaN and why where the points do not tell.
struct ProbedValue {
  double value;
  std::string note;
};

/// Value of the other quantities.
ProbedValue probed_value(const QuantitySpec& spec, const CaseData& one, const CaseData* base);

}  // namespace servomill::sim
