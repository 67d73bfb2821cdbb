#include "sim/identification/interval_report.h"

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "sim/system/text_table.h"

namespace servomill::sim::identification {
namespace {

std::string bootstrap_table(const Identification& result) {
  if (!result.bootstrap) return {};
  const Bootstrap& b = *result.bootstrap;
  Lines table({"block bootstrap", "2.5 %", "97.5 %", "+- (k = 2)", "unit", "from the spectrum"});
  for (std::size_t k = 0; k < result.estimates.size(); ++k) {
    if (!result.uncertainty.identifiable[k]) continue;
    const Estimate& one = result.estimates[k];
    const double half = 2.0 * b.standard(k), spectral = 2.0 * result.uncertainty.standard(k);
    const auto [low, high] = b.interval_95(k);
    table.add({names_of(one), with_uncertainty(low, half), with_uncertainty(high, half),
               fmt::format("{:.2g}", half), one.unit, fmt::format("{:.2g}", spectral)});
  }
  return table.text() + fmt::format("{} replicas in blocks of {} samples, by the derivatives\n\n",
                                    b.values.rows(), fmt::join(b.block, ", "));
}

std::string end_text(const ProfileSide& side, double half) {
  if (side.end == ProfileEnd::open) return "open";
  const std::string value = with_uncertainty(side.value, half);
  return side.end == ProfileEnd::bound ? value + " (bound)" : value;
}

std::string profile_table(const Identification& result) {
  if (result.profiles.empty()) return {};
  Lines table({"profile (95 %)", "from", "to", "-", "+", "unit", "by the covariance"});
  std::string notes;
  for (const Profile& one : result.profiles) {
    const Estimate& estimate = result.estimates[one.parameter];
    const double half = result.uncertainty.half_width(one.parameter);
    if (one.finds_better) {
      table.add({names_of(estimate), "none", "none", "-", "-", estimate.unit,
                 fmt::format("{:.2g}", half)});
      notes += fmt::format(
          "warning: the profile of {} finds a smaller misfit: the fit ended in a local minimum; no "
          "interval is given\n",
          estimate.keys.front());
      continue;
    }
    const auto distance = [&](const ProfileSide& side) {
      return side.end == ProfileEnd::crossed
                 ? fmt::format("{:.2g}", std::abs(side.value - estimate.start))
                 : std::string("-");
    };
    table.add({names_of(estimate), end_text(one.lower, half), end_text(one.upper, half),
               distance(one.lower), distance(one.upper), estimate.unit,
               fmt::format("{:.2g}", half)});
  }
  return table.text() + notes + "\n";
}

}  // namespace

std::string Lines::text() const {
  std::set<std::size_t> right;
  for (std::size_t k = 1; k < lines_.front().size(); ++k) right.insert(k);
  return system::text_table(lines_, 0, right);
}

std::string with_uncertainty(double value, double half_width) {
  if (!(half_width > 0.0)) return fmt::format("{:.6g}", value);
  const int digits = 1 - static_cast<int>(std::floor(std::log10(half_width)));
  if (digits < 0 || digits > 12) return fmt::format("{:.5g}", value);
  return fmt::format("{:.{}f}", value, digits);
}

std::string names_of(const Estimate& one) { return fmt::format("{}", fmt::join(one.keys, " = ")); }

std::string interval_tables(const Identification& result) {
  return bootstrap_table(result) + profile_table(result);
}

}  // namespace servomill::sim::identification
