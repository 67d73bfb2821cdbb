/// Work offsets and tool lengths, as far as the user has given them.
#pragma once

#include <array>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "controllers/gcode/interpreter.h"
#include "controllers/gcode/program_setup.h"
#include "sim/model/forward.h"
#include "sim/programs/compensate/correction.h"
#include "sim/programs/compensate/program_corrector.h"

namespace servomill::sim::programs {

struct CompensateRequest;

inline constexpr std::array<std::string_view, 9> kWorkSystems = {
    "G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"};

/// "X=10,C=90" in mm and deg; `rotation` takes R.
struct AxisValues {
  AxisWords words = AxisWords::Zero();
  std::array<bool, kAxisWords> given{};
  double rotation = 0.0;  // rad
  bool has_rotation = false;
};

/// @param option  its name, for messages
/// @param layout  nullptr: of a machine that is not known, which may have any axis
AxisValues axis_values(const std::string& option, std::string_view text, const JointLayout* layout,
                       bool takes_rotation);

/// Values of `--work-offset`, G54 ... G59.3. Axes of a second one of the same system are added,
/// another value of one is refused.
using GivenWorkOffsets = std::array<std::optional<AxisValues>, kWorkSystems.size()>;
GivenWorkOffsets work_offsets(const std::vector<std::string>& texts, const JointLayout* layout);

/// "1=50": in place of the length of the tool table.
void add_tool_length(const std::string& text, controllers::ToolTable& tools);

/// State of the control before the program, and the work systems of known place.
struct WorkKnowledge {
  controllers::ProgramSetup setup;
  JointLayout layout;
  std::set<int> work_systems;  // 1 ... 9, of which a place is known on some axis
  std::array<AxisFlags, kWorkSystems.size()> given{};  // axes of each
  /// Axes along which the errors are not the same everywhere.
  AxisFlags place_matters = {true, true, true, true, true, true};

  bool depends_on_place() const;
  /// Axes of the machine on which the place of a work system is needed, and unknown.
  std::vector<Axis> missing(int system) const;
};

WorkKnowledge read_work_knowledge(const CompensateRequest& request,
                                  const model::MachineSettings& machine);

/// Moves in a work system of unknown place would be corrected for another place. G10 makes a system
/// known on the axes that it names.
/// @throws InputError
void refuse_unknown_system(const controllers::ExecutedBlock& block,
                           const CompensateRequest& request, WorkKnowledge& knowledge);

/// Place of a work system: of the request, else of the parameter file. m, rad
struct WorkSystemPlace {
  AxisWords offset = AxisWords::Zero();
  double rotation = 0.0;
};
WorkSystemPlace place_of(const controllers::ProgramSetup& setup, int system);

/// "X1 Y2", mm and deg, of the axes that the machine has.
/// @param shown  the others are left out
std::string words_text(const AxisWords& words, const JointLayout& layout,
                       const AxisFlags& shown = {true, true, true, true, true, true});

/// Axes along which the correction differs between places of the travel.
AxisFlags axes_that_matter(const Correction& correction, const Joints& lower, const Joints& upper);

}  // namespace servomill::sim::programs
