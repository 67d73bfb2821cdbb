#include "sim/programs/compensate/work_knowledge.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "controllers/gcode/modal_state.h"
#include "controllers/gcode/parameters.h"
#include "controllers/gcode/request.h"
#include "plant/vocabulary/units.h"
#include "sim/config/option_value.h"
#include "sim/model/machine.h"
#include "sim/preparation/case_program.h"
#include "sim/preparation/prepared_case.h"
#include "sim/programs/compensate/compensate.h"
#include "sim/programs/compensate/program_corrector.h"
#include "sim/programs/named_axes.h"

namespace servomill::sim::programs {

using controllers::ProgramSetup;

AxisValues axis_values(const std::string& option, std::string_view text, const JointLayout* layout,
                       bool takes_rotation) {
  AxisValues out;
  const Place place{option + " " + std::string(text)};
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t end = std::min(text.find(',', from), text.size());
    const std::string_view item = text.substr(from, end - from);
    from = end + 1;
    const bool is_rotation = takes_rotation && !item.empty() && (item[0] == 'R' || item[0] == 'r');
    const auto axis = item.empty() ? std::nullopt : axis_of(item.front());
    if (item.size() < 3 || item[1] != '=' || (!axis && !is_rotation)) {
      throw InputError(place,
                       "must be positions, such as X=10,Y=-5.5 (in mm and deg) or \"X=10 mm\"");
    }
    const bool is_length = !is_rotation && is_linear(*axis);
    const config::ScaledText value = config::scale_option(
        item.substr(2), is_length ? config::kLength : config::kAngle, is_length ? "mm" : "deg");
    if (!value.complaint.empty()) {
      throw InputError(place, fmt::format("{}: {}", item, value.complaint));
    }
    if (is_rotation) {
      out.rotation = value.si;
      out.has_rotation = true;
      continue;
    }
    if (layout != nullptr && !layout->joint_of(*axis)) {
      throw InputError(place, fmt::format("the machine has no axis {}", letter(*axis)));
    }
    out.words[index_of(*axis)] = value.si;
    out.given[static_cast<std::size_t>(index_of(*axis))] = true;
  }
  return out;
}

namespace {

void add_work_offset(const std::string& text, const JointLayout* layout, GivenWorkOffsets& given) {
  const std::size_t colon = text.find(':');
  const std::string name = colon == std::string::npos ? "G54" : text.substr(0, colon);
  const auto found = std::find(kWorkSystems.begin(), kWorkSystems.end(), name);
  if (found == kWorkSystems.end()) {
    throw InputError(
        {"--work-offset " + text},
        fmt::format("'{}' is not allowed; must be one of {}", name, fmt::join(kWorkSystems, ", ")));
  }
  const AxisValues values = axis_values(
      "--work-offset", std::string_view(text).substr(colon == std::string::npos ? 0 : colon + 1),
      layout, true);
  auto& known = given[static_cast<std::size_t>(found - kWorkSystems.begin())];
  if (!known) {
    known = values;
    return;
  }
  const auto contradict = [&](char what, double a, double b, double unit) {
    throw InputError(
        {"--work-offset " + text},
        fmt::format("{} of {} is {:g} here, but was {:g} before", what, name, a / unit, b / unit));
  };
  for (const Axis axis : kAllAxes) {
    const int i = index_of(axis);
    const auto k = static_cast<std::size_t>(i);
    if (!values.given[k]) continue;
    if (known->given[k] && known->words[i] != values.words[i]) {
      contradict(letter(axis), values.words[i], known->words[i], is_linear(axis) ? mm : deg);
    }
    known->given[k] = true;
    known->words[i] = values.words[i];
  }
  if (!values.has_rotation) return;
  if (known->has_rotation && known->rotation != values.rotation) {
    contradict('R', values.rotation, known->rotation, deg);
  }
  known->has_rotation = true;
  known->rotation = values.rotation;
}

}  // namespace

GivenWorkOffsets work_offsets(const std::vector<std::string>& texts, const JointLayout* layout) {
  GivenWorkOffsets given;
  for (const std::string& text : texts) add_work_offset(text, layout, given);
  return given;
}

