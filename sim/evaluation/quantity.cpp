#include "sim/evaluation/quantity.h"

#include <algorithm>
#include <cassert>

#include "sim/evaluation/circular_quantities.h"
#include "sim/evaluation/day_quantities.h"
#include "sim/evaluation/demand_quantities.h"
#include "sim/evaluation/path_quantities.h"
#include "sim/evaluation/probe_quantities.h"
#include "sim/evaluation/r_test_quantities.h"
#include "sim/evaluation/spindle_quantities.h"
#include "sim/evaluation/uncertainty_quantities.h"

namespace servomill::sim::evaluation {

std::span<const QuantityEntry> quantities() {
  static const std::vector<QuantityEntry> kQuantities = [] {
    std::vector<QuantityEntry> all;
    for (const auto family :
         {path_quantities(), uncertainty_quantities(), circular_quantities(), r_test_quantities(),
          probe_quantities(), spindle_quantities(), day_quantities(), demand_quantities()}) {
      all.insert(all.end(), family.begin(), family.end());
    }
    return all;
  }();
  return kQuantities;
}

std::vector<std::string_view> quantity_names() {
  std::vector<std::string_view> out;
  for (const QuantityEntry& entry : quantities()) out.push_back(entry.name);
  return out;
}

const QuantityEntry* find_quantity(std::string_view name) {
  const auto all = quantities();
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const QuantityEntry& entry) { return entry.name == name; });
  return found == all.end() ? nullptr : &*found;
}

const QuantityEntry& quantity_entry(std::string_view name) {
  const QuantityEntry* found = find_quantity(name);
  assert(found != nullptr);
  return *found;
}

}  // namespace servomill::sim::evaluation
