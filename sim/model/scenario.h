/// A scenario: machine, program, errors, cases and what is asked of them. Read from TOML, complete
/// and in SI; nothing behind this point meets an input that it must doubt.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "controllers/gcode/reader.h"
#include "controllers/gcode/tool_table.h"
#include "plant/cutting/cutter.h"
#include "plant/cutting/material.h"
#include "plant/cutting/stock.h"
#include "plant/geometry/error_model.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/parameters.h"
#include "plant/vocabulary/stored_text.h"
#include "sim/metrology/cmm.h"
#include "sim/metrology/probing_plan.h"
#include "sim/model/design.h"
#include "sim/model/machine.h"
#include "sim/model/quantity_spec.h"
#include "sim/model/run_settings.h"
#include "sim/model/tip_uncertainty.h"
#include "sim/model/touch_probe.h"
#include "strategies/entry.h"

namespace servomill::sim::evaluation {
struct NominalPart;  // sim/evaluation/nominal_part.h
}  // namespace servomill::sim::evaluation

namespace servomill::sim::model {

struct MachineTest;  // sim/model/machine_test.h
struct WorkingDay;   // sim/model/working_day.h

struct ProgramSpec {
  std::string file;  // as messages name it
  // of the program; what is made of a scenario shares it
  std::shared_ptr<const StoredText> shared_text = std::make_shared<const StoredText>();
  std::map<std::string, std::string> subroutines;  // texts of NAME.ngc beside the program, by NAME
  std::map<std::string, double> parameters;        // "#101" -> value
  controllers::Reader reader = controllers::Reader::any;
  controllers::DecimalPoint decimal_point = controllers::DecimalPoint::unset;
  std::optional<double> first_feed;  // m/s, of moves before any F
  std::set<int> ignored_codes;       // M codes of the machine's builder without effect
  double feed_override = 1.0;
  AxisWords work_offset = AxisWords::Zero();  // G54, m, rad, machine coordinates
  AxisWords start = AxisWords::Zero();        // m, rad, in work coordinates
  Place start_place;                          // for a start outside the travel
  controllers::ToolTable tools;
  std::map<int, plant::Cutter> cutters;  // of the tools with a diameter, by number
  std::set<int> assumed_teeth;           // cutters whose number of teeth is not given

  /// Copies the text, which should be short.
  std::string text() const { return shared_text->all(); }
};

/// Instrument that shows the deviation of an actual run.
enum class SeenBy : std::uint8_t {
  scales,
  tip,   // a grid encoder reads the TCP in the workpiece
  part,  // a CMM probes what was cut
};

/// Recording of an actual run, as a strategy learns from it. Channels by the letters of axes.
struct RecordedRunSpec {
  std::string file;
  Place place;
  SeenBy sees = SeenBy::scales;
  std::map<char, std::string> measured;   // positions as scales or grid encoder read them
  std::map<char, std::string> reference;  // positions as the NC interpolated them, without offset
  std::string case_name;                  // of a result file, in place of channels
  std::vector<std::string> probes;        // features of a part in a result file; empty: all
};

struct StrategySpec {
  const strategies::Entry* entry = nullptr;
  Parameters parameters;
  strategies::Action action = strategies::Action::compensate;
  std::string model;  // name of the identified error model
  // that a strategy which runs the program knows; nullptr: that of the case
  std::shared_ptr<const MachineSettings> machine;
  std::vector<RecordedRunSpec> recordings;  // in the order of the runs; empty: it makes its own
  Place place;                              // for what the strategy itself refuses
  std::map<std::string, Place, std::less<>> key_places;  // of the parameters that are given
};

struct CaseSpec {
  std::string name;
  AxisWords work_offset = AxisWords::Zero();  // m, rad; added to that of the program
  std::vector<StrategySpec> strategies;
  bool feedback_hardware = false;
  ServoModel servo = ServoModel::cascade;
  std::optional<std::string> machine_errors;  // in place of that of the scenario; empty: no errors
  bool cutting = false;                       // feels forces of the cut
  CuttingWear wear;                           // then
  std::optional<MachineSettings> machine;     // where the case overrides keys of the machine

  /// Tells if one of its strategies passes its signals through the feedback hardware.
  bool needs_feedback_hardware() const;
};

/// Recording: signals, period and storage.
struct RecordSpec {
  RecordFormat format = {.resolution = 0.001e-9};
  int compression = 1;            // of the result file, kNoCompression to kMaxCompression
  bool uncorrectable = false;     // what strategies cannot correct
  double max_size = 8e9;          // bytes of the signals of all cases, as estimated before a run
  bool period_is_given = false;   // else rows of long programs are thinned
  double max_duration = 86400.0;  // s, of the motion of a case
  RecordWindows windows;          // that are recorded
  bool extremes = false;          // rows tell of every tick since the row before
};

/// Limits on the computing effort of cutting.
struct CuttingSpec {
  plant::CuttingCoefficients coefficients;
  CuttingWear wear;
  bool teeth = false;         // forces are those of single teeth, else their average
  bool regeneration = false;  // teeth meet the surface that vibration has left
  bool actual_depth = false;  // the depth of cut follows the actual position of the tool
  int steps_per_tooth = 20;   // forces of teeth are means over a step; at least so many while one
                              // tooth follows the other
  Place place;
};

struct Scenario {
  std::string name;  // file name without folder and extension
  std::string title, source;
  MachineSettings machine;
  ProgramSpec program;
  std::map<std::string, plant::ErrorModel> errors;
  /// Identified errors of the machine with their covariance, where a quantity needs it; or none.
  std::shared_ptr<const UncertainErrors> uncertain;
  std::string machine_errors;  // model of the machine's true errors; empty: none
  std::string imposed;  // model whose displacement at the programmed position is recorded; or empty
  FeedbackHardware hardware;
  plant::Stock stock;                                   // in work coordinates of the program
  std::shared_ptr<const evaluation::NominalPart> part;  // likewise; or none
  std::optional<CuttingSpec> cutting;
  std::vector<CaseSpec> cases;
  std::vector<metrology::ProbeSpec> probes;  // measured on the part of every case
  metrology::Cmm cmm;
  std::shared_ptr<const TouchProbe> touch_probe;  // in the spindle, for G38.2 ...; or none
  // tests of the machine; if there are any, the program is theirs
  std::vector<std::shared_ptr<const MachineTest>> tests;
  std::shared_ptr<const WorkingDay> day;  // sim/model/working_day.h; or none
  Tick record_period = 100;
  RecordSpec record;
  double settle_time = 0.1;  // s
  std::vector<QuantitySpec> quantities;
  SweepDesign sweep;

  std::string text, machine_text;  // as read
  std::string resolved;            // one TOML document with the machine and all changes in it
  std::string swept_files;         // that only the sweep names (sim/sweep/sweep.h)

  const CaseSpec* find_case(std::string_view case_name) const;
  /// The machine that a case runs on. Axes and periods are those of `machine` for all cases.
  const MachineSettings& machine_of(const CaseSpec& one) const {
    return one.machine ? *one.machine : machine;
  }
  /// Delay between the scales and what the position loops of a case read (ticks).
  Tick reading_delay_of(const CaseSpec& one) const {
    return machine.scale_delay + (one.feedback_hardware ? hardware.signal_delay : 0);
  }
  /// Delay (s) of the readings of a case by the feedback hardware; none of an ideal servo,
  /// which has no loops to read them.
  std::optional<double> signal_delay_of(const CaseSpec& one) const;
};

}  // namespace servomill::sim::model
