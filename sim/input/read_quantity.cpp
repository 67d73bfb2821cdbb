#include "sim/input/read_quantity.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "plant/vocabulary/units.h"
#include "sim/evaluation/nominal_part.h"
#include "sim/evaluation/quantity.h"
#include "sim/evaluation/r_test_quantities.h"
#include "sim/input/known_name.h"
#include "sim/input/r_test_keys.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"

namespace servomill::sim::input {
namespace {

constexpr std::array<std::string_view, 4> kStatistics = {"max", "rms", "mean", "range"};
constexpr std::array<std::string_view, 4> kBases = {"fitted", "predicted", "assumed",
                                                    "upper_bound"};
constexpr std::array<std::string_view, 2> kFits = {"minimum_zone", "least_squares"};

std::vector<std::string_view> letters_of(std::string_view axes) {
  std::vector<std::string_view> out;
  for (std::size_t i = 0; i < axes.size(); ++i) out.push_back(axes.substr(i, 1));
  return out;
}

// One number: of the magnitude; two: the limits.
std::optional<model::Tolerance> read_tolerance(config::Reader& table) {
  if (!table.is("tolerance", config::Value::Type::list)) {
    const double most = table.real("tolerance", config::kNumber, {config::above(0.0)});
    return model::Tolerance{-most, most};
  }
  const std::size_t before = table.faults();
  const std::vector<double> limits = table.reals("tolerance", config::kNumber);
  if (table.faults() > before) return std::nullopt;
  if (limits.size() == 2 && limits[0] < limits[1]) return model::Tolerance{limits[0], limits[1]};
  table.fault("tolerance", "must be a number > 0, or [lower, upper] with lower < upper");
  return std::nullopt;
}

class QuantityReader {
 public:
  QuantityReader(bool checks_cases, model::Scenario& out)
      : checks_cases_(checks_cases), out_(out) {}

  void read(config::Reader& table) {
    model::QuantitySpec spec;
    const std::size_t before = table.faults();
    const std::size_t index = table.choice("name", evaluation::quantity_names());
    if (table.faults() > before) {
      table.skip_rest();
      return;
    }
    const evaluation::QuantityEntry& info = evaluation::quantities()[index];
    spec.name = info.name;
    if (info.needs_axis()) read_axis(table, info, spec);
    if (info.has_statistic) {
      spec.statistic = kStatistics[table.choice_or("statistic", 0, kStatistics)];
    }
    read_compared_cases(table, info, spec);
    if (info.needs_imposed && out_.imposed.empty()) {
      table.fault("name", "needs the key 'imposed' of the scenario");
    }
    if (info.needs_covariance && out_.uncertain == nullptr) {
      table.fault("name",
                  "needs a machine with identified errors and their covariance, as written by "
                  "servomill calibrate -o");
    }
    if (info.needs_day && out_.day == nullptr) table.fault("name", "needs [day]");
    if (info.probes > 0) {
      read_part(table, info, spec);
    } else if (info.is_r_test) {
      read_r_test(table, info, out_.machine.chain.layout, spec);
    } else {
      spec.sections = info.circles > 0 ? table.texts("sections") : table.texts_or("sections", {});
      spec.sections_place = table.place("sections");
    }
    spec.reference = table.text_or("reference", "");
    if (table.has("tolerance")) spec.tolerance = read_tolerance(table);
    if (table.has("basis")) spec.basis = kBases[table.choice("basis", kBases)];
    refuse_keys_of_others(table, info);
    add(table, info, spec);
  }

 private:
  // No slips: keys that other quantities take.
  static void refuse_keys_of_others(config::Reader& table, const evaluation::QuantityEntry& info) {
    const std::pair<std::string_view, bool> keys[] = {
        {"axis", info.needs_axis()},
        {"statistic", info.has_statistic},
        {"baseline", info.needs_baseline || info.probes > 0}};
    const std::vector<std::string> given = table.keys();
    for (const auto& [key, is_taken] : keys) {
      if (is_taken || std::find(given.begin(), given.end(), key) == given.end()) continue;
      table.raw(key);
      table.fault(key, fmt::format("does not apply to {}", info.name));
    }
  }

  void read_axis(config::Reader& table, const evaluation::QuantityEntry& info,
                 model::QuantitySpec& spec) const {
    spec.axis = info.axes[table.choice("axis", letters_of(info.axes))];
    const JointLayout& layout = out_.machine.chain.layout;
    const auto axis = axis_of(spec.axis);
    if (layout != JointLayout{} && table.is("axis", config::Value::Type::text) && axis &&
        !layout.joint_of(*axis)) {
      table.fault("axis", "the machine has no such axis");
    }
  }

  void read_compared_cases(config::Reader& table, const evaluation::QuantityEntry& info,
                           model::QuantitySpec& spec) {
    std::vector<std::string> all;
    for (const model::CaseSpec& one : out_.cases) all.push_back(one.name);
    if (info.needs_baseline || (info.probes > 0 && table.has("baseline"))) {
      spec.baseline = table.text("baseline");
      if (table.is("baseline", config::Value::Type::text) && checks_cases_)
        must_be_known(table, "baseline", spec.baseline, "case", all);
    }
    read_cases_of(table, std::move(all), spec);
  }

