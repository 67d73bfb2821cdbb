#include "sim/run/stored_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <system_error>

#include "plant/vocabulary/input_error.h"
#include "sim/input/read_scenario.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "sim/records/input_file.h"
#include "sim/records/row_keeper.h"
#include "sim/run/day_course.h"
#include "sim/run/result_file.h"
#include "sim/run/store_day.h"
#include "sim/run/store_demands.h"
#include "sim/run/store_probes.h"

namespace servomill::sim::run {
namespace {

// Recorded signals in a file, read when they are asked for.
class StoredPages final : public records::ColumnPages {
 public:
  StoredPages(std::shared_ptr<const records::InputFile> file, const std::string& group,
              const std::vector<records::Signal>& signals, std::size_t rows)
      : file_(std::move(file)), rows_(rows) {
    for (const records::Signal& signal : signals) {
      for (std::size_t c = 0; c < signal.columns(); ++c) {
        columns_.push_back({group + "/" + signal.name, c});
      }
    }
  }
  std::size_t rows() const override { return rows_; }
  std::size_t page_rows() const override { return kPageRows; }
  void read(std::size_t column, std::size_t page, std::vector<double>& values) const override {
    const auto& [dataset, number] = columns_[column];
    const std::size_t first = page * kPageRows;
    values = file_->column(dataset, number, first, std::min(kPageRows, rows_ - first));
  }
  bool read_encoded(std::size_t, std::size_t, std::vector<std::uint8_t>&) const override {
    return false;
  }

