#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "sim/calibration/calibration.h"
#include "sim/config/document.h"
#include "sim/config/reader.h"

namespace servomill::sim::calibration {
namespace {

constexpr std::int64_t kMaxDegree = 20;
constexpr std::int64_t kMaxKnots = 1000;
constexpr int kMaxGridKnots = 100;
constexpr std::array<std::string_view, 1> kByData = {"auto"};

// Size that is expected of errors along (um) or about (urad).
std::optional<double> read_size(config::Reader& table, bool is_length) {
  const std::string_view key = is_length ? "size_um" : "size_urad";
  if (!table.has(key)) return std::nullopt;
  return table.real(key, is_length ? config::kLength : config::kAngle, {config::above(0.0)});
}

// Keys of a form: polynomial, knots, harmonics, reversal; in units of the axis.
FormSettings read_form(config::Reader& table, bool linear) {
  FormSettings form;
  const config::Quantity travel = linear ? config::kLength : config::kAngle;
  const auto key = [linear](const char* name) {
    return fmt::format("{}_{}", name, linear ? "mm" : "deg");
  };
  // "auto": whatever predicts readings best
  const auto is_by_data = [&table](std::string_view name) {
    if (!table.is(name, config::Value::Type::text)) return false;
    table.choice(name, kByData);
    return true;
  };
  form.degree_by_data = is_by_data("polynomial");
  form.knots_by_data = is_by_data("knots");
  if (table.has("polynomial") && !form.degree_by_data) {
    form.degree = static_cast<int>(
        table.integer("polynomial", {config::at_least(0.0), config::at_most(double(kMaxDegree))}));
  }
  if (table.has("knots") && !form.knots_by_data) {
    form.number_of_knots = static_cast<int>(
        table.integer("knots", {config::at_least(0.0), config::at_most(double(kMaxKnots))}));
    if (*form.number_of_knots == 1) table.fault("knots", "must be 0 or at least 2");
  }
  if (table.has(key("knots"))) {
    form.knots = table.reals(key("knots"), travel);
    if (form.number_of_knots || form.knots_by_data)
      table.fault(key("knots"), "excludes knots; give only one of them");
    if (form.knots->size() < 2 ||
        !std::is_sorted(form.knots->begin(), form.knots->end(), std::less_equal<>())) {
      table.fault(key("knots"), "must be at least two positions, in ascending order");
    }
  }
  form.periods = table.reals_or(key("harmonics"), {}, travel, {config::above(0.0)});
  if (table.has("reversal")) {
    form.reversal_degree = static_cast<int>(
        table.integer("reversal", {config::at_least(-1.0), config::at_most(double(kMaxDegree))}));
  }
  if (table.has(key("reversal_distance"))) {
    form.reversal_distance = table.real(key("reversal_distance"), travel, {config::above(0.0)});
  }
  return form;
}

// `{ axes = "XZ", knots = [5, 3] }` of an error of X.
GridSettings read_grid(config::Reader& table, const plant::ErrorName& name,
                       const JointLayout& layout) {
  GridSettings out;
  const std::size_t before = table.faults();
  const std::string axes = table.text("axes");
  if (table.faults() > before) {
    table.skip_rest();
    return out;
  }
  const char own = letter(name.axis);
  const std::size_t other = axes.size() == 2 && axes[0] == own ? 1 : 0;
  const auto across = axes.size() == 2 ? axis_of(axes[other]) : std::nullopt;
  if (!across || axes[1 - other] != own || axes[other] == own || !layout.joint_of(*across)) {
    table.fault("axes", fmt::format("must be {0} and another axis of the machine, as \"{0}{1}\"",
                                    own, own == 'Z' ? 'X' : 'Z'));
  } else {
    out.across = *across;
  }
  if (!table.has("knots")) return out;
  const std::vector<double> knots = table.reals("knots", config::kNumber);
  const auto is_count = [](double n) {
    return n == std::floor(n) && n >= 2.0 && n <= double(kMaxGridKnots);
  };
  if (knots.size() != 2 || !std::all_of(knots.begin(), knots.end(), is_count)) {
    table.fault("knots",
                fmt::format("must be two integers, a number for each of axes, from 2 to {}",
                            kMaxGridKnots));
    return out;
  }
  out.knots = {static_cast<int>(knots[1 - other]), static_cast<int>(knots[other])};
  return out;
}

std::vector<GridSettings> read_grids(config::Reader& form, const plant::ErrorName& name,
                                     const JointLayout& layout) {
  std::vector<GridSettings> out;
  if (form.is("grid", config::Value::Type::list)) {
    for (config::Reader& one : form.tables("grid")) out.push_back(read_grid(one, name, layout));
  } else if (form.has("grid")) {
    config::Reader one = form.table("grid");
    out.push_back(read_grid(one, name, layout));
  }
  for (std::size_t k = 1; k < out.size(); ++k) {
    const auto is_same = [&](const GridSettings& one) { return one.across == out[k].across; };
    if (std::any_of(out.begin(), out.begin() + std::ptrdiff_t(k), is_same)) {
      form.fault("grid", fmt::format("has two grids over {} and {}", letter(name.axis),
                                     letter(out[k].across)));
    }
  }
  return out;
}

std::array<Axis, 2> read_frame(config::Reader& table, const JointLayout& layout) {
  std::array<Axis, 2> out = {Axis::X, Axis::Y};
  if (!table.has("frame")) return out;
  const std::string text = table.text("frame");
  const auto linear = [&](char c) {
    const auto axis = axis_of(c);
    return axis && is_linear(*axis) && layout.joint_of(*axis);
  };
  if (text.size() != 2 || text[0] == text[1] || !linear(text[0]) || !linear(text[1])) {
    table.fault("frame",
                "must be two linear axes of the machine, such as \"XY\": the first one is straight "
                "by convention, the second is in their plane");
    return out;
  }
  return {*axis_of(text[0]), *axis_of(text[1])};
}

}  // namespace

CalibrationSettings read_settings(const std::string& path, const JointLayout& layout) {
  const config::Document document = config::Document::from_file(path);
  config::Reader root(document);
  for (const std::string& key : root.keys()) {
    if (key != "adjustment") root.raw(key);
  }
  CalibrationSettings out;
  config::Reader table = root.table_or_empty("adjustment");
  out.frame = read_frame(table, layout);
  out.robust = table.boolean_or("robust", false);
  std::vector<std::string> names = table.texts_or("errors", {});
  for (const std::string& name : names) {
    try {
      out.errors.push_back(plant::parse_error_name(name, layout, table.place("errors")));
    } catch (const InputError& error) {
      table.fault("errors", error.faults().front().message);
    }
  }
  config::Reader form = table.table_or_empty("form");
  for (const std::string& key : form.keys()) {
    config::Reader one = form.table(key);
    if (key == "linear" || key == "rotary") {
      (key == "linear" ? out.form_linear : out.form_rotary) = read_form(one, key == "linear");
      continue;
    }
    try {
      const plant::ErrorName name = plant::parse_error_name(key, layout, form.place(key));
      FormSettings settings;
      if (!name.is_location) {
        settings = read_form(one, is_linear(name.axis));
        settings.grids = read_grids(one, name, layout);
      }
      settings.size = read_size(one, is_linear(name.direction));
      out.forms.emplace_back(name, settings);
    } catch (const InputError& error) {
      form.fault(key, error.faults().front().message);
      one.skip_rest();
    }
  }
  root.finish();
  return out;
}

}  // namespace servomill::sim::calibration
