#include "sim/fmu/axis_constants.h"

#include <fmt/format.h>

#include "sim/fmu/axis_fields.h"

namespace servomill::sim::fmu {
namespace {

std::string headline() { return fmt::format("servomill axis {}", kAxisFileVersion); }

}  // namespace

std::string why_not_exported(const AxisConstants& axis) {
  if (axis.machine.integrator != model::Integrator::exact) {
    return "its drives are integrated by CVODE, which an FMU does not contain; use integrator = "
           "\"exact\"";
  }
  const plant::ErrorFunction& lead = axis.machine.screw[static_cast<std::size_t>(axis.joint)].lead;
  if (!lead.grids.empty() || !lead.reversals.empty()) {
    return "the lead error of its screw is a grid or has a reversal, which an FMU does not contain";
  }
  return {};
}

std::string text_of(const AxisConstants& axis) {
  ConstantsWriter writer(headline());
  AxisConstants copy = axis;  // fields are visited as a reader may change them
  AxisFields(writer).all(copy);
  return writer.finished();
}

AxisConstants read_axis_constants(std::string_view text, const std::string& name) {
  ConstantsReader reader(text, name, headline());
  AxisConstants axis;
  AxisFields(reader).all(axis);
  reader.finish();
  return axis;
}

}  // namespace servomill::sim::fmu
