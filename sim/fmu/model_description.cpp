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

std::string units(const AxisConstants& axis) {
  std::string out = "  <UnitDefinitions>\n";
  std::set<std::string_view> defined;
  for (const Variable& variable : variables()) {
    const Unit& unit = unit_of(variable.kind, axis);
    if (variable.kind == Kind::ratio || !defined.insert(unit.name).second) continue;
    out += fmt::format("    <Unit name=\"{}\"><BaseUnit", unit.name);
    const std::pair<const char*, int> powers[] = {
        {"kg", unit.kg}, {"m", unit.m}, {"s", unit.s}, {"A", unit.A}, {"rad", unit.rad}};
    for (const auto& [base, power] : powers) {
      if (power != 0) out += fmt::format(" {}=\"{}\"", base, power);
    }
    out += "/></Unit>\n";
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
std::string common_parts(const AxisConstants& axis) {
  const model::LoopPeriods& periods = axis.machine.nc.periods;
  return units(axis) + log_categories() +
         fmt::format("  <DefaultExperiment startTime=\"0\" stepSize=\"{:.12g}\"/>\n",
                     periods.seconds(periods.position));
}

std::string variables2(const AxisConstants& axis) {
  const Values values = start_values(axis);
  std::string out = "  <ModelVariables>\n";
  for (const Variable& one : variables()) {
    out += fmt::format(
        "    <ScalarVariable name=\"{}\" valueReference=\"{}\" causality=\"{}\" "
        "variability=\"{}\"{} "
        "description=\"{}\"><Real{}/></ScalarVariable>\n",
        one.name, one.reference, name_of(one.causality), name_of(one.variability), initial_of(one),
        escaped(one.description), unit_and_start(one, axis, values));
  }
  return out + "  </ModelVariables>\n";
}

// Outputs depend on no input of the same communication point: it acts from there on. When
// initialised they depend on all that was set.
std::string structure2() {
  std::string outputs, initial;
  for (const Variable& one : variables()) {
    if (one.causality != Causality::output) continue;
    const std::uint32_t index = one.reference + 1;  // variables are listed by reference
    outputs += fmt::format("      <Unknown index=\"{}\" dependencies=\"\"/>\n", index);
    initial += fmt::format("      <Unknown index=\"{}\"/>\n", index);
  }
  return "  <ModelStructure>\n    <Outputs>\n" + outputs +
         "    </Outputs>\n    <InitialUnknowns>\n" + initial +
         "    </InitialUnknowns>\n  </ModelStructure>\n";
}

std::string variables3(const AxisConstants& axis) {
  const Values values = start_values(axis);
  std::string out = "  <ModelVariables>\n";
  for (const Variable& one : variables()) {
    out += fmt::format(
        "    <Float64 name=\"{}\" valueReference=\"{}\" causality=\"{}\" variability=\"{}\"{} "
        "description=\"{}\"{}/>\n",
        one.name, one.reference, name_of(one.causality), name_of(one.variability), initial_of(one),
        escaped(one.description), unit_and_start(one, axis, values));
  }
  return out + "  </ModelVariables>\n";
}

std::string structure3() {
  std::string outputs, initial;
  for (const Variable& one : variables()) {
    if (one.causality != Causality::output) continue;
    outputs +=
        fmt::format("    <Output valueReference=\"{}\" dependencies=\"\"/>\n", one.reference);
    initial += fmt::format("    <InitialUnknown valueReference=\"{}\"/>\n", one.reference);
  }
  return "  <ModelStructure>\n" + outputs + initial + "  </ModelStructure>\n";
}

std::string model_name(const AxisConstants& axis) {
  return fmt::format("{}.{}", axis.scenario, axis.axis);
}

std::string description(const AxisConstants& axis) {
  std::string out =
      fmt::format("servo axis {} of {}, scenario {}", axis.axis, axis.machine.name, axis.scenario);
  if (!axis.case_name.empty()) out += fmt::format(", case {}", axis.case_name);
  return out;
}

}  // namespace

std::string model_description(FmiVersion version, const AxisConstants& axis,
                              std::string_view token) {
  const bool two = version == FmiVersion::fmi2;
  return fmt::format(
             "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
             "<fmiModelDescription fmiVersion=\"{}\" modelName=\"{}\" {}=\"{}\" description=\"{}\" "
             "generationTool=\"servomill {}\" variableNamingConvention=\"flat\">\n",
             two ? "2.0" : "3.0", escaped(model_name(axis)), two ? "guid" : "instantiationToken",
             escaped(token), escaped(description(axis)), escaped(axis.program)) +
         fmt::format(
             "  <CoSimulation modelIdentifier=\"{}\" "
             "canHandleVariableCommunicationStepSize=\"true\" {} {}/>\n",
             kModelIdentifier,
             two ? "canNotUseMemoryManagementFunctions=\"true\" canGetAndSetFMUstate=\"true\" "
                   "canSerializeFMUstate=\"true\""
                 : "canGetAndSetFMUState=\"true\" canSerializeFMUState=\"true\"",
             two ? "providesDirectionalDerivative=\"false\""
                 : "providesDirectionalDerivatives=\"false\"") +
         common_parts(axis) +
         (two ? variables2(axis) + structure2() : variables3(axis) + structure3()) +
         "</fmiModelDescription>\n";
}

}  // namespace servomill::sim::fmu