void add_tool_length(const std::string& text, controllers::ToolTable& tools) {
  const Place place{"--tool-length " + text};
  const std::size_t equals = text.find('=');
  const bool has_number = equals != std::string::npos;
  const double number =
      has_number ? config::plain_number(text.substr(0, equals)).value_or(0.0) : 0.0;
  constexpr double kMax = 99999.0;
  if (number < 1.0 || number > kMax || number != std::floor(number)) {
    throw InputError(place, "must be NUMBER=LENGTH of a tool, such as 1=50 (in mm) or \"1=50 mm\"");
  }
  const config::ScaledText length =
      config::scale_option(std::string_view(text).substr(equals + 1), config::kLength, "mm");
  if (!length.complaint.empty()) throw InputError(place, "length " + length.complaint);
  controllers::ToolEntry tool;
  if (const auto* known = tools.find(static_cast<int>(number))) tool = *known;
  tool.number = static_cast<int>(number);
  tool.offset[index_of(Axis::Z)] = length.si;
  tools.replace(tool);
}

WorkKnowledge read_work_knowledge(const CompensateRequest& request,
                                  const model::MachineSettings& machine) {
  const JointLayout& layout = machine.chain.layout;
  WorkKnowledge known;
  known.layout = layout;
  known.setup = program_setup(request.inputs, request.program_file);
  choose_reader(request.inputs, machine.nc, known.setup);
  known.setup.machine = preparation::tool_centre_point(machine);
  if (!request.inputs.parameter_file.empty()) {
    for (int system = 1; system <= controllers::kWorkSystems; ++system) {
      known.work_systems.insert(system);
    }
    for (AxisFlags& axes : known.given) axes.fill(true);
  }
  const GivenWorkOffsets given = work_offsets(request.work_offsets, &layout);
  for (std::size_t k = 0; k < given.size(); ++k) {
    if (!given[k]) continue;
    known.setup.work_offset[k] = given[k]->words;
    known.setup.work_rotation[k] = given[k]->rotation;
    known.work_systems.insert(static_cast<int>(k) + 1);
    for (std::size_t i = 0; i < kAxisWords; ++i) {
      known.given[k][i] = known.given[k][i] || given[k]->given[i];
    }
  }
  for (const std::string& text : request.tool_lengths) add_tool_length(text, known.setup.tools);
  return known;
}

bool WorkKnowledge::depends_on_place() const {
  return std::any_of(place_matters.begin(), place_matters.end(),
                     [](bool matters) { return matters; });
}

std::vector<Axis> WorkKnowledge::missing(int system) const {
  std::vector<Axis> out;
  for (const Axis axis : kAllAxes) {
    const auto i = static_cast<std::size_t>(index_of(axis));
    const bool is_known = given[static_cast<std::size_t>(system - 1)][i];
    if (layout.joint_of(axis) && place_matters[i] && !is_known) out.push_back(axis);
  }
  return out;
}

namespace {

void learn_G10(const controllers::ExecutedBlock& block, WorkKnowledge& known) {
  const auto& words = *block.request;
  if (words.code(controllers::Group::g_non_modal) != 100 || !words.has('P')) return;
  const int P = static_cast<int>(std::lround(words['P']));
  const int system = P == 0 ? block.state->work_system : P;
  if (system < 1 || system > controllers::kWorkSystems) return;
  known.work_systems.insert(system);
  for (const Axis axis : kAllAxes) {
    const auto i = static_cast<std::size_t>(index_of(axis));
    if (names_axis(block, axis)) known.given[static_cast<std::size_t>(system - 1)][i] = true;
  }
}

// "the work offset G54 is unknown on Y, Z, so ..."
std::string unknown_system(const WorkKnowledge& known, int system) {
  const auto name = kWorkSystems[static_cast<std::size_t>(system - 1)];
  const AxisFlags& given = known.given[static_cast<std::size_t>(system - 1)];
  const bool is_given_at_all = std::find(given.begin(), given.end(), true) != given.end();
  std::vector<char> letters;
  for (const Axis axis : known.missing(system)) letters.push_back(letter(axis));
  std::string words;
  for (const Axis axis : kAllAxes) {
    const bool is_missing =
        std::find(letters.begin(), letters.end(), letter(axis)) != letters.end();
    if (!known.layout.joint_of(axis) || (is_given_at_all && !is_missing)) continue;
    words += fmt::format("{}{}=...", words.empty() ? "" : ",", letter(axis));
  }
  return fmt::format(
      "the work offset {0} is unknown{1}, so the errors are unknown; set it with --work-offset "
      "{0}:{2} or --parameter-file (0 is allowed, but not assumed)",
      name, is_given_at_all ? fmt::format(" on {}", fmt::join(letters, ", ")) : "", words);
}

}  // namespace

