#include "sim/run/budget_store.h"

#include <fmt/format.h>

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
  const model::QuantitySpec& quantity = budget.quantity;
  group.attribute("case", quantity.cases.front());
  group.attribute("quantity", quantity.name);
  group.attribute("axis", std::string(1, quantity.axis));
  group.attribute("sections", fmt::format("{}", fmt::join(quantity.sections, ", ")));
  group.attribute("baseline", quantity.baseline);
  group.attribute("note", budget.note);
  if (!budget.note.empty()) return;
  group.attribute("place", budget.place_s);
  if (!all.has_attribute("default")) records::make_nexus_group(all, "NXentry", number);
  records::Hdf5Dataset s =
      write(group, "s", budget.s, {"mm", "arc length on the path of the original program"});
  s.make_scale("s");
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
}

}  // namespace servomill::sim::run
