#include "sim/input/uncertain_errors.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

#include "sim/config/document.h"
#include "sim/config/reader.h"
#include "sim/input/machine_document.h"
#include "sim/input/read_errors.h"
#include "sim/model/machine.h"
#include "sim/model/tip_uncertainty.h"

namespace servomill::sim::input {
namespace {

using Eigen::Index;

// { errors = { MODEL = table } }
config::Document document_of(const config::Value& errors, const std::string& model) {
  config::Value copy = errors;
  copy.key = model;
  config::Value models;
  models.key = "errors";
  models.children.push_back(std::move(copy));
  config::Value root;
  root.children.push_back(std::move(models));
  config::Document out = config::Document::from_text("", errors.place.file);
  out.merge(root);
  return out;
}

// The model with another value of one number.
plant::ErrorModel with_value(config::Document document, const std::string& model,
                             const std::string& key, double value, const std::string& unit,
                             const JointLayout& layout) {
  document.set(unit == kPlainNumber ? fmt::format("{}={}", key, value)
                                    : fmt::format("{}=\"{} {}\"", key, value, unit));
  config::Reader root(document);
  config::Reader table = root.table("errors").table(model);
  table.raw("relative_to");  // differs from the other model by what stays
  plant::ErrorModel out = read_errors(table, layout);
  root.finish();
  return out;
}

// Errors in which two models differ.
std::vector<model::UncertainPart> differences(const plant::ErrorModel& above,
                                              const plant::ErrorModel& below) {
  std::vector<model::UncertainPart> out;
  for (const Axis axis : kAllAxes) {
    for (const Axis direction : kAllAxes) {
      const plant::ErrorName component{direction, axis, false}, location{direction, axis, true};
      const plant::ErrorFunction &f = above.component(component), &g = below.component(component);
      if (!(f == g)) out.push_back({component, f, g});
      const double a = above.location(location), b = below.location(location);
      if (a != b) out.push_back({location, plant::constant(a), plant::constant(b)});
    }
  }
  return out;
}

}  // namespace

std::optional<model::UncertainErrors> uncertain_errors(const config::Value& errors,
                                                       const std::string& model,
                                                       const IdentifiedValues& identified,
                                                       const JointLayout& layout) {
  const std::string prefix = "errors." + model + ".";
  const config::Document document = document_of(errors, model);
  model::UncertainErrors out{model, {}, {}};
  std::vector<Index> scatter;
  std::vector<double> deviations;
  bool is_identified = false;
  for (std::size_t k = 0; k < identified.keys.size(); ++k) {
    if (!identified.keys[k].starts_with(prefix)) continue;
    is_identified = true;
    const double deviation = std::sqrt(identified.covariance(Index(k), Index(k)));
    if (!(deviation > 0.0)) continue;
    const auto with = [&](double value) {
      return with_value(document, model, identified.keys[k], value, identified.units[k], layout);
    };
    const double value = identified.values[k];
    out.parts.push_back(differences(with(value + deviation), with(value - deviation)));
    scatter.push_back(Index(k));
    deviations.push_back(deviation);
  }
  if (!is_identified) return std::nullopt;
  const Eigen::VectorXd inverse =
      Eigen::Map<const Eigen::VectorXd>(deviations.data(), Index(deviations.size())).cwiseInverse();
  out.correlation =
      inverse.asDiagonal() * identified.covariance(scatter, scatter) * inverse.asDiagonal();
  return out;
}

std::shared_ptr<const model::UncertainErrors> uncertain_errors_of_file(const std::string& path,
                                                                       const std::string& model,
                                                                       const JointLayout& layout) {
  if (!is_machine_file(path)) return nullptr;
  InputFiles files;
  const MachineDocument machine = machine_document(path, files);
  const config::Value* errors = machine.document.root().find("errors");
  errors = errors == nullptr ? nullptr : errors->find(model);
  if (!machine.identified || errors == nullptr) return nullptr;
  auto found = uncertain_errors(*errors, model, *machine.identified, layout);
  if (!found) return nullptr;
  return std::make_shared<const model::UncertainErrors>(*std::move(found));
}

}  // namespace servomill::sim::input
