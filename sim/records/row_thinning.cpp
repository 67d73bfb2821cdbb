#include "sim/records/row_thinning.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>

#include "plant/vocabulary/tool_axis.h"
#include "plant/vocabulary/units.h"

namespace servomill::sim::records {
namespace {

constexpr double kShare = 0.97;            // of the limit; the rest is for what the file notes
constexpr double kUsualCompression = 4.0;  // until it is known
constexpr double kLongest = 1e4;           // rows that one stands for in any case
constexpr double kMaxSaved = 1e4;          // events that were not needed before
constexpr double kForBlocks = 64.0;    // events: blocks and reversals come before the contour error
constexpr double kContourShare = 0.1;  // of the greatest contour error
constexpr double kMinContourError = 0.1;  // um; changes below it are nothing

std::size_t column_of(const Series& series, std::string_view name) {
  return series.column(name).value();
}

Eigen::Vector3d vector_at(std::span<const double> row, std::size_t first) {
  return {row[first], row[first + 1], row[first + 2]};
}

double as_single(double value) { return static_cast<double>(static_cast<float>(value)); }

}  // namespace

RowThinning::RowThinning(const std::vector<Signal>& signals, ThinningLimits limits)
    : limits_(std::move(limits)), signals_(signals) {
  const Series coming(signals);
  width_ = coming.width();
  if (limits_.every > 0) time_ = column_of(coming, "time");
  window_ = coming.column("window");
  in_window_ = coming.column("in_window");
  line_ = column_of(coming, "line");
  section_ = column_of(coming, "section");
  rapid_ = column_of(coming, "rapid");
  contour_error_ = column_of(coming, "contour_error");
  for (const Signal& signal : coming.signals()) {
    if (!signal.name.starts_with("ref_")) continue;
    for (std::size_t c = 0; c < signal.columns(); ++c) axes_.push_back(signal.offset + c);
  }
  signals_.push_back({.name = std::string(kSamples),
                      .units = "1",
                      .long_name = "number of instants that the row represents: itself and those "
                                   "omitted before it",
                      .labels = "",
                      .scale = "",
                      .storage = Storage::int32});
  for (const Signal& signal : coming.signals()) {
    const std::string& name = signal.name;
    if (name == "following_error_linear" || name == "tool_deviation" || name == "contour_error") {
      watch(signal, {.from = signal.offset, .has_mean = true});
    } else if (name == "following_error_rotary" || name.starts_with("current_")) {
      watch(signal, {.from = signal.offset});
    }
  }
  watch_tool(coming);
  senses_.assign(axes_.size(), 0);
  bytes_per_row_ =
      static_cast<double>(Series(signals_).width() * sizeof(double)) / kUsualCompression;
  spread();
}

// Distance and angle of the tool, which no column of the rows holds.
void RowThinning::watch_tool(const Series& coming) {
  Signal tip = *coming.find("tool_deviation"), axis = *coming.find("tool_axis_nominal");
  tip.name = "tcp_deviation";
  tip.long_name = "distance of the true from the nominal tool centre point at equal s";
  axis.name = "tool_axis_deviation";
  axis.long_name = "angle between the true and the nominal tool axis at equal s";
  axis.units = "urad";
  tip.labels = tip.scale = axis.labels = axis.scale = "";
  watch(tip, {.kind = Watched::Kind::length, .from = tip.offset, .has_mean = true});
  watch(axis, {.kind = Watched::Kind::angle,
               .from = axis.offset,
               .other = coming.find("tool_axis_true")->offset,
               .has_mean = true});
}

void RowThinning::watch(const Signal& signal, Watched watched) {
  watched.columns = signal.columns();
  watched.is_single = signal.storage == Storage::float32;
  watched_.push_back(watched);
  statistics_.resize(statistics_.size() + watched.columns);
  const auto add = [&](const char* suffix, const char* what, Storage storage) {
    Signal one = signal;
    one.name += suffix;
    one.long_name = std::string(what) + " of the samples: " + signal.long_name;
    one.storage = storage;
    signals_.push_back(std::move(one));
  };
  add("_min", "minimum", signal.storage);
  add("_max", "maximum", signal.storage);
  if (!watched.has_mean) return;
  add("_mean", "mean", Storage::float32);
  add("_rms", "root mean square", Storage::float32);
}

void RowThinning::add(std::span<const double> rows, std::vector<double>& out) {
  for (; !rows.empty(); rows = rows.subspan(width_)) {
    if (limits_.every > 0) {
      add_row_of_period(rows.first(width_), out);
    } else {
      add_row(rows.first(width_), out);
    }
  }
}

void RowThinning::add_row_of_period(std::span<const double> row, std::vector<double>& out) {
  const bool begins = before_.empty() || (window_ && row[*window_] != before_[*window_]);
  if (!before_.empty() && samples_ > 0 && must_stay(before_, row)) stay(before_, out);
  tell_of(row);
  if (begins || is_at_period(row)) stay(row, out);
  before_.assign(row.begin(), row.end());
}

bool RowThinning::is_at_period(std::span<const double> row) const {
  return std::llround(row[time_] / limits_.row_period) % static_cast<long long>(limits_.every) == 0;
}

void RowThinning::add_row(std::span<const double> row, std::vector<double>& out) {
  const bool is_first = before_.empty();
  if (!is_first) {
    const bool event = is_event(before_, row);
    if (samples_ > 0 && (must_stay(before_, row) || (event && takes_event()))) stay(before_, out);
  }
  tell_of(row);
  ++come_;
  events_ = std::min(kMaxSaved, events_ + events_per_row_);
  if (is_first || keeps_all(row) || static_cast<double>(samples_) >= longest_ ||
      (contour_error_has_changed(row) && events_ >= kForBlocks && takes_event())) {
    stay(row, out);
  }
  before_.assign(row.begin(), row.end());
}

void RowThinning::finish(std::vector<double>& out) {
  if (samples_ > 0) stay(before_, out);
}

// A row may stand for others of its own section and window only, and either of feed or of rapid.
bool RowThinning::must_stay(std::span<const double> before, std::span<const double> row) const {
  return row[section_] != before[section_] || row[rapid_] != before[rapid_] ||
         (window_ && row[*window_] != before[*window_]) ||
         (in_window_ && row[*in_window_] != before[*in_window_]);
}

bool RowThinning::keeps_all(std::span<const double> row) const {
  const auto section = static_cast<std::size_t>(row[section_]);
  return section < limits_.keep_all.size() && limits_.keep_all[section];
}

// Tells if a block ended or an axis reversed at the row before.
bool RowThinning::is_event(std::span<const double> before, std::span<const double> row) {
  bool any = row[line_] != before[line_];
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const double step = row[axes_[i]] - before[axes_[i]];
    if (step == 0.0) continue;
    const int sense = step > 0.0 ? 1 : -1;
    any |= sense == -senses_[i];
    senses_[i] = sense;
  }
  return any;
}

