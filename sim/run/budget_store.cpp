#include "sim/run/budget_store.h"

#include <fmt/format.h>

#include "sim/run/store.h"

namespace servomill::sim {
namespace {

void write_signal(Hdf5Group& group, const std::string& name, const std::vector<double>& signal,
                  const std::string& help, double at_place, double rms) {
  group.list(name, signal, {"um", help}, "s");
  Hdf5Dataset data = group.dataset(name);
  data.attribute("at_place", at_place);
  data.attribute("rms", rms);
}

}  // namespace

BudgetStore::BudgetStore(const std::string& path, bool force, const Scenario& scenario)
    : file_(writable_name(path, force), force) {
  file_.remove_unless_committed();
  Hdf5Group root = file_.root();
  write_inputs(root, scenario, "budget");
}

void BudgetStore::add(const Budget& budget) {
  Hdf5Group group = file_.root().group(fmt::format("budget/{:03}", count_++));
  const QuantitySpec& quantity = budget.quantity;
  group.attribute("case", quantity.cases.front());
  group.attribute("quantity", quantity.name);
  group.attribute("axis", std::string(1, quantity.axis));
  group.attribute("sections", fmt::format("{}", fmt::join(quantity.sections, ", ")));
  group.attribute("base", quantity.base);
  group.attribute("note", budget.note);
  if (!budget.note.empty()) return;
  group.attribute("place", budget.s[budget.place]);
  group.list("s", budget.s, {"mm", "arc length on the path of the original program"});
  write_signal(group, "residual", budget.residual, "residual", budget.residual_at_place(),
               budget.residual_rms());
  for (const BudgetPart& part : budget.parts) {
    if (!part.present) continue;
    const CauseInfo& info = info_of(part.cause);
    write_signal(group, std::string(info.name), part.signal, std::string(info.help), part.at_place,
                 part.rms);
  }
  write_signal(group, "remainder", budget.remainder, "residual minus all parts",
               budget.remainder_at_place(), budget.remainder_rms);
}

}  // namespace servomill::sim
