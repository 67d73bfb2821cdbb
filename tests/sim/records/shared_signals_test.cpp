// Equal signals of a result file: which of them are stored once, and under which names.

#include "sim/records/shared_signals.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sim/records/encoded_series.h"
#include "sim/records/input_file.h"
#include "sim/records/output_file.h"
#include "sim/records/series_spool.h"

namespace servomill::sim::records::shared_signals_test {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kRows = 40, kChunkRows = 16;

// Columns: time, line, section, X Y of ref, cmd and velocity, contour error.
constexpr std::size_t kRefY = 4, kCmdY = 6, kVelocityY = 8, kError = 9;

std::vector<Signal> signals() {
  return {{"time", "s", "time", "", ""},
          {"line", "1", "line", "", "", 0, Storage::int32},
          {"section", "1", "section", "", "", 0, Storage::int32},
          {"ref_linear", "mm", "interpolated position", "XY", "axis_linear"},
          {"cmd_linear", "mm", "setpoint", "XY", "axis_linear"},
          {"velocity_linear", "mm/s", "velocity", "XY", "axis_linear"},
          {"contour_error", "um", "contour error", "", ""}};
}

// Every axis signal has the same numbers, line and section, too; `change` may change a row.
Series series(const std::function<void(std::size_t row, double* values)>& change = {}) {
  Series out(signals());
  for (std::size_t n = 0; n < kRows; ++n) {
    std::vector<double> row(out.width());
    const double t = 0.001 * static_cast<double>(n);
    row[0] = t;
    row[1] = row[2] = 7.0;
    for (std::size_t c = 3; c < kError; ++c) row[c] = std::sin(t + static_cast<double>(c % 2));
    row[kError] = std::cos(t);
    if (change) change(n, row.data());
    out.append(row);
  }
  return out;
}

// Changes the last bit of the last row of a column.
auto last_bit_of(std::size_t column) {
  return [column](std::size_t n, double* row) {
    if (n == kRows - 1) row[column] = std::nextafter(row[column], 2.0);
  };
}

SeriesLayout layout() {
  SeriesLayout out;
  out.index_meaning = {"s", "time"};
  out.labels = {{"axis_linear", "XY", "linear axis"}};
  for (const Signal& signal : signals()) {
    if (signal.name == "time") continue;
    out.channels.push_back(
        {signal.name, {signal.units, signal.long_name}, signal.scale, signal.storage});
  }
  out.chunk_rows = kChunkRows;
  return out;
}

EncodedSeries encoded_of(const Series& series) {
  return {series, {kChunkRows, layout().compression}, 1};
}

const Channel& channel(const SeriesLayout& layout, const std::string& name) {
  for (const Channel& one : layout.channels) {
    if (one.name == name) return one;
  }
  throw std::logic_error(name);
}

class SharedSignalsTest : public testing::Test {
 protected:
  SharedSignalsTest() : out_(path(), true) {}
  ~SharedSignalsTest() override {
    fs::remove(path());
    fs::remove(out_.partial_path());
  }
  static std::string path() {
    return fs::path(testing::TempDir()) / ("shared_" + std::to_string(getpid()) + ".h5");
  }
  SeriesLayout found(const Series& series, SeriesLayout layout = shared_signals_test::layout()) {
    Hdf5Group root = out_.root();
    if (series.pages() != nullptr) {
      shared_.find(root, series, *series.pages(), layout);
    } else {
      shared_.find(root, series, encoded_of(series), layout);
    }
    return layout;
  }
  // Writes the series, of which the next one may share signals.
  void add(const std::string& group, const Series& series) {
    const SeriesLayout layout = found(series);
    write_pages(out_.root().group(group), layout, encoded_of(series));
    shared_.add("/" + group, series.rows(), layout);
  }