bool RowThinning::contour_error_has_changed(std::span<const double> row) {
  const double error = row[contour_error_];
  greatest_contour_error_ = std::max(greatest_contour_error_, error);
  return std::abs(error - last_contour_error_) >
         std::max(kMinContourError, kContourShare * greatest_contour_error_);
}

bool RowThinning::takes_event() {
  if (longest_ <= 1.0) return true;
  if (events_ < 1.0) return false;
  events_ -= 1.0;
  return true;
}

double RowThinning::value(const Watched& watched, std::size_t column, std::span<const double> row) {
  switch (watched.kind) {
    case Watched::Kind::column:
      return row[watched.from + column];
    case Watched::Kind::length:
      return vector_at(row, watched.from).norm();
    case Watched::Kind::angle:
      return angle_between(vector_at(row, watched.from), vector_at(row, watched.other)) / urad;
  }
  return 0.0;
}

void RowThinning::tell_of(std::span<const double> row) {
  Statistics* one_column = statistics_.data();
  for (const Watched& watched : watched_) {
    for (std::size_t c = 0; c < watched.columns; ++c, ++one_column) {
      const double v = value(watched, c, row);
      one_column->least = samples_ == 0 ? v : std::min(one_column->least, v);
      one_column->greatest = samples_ == 0 ? v : std::max(one_column->greatest, v);
      one_column->sum = samples_ == 0 ? v : one_column->sum + v;
      one_column->squares = samples_ == 0 ? v * v : one_column->squares + v * v;
    }
  }
  ++samples_;
}

void RowThinning::stay(std::span<const double> row, std::vector<double>& out) {
  out.insert(out.end(), row.begin(), row.end());
  const auto samples = static_cast<double>(samples_);
  out.push_back(samples);
  const Statistics* one_column = statistics_.data();
  for (const Watched& watched : watched_) {
    const auto put = [&](auto value, bool is_single) {
      for (std::size_t c = 0; c < watched.columns; ++c) {
        out.push_back(is_single ? as_single(value(one_column[c])) : value(one_column[c]));
      }
    };
    put([](const Statistics& one) { return one.least; }, watched.is_single);
    put([](const Statistics& one) { return one.greatest; }, watched.is_single);
    if (watched.has_mean) {
      put([&](const Statistics& one) { return one.sum / samples; }, true);
      put([&](const Statistics& one) { return std::sqrt(one.squares / samples); }, true);
    }
    one_column += watched.columns;
  }
  last_contour_error_ = row[contour_error_];
  samples_ = 0;
  ++stayed_;
}

void RowThinning::account(std::uint64_t bytes, std::size_t rows) {
  if (rows == accounted_) return;
  accounted_ = rows;
  bytes_ = static_cast<double>(bytes);
  bytes_per_row_ = bytes_ / static_cast<double>(rows);
  spread();
}

// Half of the rows that the limit leaves go to events, half to the time between them.
void RowThinning::spread() {
  const double in_memory = static_cast<double>(stayed_ - accounted_) * bytes_per_row_;
  const double left = (kShare * limits_.bytes - bytes_ - in_memory) / bytes_per_row_;
  const double coming = static_cast<double>(limits_.rows) - static_cast<double>(come_);
  const double apart = left > 0.0 ? std::max(0.0, coming) / left : kLongest;
  longest_ = apart <= 1.0 ? 1.0 : std::min(kLongest, 2.0 * apart);
  events_per_row_ = 1.0 / longest_;
}

}  // namespace servomill::sim::records
