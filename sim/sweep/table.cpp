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
#include <fstream>
#include <limits>
#include <numeric>
#include <set>

#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/user_file.h"
#include "sim/run/build_identity.h"
#include "sim/run/store.h"
#include "sim/system/output_name.h"

namespace servomill::sim {
namespace {

namespace fs = std::filesystem;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kNoText = -1.0;
constexpr std::size_t kReasonBytes = 240;
constexpr std::size_t kBlockRows = 4096;  // read or written at once
constexpr std::string_view kCsvBegin = "point,status,";
const std::string kGroup = "/sweep";

// Letters, digits and single '_': a name that Octave, netCDF and pandas take.
std::string plain_name(std::string_view text) {
  std::string name;
  for (const char c : text) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    if (plain) {
      name += c;
    } else if (!name.empty() && name.back() != '_') {
      name += '_';
    }
  }
  if (name.ends_with('_')) name.pop_back();
  const bool digit = name.empty() || (name[0] >= '0' && name[0] <= '9');
  return digit ? "n" + name : name;
}

class Names {
 public:
  std::string unique(const std::string& wanted) {
    std::string name = wanted;
    for (int n = 2; !taken_.insert(name).second; ++n) name = fmt::format("{}_{}", wanted, n);
    return name;
  }

 private:
  std::set<std::string> taken_ = {"point", "status", "reason", "simd_level"};
};

// What a TOML text says, if it says it without escapes; other values as they are.
std::string unquoted(const std::string& toml) {
  const bool is_text = toml.size() >= 2 && (toml.front() == '"' || toml.front() == '\'') &&
                       toml.back() == toml.front() && toml.find('\\') == std::string::npos;
  return is_text ? toml.substr(1, toml.size() - 2) : toml;
}

TableColumn key_column(const SweepDesign& design, std::size_t key, Names& names) {
  const SweepColumn column = design.column(key);
  const std::string& full = design.keys[key].key;
  TableColumn out;
  out.name = names.unique(plain_name(full));
  out.meaning = {column.unit.empty() ? "1" : column.unit, full};
  out.attributes = {{"role", "parameter"}, {"key", full}};
  if (!column.numeric) {
    out.storage = Storage::int32;
    out.texts = column.texts;
    std::vector<std::string> shown;
    for (const std::string& text : column.texts) shown.push_back(unquoted(text));
    out.attributes.emplace_back("values", fmt::format("{}", fmt::join(shown, "\n")));
  }
  out.fill = column.numeric ? kNone : kNoText;
  return out;
}

TableColumn quantity_column(const ComparisonRow& row, Names& names) {
  TableColumn out;
  out.name = names.unique(plain_name(fmt::format("{} {} {} {} {}", row.case_name, row.quantity,
                                                 row.axis, row.statistic, row.sections)));
  std::string about = fmt::format("{} of {}", row.quantity, row.case_name);
  for (const std::string& more : {row.axis, row.statistic, row.sections}) {
    if (!more.empty()) about += ", " + more;
  }
  out.meaning = {row.unit, about};
  out.fill = kNone;
  out.attributes = {{"role", "quantity"},         {"case", row.case_name},
                    {"quantity", row.quantity},   {"axis", row.axis},
                    {"statistic", row.statistic}, {"sections", row.sections},
                    {"reference", row.reference}, {"kind", row.kind}};
  return out;
}

bool exists(const std::string& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

// The number that stands for a level in the column simd_level; 0 stands for none.
double number_of(SimdLevel level) { return 1.0 + static_cast<double>(level); }

void add_level(std::set<SimdLevel>& levels, double number) {
  for (const SimdLevel level : kSimdLevels) {
    if (number_of(level) == number) levels.insert(level);
  }
}

// Why a file is not the table of this sweep; empty: it is.
std::string why_other(const SweepHeader& header, const Scenario& base, const Selection& selection) {
  if (header.base.resolved != base.resolved) {
    return header.base.name == base.name
               ? "holds a sweep of this scenario as it was before it changed"
               : fmt::format("holds a sweep of the scenario '{}'", header.base.name);
  }
  if (const std::string file = changed_file(header.base.swept_files, base.swept_files);
      !file.empty()) {
    return fmt::format("holds a sweep of this scenario as it was before its file '{}' changed",
                       file);
  }
  if (!(header.selection == selection)) {
    const auto said = [](const Selection& s) {
      return fmt::format("points {} to {}, shard {} of {}", s.first + 1, s.last, s.shard, s.shards);
    };
    return fmt::format("holds {} of the sweep; asked for are {}", said(header.selection),
                       said(selection));
  }
  return {};
}

// Whether a file begins with nothing: what is first in it is written last.
bool begins_empty(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, 8> begin{};
  file.read(begin.data(), begin.size());
  return std::all_of(begin.begin(), begin.end(), [](char c) { return c == '\0'; });
}

// A table that was begun but got no row.
bool is_unborn(const std::string& path) {
  if (begins_empty(path)) return true;
  if (!is_hdf5(path)) return false;
  const InputFile file(path);
  return file.has_attribute("/", "kind") && file.text("/", "kind") == "sweep" &&
         (!file.has(kGroup) || !file.has_attribute(kGroup, "points"));
}

// A CSV file of ours may be replaced, no other.
void refuse_foreign_csv(const std::string& path, bool force) {
  output_target(path, Existing::replaced);
  if (!exists(path)) return;
  if (!force) throw InputError({path}, "exists; use --force to overwrite");
  std::ifstream file(path, std::ios::binary);
  std::string begin(kCsvBegin.size(), '\0');
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  if (file && begin == kCsvBegin) return;
  throw InputError({path}, "exists and is no table of a sweep; --force does not overwrite others");
}

}  // namespace

std::vector<TableColumn> columns_of(const Scenario& base) {
  Names names;
  std::vector<TableColumn> columns;
  for (std::size_t key = 0; key < base.sweep.keys.size(); ++key) {
    columns.push_back(key_column(base.sweep, key, names));
  }
  for (const ComparisonRow& row : compare(base.quantities, {})) {
    columns.push_back(quantity_column(row, names));
  }
  return columns;
}

std::vector<TableColumn> columns_of(const InputFile& file) {
  std::vector<TableColumn> columns;
  for (const std::string& name : file.datasets(kGroup)) {
    const std::string path = kGroup + "/" + name;
    if (!file.has_attribute(path, "role")) continue;  // point, status, reason
    TableColumn column;
    column.name = name;
    column.meaning = {file.text(path, "units"), file.text(path, "long_name")};
    column.fill = kNone;
    for (const std::string_view about : {"role", "key", "values", "case", "quantity", "axis",
                                         "statistic", "sections", "reference", "kind"}) {
      const std::string attribute(about);
      if (!file.has_attribute(path, attribute)) continue;
      column.attributes.emplace_back(attribute, file.text(path, attribute));
      if (attribute != "values") continue;
      column.storage = Storage::int32;
      column.fill = kNoText;
      column.texts = split_lines(column.attributes.back().second);
    }
    columns.push_back(std::move(column));
  }
  return columns;
}

SweepTable::SweepTable(const std::string& path, bool force, const Scenario& base,
                       std::vector<TableColumn> columns, const Selection& selection)
    : path_(path),
      selection_(selection),
      columns_(std::move(columns)),
      statuses_(selection.size(), PointStatus::not_run) {
  std::error_code ignored;
  if (fs::is_directory(path_, ignored)) writable_name(path_, force);
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
    file_.emplace(OutputFile::resumed(path_, force));
    return;
  }
  file_.emplace(unborn ? path_ : writable_name(path_, replace), replace || unborn);
  try {
    make(base);
  } catch (...) {
    file_.reset();
    fs::remove(partial_path(), ignored);  // nothing is in it yet
    throw;
  }
}

