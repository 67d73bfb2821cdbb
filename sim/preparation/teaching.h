/// Lets strategies that learn have the program of a case run before the case itself does.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sim/model/forward.h"
#include "sim/preparation/case_preparation.h"
#include "strategies/trial_runs.h"

namespace servomill::sim::engine {
struct CaseInputs;
}  // namespace servomill::sim::engine

namespace servomill::sim::preparation {

/// A case all of whose strategies are made, and whose motion is planned. Lessons change its last
/// members.
struct LearningCase {
  const CasePreparation& prepare;
  const model::Scenario& scenario;
  const model::CaseSpec& spec;
  SharedProgram program;
  SharedModel machine_errors;                 // the machine as it is
  const plant::ErrorModel* component_errors;  // the same
  /// Inputs of a run as the case is now, on a machine with errors.
  std::function<engine::CaseInputs(const model::MachineSettings&, const plant::VolumetricModel&,
                                   const plant::ErrorModel*)>
      inputs;
  std::vector<SharedStrategy>& strategies;
  std::shared_ptr<const RewrittenProgram>& rewritten;
  SharedMotion& motion;
  std::vector<std::string>& warnings;
};

/// @throws InputError for what forbids the strategy of that number to learn, as far as it shows
///         before the program runs
void refuse_lessons(LearningCase& one, std::size_t number);

/// The strategy of that number learns, and then acts with its offset.
/// @pre    refuse_lessons() did not throw
/// @return its runs, and the offset
/// @throws InputError
strategies::Lesson teach(LearningCase& one, std::size_t number);

}  // namespace servomill::sim::preparation
