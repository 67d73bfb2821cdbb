/// Reads the cases of a scenario.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "sim/config/document.h"
#include "sim/config/reader.h"
#include "sim/model/forward.h"

namespace servomill::sim::input {

/// Adds the cases of a document to its scenario, one [[case]] after the other. Two things can be
/// said of them only when all have been read: who has the feedback hardware, and on which machine a
/// case with machine_override runs.
class CaseReader {
 public:
  /// @param error_models        names of all models of the scenario
  /// @param hardware_is_chosen  [feedback_hardware] says if it is connected
  /// @param out                 its machine, periods and cutting have been read
  CaseReader(std::vector<std::string> error_models, bool hardware_is_chosen, model::Scenario& out);

  void read(config::Reader& table);

  /// All cases read have names of their own, which others may refer to.
  bool names_are_known() const { return names_are_known_; }

  /// Hardware that one case needs delays the readings of all, as on one machine: unless they say
  /// otherwise, cases differ in their strategies alone.
  void connect_hardware();

  /// Machines of cases with machine_override: that of the scenario with these keys replaced; and
  /// those that strategies know: that of their case with keys replaced, or another one. To be
  /// called when all else is known to be right: of a faulty machine no override can be judged.
  /// @throws InputError with the faults of all overrides
  void read_machines(const config::Document& scenario);

 private:
  void check_name(config::Reader& table, const std::string& name) const;
  void check_recording(config::Reader& table, const model::CaseSpec& spec) const;
  void give_hardware(config::Reader& table, bool says_hardware, model::CaseSpec& spec);
  void note_machine_override(config::Reader& table);
  void read_machine_of(std::size_t index, const config::Document& with_override);
  void refuse_cold_machine(const model::CaseSpec& one) const;
  void read_known_machines(std::size_t index, const config::Document& of_case);

  std::vector<std::string> error_models_;
  bool hardware_is_chosen_;
  model::Scenario& out_;
  bool names_are_known_ = true;
  std::vector<std::size_t> follows_others_;         // cases that have the hardware if any needs it
  std::map<std::size_t, config::Value> overrides_;  // machine_override, by index of the case
  // machines that strategies know, by index of the case and of the strategy
  std::map<std::size_t, std::map<std::size_t, config::Value>> known_;
};

}  // namespace servomill::sim::input