void SweepTable::make(const Scenario& base) {
  Hdf5Group root = file_->root();
  write_inputs(root, base, "sweep");
  root.group("inputs").attribute("swept_files", base.swept_files);
  root.attribute("schema_version", kSweepSchemaVersion);
  root.flush_file();

  Hdf5Group group = root.group("sweep");
  const std::size_t rows = selection_.size();
  Hdf5Dataset point =
      group.fixed("point", rows, Storage::int32, 0.0, {"1", "number of the point, counted from 1"});
  point.make_scale("point");
  std::vector<double> numbers;
  for (std::size_t row = 0; row < rows; row += numbers.size()) {
    numbers.resize(std::min(kBlockRows, rows - row));
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      numbers[i] = static_cast<double>(selection_.point(row + i) + 1);
    }
    point.write(row, numbers);
  }

  const auto flags = [&](const std::string& name, const std::string& about,
                         const std::vector<std::string_view>& meanings) {
    Hdf5Dataset dataset = group.fixed(name, rows, Storage::int32, 0.0, {"1", about});
    std::vector<double> values(meanings.size());
    std::iota(values.begin(), values.end(), 0.0);
    dataset.attribute("flag_values", values);
    dataset.attribute("flag_meanings", fmt::format("{}", fmt::join(meanings, " ")));
    dataset.attach_scale(point, 0);
  };
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < kPointStatuses; ++i) {
    names.push_back(name_of(static_cast<PointStatus>(i)));
  }
  flags("status", "how it ended", names);
  names = {name_of(PointStatus::not_run)};
  for (const SimdLevel level : kSimdLevels) names.push_back(name_of(level));
  flags("simd_level", "instructions that computed it", names);

  Hdf5Dataset reason = group.fixed_texts("reason", rows, kReasonBytes, "why it is not done");
  reason.attach_scale(point, 0);
  Hdf5Dataset character = group.fixed("character", kReasonBytes, Storage::int32, 0.0,
                                      {"1", "place of a character in a text, counted from 1"});
  // netCDF's name of a dimension without a variable: readers then join the characters to a text,
  // and a table of the points has one row a point, not one a character
  character.make_scale(
      fmt::format("This is a netCDF dimension but not a netCDF variable.{:10}", kReasonBytes));
  numbers.resize(kReasonBytes);
  std::iota(numbers.begin(), numbers.end(), 1.0);
  character.write(0, numbers);
  reason.attach_scale(character, 1);

  for (const TableColumn& column : columns_) {
    Hdf5Dataset dataset =
        group.fixed(column.name, rows, column.storage, column.fill, column.meaning);
    for (const auto& [name, text] : column.attributes) dataset.attribute(name, text);
    dataset.attach_scale(point, 0);
  }
  group.attribute("first", static_cast<std::int64_t>(selection_.first + 1));
  group.attribute("last", static_cast<std::int64_t>(selection_.last));
  group.attribute("shard", static_cast<std::int64_t>(selection_.shard));
  group.attribute("shards", static_cast<std::int64_t>(selection_.shards));
  root.flush_file();
  // last: with it the table can be filled
  group.attribute("points", static_cast<std::int64_t>(base.sweep.size()));
  root.flush_file();
  counts_[0] = rows;
}

