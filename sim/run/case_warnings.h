/// Notes on a case that has run: lines for the user, most with a line of the program.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/engine/case_result.h"
#include "sim/evaluation/part_fit.h"
#include "sim/model/forward.h"
#include "sim/preparation/prepared_case.h"

namespace servomill::sim::evaluation {
struct NominalPart;  // sim/evaluation/nominal_part.h
}  // namespace servomill::sim::evaluation

namespace servomill::sim::run {

/// Notes on what the NC corrected or could not do as programmed.
/// @param result  displacements that strategies could not make in full, distance from the path
std::vector<std::string> notes_of_run(const preparation::PreparedParts& one,
                                      const engine::CaseResult& result);

/// Errors that the strategies of this case cannot correct, one line for each
/// (sim/run/residual_errors.h).
std::vector<std::string> notes_of_uncorrectable(const preparation::PreparedParts& one);

/// Places at which the program leaves the points of compensation tables, one line for each end.
std::vector<std::string> notes_of_left_tables(const preparation::PreparedParts& one);

/// Lays what was probed on the nominal part.
/// @param distance  largest_distance of the plan
/// @param notes  takes why that cannot be done, or how uncertain it is
std::optional<evaluation::PartFit> lay_on_nominal(const std::string& case_name,
                                                  const evaluation::NominalPart& part,
                                                  double distance,
                                                  std::span<const evaluation::ProbedFeature> probes,
                                                  std::vector<std::string>& notes);

}  // namespace servomill::sim::run
