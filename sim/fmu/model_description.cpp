#include "sim/fmu/model_description.h"

#include <fmt/format.h>

#include <charconv>
#include <set>

#include "sim/fmu/axis_variables.h"
#include "sim/fmu/clocks.h"
#include "sim/fmu/tool.h"

namespace servomill::sim::fmu {
namespace {

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        // other control characters are none of XML
        out += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
    }
  }
  return out;
}

// With as many digits as give the same bits again.
std::string number(double value) {
  char digits[64];
  return {digits, std::to_chars(std::begin(digits), std::end(digits), value).ptr};
}

std::string_view name_of(Causality causality) {
  constexpr std::string_view kNames[] = {"independent", "parameter", "input", "output", "local"};
  return kNames[static_cast<std::size_t>(causality)];
}

std::string_view name_of(Variability variability) {
  constexpr std::string_view kNames[] = {"constant", "fixed", "discrete", "continuous"};
  return kNames[static_cast<std::size_t>(variability)];
}

// True for all but the outputs, which are calculated, and time.
bool has_start(const Variable& variable) {
  return variable.causality != Causality::output && variable.causality != Causality::independent;
}

// Initial is given where the standard leaves a choice or has it: inputs and time have none.
std::string initial_of(const Variable& variable) {
  switch (variable.causality) {
    case Causality::parameter:
    case Causality::local:
      return " initial=\"exact\"";
    case Causality::output:
      return " initial=\"calculated\"";
    default:
      return {};
  }
}

// A variable of one of the axes or of the tool, in the order of the description.
struct Listed {
  const Variable& variable;
  const Unit& unit;
  double start;
  std::uint32_t reference;
  std::string name;  // of one of several axes behind its letter: Y.position
};

// Time is listed once.
void list_axes(const std::vector<AxisConstants>& axes, std::vector<Listed>& out) {
  std::uint32_t first = 0;
  for (const AxisConstants& axis : axes) {
    const Values start = start_values(axis);
    for (const Variable& one : variables()) {
      const bool is_time = one.causality == Causality::independent;
      if (is_time && first > 0) continue;
      const bool plain = axes.size() == 1 || is_time;
      out.push_back({one, unit_of(one.kind, axis), start[one.reference], first + one.reference,
                     plain ? std::string(one.name) : fmt::format("{}.{}", axis.axis, one.name)});
    }
    first += kAxisStride;
  }
}

std::vector<Listed> listed_variables(const MachineConstants& machine) {
  std::vector<Listed> out;
  list_axes(machine.axes, out);
  if (!machine.kinematics) return out;
  for (const Variable& one : tool_variables()) {
    const std::uint32_t n = one.reference - kToolReference;
    const double start = n < kTipCoordinates ? machine.kinematics->p_ST[static_cast<int>(n)] : 0.0;
    out.push_back({one, linear_unit_of(one.kind), start, one.reference, std::string(one.name)});
  }
  return out;
}

// The tip of a tool may lie anywhere.
bool is_not_negative(const Variable& variable) {
  return variable.causality == Causality::parameter && variable.reference < kToolReference;
}

// unit=... start=... of a variable.
std::string unit_and_start(const Listed& one) {
  std::string out;
  if (one.variable.kind != Kind::ratio) out += fmt::format(" unit=\"{}\"", one.unit.name);
  if (is_not_negative(one.variable)) out += " min=\"0\"";
  if (has_start(one.variable)) out += fmt::format(" start=\"{}\"", number(one.start));
  return out;
}

std::string unit_element(const Unit& unit) {
  std::string out = fmt::format("    <Unit name=\"{}\"><BaseUnit", unit.name);
  const std::pair<const char*, int> powers[] = {
      {"kg", unit.kg}, {"m", unit.m}, {"s", unit.s}, {"A", unit.A}, {"rad", unit.rad}};
  for (const auto& [base, power] : powers) {
    if (power != 0) out += fmt::format(" {}=\"{}\"", base, power);
  }
  return out + "/></Unit>\n";
}

std::string units(const std::vector<Listed>& all) {
  std::string out = "  <UnitDefinitions>\n";
  std::set<std::string_view> defined;
  for (const Listed& one : all) {
    if (one.variable.kind == Kind::ratio || !defined.insert(one.unit.name).second) continue;
    out += unit_element(one.unit);
  }
  return out + "  </UnitDefinitions>\n";
}

std::string log_categories() {
  constexpr std::pair<const char*, const char*> kCategories[] = {
      {"logEvents", "initialization"},
      {"logStatusDiscard", "why the NC stops the machine"},
      {"logStatusError", "why a call is refused"}};
  std::string out = "  <LogCategories>\n";
  for (const auto& [name, description] : kCategories) {
    out += fmt::format("    <Category name=\"{}\" description=\"{}\"/>\n", name, description);
  }
  return out + "  </LogCategories>\n";
}

std::string default_experiment(const model::LoopPeriods& periods) {
  return fmt::format("  <DefaultExperiment startTime=\"0\" stepSize=\"{:.12g}\"/>\n",
                     periods.seconds(periods.position));
}

