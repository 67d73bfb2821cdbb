/// Responses of axes on disk, for figures and other programs.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sim/frequency/bode.h"
#include "sim/frequency/step_response.h"
#include "sim/model/forward.h"
#include "sim/records/output_file.h"

namespace servomill::sim::run {

/// A file of the kind "bode": /bode/AXIS/CURVE with frequency, magnitude, phase of the exact
/// response, measured_* where it was measured; margins are attributes of /bode/AXIS/LOOP_loop.
/// @throws InputError if the file cannot be had under that name, SystemError
class BodeStore {
 public:
  BodeStore(const std::string& path, bool force, const model::Scenario& scenario);
  void add(char axis, const frequency::BodeResult& result);
  void commit() { file_.commit(); }

 private:
  records::OutputFile file_;
};

/// A file of the kind "step": /step/AXIS/KIND with time and all signals; figures of merit are
/// attributes.
/// @throws InputError if the file cannot be had under that name, SystemError
class StepStore {
 public:
  StepStore(const std::string& path, bool force, const model::Scenario& scenario);
  void add(char axis, const frequency::StepSettings& settings,
           const frequency::StepResponse& response);
  void commit() { file_.commit(); }

 private:
  std::shared_ptr<const model::MachineSettings> machine_;
  records::OutputFile file_;
};

/// "position", "velocity", "compliance"; "position", "velocity", "load".
std::string name_of(frequency::BodeLoop loop);
std::string name_of(frequency::StepKind kind);

}  // namespace servomill::sim::run