// What a file holds already. Anything but this sweep is left alone.
void SweepTable::take_over(const std::string& name, const Scenario& base) {
  std::optional<SweepHeader> header;
  try {
    header = read_sweep_header(InputFile(name));
  } catch (const InputError&) {
    writable_name(path_, false);  // says that it exists
    throw;
  }
  const InputFile file(name);
  if (const std::string build = build_of(file); build != build_identity()) {
    throw InputError(
        {name}, fmt::format("was written by servomill {}, this is {}: points of two builds may "
                            "differ; go on with that build, name another --output or use --force "
                            "to run all of it again",
                            build, build_identity()));
  }
  const std::string why = why_other(*header, base, selection_);
  if (!why.empty()) throw InputError({name}, why + "; use --force to overwrite");
  take_statuses(file);
}

namespace {

bool is_status(double value) { return value >= 0.0 && value < static_cast<double>(kPointStatuses); }
// Instructions matter where there are numbers.
bool has_numbers(double status) {
  return status == static_cast<double>(PointStatus::done) ||
         status == static_cast<double>(PointStatus::stopped);
}

}  // namespace

void SweepTable::take_statuses(const InputFile& file) {
  counts_ = {statuses_.size()};
  for (std::size_t row = 0; row < statuses_.size(); row += kBlockRows) {
    const std::size_t count = std::min(kBlockRows, statuses_.size() - row);
    const auto values = file.values(kGroup + "/status", row, count);
    const auto levels = file.values(kGroup + "/simd_level", row, count);
    for (std::size_t i = 0; i < count; ++i) {
      set_status(row + i, static_cast<PointStatus>(is_status(values[i]) ? values[i] : 0.0));
      if (has_numbers(values[i])) add_level(levels_, levels[i]);
    }
  }
}

void SweepTable::set_status(std::uint64_t row, PointStatus status) {
  --counts_[static_cast<std::size_t>(statuses_[row])];
  ++counts_[static_cast<std::size_t>(status)];
  statuses_[row] = status;
}

void SweepTable::forget(PointStatus status) {
  if (counts_[static_cast<std::size_t>(status)] == 0) return;
  if (!file_) {
    refuse_foreign_csv(csv_name(path_), true);
    fs::remove(csv_name(path_));
    file_.emplace(OutputFile::reopened(path_));
  }
  Hdf5Group group = file_->root().group("sweep");
  Hdf5Dataset statuses = group.dataset("status"), reasons = group.dataset("reason");
  for (std::size_t row = 0; row < statuses_.size(); ++row) {
    if (statuses_[row] != status) continue;
    statuses.write(row, std::array{0.0});
    reasons.write_text(row, "");
    set_status(row, PointStatus::not_run);
  }
  group.flush_file();
}

