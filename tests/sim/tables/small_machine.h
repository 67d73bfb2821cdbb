/// Machines and requests for the tests of exported tables.
#pragma once

#include <limits>
#include <string>

#include "plant/kinematics/structure.h"
#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "sim/tables/table_files.h"
#include "sim/tables/table_format.h"
#include "sim/tables/table_request.h"

namespace servomill::sim::tables {

/// X -100..100, Y -50..150, Z 0..200 mm; rotary axes endless.
inline model::MachineSettings machine_of(const std::string& structure) {
  model::MachineSettings machine;
  machine.name = "small machine";
  machine.chain = plant::make_chain(plant::parse_structure(structure));
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  machine.nc.lower << -100.0 * mm, -50.0 * mm, 0.0, -kEndless, -kEndless;
  machine.nc.upper << 100.0 * mm, 150.0 * mm, 200.0 * mm, kEndless, kEndless;
  return machine;
}

inline TableRequest request_of(TableFormat format) {
  TableRequest request;
  request.format = format;
  request.model = "test";
  return request;
}

inline const TextFile& file_named(const std::vector<TextFile>& files, const std::string& name) {
  for (const TextFile& file : files) {
    if (file.name == name) return file;
  }
  throw std::logic_error("no file " + name);
}

}  // namespace servomill::sim::tables
