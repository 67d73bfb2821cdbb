#include "sim/run/budget_store.h"

#include <fmt/format.h>

#include "sim/model/scenario.h"
#include "sim/records/hdf5_dataset.h"
#include "sim/records/hdf5_group.h"
#include "sim/records/nexus.h"
#include "sim/run/store.h"

namespace servomill::sim::run {
namespace {

records::Hdf5Dataset write(records::Hdf5Group& group, const std::string& name,
                           const records::StoredSignal& signal, const records::Meaning& meaning) {
  records::Hdf5Dataset data =
      group.extendible(name, 1, false, signal.chunk_rows(), records::Storage::float64,
                       records::SignalStore::kCompression, meaning);
  for (std::size_t chunk = 0; chunk < signal.chunks(); ++chunk) {
    const std::vector<std::uint8_t> encoded = signal.encoded(chunk);
    data.append(signal.rows_of(chunk), {&encoded, 1});
  }
  return data;
}

void write(records::Hdf5Group& group, const std::string& name, const BudgetSignal& signal,
           const std::string& help, records::Hdf5Dataset& s) {
  records::Hdf5Dataset data = write(group, name, signal.signal, {"um", help});
  data.attach_scale(s, 0);
  data.attribute("at_place", signal.at_place);
  data.attribute("rms", signal.rms);
}

// Attributes that name the residual of a group.
void write_what(records::Hdf5Group& group, const model::QuantitySpec& quantity) {
  group.attribute("case", quantity.cases.front());
  group.attribute("quantity", quantity.name);
  group.attribute("axis", std::string(1, quantity.axis));
  group.attribute("sections", fmt::format("{}", fmt::join(quantity.sections, ", ")));
  group.attribute("baseline", quantity.baseline);
}

records::Hdf5Dataset write_places(records::Hdf5Group& group, const Budget& budget) {
  records::Hdf5Dataset s =
      write(group, "s", budget.s, {"mm", "arc length on the path of the original program"});
  s.make_scale("s");
  return s;
}

// Joint effects of two causes each, over s: "friction_with_cutting".
void add_pairs(records::Hdf5Group& budget_group, const Budget& budget) {
  records::Hdf5Group group = budget_group.group("pairs");
  write_what(group, budget.quantity);
  records::Hdf5Dataset s = write_places(group, budget);
  const std::string left = "unexplained";
  write(group, left, budget.unexplained, "remainder minus all pairs of causes", s);
  records::Plot plot{left, {"s"}, {}};
  for (const BudgetPair& pair : budget.pairs) {
    const std::string_view a = info_of(pair.causes[0]).name, b = info_of(pair.causes[1]).name;
    plot.others.push_back(fmt::format("{}_with_{}", a, b));
    write(group, plot.others.back(), pair, fmt::format("{} with {}: joint effect", a, b), s);
  }
  records::make_nexus_data(group, plot);
}

// Causes with half of each of their pairs, over s.
void add_shares(records::Hdf5Group& budget_group, const Budget& budget) {
  records::Hdf5Group group = budget_group.group("shares");
  write_what(group, budget.quantity);
  records::Hdf5Dataset s = write_places(group, budget);
  const std::string left = "remainder";
  write(group, left, budget.unexplained, "residual minus all shares", s);
  records::Plot plot{left, {"s"}, {}};
  for (const BudgetPart& part : budget.parts) {
    if (!part.present) continue;
    const CauseInfo& info = info_of(part.cause);
    plot.others.emplace_back(info.name);
    write(group, plot.others.back(), part.share,
          fmt::format("{}, with half of each pair of causes that it is in", info.name), s);
  }
  records::make_nexus_data(group, plot);
}

}  // namespace

BudgetStore::BudgetStore(const std::string& path, bool force, const model::Scenario& scenario)
    : file_(writable_name(path, force), force) {
  file_.remove_unless_committed();
  records::Hdf5Group root = file_.root();
  write_inputs(root, scenario, "budget", "budget");
}

void BudgetStore::add(const Budget& budget) {
  const std::string number = fmt::format("{:03}", count_++);
  records::Hdf5Group all = file_.root().group("budget");
  records::Hdf5Group group = all.group(number);
  records::make_nexus_group(group, "NXcollection");
  write_what(group, budget.quantity);
  group.attribute("note", budget.note);
  if (!budget.note.empty()) return;
  group.attribute("place", budget.place_s);
  if (!all.has_attribute("default")) records::make_nexus_group(all, "NXentry", number);
  records::Hdf5Dataset s = write_places(group, budget);
  write(group, "residual", budget.residual, "residual", s);
  records::Plot plot{"residual", {"s"}, {}};
  for (const BudgetPart& part : budget.parts) {
    if (!part.present) continue;
    plot.others.emplace_back(info_of(part.cause).name);
    const CauseInfo& info = info_of(part.cause);
    write(group, std::string(info.name), part, std::string(info.help), s);
  }
  write(group, "remainder", budget.remainder, "residual minus all parts", s);
  plot.others.push_back("remainder");
  records::make_nexus_data(group, plot);
  if (!budget.pairs.empty()) {
    add_pairs(group, budget);
    add_shares(group, budget);
  }
}

}  // namespace servomill::sim::run