std::string variable_element(FmiVersion version, const Listed& one) {
  const std::string common = fmt::format(
      "name=\"{}\" valueReference=\"{}\" causality=\"{}\" variability=\"{}\"{} description=\"{}\"",
      one.name, one.reference, name_of(one.variable.causality), name_of(one.variable.variability),
      initial_of(one.variable), escaped(one.variable.description));
  const std::string values = unit_and_start(one);
  return version == FmiVersion::fmi2
             ? fmt::format("    <ScalarVariable {}><Real{}/></ScalarVariable>\n", common, values)
             : fmt::format("    <Float64 {}{}/>\n", common, values);
}

std::string clock_elements() {
  std::string out;
  for (const Clock& clock : kClocks) {
    out += fmt::format(
        "    <Clock name=\"{}\" valueReference=\"{}\" causality=\"output\" "
        "variability=\"discrete\" "
        "intervalVariability=\"triggered\" description=\"{}\"/>\n",
        clock.name, clock.reference, escaped(clock.description));
  }
  return out;
}

// Outputs depend on no input of the same communication point: it acts from there on. When
// initialised they depend on all that was set.
std::string structure_of_fmi2(const std::vector<Listed>& all) {
  std::string outputs, initial;
  for (std::size_t n = 0; n < all.size(); ++n) {
    if (all[n].variable.causality != Causality::output) continue;
    outputs += fmt::format("      <Unknown index=\"{}\" dependencies=\"\"/>\n", n + 1);
    initial += fmt::format("      <Unknown index=\"{}\"/>\n", n + 1);
  }
  return "    <Outputs>\n" + outputs + "    </Outputs>\n    <InitialUnknowns>\n" + initial +
         "    </InitialUnknowns>\n";
}

// Clocks have no initial value.
std::string structure_of_fmi3(const std::vector<Listed>& all) {
  std::string outputs, initial;
  const auto add = [&](std::uint32_t reference) {
    outputs += fmt::format("    <Output valueReference=\"{}\" dependencies=\"\"/>\n", reference);
  };
  for (const Listed& one : all) {
    if (one.variable.causality != Causality::output) continue;
    add(one.reference);
    initial += fmt::format("    <InitialUnknown valueReference=\"{}\"/>\n", one.reference);
  }
  for (const Clock& clock : kClocks) add(clock.reference);
  return outputs + initial;
}

std::string variables_and_structure(FmiVersion version, const std::vector<Listed>& all) {
  const bool two = version == FmiVersion::fmi2;
  std::string out = "  <ModelVariables>\n";
  for (const Listed& one : all) out += variable_element(version, one);
  if (!two) out += clock_elements();
  return out + "  </ModelVariables>\n  <ModelStructure>\n" +
         (two ? structure_of_fmi2(all) : structure_of_fmi3(all)) + "  </ModelStructure>\n";
}

// Letters of the axes: "XYZ".
std::string letters(const std::vector<AxisConstants>& axes) {
  std::string out;
  for (const AxisConstants& axis : axes) out += axis.axis;
  return out;
}

std::string description(const MachineConstants& machine) {
  const AxisConstants& first = machine.axes.front();
  const char* const what = machine.kinematics        ? "servo axes and kinematics"
                           : machine.axes.size() > 1 ? "servo axes"
                                                     : "servo axis";
  std::string out = fmt::format("{} {} of {}, scenario {}", what, letters(machine.axes),
                                first.machine.name, first.scenario);
  if (!first.case_name.empty()) out += fmt::format(", case {}", first.case_name);
  return out;
}

std::string root_element(FmiVersion version, const MachineConstants& machine,
                         std::string_view token) {
  const bool two = version == FmiVersion::fmi2;
  const AxisConstants& first = machine.axes.front();
  return fmt::format(
      "<fmiModelDescription fmiVersion=\"{}\" modelName=\"{}\" {}=\"{}\" description=\"{}\" "
      "generationTool=\"servomill {}\" variableNamingConvention=\"{}\">\n",
      two ? "2.0" : "3.0", escaped(fmt::format("{}.{}", first.scenario, letters(machine.axes))),
      two ? "guid" : "instantiationToken", escaped(token), escaped(description(machine)),
      escaped(first.program), machine.axes.size() > 1 ? "structured" : "flat");
}

std::string interface_element(FmiVersion version) {
  return fmt::format(
      "  <CoSimulation modelIdentifier=\"{}\" canHandleVariableCommunicationStepSize=\"true\" "
      "{}/>\n",
      kModelIdentifier,
      version == FmiVersion::fmi2
          ? "canNotUseMemoryManagementFunctions=\"true\" canGetAndSetFMUstate=\"true\" "
            "canSerializeFMUstate=\"true\" providesDirectionalDerivative=\"false\""
          : "canGetAndSetFMUState=\"true\" canSerializeFMUState=\"true\" "
            "providesDirectionalDerivatives=\"false\" hasEventMode=\"true\" "
            "mightReturnEarlyFromDoStep=\"true\"");
}

}  // namespace

std::string model_description(FmiVersion version, const MachineConstants& machine,
                              std::string_view token) {
  const std::vector<Listed> all = listed_variables(machine);
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" + root_element(version, machine, token) +
         interface_element(version) + units(all) + log_categories() +
         default_experiment(machine.axes.front().machine.nc.periods) +
         variables_and_structure(version, all) + "</fmiModelDescription>\n";
}

}  // namespace servomill::sim::fmu
