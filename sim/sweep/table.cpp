#include "sim/sweep/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <limits>
#include <numeric>
#include <set>

#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/progress.h"
#include "plant/vocabulary/user_file.h"
#include "sim/config/written_number.h"
#include "sim/records/hdf5_dataset.h"
#include "sim/records/hdf5_group.h"
#include "sim/records/input_file.h"
#include "sim/records/nexus.h"
#include "sim/run/build_identity.h"
#include "sim/run/store.h"
#include "sim/sweep/table_csv.h"
#include "sim/sweep/table_header.h"
#include "sim/system/output_name.h"

namespace servomill::sim::sweep {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kReasonBytes = 240;

bool exists(const std::string& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

// The number that stands for a level in the column simd_level; 0 stands for none.
double number_of_level(SimdLevel level) { return 1.0 + static_cast<double>(level); }

void add_level(std::set<SimdLevel>& levels, double number) {
  for (const SimdLevel level : kSimdLevels) {
    if (number_of_level(level) == number) levels.insert(level);
  }
}

}  // namespace

SweepTable::SweepTable(const std::string& path, bool force, const model::Scenario& base,
                       std::vector<TableColumn> columns, const Selection& selection)
    : path_(path),
      selection_(selection),
      columns_(std::move(columns)),
      statuses_(selection.size(), run::PointStatus::not_run) {
  std::error_code ignored;
  if (fs::is_directory(path_, ignored)) run::writable_name(path_, force);
  bool replace = force;
  if (!replace && exists(path_)) {
    take_over(path_, base);
    if (counts_[0] > 0) {
      throw InputError({path_},
                       fmt::format("lacks {} of its points; use --force to overwrite", counts_[0]));
    }
    if (!exists(csv_name(path_))) write_csv(path_, csv_name(path_));
    return;  // complete
  }
  const bool unborn = !replace && exists(partial_path()) && is_unborn(partial_path());
  if (!replace && !unborn && exists(partial_path())) take_over(partial_path(), base);
  refuse_foreign_csv(csv_name(path_), force);
  if (exists(partial_path()) && !replace && !unborn) {
    file_.emplace(records::OutputFile::resumed(path_, force));
    return;
  }
  file_.emplace(unborn ? path_ : run::writable_name(path_, replace), replace || unborn);
  system::TemporaryFile empty =
      system::TemporaryFile::existing(partial_path());  // until its rows are there
  try {
    make(base);
  } catch (...) {
    file_.reset();
    throw;
  }
  empty.release();
}

namespace {

records::Hdf5Dataset make_points(records::Hdf5Group& group, const Selection& selection) {
  const std::size_t rows = selection.size();
  records::Hdf5Dataset point = group.fixed("point", rows, records::Storage::int32, 0.0,
                                           {"1", "number of the point, counted from 1"});
  point.make_scale("point");
  std::vector<double> numbers;
  for (std::size_t row = 0; row < rows; row += numbers.size()) {
    numbers.resize(std::min(kSweepBlockRows, rows - row));
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      numbers[i] = static_cast<double>(selection.point(row + i) + 1);
    }
    point.write(row, numbers);
  }
  return point;
}

// A dataset of small numbers, each with a meaning.
struct Flags {
  std::string name, about;
  std::vector<std::string_view> meanings;
};

Flags flags_of_status() {
  Flags flags{"status", "how it ended", {}};
  for (std::size_t i = 0; i < run::kPointStatuses; ++i) {
    flags.meanings.push_back(run::name_of(static_cast<run::PointStatus>(i)));
  }
  return flags;
}

Flags flags_of_level() {
  Flags flags{
      "simd_level", "instructions that computed it", {run::name_of(run::PointStatus::not_run)}};
  for (const SimdLevel level : kSimdLevels) flags.meanings.push_back(name_of(level));
  return flags;
}

void make_flags(records::Hdf5Group& group, records::Hdf5Dataset& point, std::size_t rows,
                const Flags& flags) {
  records::Hdf5Dataset dataset =
      group.fixed(flags.name, rows, records::Storage::int32, 0.0, {"1", flags.about});
  std::vector<std::int32_t> values(flags.meanings.size());
  std::iota(values.begin(), values.end(), 0);
  dataset.attribute("flag_values", values);
  dataset.attribute("flag_meanings", fmt::format("{}", fmt::join(flags.meanings, " ")));
  dataset.attach_scale(point, 0);
}

void make_reasons(records::Hdf5Group& group, records::Hdf5Dataset& point, std::size_t rows) {
  records::Hdf5Dataset reason =
      group.fixed_texts("reason", rows, kReasonBytes, "reason why it is not done");
  reason.attach_scale(point, 0);
  records::Hdf5Dataset character =
      group.fixed("character", kReasonBytes, records::Storage::int32, 0.0,
                  {"1", "position of a character in a string, counted from 1"});
  // netCDF's name of a dimension without a variable: readers then join the characters to a text,
  // and a table of the points has one row a point, not one a character
  character.make_scale(
      fmt::format("This is a netCDF dimension but not a netCDF variable.{:10}", kReasonBytes));
  std::vector<double> numbers(kReasonBytes);
  std::iota(numbers.begin(), numbers.end(), 1.0);
  character.write(0, numbers);
  reason.attach_scale(character, 1);
}

void write_selection(records::Hdf5Group& group, const Selection& selection) {
  group.attribute("first", static_cast<std::int64_t>(selection.first + 1));
  group.attribute("last", static_cast<std::int64_t>(selection.last));
  group.attribute("shard", static_cast<std::int64_t>(selection.shard));
  group.attribute("shards", static_cast<std::int64_t>(selection.shards));
}

}  // namespace

