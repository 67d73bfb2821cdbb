#include "sim/fmu/machine_constants.h"

#include <fmt/format.h>

#include "plant/kinematics/structure.h"
#include "plant/vocabulary/checksum.h"
#include "sim/fmu/error_fields.h"

namespace servomill::sim::fmu {
namespace {

constexpr std::string_view kHeadline = "servomill kinematics 1";

plant::Structure structure_of(const plant::MachineChain& chain) {
  plant::Structure structure;
  for (const plant::ChainAxis& axis : chain.axes) structure.axes.push_back({axis.axis, axis.side});
  return structure;
}

// Calls visit(key, field) as AxisFields does.
template <class Visit>
class KinematicFields {
 public:
  explicit KinematicFields(Visit& visit) : visit_(visit) {}

  void all(KinematicConstants& k) {
    std::string structure = to_string(structure_of(k.chain));
    visit_("structure", structure);
    if (k.chain.axes.empty()) k.chain = plant::make_chain(plant::parse_structure(structure));
    for (plant::ChainAxis& axis : k.chain.axes) {
      axis_of_chain(std::string(1, letter(axis.axis)), axis);
      errors(k.errors, axis.axis);
    }
    vector("tip", k.p_ST);
  }

 private:
  void vector(const std::string& name, Eigen::Vector3d& v) {
    for (int i = 0; i < 3; ++i) visit_(name + "." + "xyz"[i], v[i]);
  }

  void axis_of_chain(const std::string& name, plant::ChainAxis& axis) {
    vector(name + ".centre", axis.centre);
    visit_(name + ".sense", axis.sense);
    visit_(name + ".inclined", axis.is_inclined);
    if (!axis.is_inclined) return;
    for (int i = 0; i < 9; ++i)
      visit_(name + ".R_MA." + std::to_string(i), axis.R_MA(i / 3, i % 3));
  }

  void errors(plant::ErrorModel& errors, Axis axis) {
    ErrorFields<Visit> fields(visit_);
    for (const Axis direction : kAllAxes) {
      plant::ErrorFunction& f = errors.component({direction, axis, false});
      const std::string name = to_string(plant::ErrorName{direction, axis, false});
      bool there = !f.is_zero();
      visit_(name, there);
      if (there) {
        fields.function(name, f);
        fields.grids(name + ".grids", f);
      }
      const plant::ErrorName location{direction, axis, true};
      visit_(to_string(location), errors.location(location));
    }
  }

  Visit& visit_;
};

std::string text_of(const KinematicConstants& kinematics) {
  ConstantsWriter writer{std::string(kHeadline)};
  KinematicConstants copy = kinematics;  // fields are visited as a reader may change them
  KinematicFields(writer).all(copy);
  return writer.finished();
}

KinematicConstants read_kinematics(std::string_view text, const std::string& name) {
  ConstantsReader reader(text, name, kHeadline);
  KinematicConstants kinematics;
  KinematicFields(reader).all(kinematics);
  reader.finish();
  return kinematics;
}

bool has_reversals(const plant::ErrorModel& errors) {
  for (const auto& axis : errors.components) {
    for (const plant::ErrorFunction& f : axis) {
      if (!f.reversals.empty()) return true;
    }
  }
  return false;
}

}  // namespace

std::string why_not_exported(const KinematicConstants& kinematics,
                             const model::MachineSettings& machine) {
  constexpr std::string_view kNot = ", which an FMU does not contain";
  if (has_reversals(kinematics.errors)) {
    return fmt::format("its errors depend on the direction of travel{}", kNot);
  }
  if (machine.heat) return fmt::format("its errors change with temperature{}", kNot);
  if (!machine.structural_modes.empty()) return fmt::format("its structure vibrates{}", kNot);
  if (!machine.inertial_compliances.empty()) {
    return fmt::format("its structure deflects under acceleration{}", kNot);
  }
  return {};
}

std::string text_of(const MachineConstants& machine) {
  std::string text;
  for (const AxisConstants& axis : machine.axes) text += text_of(axis);
  return machine.kinematics ? text + text_of(*machine.kinematics) : text;
}

MachineConstants read_machine_constants(std::string_view text, const std::string& name) {
  MachineConstants machine;
  do {
    const std::string_view one = first_text(text);
    if (one.starts_with(kHeadline)) {
      machine.kinematics = read_kinematics(one, name);
    } else {
      machine.axes.push_back(read_axis_constants(one, name));
    }
    text.remove_prefix(one.size());
  } while (!text.empty());
  return machine;
}

std::string token_of(std::string_view text) {
  return fmt::format("{{{:016x}-{:016x}}}", crc64(text), crc64(fmt::format("servomill {}", text)));
}

}  // namespace servomill::sim::fmu