  // Default: all but the one compared with, whose differences would all be 0.
  void read_cases_of(config::Reader& table, std::vector<std::string> all,
                     model::QuantitySpec& spec) {
    std::vector<std::string> others = all;
    if (others.size() > 1) std::erase(others, spec.baseline);
    spec.cases = table.texts_or("cases", others);
    for (const std::string& name : spec.cases) {
      if (checks_cases_) must_be_known(table, "cases", name, fmt::format("case '{}'", name), all);
    }
  }

  // Features that a quantity evaluates, and how they are fitted.
  void read_part(config::Reader& table, const evaluation::QuantityEntry& info,
                 model::QuantitySpec& spec) {
    spec.part.emplace();
    std::vector<std::string> names;
    for (const metrology::ProbeSpec& one : out_.probes) names.push_back(one.name);
    const bool all_named = std::find(names.begin(), names.end(), "") == names.end();
    if (info.probes == evaluation::kEveryProbe) {
      spec.part->probes = table.texts_or("probes", names);
      for (const std::string& name : spec.part->probes) {
        if (all_named) must_be_known(table, "probes", name, fmt::format("probe '{}'", name), names);
      }
      if (spec.part->probes.empty()) table.fault("needs a [[probe]]");
      if (out_.part) spec.part->nominal = out_.part->mesh;
      return;
    }
    for (const char* key : info.probes == 1 ? std::vector{"probe"} : std::vector{"probe", "to"}) {
      const std::size_t before = table.faults();
      const std::string name = table.text(key);
      spec.part->probes.push_back(name);
      if (table.faults() > before || !all_named) continue;
      if (must_be_known(table, key, name, "probe", names)) must_suit(table, info, key, name);
    }
    if (info.has_fit) spec.part->minimum_zone = table.choice_or("fit", 0, kFits) == 0;
  }

  // A probe measures a kind of feature; a quantity is of some kinds only.
  void must_suit(config::Reader& table, const evaluation::QuantityEntry& info, std::string_view key,
                 const std::string& name) {
    const auto probe =
        std::find_if(out_.probes.begin(), out_.probes.end(),
                     [&](const metrology::ProbeSpec& one) { return one.name == name; });
    if (probe->feature.targets.empty()) return;  // its fault has been noted
    const metrology::FeatureKind kind = probe->feature.kind;
    if (std::count(info.kinds.begin(), info.kinds.end(), kind) > 0) return;
    std::vector<std::string_view> wanted;
    for (const metrology::FeatureKind one : info.kinds) wanted.push_back(metrology::name_of(one));
    table.fault(key, fmt::format("is a {}; {} applies to: {}", metrology::name_of(kind), info.name,
                                 fmt::join(wanted, ", ")));
  }

  // One quantity, or one for each circle, ball bar or location error.
  void add(config::Reader& table, const evaluation::QuantityEntry& info,
           model::QuantitySpec& spec) {
    if (info.circles > 0) {
      add_circles(table, spec, static_cast<std::size_t>(info.circles));
    } else if (info.bars == evaluation::BallBars::required) {
      add_bars(spec);
    } else if (info.identifies) {
      add_location_errors(spec);
    } else {
      out_.quantities.push_back(std::move(spec));
    }
  }

  // Ball bars are evaluated one by one.
  void add_bars(const model::QuantitySpec& all) {
    for (std::size_t i = 0; i < all.ball->bar_centres.size(); ++i) {
      model::QuantitySpec one = all;
      one.sections = {all.sections[i]};
      one.ball->bar_centres = {all.ball->bar_centres[i]};
      out_.quantities.push_back(std::move(one));
    }
  }

  // The one asked for or every location error of the machine, and what it truly is where no other
  // reference is given.
  void add_location_errors(const model::QuantitySpec& all) {
    const auto truth = out_.errors.find(out_.machine_errors);
    std::vector<plant::ErrorName> names = metrology::location_errors(out_.machine.chain);
    if (all.ball->error) names = {*all.ball->error};
    const bool is_true_of_each =
        std::none_of(out_.cases.begin(), out_.cases.end(),
                     [](const model::CaseSpec& one) { return one.machine_errors.has_value(); });
    for (const plant::ErrorName& name : names) {
      model::QuantitySpec one = all;
      one.ball->error = name;
      if (one.reference.empty() && truth != out_.errors.end() && is_true_of_each) {
        const double unit = is_linear(name.direction) ? um : urad;
        one.reference = fmt::format("{:g} {} true", truth->second.location(name) / unit,
                                    evaluation::unit_of_location(name));
      }
      out_.quantities.push_back(std::move(one));
    }
  }

  // Circles are evaluated one by one, or in pairs of directions: a quantity for each.
  void add_circles(config::Reader& table, const model::QuantitySpec& all, std::size_t together) {
    if (table.has("sections") && (all.sections.empty() || all.sections.size() % together != 0)) {
      table.fault("sections", together == 1
                                  ? "must name at least one full circle"
                                  : "must name pairs of full circles, one in each direction");
    }
    for (std::size_t i = 0; i + together <= all.sections.size(); i += together) {
      model::QuantitySpec one = all;
      const auto first = all.sections.begin() + static_cast<std::ptrdiff_t>(i);
      one.sections.assign(first, first + static_cast<std::ptrdiff_t>(together));
      out_.quantities.push_back(std::move(one));
    }
  }

  bool checks_cases_;
  model::Scenario& out_;
};

}  // namespace

void read_quantity(config::Reader& table, bool checks_cases, model::Scenario& out) {
  QuantityReader(checks_cases, out).read(table);
}

}  // namespace servomill::sim::input
