#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "plant/vocabulary/input_error.h"
#include "sim/input/read_scenario.h"
#include "sim/model/run_settings.h"
#include "sim/model/scenario_parts.h"
#include "sim/preparation/estimate.h"
#include "sim/run/budget.h"
#include "sim/run/budget_quantities.h"
#include "sim/run/budget_store.h"
#include "sim/run/day_course.h"
#include "sim/system/json.h"
#include "tools/servomill/command.h"
#include "tools/servomill/interrupt.h"
#include "tools/servomill/json_list.h"
#include "tools/servomill/progress_line.h"

namespace servomill::tools {
namespace {

namespace po = boost::program_options;

std::string causes_help() {
  std::string out =
      "Splits the residuals of a scenario's cases into the contributions of their causes: runs\n"
      "each case again without each cause and compares the signals at equal arc length. A long\n"
      "budget first reports the number of its runs, their time, memory and disk space. Causes:\n";
  for (std::size_t c = 0; c < sim::run::kCauses; ++c) {
    const sim::run::CauseInfo& info = sim::run::info_of(static_cast<sim::run::Cause>(c));
    out += fmt::format("  {:<18}{}\n", info.name, info.help);
  }
  out +=
      "Every cause acts through interpolation, lag and delay. Their effect on the program alone\n"
      "is their own; their effect on another cause is counted as part of that cause. Each of the\n"
      "other causes is removed alone (measurement from all runs, first), so that parts do not\n"
      "depend on an order. The interaction of causes is in the remainder. Where it exceeds a\n"
      "tenth of the residual, pairs of causes are removed, too, to show which of them interact:\n"
      "half of the interaction of a pair is added to the share of each cause, and what then\n"
      "remains is due to three or more causes. The error that remains without any cause is\n"
      "uncorrected, uncorrectable or imposed. Sums are printed by kind: static geometry, servo,\n"
      "inertia, heat, force, imposed. Quantities that have a budget: imposed_error_residual,\n"
      "trajectory_difference, tool_deviation, following_error.";
  return out;
}

template <class Names>
void must_be_among(const std::string& name, const Names& names, const char* option,
                   const char* what) {
  if (std::find(names.begin(), names.end(), name) != names.end()) return;
  const std::vector<std::string_view> views(names.begin(), names.end());
  const std::string near = did_you_mean(name, views);
  throw InputError(
      {option},
      fmt::format("no {} '{}'{}", what, name,
                  !near.empty() ? near : fmt::format("; known are: {}", fmt::join(views, ", "))));
}

// Quantities of the scenario that the options choose.
std::vector<sim::model::QuantitySpec> chosen(const sim::model::Scenario& scenario,
                                             const Options& options) {
  std::vector<std::string> also = options.list("quantity");
  std::erase_if(also, [](const std::string& name) { return !sim::run::is_of_any_case(name); });
  std::vector<sim::model::QuantitySpec> all =
      sim::run::budget_quantities(scenario, also, options.list("section"));
  if (all.empty()) {
    throw InputError({options.word()},
                     "has no quantity with a budget (imposed_error_residual, realised_ratio, "
                     "lag_time, trajectory_difference, tool_deviation, following_error); "
                     "use --quantity tool_deviation or following_error, which every case has");
  }
  if (options.has("section")) {
    for (sim::model::QuantitySpec& one : all) one.sections_place = {"--section"};
  }
  const auto keep = [&](const char* option, const char* what, auto name_of) {
    const std::vector<std::string> wanted = options.list(option);
    if (wanted.empty()) return;
    std::vector<std::string> known;
    for (const auto& one : all) {
      if (std::find(known.begin(), known.end(), name_of(one)) == known.end()) {
        known.push_back(name_of(one));
      }
    }
    for (const std::string& name : wanted) {
      must_be_among(name, known, fmt::format("--{}", option).c_str(), what);
    }
    std::erase_if(all, [&](const auto& one) {
      return std::find(wanted.begin(), wanted.end(), name_of(one)) == wanted.end();
    });
  };
  keep("quantity", "quantity with a budget", [](const auto& one) { return one.name; });
  keep("axis", "axis with a budget", [](const auto& one) { return std::string(1, one.axis); });
  keep("case", "case with a budget", [](const auto& one) { return one.cases.front(); });
  return all;
}

std::string title_of(const sim::model::QuantitySpec& quantity) {
  return fmt::format(
      "{}: {} of {}{}{}", quantity.cases.front(), quantity.name, quantity.axis,
      quantity.sections.empty() ? "" : fmt::format(", {}", fmt::join(quantity.sections, ", ")),
      quantity.baseline.empty() ? "" : fmt::format(", against {}", quantity.baseline));
}

// -0.04 with one decimal is 0, not -0.
std::string fixed(double value, int decimals) {
  const double scale = std::pow(10.0, decimals);
  return fmt::format("{:.{}f}", std::round(scale * value) / scale + 0.0, decimals);
}

std::string micrometres(double value) {
  const double size = std::abs(value);
  return fixed(value, size >= 100.0 ? 1 : size >= 10.0 ? 2 : size >= 0.1 ? 3 : 4);
}

std::string percent(double share) { return fixed(100.0 * share, 1); }

// Columns of one row: where the residual is largest, and along the path.
std::string columns(const sim::run::BudgetSignal& signal, double whole) {
  const double share = whole != 0.0 ? signal.at_place / whole : 0.0;
  return fmt::format("{:>9} um {:>7} % {:>9} um", micrometres(signal.at_place), percent(share),
                     micrometres(signal.rms));
}

// "static geometry 0.120 um, servo -0.310 um" at the place of the residual.
template <class SumOf>
std::string groups_of(SumOf sum_of) {
  std::string text;
  for (std::size_t g = 0; g < sim::run::kCauseGroups.size(); ++g) {
    const std::optional<double> sum = sum_of(static_cast<sim::run::CauseGroup>(g));
    if (!sum) continue;
    text += fmt::format("{}{} {} um", text.empty() ? "" : ", ", sim::run::kCauseGroups[g],
                        micrometres(*sum));
  }
  return text;
}

std::string pair_name(const sim::run::BudgetPair& pair) {
  return fmt::format("{} with {}", sim::run::info_of(pair.causes[0]).name,
                     sim::run::info_of(pair.causes[1]).name);
}

// Pairs that make a large remainder, and what is left of it.
void print_pairs(const sim::run::Budget& budget) {
  constexpr double kShown = 0.05;  // of the remainder
  const auto print = [](const sim::run::BudgetSignal& signal, const std::string& name) {
    fmt::print("    {:<16} {:>9} um {:>9} {:>9} um  {}\n", "of it", micrometres(signal.at_place),
               "", micrometres(signal.rms), name);
  };
  for (const sim::run::BudgetPair& pair : budget.pairs) {
    if (pair.rms >= kShown * budget.remainder.rms) print(pair, pair_name(pair));
  }
  print(budget.unexplained, "of three and more");
}

// The summary where pairs were looked for: causes with half of each of their pairs.
void print_shares(const sim::run::Budget& budget) {
  const double whole = budget.residual.at_place;
  fmt::print("  with half of each pair of causes:\n");
  for (const sim::run::BudgetPart& part : budget.parts) {
    if (!part.present) continue;
    fmt::print("  {:<18} {}\n", sim::run::info_of(part.cause).name, columns(part.share, whole));
  }
  fmt::print(
      "  {:<18} {}  {} % of the residual in rms\n", "remainder", columns(budget.unexplained, whole),
      percent(budget.residual.rms > 0.0 ? budget.unexplained.rms / budget.residual.rms : 0.0));
  fmt::print("  by kind: {}\n", groups_of([&](sim::run::CauseGroup group) {
               return budget.group_share_at_place(group);
             }));
}

// The causes that a case has, by (1) to (7) of budget.h.
void print_parts(const sim::run::Budget& budget) {
  const double whole = budget.residual.at_place;
  fmt::print("  {:<18} {:>12} {:>9} {:>12}\n", "cause", fmt::format("at s {:.1f}", budget.place_s),
             "share", "rms");
  for (const sim::run::BudgetPart& part : budget.parts) {
    if (!part.present) continue;
    const sim::run::CauseInfo& info = sim::run::info_of(part.cause);
    fmt::print("  {:<18} {}  {}\n", info.name, columns(part, whole), info.help);
  }
  const double sum = budget.sum_at_place();
  fmt::print("  {:<18} {:>9} um {:>7} %\n", "sum", micrometres(sum),
             percent(whole != 0.0 ? sum / whole : 0.0));
  fmt::print("  {:<18} {}  combined effects of causes\n", "remainder",
             columns(budget.remainder, whole));
  if (!budget.pairs.empty()) print_pairs(budget);
  fmt::print("  {:<18} {}\n", "residual", columns(budget.residual, whole));
  fmt::print("  by kind: {}\n",
             groups_of([&](sim::run::CauseGroup group) { return budget.group_at_place(group); }));
}

void print_budget(const sim::run::Budget& budget) {
  fmt::print("\n{}\n", title_of(budget.quantity));
  if (!budget.note.empty()) {
    fmt::print("  none: {}\n", budget.note);
    return;
  }
  print_parts(budget);
  if (!budget.pairs.empty()) print_shares(budget);
  std::string absent;
  for (const sim::run::BudgetPart& part : budget.parts) {
    if (part.present) continue;
    absent += fmt::format("{}{}", absent.empty() ? "" : ", ", sim::run::info_of(part.cause).name);
  }
  if (!absent.empty()) fmt::print("  not in this case: {}\n", absent);
}

// Numbers of one cause.
std::string part_json(const sim::run::BudgetPart& part, bool has_share) {
  sim::system::JsonObject out;
  out.number("at_place", part.at_place).number("rms", part.rms);
  if (has_share) out.number("share", part.share.at_place).number("share_rms", part.share.rms);
  return out.line();
}

template <class SumOf>
std::string kinds_json(SumOf sum_of) {
  sim::system::JsonObject kinds;
  for (std::size_t g = 0; g < sim::run::kCauseGroups.size(); ++g) {
    const std::optional<double> sum = sum_of(static_cast<sim::run::CauseGroup>(g));
    if (sum) kinds.number(sim::run::kCauseGroups[g], *sum);
  }
  return kinds.line();
}

// Adds pairs of causes, and what they leave.
void add_pairs(const sim::run::Budget& budget, sim::system::JsonObject& out) {
  std::vector<std::string> pairs;
  for (const sim::run::BudgetPair& pair : budget.pairs) {
    const std::vector<std::string> causes = {std::string(sim::run::info_of(pair.causes[0]).name),
                                             std::string(sim::run::info_of(pair.causes[1]).name)};
    pairs.push_back(sim::system::JsonObject()
                        .raw("causes", sim::system::json_texts(causes))
                        .number("at_place", pair.at_place)
                        .number("rms", pair.rms)
                        .line());
  }
  out.raw("pairs", sim::system::json_list(pairs));
  out.raw("share_kinds", kinds_json([&](sim::run::CauseGroup group) {
            return budget.group_share_at_place(group);
          }));
  out.number("unexplained", budget.unexplained.at_place);
  out.number("unexplained_rms", budget.unexplained.rms);
}

std::string budget_json(const sim::run::Budget& budget) {
  const sim::model::QuantitySpec& q = budget.quantity;
  sim::system::JsonObject out;
  out.text("case", q.cases.front()).text("quantity", q.name);
  out.text_or_null("axis", q.axis == '\0' ? "" : std::string(1, q.axis));
  out.text("sections", fmt::format("{}", fmt::join(q.sections, ", "))).text("baseline", q.baseline);
  if (!budget.note.empty()) return out.text("note", budget.note).line();
  out.text("unit", "um").number("s_mm", budget.place_s);
  out.number("residual", budget.residual.at_place).number("residual_rms", budget.residual.rms);
  sim::system::JsonObject parts;
  for (const sim::run::BudgetPart& part : budget.parts) {
    if (!part.present) continue;
    parts.raw(sim::run::info_of(part.cause).name, part_json(part, !budget.pairs.empty()));
  }
  out.raw("parts", parts.line()).number("sum", budget.sum_at_place());
  out.raw("kinds",
          kinds_json([&](sim::run::CauseGroup group) { return budget.group_at_place(group); }));
  out.number("remainder", budget.remainder.at_place);
  out.number("remainder_rms", budget.remainder.rms);
  if (!budget.pairs.empty()) add_pairs(budget, out);
  return out.line();
}

void add_budget_options(Options& options) {
  options.add()("case,c", po::value<std::vector<std::string>>()->value_name("NAME"),
                "only this case (default: all cases named by the quantities of the scenario)");
  options.add()("quantity", po::value<std::vector<std::string>>()->value_name("NAME"),
                "only this quantity; tool_deviation and following_error are available even if the "
                "scenario does not list them");
  options.add()("axis", po::value<std::vector<std::string>>()->value_name("Y"), "only this axis");
  options.add()("section", po::value<std::vector<std::string>>()->value_name("NAME"),
                "only this section of the program (default: the sections of the quantity)");
  options.add()("output,o", po::value<std::string>()->value_name("OUT.h5"),
                "writes the signals of all contributions, for tools/plot.py");
  options.add()("set", po::value<std::vector<std::string>>()->value_name("KEY=VALUE"),
                "changes a key of the scenario, as in run");
  options.add()("threads,j", po::value<int>()->default_value(0)->value_name("N"),
                "threads (default: one per core); results do not depend on it");
  options.add()("force,f", "replaces the result file if it exists");
  options.add()("json", "prints a JSON list, one object per budget");
  options.add()("quiet,q", "no progress bar");
  add_plugin_option(options);
}

// Names parts of the scenario that have no budget.
void tell_parts_without_budget(const sim::model::Scenario& scenario, ProgressLine& line) {
  const auto hidden = line.hidden();
  if (sim::model::has_day(scenario)) fmt::print(stderr, "note: {}\n", sim::run::kDayLeftOut);
  if (sim::model::has_windows(scenario)) {
    fmt::print(stderr, "note: {}\n", sim::model::kWindowsLeftOut);
  }
}

// @param folder  of recordings while it computes; empty: that of temporary files
void print_estimate(const sim::model::Scenario& scenario, const sim::run::BudgetEstimate& takes,
                    std::string folder) {
  const bool is_long = sim::run::is_worth_telling(takes);
  if (is_long) fmt::print(stderr, "estimate: {}\n", sim::run::to_string(takes));
  if (takes.run.is_thinned) {
    fmt::print(stderr, "{}\n", sim::preparation::thinning_message(takes.run));
  }
  if (folder.empty()) folder = std::filesystem::temp_directory_path().string();
  if (takes.run.file > 0.0 && is_long) {
    sim::preparation::refuse_full_disk(scenario, takes.run, folder, takes.disk / takes.run.file);
  }
}

}  // namespace

int budget_command(const Arguments& arguments) {
  const std::string summary = causes_help();
  Options options("budget", "SCENARIO.toml [--case NAME]... [--quantity NAME]... [-o OUT.h5]",
                  summary, "SCENARIO.toml");
  add_budget_options(options);
  if (!options.parse(arguments)) return kDone;
  load_plugins(options);

  ProgressLine line(options);
  const auto read = sim::input::shared_scenario(options.word(), options.list("set"));
  const sim::model::Scenario& scenario = *read;
  const std::vector<sim::model::QuantitySpec> quantities = chosen(scenario, options);
  tell_parts_without_budget(scenario, line);
  std::optional<sim::run::BudgetStore> store;
  if (options.has("output")) {
    store.emplace(options.get<std::string>("output"), options.has("force"), scenario);
  }
  const auto& stop = stop_on_interrupt();
  sim::run::BudgetControl control;
  control.threads = thread_count(options);
  control.stop = &stop;
  control.prepared = [&](const sim::run::BudgetEstimate& takes) {
    const auto hidden = line.hidden();
    print_estimate(scenario, takes, control.scratch_folder);
  };
  if (store) {
    const auto path = std::filesystem::absolute(options.get<std::string>("output"));
    control.scratch_folder = path.parent_path().string();
  }
  const std::vector<sim::run::Budget> budgets =
      sim::run::find_budgets(scenario, quantities, control);
  line.end();
  if (budgets.empty()) {
    print_interrupted("");
    return kInterrupted;
  }
  if (!options.has("json")) fmt::print("{}\n", sim::model::title_of(scenario));
  bool all = true;
  JsonList list;
  for (const sim::run::Budget& budget : budgets) {
    options.has("json") ? list.add(budget_json(budget)) : print_budget(budget);
    if (store) store->add(budget);
    all &= budget.note.empty();
  }
  if (options.has("json")) list.end();
  if (store) {
    store->commit();
    if (!options.has("json")) {
      fmt::print("\nwritten to {}\n", options.get<std::string>("output"));
    }
  }
  return all ? kDone : kMachineStopped;
}

}  // namespace servomill::tools
