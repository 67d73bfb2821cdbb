#include "sim/records/row_thinning.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/records/row_keeper.h"

namespace servomill::sim::records::row_thinning_test {
namespace {

constexpr std::size_t kRows = 20000;
constexpr std::size_t kBlock = 50;       // rows that a block of the program lasts
constexpr std::size_t kReversal = 1730;  // rows from one reversal of X to the next
constexpr double kSingle = 1e-6;         // relative: means are kept as float32

std::vector<Signal> signals() {
  return {{"time", "s", "", "", ""},
          {"s", "mm", "", "", ""},
          {"line", "1", "", "", ""},
          {"section", "1", "", "", ""},
          {"rapid", "1", "", "", ""},
          {"ref_linear", "mm", "", "XYZ", "axis_linear"},
          {"following_error_linear", "um", "", "XYZ", "axis_linear"},
          {"tool_deviation", "um", "", "XYZ", "xyz"},
          {"tool_axis_nominal", "1", "", "IJK", "ijk"},
          {"tool_axis_true", "1", "", "IJK", "ijk"},
          {"contour_error", "um", "", "", ""}};
}

// Sections 0, 1 and 0 again; a rapid move in the second.
double section_at(std::size_t n) { return n >= 8000 && n < 8500 ? 1.0 : 0.0; }
double rapid_at(std::size_t n) { return n >= 8100 && n < 8200 ? 1.0 : 0.0; }

// Largest once, between everything that makes a row stay.
double contour_error_at(std::size_t n) {
  return 10.0 + 0.9 * std::sin(0.37 * static_cast<double>(n)) + (n == 12345 ? 0.05 : 0.0);
}

std::vector<double> rows() {
  std::vector<double> out;
  for (std::size_t n = 0; n < kRows; ++n) {
    const double t = static_cast<double>(n);
    const double e = contour_error_at(n);
    const std::size_t turn = n % (2 * kReversal);
    const double x = static_cast<double>(turn < kReversal ? turn : 2 * kReversal - turn);
    const double tilt = 1e-5 * std::sin(0.11 * t);
    const double row[] = {1e-3 * t,
                          0.1 * t,
                          static_cast<double>(n / kBlock),
                          section_at(n),
                          rapid_at(n),
                          x,
                          t,
                          0.0,
                          std::sin(t),
                          std::cos(0.3 * t),
                          0.0,
                          e,
                          0.0,
                          0.0,
                          0.0,
                          0.0,
                          1.0,
                          std::sin(tilt),
                          0.0,
                          std::cos(tilt),
                          e};
    out.insert(out.end(), std::begin(row), std::end(row));
  }
  return out;
}

class Thinned : public testing::Test {
 protected:
  // Rows that stay if they may take so many bytes; what is accounted for is `bytes_per_row`.
  Series thin(double bytes, std::vector<bool> keep_all = {}, std::size_t portion = 1000) {
    RowThinning thinning(signals(),
                         {.bytes = bytes, .rows = kRows, .keep_all = std::move(keep_all)});
    std::vector<double> out;
    const std::span<const double> all(all_);
    for (std::size_t n = 0; n < kRows; n += portion) {
      const std::size_t count = std::min(portion, kRows - n);
      thinning.add(all.subspan(n * width_, count * width_), out);
    }
    thinning.finish(out);
    Series series(thinning.signals());
    series.append(out);
    return series;
  }
  static std::vector<double> column(const Series& series, std::string_view name,
                                    char label = '\0') {
    std::vector<double> out;
    const std::size_t c = series.column(name, label).value();
    for (std::size_t row = 0; row < series.rows(); ++row) out.push_back(series.at(row, c));
    return out;
  }
  static double row_bytes() {
    return static_cast<double>(Series(RowThinning(signals(), {}).signals()).width() * 8);
  }

