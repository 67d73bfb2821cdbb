/// Faults of cases: what refuses a case before it runs, and how the faults of several are reported.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/move_list.h"
#include "sim/model/forward.h"
#include "strategies/strategy.h"

namespace servomill::sim::preparation {

struct InterpretedProgram;

/// The fault that a strategy finds, at the key that it names first, or else where it stands.
/// @param error  without a place
InputError fault_of(const model::StrategySpec& spec, const std::string& case_name,
                    const InputError& error);

/// A simulation knows tools by their numbers: those of G43.1 and G43.2 have none.
/// @param file  of the program
/// @throws InputError at the first motion with such a tool offset
void refuse_unnumbered_tools(const MoveRange& moves, const std::string& file);

/// Words of axes that the machine lacks would have no effect.
/// @throws InputError for each such axis, where the program first moves it
void refuse_absent_axes(const InterpretedProgram& program, const model::Scenario& scenario);

/// A feed per revolution of a spindle that stands still moves nothing, for ever.
/// @throws InputError at the first such move
void refuse_standing_spindle(const InterpretedProgram& program, const model::Scenario& scenario);

/// Under tool control X Y Z do not turn with the work offset, so that the coordinates of the
/// program are not those of the probes and the stock.
/// @throws InputError at the first probe; without one, if the case feels its cut, at [cutting]
void refuse_turned_tip(const InterpretedProgram& program, const model::Scenario& scenario,
                       const model::CaseSpec& spec);

/// A rewritten program would measure where the corrected positions are, not where the part is.
/// @param spec  of a strategy that rewrites
/// @throws InputError at the strategy, if the program has probing moves
void refuse_rewritten_probing(const model::StrategySpec& spec, const InterpretedProgram& program,
                              const std::string& case_name);

/// @param machine  that the case runs on
/// @param start    of the joints, all work offsets in it (5; m, rad)
/// @throws InputError for each axis that starts outside its travel
void refuse_start_outside(const model::Scenario& scenario, const model::MachineSettings& machine,
                          const Joints& start);

/// A displaced scale moves nothing where the motor closes the position loop.
/// @param spec  of the strategy
/// @throws InputError at the strategy
void refuse_unread_scale(const model::StrategySpec& spec, const strategies::Strategy& strategy,
                         const model::MachineSettings& machine, const std::string& case_name);

/// Hardware and delay follow what the registry says of a strategy, its action what the strategy
/// says: a displacement without hardware would be one without delay.
/// @param spec  of the strategy
/// @throws std::logic_error if it displaces the feedback and its entry says nothing of hardware
void refuse_undeclared_feedback(const model::StrategySpec& spec,
                                const strategies::Strategy& strategy);

/// Most strategies displace axes; moves under tool control are not of the axes. No strategy knows
/// more than one tool.
/// @param spec  of the strategy, which rewrites moves
/// @param file  of the program
/// @throws InputError at the strategy
void refuse_tip_moves(const model::StrategySpec& spec, const strategies::Strategy& strategy,
                      const InterpretedProgram& program, const std::string& file,
                      const std::string& case_name);

/// Strategies of two kinds that compensate the errors of one model would correct them twice.
/// Several of one kind may share them, such as tables over different axes; a strategy that has the
/// program run corrects only what the others leave.
/// @throws InputError at the second one
void refuse_second_correction(const model::StrategySpec& spec, const model::CaseSpec& one);

/// Two of a kind would correct twice.
/// @throws InputError at the strategy, if a case may have one and has two
void refuse_second(const model::StrategySpec& spec, const model::CaseSpec& one);

/// A strategy in the position loops follows the tip of the first tool; while rotary axes stand
/// still, those of other tools move alike.
/// @throws InputError at the strategy, where rotary axes move with another one
void refuse_other_tip(const model::StrategySpec& spec, const InterpretedProgram& program,
                      const std::string& file, const std::string& case_name);

/// Each cycle of a day is another part, whose temperature no day follows.
/// @throws InputError if the part of the case grows and the scenario has a day
void refuse_growing_part(const model::Scenario& scenario, const model::CaseSpec& spec);

/// A slip of the unit can make a program last for years.
/// @param duration  s; of the planned motion, or less: way over feed, which is known before
/// @throws InputError at the program
void refuse_endless(const model::Scenario& scenario, double duration);

/// Quantities of circles and balls, of sections that the recording leaves out.
/// @throws InputError for each such section
void refuse_narrow_windows(const model::Scenario& scenario);

/// Sections that quantities and windows of the recording name, among those that the program has.
/// @throws InputError for each that it has not
void refuse_absent_sections(const model::Scenario& scenario,
                            const std::vector<std::string>& sections);

/// Faults of several cases, each said once; with the case if not all cases have it.
class CaseFaults {
 public:
  void add(const std::string& case_name, const InputError& error);

  /// @param cases  how many there are
  /// @throws InputError if a fault was added
  void report(std::size_t cases);

 private:
  struct Found {
    Fault fault;
    std::vector<std::string> cases;
  };
  std::vector<Found> found_;
};

}  // namespace servomill::sim::preparation