void SweepTable::make(const model::Scenario& base) {
  records::Hdf5Group root = file_->root();
  run::write_inputs(root, base, "sweep", "sweep");
  root.group("inputs").attribute("swept_files", base.swept_files);
  root.attribute("schema_version", kSweepSchemaVersion);
  root.flush_file();

  records::Hdf5Group group = root.group("sweep");
  const std::size_t rows = selection_.size();
  records::Hdf5Dataset point = make_points(group, selection_);
  make_flags(group, point, rows, flags_of_status());
  make_flags(group, point, rows, flags_of_level());
  make_reasons(group, point, rows);
  for (const TableColumn& column : columns_) {
    records::Hdf5Dataset dataset =
        group.fixed(column.name, rows, column.storage, column.fill, column.meaning);
    for (const auto& [name, text] : column.attributes) dataset.attribute(name, text);
    dataset.attach_scale(point, 0);
  }
  records::make_nexus_data(group, plot_of(columns_));
  write_selection(group, selection_);
  root.flush_file();
  // last: with it the table can be filled
  group.attribute("points", static_cast<std::int64_t>(base.sweep.size()));
  root.flush_file();
  counts_[0] = rows;
}

// Takes over the points that a file holds already. A file that is not of this sweep is refused.
void SweepTable::take_over(const std::string& name, const model::Scenario& base) {
  std::optional<SweepHeader> header;
  try {
    header = read_sweep_header(records::InputFile(name));
  } catch (const InputError&) {
    run::writable_name(path_, false);  // says that it exists
    throw;
  }
  const records::InputFile file(name);
  if (const std::string build = run::build_of(file); build != run::result_identity()) {
    throw InputError(
        {name},
        fmt::format(
            "was written by servomill {}, this is {}: points of two builds may differ; continue "
            "with that build, choose another --output or use --force to run all points again",
            build, run::result_identity()));
  }
  const std::string why = why_other(*header, base, selection_);
  if (!why.empty()) throw InputError({name}, why + "; use --force to overwrite");
  take_statuses(file);
}

namespace {

bool is_status(double value) {
  return value >= 0.0 && value < static_cast<double>(run::kPointStatuses);
}
// Instructions matter where there are numbers.
bool has_numbers(double status) {
  return status == static_cast<double>(run::PointStatus::done) ||
         status == static_cast<double>(run::PointStatus::stopped);
}

}  // namespace

void SweepTable::take_statuses(const records::InputFile& file) {
  counts_ = {statuses_.size()};
  for (std::size_t row = 0; row < statuses_.size(); row += kSweepBlockRows) {
    const std::size_t count = std::min(kSweepBlockRows, statuses_.size() - row);
    const auto values = file.values(kSweepGroup + "/status", row, count);
    const auto levels = file.values(kSweepGroup + "/simd_level", row, count);
    for (std::size_t i = 0; i < count; ++i) {
      set_status(row + i, static_cast<run::PointStatus>(is_status(values[i]) ? values[i] : 0.0));
      if (has_numbers(values[i])) add_level(levels_, levels[i]);
    }
  }
}

void SweepTable::set_status(std::uint64_t row, run::PointStatus status) {
  --counts_[static_cast<std::size_t>(statuses_[row])];
  ++counts_[static_cast<std::size_t>(status)];
  statuses_[row] = status;
}

void SweepTable::forget(run::PointStatus status) {
  if (counts_[static_cast<std::size_t>(status)] == 0) return;
  if (!file_) {
    refuse_foreign_csv(csv_name(path_), true);
    fs::remove(csv_name(path_));
    file_.emplace(records::OutputFile::reopened(path_));
  }
  records::Hdf5Group group = file_->root().group("sweep");
  records::Hdf5Dataset statuses = group.dataset("status"), reasons = group.dataset("reason");
  for (std::size_t row = 0; row < statuses_.size(); ++row) {
    if (statuses_[row] != status) continue;
    statuses.write(row, std::array{0.0});
    reasons.write_text(row, "");
    set_status(row, run::PointStatus::not_run);
  }
  group.flush_file();
}

