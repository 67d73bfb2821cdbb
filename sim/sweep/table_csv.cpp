#include "sim/sweep/table_csv.h"

#include <fmt/format.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <vector>

#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/progress.h"
#include "plant/vocabulary/user_file.h"
#include "sim/model/scenario.h"
#include "sim/records/input_file.h"
#include "sim/run/point_batch.h"
#include "sim/sweep/table_columns.h"
#include "sim/system/output_name.h"
#include "sim/system/system_error.h"

namespace servomill::sim::sweep {
namespace {

constexpr std::string_view kCsvBegin = "point,status,";

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
      : path_(system::output_target(path, system::Existing::replaced)),
        partial_(path_),
        file_(std::fopen(partial_.name().c_str(), "wbx")) {
    if (file_ == nullptr)
      throw system::SystemError(path_, "cannot be created", std::strerror(errno));
  }
  void write(const std::string& text) {
    if (std::fwrite(text.data(), 1, text.size(), file_.get()) != text.size()) fail();
  }
  void commit() {
    if (std::fclose(file_.release()) != 0) fail();
    system::give_name(partial_.name(), path_, system::Existing::replaced);
  }

 private:
  [[noreturn]] void fail() const {
    throw system::SystemError(path_, "cannot be written", std::strerror(errno));
  }
  std::string path_;
  system::TemporaryFile partial_;
  OpenFile file_;
};

}  // namespace

std::string csv_name(const std::string& path) {
  return (path.ends_with(".h5") ? path.substr(0, path.size() - 3) : path) + ".csv";
}

std::string writable_table(std::string path, const Selection& selection, const std::string& shard,
                           bool force) {
  using system::Existing;
  if (!shard.empty()) path = shard_name(path, selection);
  path = system::output_target(path, force ? Existing::replaced : Existing::resumed);
  system::output_target(csv_name(path), Existing::replaced);
  return path;
}

void refuse_foreign_csv(const std::string& path, bool force) {
  system::output_target(path, system::Existing::replaced);
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return;
  if (!force) throw InputError({path}, "exists; use --force to overwrite");
  std::ifstream file(path, std::ios::binary);
  std::string begin(kCsvBegin.size(), '\0');
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  if (file && begin == kCsvBegin) return;
  throw InputError({path},
                   "exists and is not a table of a sweep; --force does not overwrite other files");
}

void write_csv(const std::string& table, const std::string& csv) {
  const records::InputFile file(table);
  const std::vector<TableColumn> columns = columns_of(file);
  CsvFile out(csv);
  out.write(csv_header(columns));
  const std::size_t length = file.shape(kSweepGroup + "/point").at(0);
  Stage stage("rows", static_cast<double>(length));
  for (std::size_t begin = 0; begin < length; begin += kSweepBlockRows) {
    throw_if_interrupted();
    stage.reach(static_cast<double>(begin));
    const std::size_t count = std::min(kSweepBlockRows, length - begin);
    const auto points = file.values(kSweepGroup + "/point", begin, count);
    const auto statuses = file.values(kSweepGroup + "/status", begin, count);
    const auto reasons = file.texts(kSweepGroup + "/reason", begin, count);
    std::vector<std::vector<double>> values;
    for (const auto& column : columns) {
      values.push_back(file.values(kSweepGroup + "/" + column.name, begin, count));
    }
    std::string text;
    for (std::size_t i = 0; i < count; ++i) {
      text += fmt::format("{},{},", points[i],
                          run::name_of(static_cast<run::PointStatus>(statuses[i])));
      for (std::size_t c = 0; c < columns.size(); ++c) {
        text += csv_number(columns[c], values[c][i]) + ",";
      }
      text += csv_text(reasons[i]) + "\n";
    }
    out.write(text);
  }
  out.commit();
}

}  // namespace servomill::sim::sweep
