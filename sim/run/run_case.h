/// A prepared case, run: its recording, and what follows from it.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plant/vocabulary/stored_text.h"
#include "sim/engine/case_result.h"
#include "sim/evaluation/comparison.h"
#include "sim/evaluation/part_fit.h"
#include "sim/evaluation/probed_part.h"
#include "sim/model/work_frame.h"
#include "sim/preparation/touch.h"
#include "strategies/lesson.h"

namespace servomill::sim::model {
struct UncertainErrors;
}  // namespace servomill::sim::model
namespace servomill::sim::engine {
struct CaseInputs;
}  // namespace servomill::sim::engine
namespace servomill::sim::preparation {
class PreparedCase;
}  // namespace servomill::sim::preparation

namespace servomill::sim::run {

struct TestResult;  // sim/run/machine_tests.h
struct DayCourse;   // sim/run/day_course.h

/// Runs of the program that a strategy has learnt from before the case ran, and its offset.
struct LearntRuns {
  std::string strategy;
  strategies::Lesson lesson;
};

struct CaseOutput {
  std::string name;
  engine::CaseResult result;
  std::shared_ptr<const StoredText> program;  // the rewritten one; nullptr: the original one ran
  double duration = 0.0;                      // s, of the program that the NC ran
  double blocks = 0.0;
  std::vector<std::string> notes;  // what the NC put right or could not do as programmed
  std::vector<std::string> sections;
  plant::MachineChain chain;           // the ideal machine
  model::PartFrame frame;              // work frame of the program
  std::optional<double> signal_delay;  // s, of the feedback hardware; none of an ideal servo
  std::shared_ptr<const model::UncertainErrors> uncertain;  // errors of the machine; or none
  std::vector<evaluation::ProbedFeature> probes;  // empty: nothing is probed, or the case stopped
  std::optional<evaluation::PartFit> part_fit;    // of them, where there is a nominal part
  std::shared_ptr<const evaluation::SpindleMotion> spindle;
  std::vector<preparation::Touch> touches;  // of the program's probing moves
  std::vector<LearntRuns> learnt;
  std::vector<evaluation::AxisDemand> demands;           // of all its axes
  std::vector<std::shared_ptr<const TestResult>> tests;  // of the machine; or it stopped
  std::shared_ptr<const DayCourse> day;                  // likewise; or none
  evaluation::CaseData data() const;
};

/// Probes the part that a run of `prepared.inputs()` has cut, and notes what the NC put right.
CaseOutput output_of(const preparation::PreparedCase& prepared, engine::CaseResult result);

/// output_of() with all notes of sim/run/case_warnings.h.
CaseOutput noted_output_of(const preparation::PreparedCase& prepared, engine::CaseResult result);

/// How the signals of a case are kept.
struct SignalStorage {
  std::string scratch_folder;  // of recordings that are long; empty: that of temporary files
  bool is_encoded = false;     // for a file
};

/// Inputs of a case whose signals are kept so.
engine::CaseInputs inputs_with(const preparation::PreparedCase& prepared,
                               const SignalStorage& storage);

/// Runs a case on this thread: noted_output_of() of its simulation.
CaseOutput run_case(const preparation::PreparedCase& prepared, const engine::StopFlag& stop,
                    std::atomic<float>& progress, const SignalStorage& storage = {});

}  // namespace servomill::sim::run
