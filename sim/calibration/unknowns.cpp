#include <fmt/format.h>

#include <algorithm>

#include "sim/calibration/adjustment.h"

namespace servomill::sim::calibration {

int Unknowns::size() const {
  int out = first_function();
  for (const SoughtFunction& function : functions) out += function.basis.size();
  for (const SoughtGrid& grid : grids) out += grid.basis.size();
  return out;
}

namespace {

// The function or grid that has an unknown; nullptr: none of them.
template <typename Sought>
const Sought* owner_of(const std::vector<Sought>& all, int unknown) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const Sought& one) {
    return unknown >= one.first && unknown < one.first + one.basis.size();
  });
  return found == all.end() ? nullptr : &*found;
}

}  // namespace

std::string name_of(const SoughtGrid& grid) {
  const auto& axes = grid.basis.form().axes;
  return fmt::format("{} over {} and {}", plant::to_string(grid.name), letter(axes[0]),
                     letter(axes[1]));
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
  if (const SoughtFunction* function = owner_of(functions, unknown)) {
    return plant::to_string(function->name);
  }
  return name_of(*owner_of(grids, unknown));
}

std::optional<double> Unknowns::prior(int unknown) const {
  if (unknown < first_location()) return set_up[static_cast<std::size_t>(unknown)].prior;
  if (unknown < first_function()) {
    return locations[static_cast<std::size_t>(unknown - first_location())].size;
  }
  if (const SoughtFunction* function = owner_of(functions, unknown)) return function->size;
  return owner_of(grids, unknown)->size;
}

double GroupResult::ratio() const {
  if (!(redundancy > 0.0)) return 0.0;
  return rms * rms * double(numbers) / (redundancy * uncertainty * uncertainty);
}

}  // namespace servomill::sim::calibration
