#include <fmt/format.h>

#include <algorithm>

#include "sim/calibration/adjustment.h"

namespace servomill::sim::calibration {

int Unknowns::size() const {
  int out = first_function();
  for (const SoughtFunction& function : functions) out += function.basis.size();
  return out;
}

std::string Unknowns::name(int unknown, const readings::Readings& readings) const {
  if (unknown < first_location()) {
    const SetUpUnknown& one = set_up[static_cast<std::size_t>(unknown)];
    return one.group ? fmt::format("{} of \"{}\"", one.name, readings.groups[*one.group].name)
                     : one.name;
  }
  if (unknown < first_function()) {
    return plant::to_string(locations[static_cast<std::size_t>(unknown - first_location())].name);
  }
  const auto found =
      std::find_if(functions.begin(), functions.end(), [&](const SoughtFunction& function) {
        return unknown < function.first + function.basis.size();
      });
  return plant::to_string(found->name);
}

std::optional<double> Unknowns::prior(int unknown) const {
  if (unknown < first_location()) return set_up[static_cast<std::size_t>(unknown)].prior;
  if (unknown < first_function()) {
    return locations[static_cast<std::size_t>(unknown - first_location())].size;
  }
  const auto found = std::find_if(functions.begin(), functions.end(), [&](const SoughtFunction& f) {
    return unknown < f.first + f.basis.size();
  });
  return found->size;
}

double GroupResult::ratio() const {
  if (!(redundancy > 0.0)) return 0.0;
  return rms * rms * double(numbers) / (redundancy * uncertainty * uncertainty);
}

}  // namespace servomill::sim::calibration