std::vector<SimdLevel> SweepTable::simd_levels() const { return {levels_.begin(), levels_.end()}; }

// Rows that follow each other are written at once.
void SweepTable::write_runs(std::span<const std::uint64_t> rows, Hdf5Dataset& to,
                            std::span<const double> values) {
  for (std::size_t begin = 0; begin < rows.size();) {
    std::size_t end = begin + 1;
    while (end < rows.size() && rows[end] == rows[end - 1] + 1) ++end;
    to.write(rows[begin], values.subspan(begin, end - begin));
    begin = end;
  }
}

void SweepTable::write(std::span<const SweepPoint> points) {
  assert(file_);
  Hdf5Group group = file_->root().group("sweep");
  std::vector<std::uint64_t> rows;
  for (const SweepPoint& point : points) rows.push_back(selection_.place(point.index));
  std::vector<double> values(points.size());
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    const TableColumn& column = columns_[c];
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto& [index, keys, result] = points[i];
      if (c >= keys.size()) {
        const std::size_t q = c - keys.size();
        values[i] = q < result.rows.size() ? result.rows[q].value : kNone;
      } else if (column.texts.empty()) {
        values[i] = number_of(keys[c]);
      } else {
        const auto text = std::find(column.texts.begin(), column.texts.end(), keys[c]);
        assert(text != column.texts.end());
        values[i] = static_cast<double>(text - column.texts.begin());
      }
    }
    Hdf5Dataset dataset = group.dataset(column.name);
    write_runs(rows, dataset, values);
  }
  std::fill(values.begin(), values.end(), number_of(simd_level()));
  Hdf5Dataset levels = group.dataset("simd_level");
  write_runs(rows, levels, values);
  levels_.insert(simd_level());
  Hdf5Dataset reasons = group.dataset("reason");
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].result.reason.empty()) reasons.write_text(rows[i], points[i].result.reason);
  }
  group.flush_file();

  for (std::size_t i = 0; i < points.size(); ++i) {
    values[i] = static_cast<double>(points[i].result.status);
    set_status(rows[i], points[i].result.status);
  }
  Hdf5Dataset statuses = group.dataset("status");
  write_runs(rows, statuses, values);
  group.flush_file();
}