std::vector<SimdLevel> SweepTable::simd_levels() const { return {levels_.begin(), levels_.end()}; }

// Rows that follow each other are written at once.
void SweepTable::write_runs(std::span<const std::uint64_t> rows, records::Hdf5Dataset& to,
                            std::span<const double> values) {
  for (std::size_t begin = 0; begin < rows.size();) {
    std::size_t end = begin + 1;
    while (end < rows.size() && rows[end] == rows[end - 1] + 1) ++end;
    to.write(rows[begin], values.subspan(begin, end - begin));
    begin = end;
  }
}

namespace {

// Value of a point in column c.
double value_in(const TableColumn& column, std::size_t c, const SweepPoint& point) {
  if (c >= point.values.size()) {
    const std::size_t q = c - point.values.size();
    return q < point.result.rows.size() ? point.result.rows[q].value : kNoNumber;
  }
  if (column.texts.empty()) return config::number_of(point.values[c]);
  const auto text = std::find(column.texts.begin(), column.texts.end(), point.values[c]);
  assert(text != column.texts.end());
  return static_cast<double>(text - column.texts.begin());
}

}  // namespace

void SweepTable::write(std::span<const SweepPoint> points) {
  assert(file_);
  records::Hdf5Group group = file_->root().group("sweep");
  std::vector<std::uint64_t> rows;
  for (const SweepPoint& point : points) rows.push_back(selection_.place(point.index));
  std::vector<double> values(points.size());
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    for (std::size_t i = 0; i < points.size(); ++i) values[i] = value_in(columns_[c], c, points[i]);
    records::Hdf5Dataset dataset = group.dataset(columns_[c].name);
    write_runs(rows, dataset, values);
  }
  std::fill(values.begin(), values.end(), number_of_level(simd_level()));
  records::Hdf5Dataset levels = group.dataset("simd_level");
  write_runs(rows, levels, values);
  levels_.insert(simd_level());
  records::Hdf5Dataset reasons = group.dataset("reason");
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].result.reason.empty()) reasons.write_text(rows[i], points[i].result.reason);
  }
  group.flush_file();

  for (std::size_t i = 0; i < points.size(); ++i) {
    values[i] = static_cast<double>(points[i].result.status);
    set_status(rows[i], points[i].result.status);
  }
  records::Hdf5Dataset statuses = group.dataset("status");
  write_runs(rows, statuses, values);
  group.flush_file();
}

void SweepTable::copy(const records::InputFile& from) {
  assert(file_);
  records::Hdf5Group group = file_->root().group("sweep");
  const std::size_t length = from.shape(kSweepGroup + "/point").at(0);
  Stage stage("rows", static_cast<double>(length));
  for (std::size_t begin = 0; begin < length; begin += kSweepBlockRows) {
    throw_if_interrupted();
    stage.reach(static_cast<double>(begin));
    const std::size_t count = std::min(kSweepBlockRows, length - begin);
    const auto numbers = from.values(kSweepGroup + "/point", begin, count);
    const auto statuses = from.values(kSweepGroup + "/status", begin, count);
    const auto levels = from.values(kSweepGroup + "/simd_level", begin, count);
    std::vector<std::size_t> taken;
    std::vector<std::uint64_t> rows;
    for (std::size_t i = 0; i < count; ++i) {
      if (statuses[i] == 0.0) continue;
      if (!is_status(statuses[i])) {
        throw InputError({from.path()}, fmt::format("point {} has the unknown status {}",
                                                    numbers[i], statuses[i]));
      }
      taken.push_back(i);
      rows.push_back(selection_.place(static_cast<std::uint64_t>(numbers[i]) - 1));
      set_status(rows.back(), static_cast<run::PointStatus>(statuses[i]));
      if (has_numbers(statuses[i])) add_level(levels_, levels[i]);
    }
    const auto take = [&](const std::string& name) {
      const auto all = from.values(kSweepGroup + "/" + name, begin, count);
      std::vector<double> some;
      for (const std::size_t i : taken) some.push_back(all[i]);
      records::Hdf5Dataset dataset = group.dataset(name);
      write_runs(rows, dataset, some);
    };
    for (const TableColumn& column : columns_) take(column.name);
    take("status");
    take("simd_level");
    const auto reasons = from.texts(kSweepGroup + "/reason", begin, count);
    records::Hdf5Dataset to = group.dataset("reason");
    for (std::size_t i = 0; i < taken.size(); ++i) {
      if (!reasons[taken[i]].empty()) to.write_text(rows[i], reasons[taken[i]]);
    }
  }
}

void SweepTable::commit() {
  assert(file_);
  file_->commit();
  file_.reset();
  write_csv(path_, csv_name(path_));
}

}  // namespace servomill::sim::sweep
