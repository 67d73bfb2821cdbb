#include "sim/preparation/circular_sections.h"

#include <fmt/format.h>

#include "sim/evaluation/quantity.h"
#include "sim/model/scenario.h"

namespace servomill::sim::preparation {
namespace {

std::string wrong_alone(const CircularSection& section, const std::string& name, char axis) {
  if (const auto* no = std::get_if<metrology::NoCircle>(&section.circle)) {
    return fmt::format("section '{}' {}", name, no->why);
  }
  const auto& circle = std::get<metrology::SectionCircle>(section.circle);
  const std::string plane = {"XYZ"[circle.first], "XYZ"[circle.second]};
  if (axis == '\0' || plane.find(axis) != std::string::npos) return "";
  return fmt::format("section '{}' is a circle in {}, where {} does not move", name, plane, axis);
}

std::string wrong_together(const CircularSection& one, const CircularSection& other,
                           const std::vector<std::string>& names) {
  const auto both = fmt::format("sections '{}' and '{}'", names[0], names[1]);
  if (!metrology::is_same_circle(std::get<metrology::SectionCircle>(one.circle),
                                 std::get<metrology::SectionCircle>(other.circle))) {
    return both + " are not the same circle";
  }
  if (one.sense != other.sense) return "";
  return both + " have the same direction; must be one clockwise and one counter-clockwise";
}

}  // namespace

CircularSection circular_section(const std::vector<Eigen::Vector3d>& positions) {
  CircularSection section{metrology::circle_of_section(positions)};
  if (const auto* circle = std::get_if<metrology::SectionCircle>(&section.circle)) {
    section.sense = metrology::sense_of(circle->in_plane(positions), circle->nominal);
  }
  return section;
}

std::set<std::string> circular_section_names(const model::Scenario& scenario) {
  std::set<std::string> names;
  for (const model::QuantitySpec& quantity : scenario.quantities) {
    if (evaluation::quantity_entry(quantity.name).circles == 0) continue;
    names.insert(quantity.sections.begin(), quantity.sections.end());
  }
  return names;
}

std::vector<Fault> circular_faults(const model::Scenario& scenario,
                                   const std::map<std::string, CircularSection>& sections) {
  std::vector<Fault> faults;
  for (const model::QuantitySpec& quantity : scenario.quantities) {
    if (evaluation::quantity_entry(quantity.name).circles == 0) continue;
    std::string wrong;
    for (const std::string& name : quantity.sections) {
      if (wrong.empty()) wrong = wrong_alone(sections.at(name), name, quantity.axis);
    }
    if (wrong.empty() && quantity.sections.size() == 2) {
      wrong = wrong_together(sections.at(quantity.sections[0]), sections.at(quantity.sections[1]),
                             quantity.sections);
    }
    if (wrong.empty()) continue;
    faults.push_back({quantity.sections_place,
                      fmt::format("{}: {}: {}", quantity.name, scenario.program.file, wrong)});
  }
  return faults;
}

}  // namespace servomill::sim::preparation
