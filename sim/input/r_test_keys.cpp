#include "sim/input/r_test_keys.h"

#include "sim/evaluation/quantity.h"
#include "sim/model/scenario.h"

namespace servomill::sim::input {
namespace {

void read_bar(config::Reader& bar, model::QuantitySpec& spec) {
  spec.sections.push_back(bar.text("section"));
  const std::size_t before = bar.faults();
  const std::vector<double> centre = bar.reals("centre_mm", config::kLength);
  if (bar.faults() > before) return;
  if (centre.size() == 3) {
    spec.ball->bar_centres.emplace_back(centre.data());
  } else {
    bar.fault("centre_mm", "must be [x, y, z]");
  }
}

std::optional<plant::ErrorName> read_error(config::Reader& table, const JointLayout& layout) {
  const std::size_t before = table.faults();
  const std::string text = table.text("error");
  if (table.faults() > before || layout == JointLayout{}) return std::nullopt;
  try {
    const plant::ErrorName name = plant::parse_error_name(text, layout, {});
    if (name.is_location) return name;
    table.fault("error", "must be a location error, like EX0C");
  } catch (const InputError& error) {
    table.fault("error", error.faults().front().message);
  }
  return std::nullopt;
}

}  // namespace

void read_r_test(config::Reader& table, const evaluation::QuantityEntry& entry,
                 const JointLayout& layout, model::QuantitySpec& spec) {
  spec.ball.emplace();
  if (entry.bars == evaluation::BallBars::required ||
      (entry.bars == evaluation::BallBars::optional && table.has("bar"))) {
    for (config::Reader& bar : table.tables("bar")) read_bar(bar, spec);
    spec.sections_place = table.place("bar");
  } else {
    spec.sections = table.texts("sections");
    spec.sections_place = table.place("sections");
    if (table.has("sections") && spec.sections.empty()) {
      table.fault("sections", "must name at least one section");
    }
  }
  if (!entry.identifies) return;
  spec.ball->tcp_is_known = table.boolean_or("tcp_is_known", false);
  if (table.has("error")) spec.ball->error = read_error(table, layout);
}

}  // namespace servomill::sim::input
