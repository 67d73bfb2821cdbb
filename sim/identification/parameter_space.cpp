#include "sim/identification/parameter_space.h"

#include <fmt/format.h>

#include <cassert>

#include "sim/input/read_machine.h"

namespace servomill::sim::identification {

std::string document_key(const std::string& key) {
  return key.starts_with("loop.") ? key : "machine." + key;
}

model::MachineSettings read_axes(config::Reader& root) {
  config::Reader machine = root.table("machine");
  return input::read_machine(machine);
}

std::string written(double value, const std::string& unit) {
  return unit.empty() ? fmt::format("{}", value) : fmt::format("\"{} {}\"", value, unit);
}

config::Document with_values(const config::Document& document,
                             std::span<const Estimate> estimates) {
  config::Document changed = document;
  for (const Estimate& one : estimates) {
    for (const std::string& key : one.keys) {
      changed.set(document_key(key) + "=" + written(one.start, one.unit));
    }
  }
  return changed;
}

char letter_of(const Experiment& experiment, int joint) {
  return model_of(experiment.document, {}, {}).machine.chain.layout.letter_of(joint);
}

ModelOfValues model_of(const config::Document& document, std::span<const Estimate> estimates,
                       std::span<const double> values) {
  assert(estimates.size() == values.size());
  std::vector<Estimate> at(estimates.begin(), estimates.end());
  for (std::size_t k = 0; k < at.size(); ++k) at[k].start = values[k];
  const config::Document changed = with_values(document, at);
  config::Reader root(changed);
  for (const std::string& key : root.keys()) {
    if (key != "machine" && key != "loop") root.raw(key);
  }
  config::Reader loop = root.table("loop");
  ModelOfValues out;
  out.loop = read_loop(loop);
  out.machine = read_axes(root);
  root.finish();
  return out;
}

}  // namespace servomill::sim::identification
