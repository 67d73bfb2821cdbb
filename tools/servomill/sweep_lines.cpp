#include "tools/servomill/sweep_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "sim/model/scenario.h"
#include "sim/sweep/statistics.h"
#include "sim/system/json.h"

namespace servomill::tools {
namespace {

constexpr std::size_t kMinWidth = 9;  // of a column

std::string number(double value) {
  return std::isfinite(value) ? fmt::format("{:.5g}", value) : "-";
}

// "q3": how a line of the comparison is called in the heading.
std::string label(std::size_t row) { return fmt::format("q{}", row + 1); }

std::size_t width_of(const std::string& heading) { return std::max(kMinWidth, heading.size()); }

}  // namespace

SweepLines::SweepLines(Form form, const sim::model::SweepDesign& design,
                       std::vector<sim::evaluation::ComparisonRow> rows,
                       const sim::sweep::Selection& selection, std::vector<bool> done)
    : form_(form),
      design_(design),
      rows_(std::move(rows)),
      selection_(selection),
      done_(std::move(done)) {
  done_.resize(selection_.size(), false);
}

std::string SweepLines::heading() const {
  std::string out;
  for (std::size_t n = 0; n < rows_.size(); ++n) {
    const sim::evaluation::ComparisonRow& row = rows_[n];
    out += fmt::format("{:<4} {}", label(n), row.quantity);
    for (const std::string& more : {row.axis, row.statistic, row.sections, row.case_name}) {
      if (!more.empty()) out += ", " + more;
    }
    if (row.unit != "1") out += fmt::format(" ({})", row.unit);
    out += '\n';
  }
  out += "\npoint";
  for (const sim::model::SweepKey& key : design_.keys) {
    out += fmt::format("  {:>{}}", key.key, width_of(key.key));
  }
  for (std::size_t n = 0; n < rows_.size(); ++n)
    out += fmt::format("  {:>{}}", label(n), kMinWidth);
  return out + '\n';
}

std::string SweepLines::line_of(const sim::sweep::SweepPoint& point) const {
  std::string out = fmt::format("{:>5}", point.index + 1);
  for (std::size_t k = 0; k < point.values.size(); ++k) {
    out += fmt::format("  {:>{}}", point.values[k], width_of(design_.keys[k].key));
  }
  for (const sim::evaluation::ComparisonRow& row : point.result.rows) {
    out += fmt::format("  {:>{}}", number(row.value), kMinWidth);
  }
  return out + '\n';
}

SweepLines::Said SweepLines::said_of(const sim::sweep::SweepPoint& point) const {
  Said said;
  std::string where;
  for (std::size_t k = 0; k < point.values.size(); ++k) {
    where += fmt::format("{}{} = {}", k == 0 ? "" : ", ", design_.keys[k].key, point.values[k]);
  }
  const sim::run::BatchResult& result = point.result;
  if (!result.reason.empty()) {
    said.error = fmt::format("point {} ({}): {}: {}\n", point.index + 1, where,
                             sim::run::name_of(result.status), result.reason);
  }
  if (form_ == Form::json) {
    for (const auto& row : result.rows) {
      said.objects.push_back(sim::system::JsonObject()
                                 .text("point", where)
                                 .raw("row", sim::evaluation::to_json(row))
                                 .line());
    }
  } else if (form_ == Form::table && !result.rows.empty()) {
    said.out = line_of(point);
  }
  return said;
}

void SweepLines::add(const sim::sweep::SweepPoint& point) {
  waiting_.emplace(selection_.place(point.index), said_of(point));
  for (; next_ < selection_.size(); ++next_) {
    const auto first = waiting_.find(next_);
    if (first != waiting_.end()) {
      print(first->second);
      waiting_.erase(first);
    } else if (!done_[next_]) {
      break;
    }
  }
  std::fflush(stdout);  // to a pipe, too
}

void SweepLines::finish() {
  for (const auto& [place, said] : waiting_) print(said);
  waiting_.clear();
  if (form_ == Form::json) list_.end();
  std::fflush(stdout);
}

void SweepLines::print(const Said& said) {
  if (!said.out.empty() && form_ == Form::table && !headed_) {
    fmt::print("{}", heading());
    headed_ = true;
  }
  fmt::print(stderr, "{}", said.error);
  fmt::print("{}", said.out);
  for (const std::string& object : said.objects) list_.add(object);
}

std::string points_by_status(const sim::sweep::StatusCounts& counts) {
  std::string text;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    // done first, then all others that there are
    const std::size_t status = i == 0 ? 1 : i == 1 ? 0 : i;
    if (status != 1 && counts[status] == 0) continue;
    std::string name(sim::run::name_of(static_cast<sim::run::PointStatus>(status)));
    std::replace(name.begin(), name.end(), '_', ' ');
    text += fmt::format("{}{} points {}", text.empty() ? "" : ", ", counts[status], name);
  }
  return text;
}

void print_statistics(const std::string& table) {
  constexpr std::size_t kMaxLines = 100;
  const auto quantities = sim::sweep::sample_statistics(table);
  if (quantities.empty()) return;
  fmt::print("\n{}\n", sim::sweep::format_statistics(quantities, kMaxLines));
}

void tell_estimate(sim::preparation::RunEstimate takes, std::uint64_t points, unsigned threads,
                   bool series) {
  if (points > 0 && takes.is_thinned)
    fmt::print(stderr, "{}\n", sim::preparation::thinning_message(takes));
  takes = sim::preparation::estimate_of_points(takes, points, threads);
  if (!series) takes.size = takes.file = 0.0;
  if (points == 0 || !sim::preparation::is_worth_telling(takes)) return;
  fmt::print(stderr, "estimate: {} points like the first: {}\n", points,
             sim::preparation::to_string(takes));
}

void tell_refused_samples(const sim::model::SweepDesign& design,
                          const sim::sweep::StatusCounts& counts) {
  const auto refused = counts[static_cast<std::size_t>(sim::run::PointStatus::refused)];
  if (refused == 0 || design.joint.empty()) return;
  std::vector<std::string> names;
  for (const auto& file : design.sample_files) names.push_back(file.name);
  fmt::print(stderr,
             "{} points refused: samples{} reach values that the machine does not accept and are "
             "excluded from its quantities; narrow the interval by recordings that excite these "
             "keys more, or remove the keys from [identified]\n",
             refused, names.empty() ? "" : fmt::format(" of {}", fmt::join(names, ", ")));
}

void tell_mixed_levels(const std::string& path, const std::vector<SimdLevel>& levels) {
  // those with fused multiply-add give the same bits
  if (levels.size() < 2 || levels.front() != SimdLevel::baseline) return;
  std::vector<std::string_view> names;
  for (const SimdLevel level : levels) names.push_back(name_of(level));
  fmt::print(stderr,
             "{}: points were computed with different instructions ({}; column simd_level): they "
             "differ only in their last bits; SERVOMILL_SIMD={} gives the same bits everywhere\n",
             path, fmt::join(names, ", "), names.front());
}

}  // namespace servomill::tools
