#include "sim/circular_sections.h"

#include <fmt/format.h>

#include <map>
#include <variant>

#include "sim/comparison.h"
#include "sim/metrology/circular_test.h"
#include "sim/metrology/section_circle.h"
#include "sim/scenario.h"

namespace servomill::sim {
namespace {

struct Section {
  std::variant<SectionCircle, NoCircle> circle;
  Sense sense = Sense::counter_clockwise;
};

Section section_of(const std::vector<Eigen::Vector3d>& positions) {
  Section section{circle_of_section(positions)};
  if (const auto* circle = std::get_if<SectionCircle>(&section.circle)) {
    section.sense = sense_of(circle->in_plane(positions), circle->nominal);
  }
  return section;
}

std::string wrong_alone(const Section& section, const std::string& name, char axis) {
  if (const auto* no = std::get_if<NoCircle>(&section.circle)) {
    return fmt::format("section '{}' {}", name, no->why);
  }
  const auto& circle = std::get<SectionCircle>(section.circle);
  const std::string plane = {"XYZ"[circle.first], "XYZ"[circle.second]};
  if (axis == '\0' || plane.find(axis) != std::string::npos) return "";
  return fmt::format("section '{}' is a circle in {}, where {} does not move", name, plane, axis);
}

std::string wrong_together(const Section& one, const Section& other,
                           const std::vector<std::string>& names) {
  const auto both = fmt::format("sections '{}' and '{}'", names[0], names[1]);
  if (!is_same_circle(std::get<SectionCircle>(one.circle), std::get<SectionCircle>(other.circle))) {
    return both + " are not the same circle";
  }
  if (one.sense != other.sense) return "";
  return both + " turn in one direction; must be one clockwise, one counter-clockwise";
}

}  // namespace

std::vector<Fault> circular_faults(
    const Scenario& scenario,
    const std::function<std::vector<Eigen::Vector3d>(const std::string&)>& positions) {
  std::map<std::string, Section> known;
  const auto section = [&](const std::string& name) -> const Section& {
    const auto found = known.find(name);
    return found != known.end() ? found->second
                                : known.emplace(name, section_of(positions(name))).first->second;
  };
  std::vector<Fault> faults;
  for (const QuantitySpec& quantity : scenario.quantities) {
    if (quantity_info(quantity.name).circles == 0) continue;
    std::string wrong;
    for (const std::string& name : quantity.sections) {
      if (wrong.empty()) wrong = wrong_alone(section(name), name, quantity.axis);
    }
    if (wrong.empty() && quantity.sections.size() == 2) {
      wrong = wrong_together(section(quantity.sections[0]), section(quantity.sections[1]),
                             quantity.sections);
    }
    if (wrong.empty()) continue;
    faults.push_back({quantity.sections_place,
                      fmt::format("{}: {}: {}", quantity.name, scenario.program.file, wrong)});
  }
  return faults;
}

}  // namespace servomill::sim