 private:
  static constexpr std::size_t kPageRows = 16384;
  std::shared_ptr<const records::InputFile> file_;
  std::size_t rows_;
  std::vector<std::pair<std::string, std::size_t>> columns_;
};

struct StoredSignals {
  std::vector<records::Signal> signals;
  std::size_t rows = 0;
};

// Signals of one group, in the order in which they were written.
StoredSignals signals_of(const records::InputFile& file, const std::string& group) {
  StoredSignals out;
  auto& [signals, rows] = out;
  for (const std::string& name : file.datasets(group)) {
    const std::string path = group + "/" + name;
    if (name.starts_with("axis") || name == "xyz" || name == "ijk") continue;  // labels
    const auto shape = file.shape(path);
    if (shape.empty() || shape.size() > 2 || (!signals.empty() && shape[0] != rows)) {
      throw InputError({file.path()},
                       fmt::format("'{}' differs in length from the earlier signals", path));
    }
    std::string labels;
    if (shape.size() == 2) labels = file.text(path, "columns");
    rows = shape.at(0);
    const records::Meaning meaning = file.meaning(path);
    signals.push_back({name, meaning.units, meaning.long_name, labels, ""});
  }
  return out;
}

// Rows from `first` to before `end`, of signals one behind the other.
void copy_rows(const std::vector<std::vector<double>>& of_signals, const records::Series& series,
               std::size_t first, std::size_t end, double* to) {
  for (std::size_t row = first; row < end; ++row) {
    for (std::size_t n = 0; n < of_signals.size(); ++n) {
      const std::size_t width = series.signals()[n].columns();
      to = std::copy_n(of_signals[n].data() + row * width, width, to);
    }
  }
}

// Columns of one group read back; of long recordings when they are asked for.
std::unique_ptr<records::Series> read_series(const std::shared_ptr<const records::InputFile>& file,
                                             const std::string& group) {
  auto [signals, rows] = signals_of(*file, group);
  auto series = std::make_unique<records::Series>(signals);
  const auto size = static_cast<double>(rows * series->width() * sizeof(double));
  if (size > records::RowKeeping().most_in_memory) {
    auto pages = std::make_shared<StoredPages>(file, group, series->signals(), rows);
    return std::make_unique<records::Series>(std::move(signals), std::move(pages));
  }
  std::vector<std::vector<double>> columns;
  for (const records::Signal& signal : signals)
    columns.push_back(file->values(group + "/" + signal.name));
  series->reserve(rows);
  constexpr std::size_t kRowsAtOnce = 256;
  std::vector<double> values;
  for (std::size_t first = 0; first < rows; first += kRowsAtOnce) {
    const std::size_t end = std::min(first + kRowsAtOnce, rows);
    values.resize((end - first) * series->width());
    copy_rows(columns, *series, first, end, values.data());
    series->append(values);
  }
  return series;
}

// Signals that a case has only if it is loaded by cutting forces or its structure gives way to
// acceleration: another one of the same run may be in air, or rigid. So with temperatures.
constexpr std::array<std::string_view, 5> kOfSomeCases = {"cutting_force", "structural_deflection",
                                                          "inertial_deflection", "spindle_angle",
                                                          "bed_displacement"};

// Checks that a group has the signals that every comparison needs, and those of the other cases.
void check_signals(const records::InputFile& file, const std::string& group,
                   const records::Series& series, const records::Series& first) {
  std::vector<std::string> needed = {"s", "rapid", "section"};
  for (const records::Signal& signal : first.signals()) {
    const bool may_miss =
        signal.name.starts_with("temperature_") || signal.name.starts_with("sensor_") ||
        std::find(kOfSomeCases.begin(), kOfSomeCases.end(), signal.name) != kOfSomeCases.end();
    if (!may_miss) needed.push_back(signal.name);
  }
  for (const std::string& name : needed) {
    const auto& has = series.signals();
    if (std::any_of(has.begin(), has.end(),
                    [&](const records::Signal& one) { return one.name == name; })) {
      continue;
    }
    throw InputError({file.path()}, fmt::format("has no '{}/{}'", group, name));
  }
}

// Chain of the ideal machine of a case.
plant::MachineChain chain_of(const model::Scenario& scenario, const std::string& name) {
  const model::CaseSpec* one = scenario.find_case(name);
  return (one != nullptr ? scenario.machine_of(*one) : scenario.machine).chain;
}

// Delay by the feedback hardware of a case.
std::optional<double> signal_delay_of(const model::Scenario& scenario, const std::string& name) {
  const model::CaseSpec* one = scenario.find_case(name);
  return one != nullptr ? scenario.signal_delay_of(*one) : std::nullopt;
}

// Rows that the windows of a recording left out, by section.
std::vector<std::size_t> left_out_of(const records::InputFile& file, const std::string& group) {
  std::vector<std::size_t> out;
  if (!file.has_attribute(group, "rows_left_out")) return out;
  for (const std::string& rows : split_lines(file.text(group, "rows_left_out"))) {
    std::size_t number = 0;
    if (std::from_chars(rows.data(), rows.data() + rows.size(), number).ec != std::errc{}) {
      throw InputError({file.path()}, fmt::format("'{}' has wrong rows_left_out", group));
    }
    out.push_back(number);
  }
  return out;
}

void check_schema(const records::InputFile& file, const std::string& path,
                  const std::string& kind) {
  if (!file.has_attribute("/", "schema_version")) {
    throw InputError({path}, "is not a result file of servomill");
  }
  if (file.has_attribute("/", "kind") && file.text("/", "kind") != kind) {
    throw InputError({path}, fmt::format("contains a {}, not a {}", file.text("/", "kind"), kind));
  }
  const auto version = static_cast<int>(file.number("/", "schema_version"));
  if (version != kSchemaVersion) {
    throw InputError({path}, fmt::format("has schema version {}; this program reads version {}",
                                         version, kSchemaVersion));
  }
}

}  // namespace

StoredRun read_run(const std::string& path) {
  const auto opened = std::make_shared<const records::InputFile>(path);
  const records::InputFile& file = *opened;
  check_schema(file, path, "run");
  StoredRun run;
  run.scenario_name = file.text("/", "scenario");
  run.title = file.text("/", "title");
  const model::Scenario scenario = input::read_resolved_scenario(
      file.text("/inputs", "resolved"), path + ":/inputs",
      std::make_shared<const StoredText>(file.stored_text("/inputs", "program")));
  run.quantities = scenario.quantities;
  for (const std::string& name : file.groups("/cases")) {
    const std::string group = "/cases/" + name;
    // cut off while it was written: no complete case
    if (!file.has("/comparison") && !file.has_attribute(group, "finished")) continue;
    run.series.push_back(read_series(opened, group + "/servo"));
    check_signals(file, group + "/servo", *run.series.back(), *run.series.front());
    run.probes.push_back(std::make_unique<std::vector<evaluation::ProbedFeature>>(
        read_probed(file, group + "/probes", scenario.probes)));
    const std::vector<evaluation::ProbedFeature>& probes = *run.probes.back();
    const std::shared_ptr<const DayCourse> day = read_day(file, group + "/day");
    if (day) run.days.push_back({name, day});
    run.cases.push_back({name, run.series.back().get(), split_lines(file.text(group, "sections")),
                         file.number(group, "duration_s"), file.number(group, "blocks"),
                         file.number(group, "finished") != 0.0, chain_of(scenario, name),
                         probes.empty() ? nullptr : &probes, signal_delay_of(scenario, name),
                         scenario.uncertain, left_out_of(file, group)});
    if (day && !day->cycles.empty()) run.cases.back().day = figures_of(*day);
    run.cases.back().demands = read_demands(file, group + "/demands");
  }
  return run;
}

}  // namespace servomill::sim::run