  OutputFile out_;
  SharedSignals shared_;
};

TEST_F(SharedSignalsTest, OfOneSeriesHaveLabelsAndTheSameUnit) {
  const SeriesLayout layout = found(series());
  EXPECT_EQ(channel(layout, "cmd_linear").same_as, "ref_linear");
  for (const char* name : {"line", "section", "ref_linear", "velocity_linear", "contour_error"}) {
    EXPECT_EQ(channel(layout, name).same_as, "") << name;
  }
  EXPECT_EQ(channel(layout, "ref_linear").meaning.long_name,
            "ref_linear: interpolated position = cmd_linear: setpoint");
  EXPECT_EQ(channel(layout, "velocity_linear").meaning.long_name, "velocity");
}

TEST_F(SharedSignalsTest, AreEqualToTheLastBitOfTheLastRow) {
  const SeriesLayout layout = found(series(last_bit_of(kCmdY)));
  EXPECT_EQ(channel(layout, "cmd_linear").same_as, "");
  EXPECT_EQ(channel(layout, "ref_linear").meaning.long_name, "interpolated position");
}

TEST_F(SharedSignalsTest, AreNoneOfASeriesWithoutRows) {
  const SeriesLayout layout = found(Series(signals()));
  EXPECT_EQ(channel(layout, "cmd_linear").same_as, "");
}

TEST_F(SharedSignalsTest, TellZerosOfDifferentSignApart) {
  const Series zeros = series([](std::size_t, double* row) {
    row[kRefY] = 0.0;
    row[kCmdY] = -0.0;
  });
  EXPECT_EQ(channel(found(zeros), "cmd_linear").same_as, "");
}

TEST_F(SharedSignalsTest, OfEarlierSeriesKeepTheirNames) {
  add("one", series());
  const SeriesLayout layout = found(series(last_bit_of(kVelocityY)));
  EXPECT_EQ(layout.index_same_as, "/one/time");
  EXPECT_EQ(layout.labels.front().same_as, "/one/axis_linear");
  EXPECT_EQ(channel(layout, "line").same_as, "/one/line");
  EXPECT_EQ(channel(layout, "section").same_as, "/one/section");
  EXPECT_EQ(channel(layout, "ref_linear").same_as, "/one/ref_linear");
  EXPECT_EQ(channel(layout, "cmd_linear").same_as, "ref_linear");
  EXPECT_EQ(channel(layout, "velocity_linear").same_as, "");
  EXPECT_EQ(channel(layout, "contour_error").same_as, "/one/contour_error");
}

// Its long name says that both are the same, which is wrong of the second series.
TEST_F(SharedSignalsTest, AreNotADatasetThatSaysSomethingElse) {
  add("one", series());
  add("two", series(last_bit_of(kCmdY)));
  EXPECT_EQ(channel(found(series(last_bit_of(kCmdY))), "ref_linear").same_as, "/two/ref_linear");
  EXPECT_EQ(channel(found(series()), "ref_linear").same_as, "/one/ref_linear");
}

TEST_F(SharedSignalsTest, HaveTheSameIndex) {
  add("one", series());
  const SeriesLayout layout = found(series(last_bit_of(0)));
  EXPECT_EQ(layout.index_same_as, "");
  EXPECT_EQ(layout.labels.front().same_as, "");
  EXPECT_EQ(channel(layout, "contour_error").same_as, "");
}

TEST_F(SharedSignalsTest, HaveTheSameScales) {
  add("one", series());
  SeriesLayout renamed = layout();
  renamed.labels.front().long_name = "axis of the table";
  const SeriesLayout layout = found(series(), renamed);
  EXPECT_EQ(layout.labels.front().same_as, "");
  EXPECT_EQ(channel(layout, "velocity_linear").same_as, "");
  EXPECT_EQ(channel(layout, "line").same_as, "/one/line");
}

// A viewer's label of what is drawn has its unit.
TEST_F(SharedSignalsTest, AreDrawnInBothOrInNone) {
  add("one", series());
  SeriesLayout drawn = layout();
  drawn.plot = {"contour_error", {"time"}, {}};
  const SeriesLayout layout = found(series(), drawn);
  EXPECT_EQ(channel(layout, "contour_error").same_as, "");
  EXPECT_EQ(channel(layout, "line").same_as, "/one/line");
}

TEST_F(SharedSignalsTest, AreThoseOfRowsOnTheDisk) {
  add("one", series());
  const Series rows = series(last_bit_of(kVelocityY));
  auto spool = std::make_shared<SeriesSpool>(
      rows.signals(), SpoolFormat{testing::TempDir(), {kChunkRows, layout().compression}});
  spool->append(rows.by_rows());
  spool->finish();
  const SeriesLayout on_disk = found(Series(rows.signals(), spool)), in_memory = found(rows);
  EXPECT_EQ(on_disk.index_same_as, in_memory.index_same_as);
  for (const Channel& one : in_memory.channels) {
    EXPECT_EQ(channel(on_disk, one.name).same_as, one.same_as) << one.name;
  }
}

TEST_F(SharedSignalsTest, ReadAsTheyWereUnderEachName) {
  const std::vector<Series> written = [] {
    std::vector<Series> all;
    all.push_back(series());
    all.push_back(series(last_bit_of(kCmdY)));
    all.push_back(series(last_bit_of(kVelocityY)));
    return all;
  }();
  for (std::size_t i = 0; i < written.size(); ++i) add("s" + std::to_string(i), written[i]);
  out_.commit();
  const InputFile in(path());
  for (std::size_t i = 0; i < written.size(); ++i) {
    const std::string group = "/s" + std::to_string(i);
    EXPECT_EQ(in.datasets(group).size(), signals().size() + 1) << "and the letters of the axes";
    for (const Signal& signal : written[i].signals()) {
      const std::string name = group + "/" + signal.name;
      EXPECT_EQ(in.meaning(name).long_name, signal.long_name) << name;
      for (std::size_t c = 0; c < signal.columns(); ++c) {
        const std::vector<double> values = in.column(name, c, 0, kRows);
        for (std::size_t n = 0; n < kRows; ++n) {
          EXPECT_EQ(values[n], written[i].at(n, signal.offset + c)) << name << ", row " << n;
        }
      }
    }
  }
}

TEST(LongNameOfAll, TellsWhichNameMeansWhat) {
  const Channel ref{"ref", {"mm", "interpolated"}, ""}, cmd{"cmd", {"mm", "setpoint"}, ""};
  const std::string both = long_name_of_all(std::vector<const Channel*>{&ref, &cmd});
  EXPECT_EQ(both, "ref: interpolated = cmd: setpoint");
  EXPECT_EQ(own_long_name(both, "ref"), "interpolated");
  EXPECT_EQ(own_long_name(both, "cmd"), "setpoint");
  EXPECT_EQ(own_long_name("setpoint", "cmd"), "setpoint");
}

}  // namespace
}  // namespace servomill::sim::records::shared_signals_test
