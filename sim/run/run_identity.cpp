#include "sim/run/run_identity.h"

#include <utility>

#include "sim/config/parse_toml.h"
#include "sim/engine/simulate.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "sim/preparation/prepared_case.h"

namespace servomill::sim::run {
namespace {

void add_outputs(const engine::RunOutputs& outputs, std::string& text) {
  text += outputs.demands ? "\ndemands" : "\n";
  text += outputs.last_ticks ? "\nlast ticks" : "\n";
  if (!outputs.signals) return;
  for (const std::string& signal : *outputs.signals) text += "\n" + signal;
}

}  // namespace

config::Value document_of_run(std::string_view toml, std::size_t number) {
  config::Value root = config::parse_toml(toml, "");
  std::erase_if(root.children, [](const config::Value& table) {
    return table.key == "errors" || table.key == "quantity" || table.key == "sweep";
  });
  if (config::Value* const cases = root.find("case")) {
    config::Value own = std::move(cases->children.at(number));
    cases->children.clear();
    cases->children.push_back(std::move(own));
  }
  return root;
}

RunIdentity::RunIdentity(const preparation::PreparedCase& prepared,
                         const engine::CaseInputs& inputs, std::size_t number) {
  const preparation::PreparedParts p = prepared.parts();
  const bool learns = !p.lessons.empty();
  if (inputs.machine.heat || inputs.keeping.thinning || learns || !inputs.stops_with.empty())
    return;
  resolved_ = &p.scenario.resolved;
  number_ = number;
  add_outputs(inputs.outputs, outputs_);
  prepared_ = {&p.program, &p.motion, p.rewritten, p.cutting, p.imposed, &inputs.machine_errors};
  for (const auto& strategy : p.strategies) prepared_.push_back(strategy.get());
}

const config::Value& RunIdentity::document() const {
  if (!document_) document_ = document_of_run(*resolved_, number_);
  return *document_;
}

bool RunIdentity::is_same_as(const RunIdentity& other) const {
  if (resolved_ == nullptr || other.resolved_ == nullptr) return false;
  return prepared_ == other.prepared_ && outputs_ == other.outputs_ &&
         config::same_value(document(), other.document());
}

}  // namespace servomill::sim::run
