#include "sim/fmu/model_description.h"

#include <fmt/format.h>

#include <charconv>
#include <set>

#include "sim/fmu/axis_variables.h"

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

// unit=... start=... of a variable.
std::string unit_and_start(const Variable& variable, const AxisConstants& axis,
                           const Values& values) {
  std::string out;
  if (variable.kind != Kind::ratio) {
    out += fmt::format(" unit=\"{}\"", unit_of(variable.kind, axis).name);
  }
  if (variable.causality == Causality::parameter) out += " min=\"0\"";
  if (has_start(variable)) out += fmt::format(" start=\"{}\"", number(values[variable.reference]));
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

std::string units(const std::vector<AxisConstants>& axes) {
  std::string out = "  <UnitDefinitions>\n";
  std::set<std::string_view> defined;
  for (const AxisConstants& axis : axes) {
    for (const Variable& variable : variables()) {
      const Unit& unit = unit_of(variable.kind, axis);
      if (variable.kind == Kind::ratio || !defined.insert(unit.name).second) continue;
      out += unit_element(unit);
    }
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

// Parts of both versions: units, log categories, default experiment.
std::string common_parts(const std::vector<AxisConstants>& axes) {
  const model::LoopPeriods& periods = axes.front().machine.nc.periods;
  return units(axes) + log_categories() +
         fmt::format("  <DefaultExperiment startTime=\"0\" stepSize=\"{:.12g}\"/>\n",
                     periods.seconds(periods.position));
}

// A variable of one of the axes, in the order of the description.
struct Listed {
  const Variable& variable;
  const AxisConstants& axis;
  std::uint32_t reference;
  std::string name;  // with several axes behind that of its axis: Y.position
};

// Time is listed once.
std::vector<Listed> listed_variables(const std::vector<AxisConstants>& axes) {
  std::vector<Listed> out;
  std::uint32_t first = 0;
  for (const AxisConstants& axis : axes) {
    for (const Variable& one : variables()) {
      const bool is_time = one.causality == Causality::independent;
      if (is_time && first > 0) continue;
      const bool plain = axes.size() == 1 || is_time;
      out.push_back({one, axis, first + one.reference,
                     plain ? std::string(one.name) : fmt::format("{}.{}", axis.axis, one.name)});
    }
    first += kAxisStride;
  }
  return out;
}

std::string variable_element(FmiVersion version, const Listed& one) {
  const std::string common = fmt::format(
      "name=\"{}\" valueReference=\"{}\" causality=\"{}\" variability=\"{}\"{} description=\"{}\"",
      one.name, one.reference, name_of(one.variable.causality), name_of(one.variable.variability),
      initial_of(one.variable), escaped(one.variable.description));
  const std::string values = unit_and_start(one.variable, one.axis, start_values(one.axis));
  return version == FmiVersion::fmi2
             ? fmt::format("    <ScalarVariable {}><Real{}/></ScalarVariable>\n", common, values)
             : fmt::format("    <Float64 {}{}/>\n", common, values);
}

// Outputs depend on no input of the same communication point: it acts from there on. When
// initialised they depend on all that was set.
std::string structure(FmiVersion version, const std::vector<Listed>& all) {
  std::string outputs, initial;
  for (std::size_t n = 0; n < all.size(); ++n) {
    if (all[n].variable.causality != Causality::output) continue;
    if (version == FmiVersion::fmi2) {
      outputs += fmt::format("      <Unknown index=\"{}\" dependencies=\"\"/>\n", n + 1);
      initial += fmt::format("      <Unknown index=\"{}\"/>\n", n + 1);
    } else {
      outputs +=
          fmt::format("    <Output valueReference=\"{}\" dependencies=\"\"/>\n", all[n].reference);
      initial += fmt::format("    <InitialUnknown valueReference=\"{}\"/>\n", all[n].reference);
    }
  }
  if (version == FmiVersion::fmi2) {
    outputs = "    <Outputs>\n" + outputs + "    </Outputs>\n";
    initial = "    <InitialUnknowns>\n" + initial + "    </InitialUnknowns>\n";
  }
  return "  <ModelStructure>\n" + outputs + initial + "  </ModelStructure>\n";
}

std::string variables_and_structure(FmiVersion version, const std::vector<AxisConstants>& axes) {
  const std::vector<Listed> all = listed_variables(axes);
  std::string out = "  <ModelVariables>\n";
  for (const Listed& one : all) out += variable_element(version, one);
  return out + "  </ModelVariables>\n" + structure(version, all);
}

// Letters of the axes: "XYZ".
std::string letters(const std::vector<AxisConstants>& axes) {
  std::string out;
  for (const AxisConstants& axis : axes) out += axis.axis;
  return out;
}

std::string description(const std::vector<AxisConstants>& axes) {
  const AxisConstants& first = axes.front();
  std::string out = fmt::format("servo {} {} of {}, scenario {}", axes.size() > 1 ? "axes" : "axis",
                                letters(axes), first.machine.name, first.scenario);
  if (!first.case_name.empty()) out += fmt::format(", case {}", first.case_name);
  return out;
}

}  // namespace

std::string model_description(FmiVersion version, const std::vector<AxisConstants>& axes,
                              std::string_view token) {
  const bool two = version == FmiVersion::fmi2;
  return fmt::format(
             "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
             "<fmiModelDescription fmiVersion=\"{}\" modelName=\"{}\" {}=\"{}\" description=\"{}\" "
             "generationTool=\"servomill {}\" variableNamingConvention=\"{}\">\n",
             two ? "2.0" : "3.0",
             escaped(fmt::format("{}.{}", axes.front().scenario, letters(axes))),
             two ? "guid" : "instantiationToken", escaped(token), escaped(description(axes)),
             escaped(axes.front().program), axes.size() > 1 ? "structured" : "flat") +
         fmt::format(
             "  <CoSimulation modelIdentifier=\"{}\" "
             "canHandleVariableCommunicationStepSize=\"true\" {} {}/>\n",
             kModelIdentifier,
             two ? "canNotUseMemoryManagementFunctions=\"true\" canGetAndSetFMUstate=\"true\" "
                   "canSerializeFMUstate=\"true\""
                 : "canGetAndSetFMUState=\"true\" canSerializeFMUState=\"true\"",
             two ? "providesDirectionalDerivative=\"false\""
                 : "providesDirectionalDerivatives=\"false\"") +
         common_parts(axes) + variables_and_structure(version, axes) + "</fmiModelDescription>\n";
}

}  // namespace servomill::sim::fmu
