#include "sim/evaluation/outputs_read.h"

#include "sim/evaluation/quantity.h"
#include "sim/model/scenario.h"

namespace servomill::sim::evaluation {

engine::RunOutputs outputs_read_by(std::span<const model::QuantitySpec> quantities) {
  engine::RunOutputs out{.signals = engine::RunOutputs::Names(), .demands = false};
  out.last_ticks = false;
  for (const model::QuantitySpec& spec : quantities) {
    const QuantityEntry& entry = quantity_entry(spec.name);
    out.demands |= entry.reads_demands;
    if (!entry.reads) out.signals.reset();
    if (!out.signals) continue;
    out.signals->insert(entry.reads->begin(), entry.reads->end());
  }
  return out;
}

}  // namespace servomill::sim::evaluation