  const std::vector<double> all_ = rows();
  const std::size_t width_ = Series(signals()).width();
};

TEST_F(Thinned, EveryRowStaysWhereAllMay) {
  const Series series = thin(1e9);
  ASSERT_EQ(series.rows(), kRows);
  for (const double samples : column(series, kSamples)) EXPECT_EQ(samples, 1.0);
  EXPECT_EQ(column(series, "contour_error"), column(series, "contour_error_max"));
}

TEST_F(Thinned, RowsTellOfAllThatAreLeftOut) {
  const Series series = thin(400.0 * row_bytes() / 4.0);
  ASSERT_LT(series.rows(), kRows / 20);
  const auto samples = column(series, kSamples);
  const auto least = column(series, "contour_error_min");
  const auto greatest = column(series, "contour_error_max");
  const auto mean = column(series, "contour_error_mean");
  const auto rms = column(series, "contour_error_rms");
  double count = 0.0, sum = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    count += samples[i];
    sum += samples[i] * mean[i];
    squares += samples[i] * rms[i] * rms[i];
  }
  double of_all = 0.0, squares_of_all = 0.0, largest = 0.0, smallest = 1e9;
  for (std::size_t n = 0; n < kRows; ++n) {
    const double e = contour_error_at(n);
    of_all += e;
    squares_of_all += e * e;
    largest = std::max(largest, e);
    smallest = std::min(smallest, e);
  }
  EXPECT_EQ(count, static_cast<double>(kRows));
  EXPECT_EQ(*std::max_element(greatest.begin(), greatest.end()), largest);
  EXPECT_EQ(*std::min_element(least.begin(), least.end()), smallest);
  EXPECT_NEAR(sum, of_all, kSingle * of_all);
  EXPECT_NEAR(squares, squares_of_all, kSingle * squares_of_all);
}

TEST_F(Thinned, DistanceAndAngleOfTheToolAreToldToo) {
  const Series series = thin(400.0 * row_bytes() / 4.0);
  const auto tip = column(series, "tcp_deviation_max");
  const auto axis = column(series, "tool_axis_deviation_max");
  double largest_tip = 0.0, largest_axis = 0.0;
  for (std::size_t n = 0; n < kRows; ++n) {
    largest_tip = std::max(largest_tip, contour_error_at(n));  // along X
    largest_axis = std::max(largest_axis, 10.0 * std::abs(std::sin(0.11 * static_cast<double>(n))));
  }
  EXPECT_EQ(*std::max_element(tip.begin(), tip.end()), largest_tip);
  EXPECT_NEAR(*std::max_element(axis.begin(), axis.end()), largest_axis, 1e-9);  // urad
}

TEST_F(Thinned, FirstAndLastRowAndChangesOfSectionAndRapidStay) {
  const auto time = column(thin(0.0), "time");
  for (const double n : {0.0, 7999.0, 8099.0, 8199.0, 8499.0, kRows - 1.0}) {
    EXPECT_TRUE(std::find(time.begin(), time.end(), 1e-3 * n) != time.end()) << n;
  }
  EXPECT_LT(time.size(), 12U);
}

TEST_F(Thinned, ReversalsAndBlockEndsStayWhereThereIsRoom) {
  // half of the rows are for events: 400 ends of blocks and 11 reversals
  const auto time = column(thin(4000.0 * row_bytes() / 4.0), "time");
  std::size_t missed = 0;
  for (std::size_t n = kBlock; n <= kRows; n += kBlock) {
    const double end = 1e-3 * static_cast<double>(n - 1);
    missed += std::find(time.begin(), time.end(), end) == time.end() ? 1 : 0;
  }
  for (std::size_t n = kReversal; n < kRows; n += kReversal) {
    const double turn = 1e-3 * static_cast<double>(n);
    missed += std::find(time.begin(), time.end(), turn) == time.end() ? 1 : 0;
  }
  EXPECT_LT(missed, 40U);
}

TEST_F(Thinned, SectionsThatAreKeptWholeAre) {
  const Series series = thin(0.0, {false, true});
  const auto samples = column(series, kSamples);
  const auto section = column(series, "section");
  EXPECT_EQ(std::count(section.begin(), section.end(), 1.0), 500);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (section[i] == 1.0) {
      EXPECT_EQ(samples[i], 1.0);
    }
  }
}

TEST_F(Thinned, DoesNotDependOnPortions) {
  const double bytes = 1000.0 * row_bytes() / 4.0;
  const Series one = thin(bytes), other = thin(bytes, {}, 37);
  EXPECT_EQ(one.by_rows(), other.by_rows());
}

TEST_F(Thinned, TakesWhatItMayOnTheDisk) {
  for (const double bytes : {50e3, 200e3, 1e6}) {
    RowKeeper keeper(signals(), {.folder = testing::TempDir(), .thinning = ThinningLimits{bytes}},
                     kRows);
    const std::span<const double> all(all_);
    for (std::size_t n = 0; n < kRows; n += 1000) {
      keeper.add(all.subspan(n * width_, 1000 * width_));
    }
    const Series series = keeper.take();
    double taken = 0.0;
    std::vector<std::uint8_t> chunk;
    const ColumnPages& pages = *series.pages();
    for (std::size_t page = 0; page * pages.page_rows() < pages.rows(); ++page) {
      for (std::size_t column = 0; column < series.width(); ++column) {
        pages.read_encoded(column, page, chunk);
        taken += static_cast<double>(chunk.size());
      }
    }
    EXPECT_LE(taken, bytes);
    EXPECT_GT(taken, 0.4 * bytes);
  }
}

}  // namespace
}  // namespace servomill::sim::records::row_thinning_test