void refuse_unknown_system(const controllers::ExecutedBlock& block,
                           const CompensateRequest& request, WorkKnowledge& knowledge) {
  if (block.request == nullptr) return;
  learn_G10(block, knowledge);
  const int system = block.state->work_system;
  const bool moves = std::any_of(block.moves.begin(), block.moves.end(),
                                 [](const Move& move) { return is_motion(move.kind); });
  if (!moves || knowledge.missing(system).empty() || is_place_of_machine(block)) return;
  const auto& chosen = block.request->of(controllers::Group::g_work_system);
  throw InputError({request.program_file, block.line, chosen.column},
                   unknown_system(knowledge, system));
}

std::string words_text(const AxisWords& words, const JointLayout& layout, const AxisFlags& shown) {
  std::string out;
  for (const Axis axis : kAllAxes) {
    if (!layout.joint_of(axis) || !shown[static_cast<std::size_t>(index_of(axis))]) continue;
    out += fmt::format("{}{}{:g}", out.empty() ? "" : " ", letter(axis),
                       words[index_of(axis)] / (is_linear(axis) ? mm : deg));
  }
  return out;
}

WorkSystemPlace place_of(const controllers::ProgramSetup& setup, int system) {
  const auto k = static_cast<std::size_t>(system - 1);
  const auto stored = [&](int number) {
    const auto found = setup.stored.find(number);
    return found == setup.stored.end() ? 0.0 : found->second;
  };
  WorkSystemPlace place{setup.work_offset[k], setup.work_rotation[k]};
  for (const Axis axis : kAllAxes) {
    const int i = index_of(axis);
    if (place.offset[i] != 0.0) continue;
    place.offset[i] =
        stored(controllers::parameter::work_offset(system) + i) * (is_linear(axis) ? mm : deg);
  }
  if (place.rotation == 0.0) {
    place.rotation = stored(controllers::parameter::work_rotation(system)) * deg;
  }
  return place;
}

// Irregular places: no period of an error fits all of them.
AxisFlags axes_that_matter(const Correction& correction, const Joints& lower, const Joints& upper) {
  constexpr int kPlaces = 64;
  constexpr double kSame = 1e-9, kReach = 0.5;  // m, rad; m, rad about zero where nothing is given
  const JointLayout& layout = correction.layout();
  const auto place = [&](int n, int j) {
    const double a = std::isfinite(lower[j]) ? lower[j] : -kReach;
    const double b = std::isfinite(upper[j]) ? upper[j] : kReach;
    return a + std::fmod((n + 1) * std::sqrt(2.0 + 3.0 * j), 1.0) * (b - a);
  };
  AxisFlags out{};
  for (int n = 0; n < kPlaces; ++n) {
    Joints Q = Joints::Zero();
    for (int j = 0; j < kJoints; ++j) {
      if (layout.has(j)) Q[j] = place(n, j);
    }
    const AxisWords d = correction.at(layout.words(Q));
    for (const Axis axis : kAllAxes) {
      const auto j = layout.joint_of(axis);
      if (!j) continue;
      Joints moved = Q;
      moved[*j] = place(n + 1, *j);
      const AxisWords other = correction.at(layout.words(moved));
      if ((other - d).cwiseAbs().maxCoeff() > kSame) {
        out[static_cast<std::size_t>(index_of(axis))] = true;
      }
    }
  }
  return out;
}

}  // namespace servomill::sim::programs
