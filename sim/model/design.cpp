#include "sim/model/design.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>
#include <string_view>

#include "sim/config/value.h"
#include "sim/config/written_number.h"

namespace servomill::sim::model {
namespace {

// The shortest text that reads again to the same number.
std::string as_toml(double value, const std::string& unit) {
  const std::string number = fmt::format("{}", value);
  return unit.empty() ? number : config::quoted_text(number + " " + unit);
}

// TOML of a number between two that the user wrote, without digits that come from rounding.
std::string as_toml_between(double value, const std::string& unit) {
  constexpr int kSure = 15;  // digits
  return as_toml(std::strtod(fmt::format("{:.{}g}", value, kSure).c_str(), nullptr), unit);
}

std::string value_at(const ValueTexts& texts, std::uint64_t index) { return texts.at(index); }

std::string value_at(const SweepRange& range, std::uint64_t index) {
  if (index == 0) return as_toml(range.first, range.unit);
  if (index + 1 == range.count) return as_toml(range.last, range.unit);
  const double share = static_cast<double>(index) / static_cast<double>(range.count - 1);
  const double value = range.log ? range.first * std::pow(range.last / range.first, share)
                                 : range.first + (range.last - range.first) * share;
  return as_toml_between(value, range.unit);
}

std::string sampled(const ValueTexts& texts, double u) {
  const auto count = static_cast<double>(texts.size());
  return texts[std::min(texts.size() - 1, static_cast<std::size_t>(u * count))];
}

std::string sampled(const NumberDistribution& d, double u) {
  switch (d.kind) {
    case NumberDistribution::Kind::uniform:
      return as_toml(d.a + (d.b - d.a) * u, d.unit);
    case NumberDistribution::Kind::log_uniform:
      return as_toml(d.a * std::pow(d.b / d.a, u), d.unit);
    case NumberDistribution::Kind::normal:
      return as_toml(d.a + d.b * normal_quantile(u), d.unit);
  }
  return {};
}

// u: the sample of all dimensions.
std::string sampled(const SweepKey& key, const std::vector<JointNormal>& joint,
                    const std::vector<double>& u) {
  if (const auto* texts = std::get_if<ValueTexts>(&key.values)) {
    return sampled(*texts, u[key.dimension]);
  }
  if (const auto* number = std::get_if<NumberDistribution>(&key.values)) {
    return sampled(*number, u[key.dimension]);
  }
  const auto& member = std::get<JointMember>(key.values);
  const JointNormal& group = joint[member.group];
  double value = group.mean[member.row];
  for (std::size_t d = 0; d < group.dimensions(); ++d) {
    value += group.factor(member.row, static_cast<Eigen::Index>(d)) *
             normal_quantile(u[key.dimension + d]);
  }
  return as_toml(value, member.unit);
}

std::string value_on_grid(const SweepKey& key, std::uint64_t index) {
  const auto* texts = std::get_if<ValueTexts>(&key.values);
  return texts ? value_at(*texts, index) : value_at(std::get<SweepRange>(key.values), index);
}

}  // namespace

std::uint64_t SweepDesign::size() const {
  std::uint64_t points = sampled_dimensions > 0 ? samples.count : 1;
  for (const std::uint64_t length : grid) points *= length;
  return points;
}

std::vector<std::string> SweepDesign::point(std::uint64_t index) const {
  assert(index < size());
  std::vector<double> u;
  if (sampled_dimensions > 0) {
    u = unit_sample(samples, index % samples.count, sampled_dimensions);
    index /= samples.count;
  }
  std::vector<std::uint64_t> at(grid.size());
  for (std::size_t d = grid.size(); d-- > 0;) {
    at[d] = index % grid[d];
    index /= grid[d];
  }
  std::vector<std::string> values;
  values.reserve(keys.size());
  for (const SweepKey& key : keys) {
    values.push_back(key.sampled ? sampled(key, joint, u) : value_on_grid(key, at[key.dimension]));
  }
  return values;
}

SweepColumn SweepDesign::column(std::size_t key) const {
  const auto& values = keys[key].values;
  if (const auto* range = std::get_if<SweepRange>(&values)) return {true, range->unit, {}};
  if (const auto* number = std::get_if<NumberDistribution>(&values))
    return {true, number->unit, {}};
  if (const auto* member = std::get_if<JointMember>(&values)) return {true, member->unit, {}};
  const auto& texts = std::get<ValueTexts>(values);
  const auto first = config::written_number(texts.front());
  const auto is_alike = [&](const std::string& text) {
    const auto number = config::written_number(text);
    return number && number->unit == first->unit;
  };
  if (first && std::all_of(texts.begin(), texts.end(), is_alike)) return {true, first->unit, {}};
  SweepColumn column{false, "", {}};
  std::set<std::string_view> known;
  for (const std::string& text : texts) {
    if (known.insert(text).second) column.texts.push_back(text);
  }
  return column;
}

}  // namespace servomill::sim::model
