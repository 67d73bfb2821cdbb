#include "sim/identification/parameter_space.h"

#include <fmt/format.h>

#include <array>
#include <cassert>
#include <cmath>
#include <optional>

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

config::Document with_values(const config::Document& document, std::span<const Estimate> estimates,
                             std::size_t record) {
  config::Document changed = document;
  for (const Estimate& one : estimates) {
    if (!one.is_for(record)) continue;
    for (const std::string& key : one.keys) {
      const std::string value = "=" + written(one.start, one.unit);
      changed.set(document_key(key) + value);
      if (one.of_nc && !key.starts_with("loop.")) changed.set("controller." + key + value);
    }
  }
  return changed;
}

namespace {

// Drives and encoders of a machine, for comparison.
bool are_equal_plants(const model::MachineSettings& a, const model::MachineSettings& b) {
  return a.drives == b.drives;
}

// An estimate a little beside its start, to the side that the machine allows.
std::optional<model::MachineSettings> beside_start(const config::Document& document,
                                                   const Estimate& estimate) {
  constexpr double kShare = 1e-3;
  const double step = estimate.start != 0.0 ? kShare * std::abs(estimate.start) : kShare;
  for (const double side : {step, -step}) {
    try {
      return model_of(document, {&estimate, 1}, std::array{estimate.start + side}, estimate.record)
          .machine;
    } catch (const InputError&) {
      continue;
    }
  }
  return std::nullopt;
}

}  // namespace

void add_controller(config::Document& document, std::vector<Estimate>& estimates) {
  for (Estimate& one : estimates) {
    const model::MachineSettings before =
        model_of(document, {&one, 1}, {&one.start, 1}, one.record).machine;
    const auto after = beside_start(document, one);
    one.of_nc = after && are_equal_plants(before, *after);
  }
  config::Value controller = *document.root().find("machine");
  controller.key = "controller";
  config::Value root;
  root.children.push_back(std::move(controller));
  document.merge(root);
}

char letter_of(const Experiment& experiment, int joint) {
  return model_of(experiment.document, {}, {}).machine.chain.layout.letter_of(joint);
}

ModelOfValues model_of(const config::Document& document, std::span<const Estimate> estimates,
                       std::span<const double> values, std::size_t record) {
  assert(estimates.size() == values.size());
  std::vector<Estimate> at(estimates.begin(), estimates.end());
  for (std::size_t k = 0; k < at.size(); ++k) at[k].start = values[k];
  const config::Document changed = with_values(document, at, record);
  config::Reader root(changed);
  for (const std::string& key : root.keys()) {
    if (key != "machine" && key != "loop" && key != "controller") root.raw(key);
  }
  config::Reader loop = root.table("loop");
  ModelOfValues out;
  out.loop = read_loop(loop);
  out.machine = read_axes(root);
  if (root.has("controller")) {
    config::Reader controller = root.table("controller");
    out.machine.nc = input::read_machine(controller).nc;
  }
  root.finish();
  return out;
}

}  // namespace servomill::sim::identification
