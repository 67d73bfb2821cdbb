#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "sim/calibration/identified_errors.h"
#include "sim/calibration/report.h"
#include "sim/input/machine_description.h"
#include "sim/input/machine_document.h"
#include "sim/input/write_identified.h"
#include "sim/system/write_file.h"

namespace servomill::sim::calibration {
namespace {

constexpr double kSame = 1e-13;  // m, rad; units round

std::string text_of(const Calibration& calibration, const IdentifiedErrors& errors,
                    const std::string& machine, const std::string& model) {
  std::string out =
      fmt::format("# Errors identified from {}\n",
                  std::filesystem::path(calibration.readings.path).filename().string());
  for (const std::string& sentence : unidentifiable_sentences(calibration)) {
    out += fmt::format("# {}\n", sentence);
  }
  out += fmt::format("based_on = {}  # machine that was measured\n\n[errors.{}]\n",
                     config::quoted_text(machine), model);
  for (const std::string& line : errors.lines) out += line + "\n";
  if (errors.values.keys.size() > std::size_t(kMaxCovarianceNumbers)) {
    return out + fmt::format("# The covariance of these {} numbers is not written: at most {}.\n",
                             errors.values.keys.size(), kMaxCovarianceNumbers);
  }
  return out + "\n[identified]\n" + input::table_lines(errors.values);
}

// Functions of their own axis alone; grids are compared by their values.
plant::ErrorFunction without_grids(plant::ErrorFunction f) {
  f.grids.clear();
  return f;
}

std::vector<Axis> grid_axes(const SoughtGrid& grid) {
  const auto& axes = grid.basis.form().axes;
  return {axes[0], axes[1]};
}

bool same_grids(const Adjustment& adjustment, const plant::ErrorModel& read) {
  for (const SoughtGrid& grid : adjustment.unknowns.grids) {
    const auto& found = adjustment.errors.component(grid.name).grids;
    const auto& back = read.component(grid.name).grids;
    if (adjustment.covariance.diagonal().segment(grid.first, grid.basis.size()).isZero(0.0)) {
      continue;
    }
    const bool is_there = std::any_of(back.begin(), back.end(), [&](const auto& one) {
      return std::any_of(found.begin(), found.end(), [&](const auto& other) {
        const auto &a = one.points().error, &b = other.points().error;
        return one.axes() == grid_axes(grid) && other.axes() == one.axes() &&
               std::equal(a.begin(), a.end(), b.begin(), b.end(),
                          [](double x, double y) { return std::abs(x - y) <= kSame; });
      });
    });
    if (!is_there) return false;
  }
  return true;
}

bool same_functions(const Adjustment& adjustment, const plant::ErrorModel& read) {
  for (const auto& [name, size] : adjustment.unknowns.locations) {
    if (std::abs(read.location(name) - adjustment.errors.location(name)) > kSame) return false;
  }
  for (const KnownFunction& known : functions_along_travel(adjustment)) {
    for (const double direction : {-1.0, 0.0, 1.0}) {
      const auto one = plant::travelling(without_grids(read.component(known.name)), direction);
      const auto other =
          plant::travelling(without_grids(adjustment.errors.component(known.name)), direction);
      for (const double s : known.s) {
        if (std::abs(one.value(s) - other.value(s)) > kSame) return false;
      }
    }
  }
  return same_grids(adjustment, read);
}

void refuse_unreadable(const std::string& text, const std::string& path,
                       const Calibration& calibration, const IdentifiedErrors& errors,
                       const std::string& model) {
  input::InputFiles files;
  const input::MachineDocument read = input::machine_document_of_text(text, path, files);
  const input::MachineDescription machine = input::described(read.document);
  const auto found = machine.errors.find(model);
  if (found == machine.errors.end() || !same_functions(calibration.adjustment, found->second)) {
    throw std::logic_error(path + ": the error model differs when read back");
  }
  if (read.identified && (read.identified->values != errors.values.values ||
                          read.identified->covariance != errors.values.covariance ||
                          read.identified->unidentifiable != errors.values.unidentifiable)) {
    throw std::logic_error(path + ": the covariance differs when read back");
  }
}

}  // namespace

void write_identified_errors(const std::string& path, const Calibration& calibration,
                             const std::string& machine, const std::string& model, bool force) {
  system::refuse_unwritable_text(path, force);
  if (input::read_machine_description(machine).errors.contains(model)) {
    throw InputError(
        {machine},
        fmt::format("already has an error model {}; choose another name with --model", model));
  }
  const IdentifiedErrors errors = identified_errors(calibration, model);
  if (errors.values.keys.empty()) {
    throw InputError({calibration.readings.path}, "does not determine any error");
  }
  const std::string text =
      text_of(calibration, errors, input::machine_seen_from(path, machine), model);
  refuse_unreadable(text, path, calibration, errors, model);
  system::write_text_file(path, text, force);
}

}  // namespace servomill::sim::calibration