void SweepTable::copy(const InputFile& from) {
  assert(file_);
  Hdf5Group group = file_->root().group("sweep");
  const std::size_t length = from.shape(kGroup + "/point").at(0);
  for (std::size_t begin = 0; begin < length; begin += kBlockRows) {
    throw_if_interrupted();
    const std::size_t count = std::min(kBlockRows, length - begin);
    const auto numbers = from.values(kGroup + "/point", begin, count);
    const auto statuses = from.values(kGroup + "/status", begin, count);
    const auto levels = from.values(kGroup + "/simd_level", begin, count);
    std::vector<std::size_t> taken;
    std::vector<std::uint64_t> rows;
    for (std::size_t i = 0; i < count; ++i) {
      if (statuses[i] == 0.0) continue;
      if (!is_status(statuses[i])) {
        throw InputError(
            {from.path()},
            fmt::format("point {} has the status {}, which there is not", numbers[i], statuses[i]));
      }
      taken.push_back(i);
      rows.push_back(selection_.place(static_cast<std::uint64_t>(numbers[i]) - 1));
      set_status(rows.back(), static_cast<PointStatus>(statuses[i]));
      if (has_numbers(statuses[i])) add_level(levels_, levels[i]);
    }
    const auto take = [&](const std::string& name) {
      const auto all = from.values(kGroup + "/" + name, begin, count);
      std::vector<double> some;
      for (const std::size_t i : taken) some.push_back(all[i]);
      Hdf5Dataset dataset = group.dataset(name);
      write_runs(rows, dataset, some);
    };
    for (const TableColumn& column : columns_) take(column.name);
    take("status");
    take("simd_level");
    const auto reasons = from.texts(kGroup + "/reason", begin, count);
    Hdf5Dataset to = group.dataset("reason");
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

std::string changed_file(const std::string& before, const std::string& after) {
  if (before == after) return {};
  const std::vector<std::string> others = split_lines(before);
  for (const std::string& line : split_lines(after)) {
    if (std::find(others.begin(), others.end(), line) != others.end()) continue;
    return line.substr(line.find(' ') + 1);
  }
  return {};
}

SweepHeader read_sweep_header(const InputFile& file) {
  const std::string& path = file.path();
  if (!file.has_attribute("/", "schema_version")) {
    throw InputError({path}, "is not a result file of servomill");
  }
  if (file.text("/", "kind") != "sweep") {
    throw InputError({path}, fmt::format("holds a {}, not a sweep", file.text("/", "kind")));
  }
  const auto version = static_cast<int>(file.number("/", "schema_version"));
  if (version != kSweepSchemaVersion) {
    throw InputError({path}, fmt::format("holds a sweep of schema version {}; this program reads "
                                         "version {}",
                                         version, kSweepSchemaVersion));
  }
  if (!file.has(kGroup) || !file.has_attribute(kGroup, "points")) {
    throw InputError({path}, "was left before its table was complete");
  }
  SweepHeader header;
  const std::string resolved = file.text("/inputs", "resolved");
  header.base = read_resolved_scenario(resolved, path + ":/inputs");
  header.base.name = file.text("/", "scenario");
  header.base.text = file.text("/inputs", "scenario");
  header.base.machine_text = file.text("/inputs", "machine");
  header.base.resolved = resolved;
  if (file.has_attribute("/inputs", "swept_files")) {
    header.base.swept_files = file.text("/inputs", "swept_files");
  }
  const auto number = [&](const std::string& name) {
    return static_cast<std::uint64_t>(file.number(kGroup, name));
  };
  header.points = number("points");
  header.selection = {number("first") - 1, number("last"), number("shard"), number("shards")};
  return header;
}

std::string csv_name(const std::string& path) {
  return (path.ends_with(".h5") ? path.substr(0, path.size() - 3) : path) + ".csv";
}

namespace {

std::string csv_text(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + '"';
}

std::string csv_number(const TableColumn& column, double value) {
  if (!column.texts.empty()) {
    return value < 0.0 ? "" : csv_text(column.texts.at(static_cast<std::size_t>(value)));
  }
  return std::isnan(value) ? "" : fmt::format("{}", value);
}

std::string csv_header(const std::vector<TableColumn>& columns) {
  std::string line(kCsvBegin);
  for (const TableColumn& column : columns) {
    const std::string& unit = column.meaning.units;
    line += csv_text(unit == "1" ? column.name : fmt::format("{} [{}]", column.name, unit)) + ",";
  }
  return line + "reason\n";
}

// The file under a temporary name until it is complete.
class CsvFile {
 public:
  explicit CsvFile(const std::string& path)
      : path_(output_target(path, Existing::replaced)),
        partial_(path_),
        file_(std::fopen(partial_.name().c_str(), "wbx")) {
    if (file_ == nullptr) throw SystemError(path_, "cannot be made", std::strerror(errno));
  }
  void write(const std::string& text) {
    if (std::fwrite(text.data(), 1, text.size(), file_.get()) != text.size()) fail();
  }
  void commit() {
    if (std::fclose(file_.release()) != 0) fail();
    give_name(partial_.name(), path_, Existing::replaced);
  }

 private:
  [[noreturn]] void fail() const {
    throw SystemError(path_, "cannot be written", std::strerror(errno));
  }
  std::string path_;
  TemporaryFile partial_;
  OpenFile file_;
};

}  // namespace

void write_csv(const std::string& table, const std::string& csv) {
  const InputFile file(table);
  const std::vector<TableColumn> columns = columns_of(file);
  CsvFile out(csv);
  out.write(csv_header(columns));
  const std::size_t length = file.shape(kGroup + "/point").at(0);
  for (std::size_t begin = 0; begin < length; begin += kBlockRows) {
    throw_if_interrupted();
    const std::size_t count = std::min(kBlockRows, length - begin);
    const auto points = file.values(kGroup + "/point", begin, count);
    const auto statuses = file.values(kGroup + "/status", begin, count);
    const auto reasons = file.texts(kGroup + "/reason", begin, count);
    std::vector<std::vector<double>> values;
    for (const auto& column : columns) {
      values.push_back(file.values(kGroup + "/" + column.name, begin, count));
    }
    std::string text;
    for (std::size_t i = 0; i < count; ++i) {
      text += fmt::format("{},{},", points[i], name_of(static_cast<PointStatus>(statuses[i])));
      for (std::size_t c = 0; c < columns.size(); ++c) {
        text += csv_number(columns[c], values[c][i]) + ",";
      }
      text += csv_text(reasons[i]) + "\n";
    }
    out.write(text);
  }
  out.commit();
}

}  // namespace servomill::sim
