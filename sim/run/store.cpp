#include "sim/run/store.h"

#include <fmt/format.h>

#include <algorithm>

#include "plant/vocabulary/simd.h"
#include "sim/evaluation/comparison_row.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "sim/records/hdf5_group.h"
#include "sim/records/nexus.h"
#include "sim/records/shared_signals.h"
#include "sim/run/day_course.h"
#include "sim/run/run_case.h"
#include "sim/run/store_chain.h"
#include "sim/run/store_day.h"
#include "sim/run/store_demands.h"
#include "sim/run/store_errors.h"
#include "sim/run/store_learnt.h"
#include "sim/run/store_probes.h"
#include "sim/run/store_sections.h"
#include "sim/run/store_series.h"
#include "sim/run/store_tests.h"
#include "sim/run/touch_record.h"

namespace servomill::sim::run {
namespace {

constexpr const char* kUnfinished = "unfinished";  // group of a case until it is complete
constexpr std::size_t kRoomOfAttributes = 8;       // as names of cases take

void write_row(records::Hdf5Group& group, const evaluation::ComparisonRow& row) {
  group.attribute("case", row.case_name);
  group.attribute("quantity", row.quantity);
  group.attribute("axis", row.axis);
  group.attribute("statistic", row.statistic);
  group.attribute("sections", row.sections);
  group.attribute("reference", row.reference);
  group.attribute("basis", row.basis);
  if (!row.note.empty()) group.attribute("note", row.note);
}

}  // namespace

void write_inputs(records::Hdf5Group& root, const model::Scenario& scenario, std::string_view kind,
                  const std::string& shown) {
  root.attribute("Conventions", "CF-1.8");
  write_build(root);
  root.attribute("schema_version", kSchemaVersion);
  root.attribute("kind", kind);
  records::make_nexus_group(root, "NXroot", shown);
  root.attribute("simd_level", name_of(simd_level()));
  root.attribute("scenario", scenario.name);
  root.attribute("title", scenario.title);
  root.attribute("source", scenario.source);
  records::Hdf5Group inputs = root.group("inputs");
  records::make_nexus_group(inputs, "NXcollection");
  inputs.attribute("scenario", scenario.text);
  inputs.attribute("machine", scenario.machine_text);
  inputs.write_text("program", *scenario.program.shared_text);
  inputs.attribute("resolved", scenario.resolved);
}

// Form of the signals, and those of the complete cases.
struct RunStore::Signals {
  SeriesFormat format;
  records::SharedSignals shared;
};

RunStore::RunStore(const std::string& path, bool force, const model::Scenario& scenario,
                   unsigned threads)
    : file_(writable_name(path, force), force),
      shown_(scenario.cases.front().name),
      signals_(std::make_unique<Signals>(
          Signals{{{scenario.record_period, scenario.machine.nc.periods.base},
                   scenario.record.compression,
                   threads},
                  {}})) {
  records::Hdf5Group root = file_.root();
  write_inputs(root, scenario, "run", "cases");
  write_errors(root, scenario);
  std::size_t longest_name = 0;
  for (const model::CaseSpec& one : scenario.cases)
    longest_name = std::max(longest_name, one.name.size());
  // room for the attributes that show the first case, too
  records::Hdf5Group cases =
      root.group_with_room("cases", scenario.cases.size() + kRoomOfAttributes, longest_name);
  records::make_nexus_group(cases, "NXentry", shown_);
  root.group_with_room(kUnfinished, 1, longest_name);
  root.flush_file();
}

RunStore::RunStore(RunStore&&) noexcept = default;
RunStore::~RunStore() = default;

void RunStore::add(const CaseOutput& one) {
  records::Hdf5Group root = file_.root();
  const std::string unfinished = fmt::format("{}/{}", kUnfinished, one.name);
  records::Hdf5Group group = root.group(unfinished);
  records::make_nexus_group(group, "NXsubentry", "servo");
  write_chain(group, one.chain);
  const SeriesFormat& format = signals_->format;
  const auto pages = encoded_pages(one.result.servo, format);
  const records::SeriesLayout servo =
      write_series(group.group("servo"), one.result.servo, *pages, format, signals_->shared);
  if (const records::Series& ticks = one.result.last_ticks; ticks.rows() > 0) {
    write_series(group.group("last_ticks"), ticks, *encoded_pages(ticks, format), format);
  }
  if (!one.probes.empty()) write_probes(group.group("probes"), one.probes, one.frame, one.part_fit);
  if (!one.touches.empty()) write_touches(group.group("touches"), one.touches, one.chain.layout);
  if (!one.tests.empty()) write_tests(group.group("tests"), one.tests);
  write_sections(group.group("sections"), passes_of(one.result.servo), one.sections);
  if (!one.learnt.empty()) {
    records::Hdf5Group learnt = group.group("learnt");
    records::make_nexus_group(learnt, "NXcollection", one.learnt.front().strategy);
    for (const LearntRuns& runs : one.learnt) write_learnt(learnt, runs, one.chain.layout);
  }
  if (!one.demands.empty()) write_demands(group.group("demands"), one.demands);
  if (one.day) write_day(group.group("day"), *one.day);
  group.attribute("outcome", one.result.outcome.reason);
  group.attribute("duration_s", one.duration);
  group.attribute("blocks", static_cast<std::int64_t>(one.blocks));
  group.attribute("sections", fmt::format("{}", fmt::join(one.sections, "\n")));
  if (one.program != nullptr) group.write_text("program", *one.program);
  if (!one.result.left_out.empty()) {
    group.attribute("rows_left_out", fmt::format("{}", fmt::join(one.result.left_out, "\n")));
  }
  group.attribute("finished", one.result.outcome.finished ? 1 : 0);
  // A kill meanwhile spoils nothing but this case; from now on it is one of the complete ones.
  root.flush_file();
  root.move(unfinished, "cases/" + one.name);
  signals_->shared.add(fmt::format("/cases/{}/servo", one.name), one.result.servo.rows(), servo);
  // the first case ended without result, as that of a plug-in that crashed
  if (!has_case_ && one.name != shown_) root.group("cases").attribute("default", one.name);
  has_case_ = true;
  root.flush_file();
}

void RunStore::commit(const std::vector<evaluation::ComparisonRow>& comparison) {
  file_.root().remove(kUnfinished);
  records::Hdf5Group table = file_.root().group("comparison");
  records::make_nexus_group(table, "NXcollection");
  for (std::size_t i = 0; i < comparison.size(); ++i) {
    records::Hdf5Group group = table.group(fmt::format("{:03}", i));
    records::make_nexus_group(group, "NXcollection");
    write_row(group, comparison[i]);
    group.scalar("value", comparison[i].value, {comparison[i].unit, comparison[i].quantity});
  }
  file_.commit();
}

}  // namespace servomill::sim::run
