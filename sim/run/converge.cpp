#include "sim/run/converge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "plant/vocabulary/parameters.h"
#include "plant/vocabulary/progress.h"
#include "plant/vocabulary/units.h"
#include "sim/config/quantity.h"
#include "sim/engine/case_result.h"
#include "sim/evaluation/quantity.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "sim/preparation/preparation_cache.h"
#include "sim/run/day_course.h"
#include "sim/run/run_case.h"
#include "sim/run/run_output.h"
#include "sim/run/test_sheet.h"
#include "sim/system/json.h"
#include "sim/system/text_table.h"

namespace servomill::sim::run {
namespace {

constexpr std::array<RefinementInfo, kRefinements> kInfos = {{
    {"recording", "recording period"},
    {"block", "length of blocks of rewritten programs, their chord tolerance a quarter"},
    {"solver", "solver tolerance of nonlinear drives"},
    {"tick", "base period"},
}};
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kOfFirstOrder = 2.0;  // error over the change by halving

std::string assignment(const std::string& key, double value, std::string_view unit) {
  return fmt::format("{}=\"{:.15g} {}\"", key, value, unit);
}

bool is_of_blocks(const ParameterSpec& spec) {
  return spec.shortcoming == Shortcoming::block_length ||
         spec.shortcoming == Shortcoming::chord_tolerance;
}

// Names of the parameters of blocks that have not their defaults.
std::vector<std::string_view> set_for_blocks(const model::StrategySpec& strategy) {
  std::vector<std::string_view> out;
  for (const ParameterSpec& spec : strategy.entry->parameters) {
    if (!is_of_blocks(spec)) continue;
    const config::ParsedUnit unit = config::parse_unit(spec.unit);
    const double by_default =
        std::stod(std::string(spec.default_text)) * (unit.unit ? unit.unit->factor : 1.0);
    const double value = strategy.parameters.number(spec.name);
    if (std::abs(value - by_default) > 1e-9 * by_default) out.push_back(spec.name);
  }
  return out;
}

// Lengths and tolerances of the blocks that strategies write, where none of them is an input: a
// finer tolerance would shorten blocks of an identified length, too.
std::vector<std::string> halved_blocks(const model::Scenario& scenario) {
  std::vector<std::string> out;
  for (std::size_t c = 0; c < scenario.cases.size(); ++c) {
    const auto& strategies = scenario.cases[c].strategies;
    for (std::size_t k = 0; k < strategies.size(); ++k) {
      if (!set_for_blocks(strategies[k]).empty()) continue;
      for (const ParameterSpec& spec : strategies[k].entry->parameters) {
        if (!is_of_blocks(spec)) continue;
        const bool is_length = spec.shortcoming == Shortcoming::block_length;
        const double share = is_length ? 0.5 : 0.25;
        const config::ParsedUnit unit = config::parse_unit(spec.unit);
        const bool is_angle = unit.unit && unit.unit->quantity == config::kAngle;
        out.push_back(assignment(fmt::format("case[{}].strategy[{}].{}", c, k, spec.name),
                                 share * strategies[k].parameters.number(spec.name),
                                 is_angle ? "rad" : "m"));
      }
    }
  }
  return out;
}

// The tolerance, where any drive is solved for and not propagated.
std::vector<std::string> halved_solver(const model::Scenario& scenario) {
  const auto solves = [](const model::MachineSettings& machine) {
    return std::any_of(machine.drives.begin(), machine.drives.end(), [&](const auto& drive) {
      return machine.integrator == model::Integrator::cvode || !drive.is_linear();
    });
  };
  const bool any =
      std::any_of(scenario.cases.begin(), scenario.cases.end(), [&](const model::CaseSpec& one) {
        return one.servo != model::ServoModel::ideal && solves(scenario.machine_of(one));
      });
  if (!any) return {};
  const double tolerance = scenario.machine.drives.front().solver_tolerance;
  return {assignment("machine.solver_tolerance_nm", 0.5 * tolerance, "m")};
}

// No change of a comparison is of these.
void leave_out(model::Scenario& scenario) {
  scenario.day.reset();
  scenario.record.windows = {};
}

// The scenario with a step halved, or why it cannot be.
struct Halved {
  std::optional<model::Scenario> scenario;
  std::string why_not;
};

Halved halve(const input::ScenarioSource& source, const std::vector<std::string>& changes) {
  try {
    Halved out{source.at(changes), ""};
    leave_out(*out.scenario);
    check_scenario(*out.scenario);
    return out;
  } catch (const InputError& error) {
    std::vector<std::string> faults;
    for (const Fault& fault : error.faults()) faults.push_back(fault.message);
    return {std::nullopt, fmt::format("{}", fmt::join(faults, "; "))};
  }
}

std::string number(double value) {
  if (std::isnan(value)) return "-";
  return value == 0.0 ? "0" : fmt::format("{:+.2g}", value);
}

// A share of the imposed displacement is as uncertain as the displacement is. What that is follows
// from the residual, which is evaluated with it.
constexpr std::string_view kForShares = "for shares";  // kind of a quantity that is not printed

void add_residuals_of_shares(model::Scenario& scenario) {
  const std::vector<model::QuantitySpec> given = scenario.quantities;
  for (const model::QuantitySpec& spec : given) {
    const evaluation::QuantityEntry& share = evaluation::quantity_entry(spec.name);
    if (share.derived_from.empty() || share.unit != "%") continue;
    model::QuantitySpec& residual = scenario.quantities.emplace_back(spec);
    residual.name = share.derived_from;
    residual.statistic = "max";
    residual.basis = kForShares;
  }
}

// Resolution in % of a share, in the order of comparison rows: r / (residual / (1 - share)).
double resolution_of_share(const model::Scenario& scenario, const evaluation::ComparisonRow& share,
                           std::span<const evaluation::ComparisonRow> rows) {
  constexpr double kPercent = 100.0;
  for (const evaluation::ComparisonRow& residual : rows) {
    if (residual.basis != kForShares || residual.case_name != share.case_name ||
        residual.axis != share.axis || residual.sections != share.sections) {
      continue;
    }
    const double imposed = residual.value / (1.0 - share.value / kPercent);
    const double resolution = kPercent * resolution_of(scenario, residual) / imposed;
    return std::isfinite(resolution) ? std::abs(resolution) : 0.0;
  }
  return 0.0;
}

// The power of ten of the last digit that an error does not reach.
int last_place(double error) { return static_cast<int>(std::ceil(std::log10(2.0 * error))); }

}  // namespace

const RefinementInfo& info_of(Refinement refinement) {
  return kInfos[static_cast<std::size_t>(refinement)];
}

double ConvergedRow::error() const {
  double sum = 0.0;
  for (const double one : change) sum += std::abs(one);
  return std::isnan(sum) ? sum : std::max(kOfFirstOrder * sum, 0.5 * resolution);
}

bool ConvergedRow::is_limited_by_resolution() const {
  ConvergedRow exact = *this;
  exact.resolution = 0.0;
  return exact.error() < error();
}

int ConvergedRow::digits() const {
  if (!std::isfinite(row.value) || !std::isfinite(error())) return 0;
  if (error() == 0.0) return kAllDigits;
  if (row.value == 0.0) return 0;
  const int first = static_cast<int>(std::floor(std::log10(std::abs(row.value))));
  return std::clamp(first + 1 - last_place(error()), 0, kAllDigits);
}

std::string ConvergedRow::stable() const {
  if (digits() == 0) return "-";
  if (error() == 0.0 || digits() == kAllDigits)
    return fmt::format("{:.{}g}", row.value, kAllDigits);
  const int place = last_place(error());
  if (place <= 0) return fmt::format("{:.{}f}", row.value, -place);
  const double unit = std::pow(10.0, place);
  return fmt::format("{:.0f}", std::round(row.value / unit) * unit);
}

double resolution_of(const model::Scenario& scenario, const evaluation::ComparisonRow& row) {
  const bool is_linear = row.unit == "um";
  if (!is_linear && row.unit != "urad") return 0.0;
  const double unit = is_linear ? um : urad;
  double largest = scenario.record.format.resolution;  // angles are rounded as seen from 1 m
  for (const model::CaseSpec& one : scenario.cases) {
    if (one.name != row.case_name || one.servo == model::ServoModel::ideal) continue;
    const model::MachineSettings& machine = scenario.machine_of(one);
    const auto joints = machine.joints();
    const auto is_named = [&](int j) {
      return row.axis == std::string(1, machine.chain.layout.letter_of(j));
    };
    const bool one_axis = std::any_of(joints.begin(), joints.end(), is_named);
    for (const int j : joints) {
      if ((j < kLinearJoints) != is_linear || (one_axis && !is_named(j))) continue;
      largest = std::max(largest, machine.scale[static_cast<std::size_t>(j)].step());
    }
  }
  return largest / unit;
}

std::vector<std::string> blocks_as_inputs(const model::Scenario& scenario) {
  std::vector<std::string> out;
  for (const model::CaseSpec& one : scenario.cases) {
    for (const model::StrategySpec& strategy : one.strategies) {
      const auto set = set_for_blocks(strategy);
      if (set.empty()) continue;
      out.push_back(fmt::format("case {}: strategy {}: {}", one.name, strategy.entry->name,
                                fmt::join(set, ", ")));
    }
  }
  return out;
}

std::vector<std::string> halved(Refinement refinement, const model::Scenario& scenario) {
  const model::LoopPeriods& periods = scenario.machine.nc.periods;
  switch (refinement) {
    case Refinement::recording:
      return {assignment("record.period_ms", 0.5 * periods.seconds(scenario.record_period), "s")};
    case Refinement::block:
      return halved_blocks(scenario);
    case Refinement::solver:
      return halved_solver(scenario);
    case Refinement::tick:
      return {assignment("machine.nc.base_period_us", 0.5 * periods.base, "s")};
  }
  return {};
}

namespace {

// Note on parts of the scenario that the command leaves out, if any.
std::optional<std::string> leave_out_parts(model::Scenario& base) {
  std::optional<std::string> note = note_of_missing_tests(base, "converge");
  if (base.day && !note) note = kDayLeftOut;
  if (base.record.windows.limited()) {
    note = fmt::format("{}{}", note ? *note + "; " : "", model::kWindowsLeftOut);
  }
  leave_out(base);
  return note;
}

}  // namespace

std::optional<Convergence> find_convergence(const input::ScenarioSource& source,
                                            const std::set<Refinement>& refinements,
                                            const ConvergeControl& control) {
  model::Scenario base = source.at();
  const std::optional<std::string> note = leave_out_parts(base);
  add_residuals_of_shares(base);
  preparation::PreparationCache cache;
  Stage runs("runs", 1.0 + static_cast<double>(refinements.size()));
  RunControl run;
  run.threads = control.threads;
  run.stop = control.stop;
  run.cache = &cache;
  const auto stopped = [&] { return control.stop != nullptr && *control.stop; };

  Convergence out;
  out.note = note;
  const RunOutput as_it_is = run_scenario(base, run);
  for (const CaseOutput& one : as_it_is.cases) {
    const engine::Outcome& outcome = one.result.outcome;
    if (!outcome.finished)
      out.stopped.push_back(fmt::format("case {}: {}", one.name, outcome.reason));
  }
  for (const evaluation::ComparisonRow& row : as_it_is.comparison) {
    if (row.basis == kForShares) continue;
    const double resolution = row.unit == "%" ? resolution_of_share(base, row, as_it_is.comparison)
                                              : resolution_of(base, row);
    out.rows.push_back({row, {}, resolution});
  }
  if (refinements.contains(Refinement::block)) out.inputs = blocks_as_inputs(base);
  for (const Refinement refinement : refinements) {
    runs.advance();
    if (stopped()) return std::nullopt;
    const auto index = static_cast<std::size_t>(refinement);
    const std::vector<std::string> changes = halved(refinement, base);
    if (changes.empty()) continue;  // nothing to halve, nothing changes
    const Halved finer = halve(source, changes);
    out.why_not[index] = finer.why_not;
    std::vector<evaluation::ComparisonRow> rows;
    if (finer.scenario) rows = run_scenario(*finer.scenario, run).comparison;
    for (std::size_t n = 0; n < out.rows.size(); ++n) {
      const double before = out.rows[n].row.value;
      out.rows[n].change[index] = n < rows.size() ? rows[n].value - before : kNone;
    }
  }
  if (stopped()) return std::nullopt;
  return out;
}

std::string format_table(const Convergence& found) {
  std::vector<std::vector<std::string>> lines = {
      {"quantity", "axis", "statistic", "section", "case", "value"}};
  for (const RefinementInfo& info : kInfos) lines[0].emplace_back(info.name);
  for (const char* heading : {"digits", "stable", "unit"}) lines[0].emplace_back(heading);
  for (const ConvergedRow& one : found.rows) {
    const evaluation::ComparisonRow& row = one.row;
    std::vector<std::string>& line = lines.emplace_back();
    line = {row.quantity,  row.axis,
            row.statistic, row.sections,
            row.case_name, std::isfinite(row.value) ? fmt::format("{:.6g}", row.value) : "-"};
    for (const double change : one.change) line.push_back(number(change));
    line.push_back(fmt::format("{}{}", one.digits(), one.is_limited_by_resolution() ? "r" : ""));
    line.push_back(one.stable());
    line.push_back(row.unit == "1" ? "" : row.unit);
  }
  std::string out = system::text_table(std::move(lines), 4, {5, 6, 7, 8, 9, 10, 11});
  if (std::any_of(found.rows.begin(), found.rows.end(),
                  [](const ConvergedRow& one) { return one.is_limited_by_resolution(); })) {
    out += "r: limited by the resolution of the recording or of the scales, not by a step\n";
  }
  for (const std::string& input : found.inputs) {
    out += fmt::format("not halved: {}: not the default, an input of the scenario\n", input);
  }
  for (std::size_t n = 0; n < kRefinements; ++n) {
    if (found.why_not[n].empty()) continue;
    out += fmt::format("not halved: {}: {}\n", kInfos[n].help, found.why_not[n]);
  }
  return out;
}

std::string to_json(const ConvergedRow& one) {
  system::JsonObject changes;
  for (std::size_t n = 0; n < kRefinements; ++n) changes.number(kInfos[n].name, one.change[n]);
  const std::string row = evaluation::to_json(one.row);
  const int digits = one.digits();
  const std::string more = system::JsonObject()
                               .raw("changes", changes.line())
                               .number("resolution", one.resolution)
                               .integer("digits", digits)
                               .text_or_null("stable", digits == 0 ? "" : one.stable())
                               .line();
  return fmt::format("{}, {}", std::string_view(row).substr(0, row.size() - 1),
                     std::string_view(more).substr(1));
}

}  // namespace servomill::sim::run
