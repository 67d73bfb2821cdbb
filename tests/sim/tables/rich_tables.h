/// Error models of all kinds, and tables of them, for the tests of written tables.
#pragma once

#include <string>
#include <vector>

#include "plant/geometry/error_model.h"
#include "plant/vocabulary/input_error.h"
#include "sim/tables/table_export.h"
#include "sim/tables/verify_tables.h"
#include "tests/sim/tables/small_machine.h"

namespace servomill::sim::tables {

using plant::operator""_err;

// Errors of all kinds, two of them dependent on the direction of travel.
inline plant::ErrorModel rich_model() {
  plant::ErrorModel errors;
  errors.component("EXX"_err) = plant::polynomial({5.0 * um, 2e-4, 1e-3}) +
                                plant::harmonic(10.0 * um, 60.0 * mm, 0.3) +
                                plant::reversal({6.0 * um, 2e-5}, 0.1 * mm);
  errors.component("EYX"_err) =
      plant::harmonic(8.0 * um, 150.0 * mm) + plant::reversal({4.0 * um}, 0.1 * mm);
  errors.component("EZX"_err) = plant::polynomial({0.0, 1e-4, 2e-3});
  errors.component("EYY"_err) = plant::harmonic(20.0 * um, 150.0 * mm, 1.0);
  errors.component("EXZ"_err) = plant::polynomial({0.0, 5e-5, -1e-4});
  errors.component("EAZ"_err) = plant::polynomial({0.0, 2e-4});
  errors.location("EC0Y"_err) = 200.0 * urad;
  errors.component("ECC"_err) = plant::harmonic(100.0 * urad, 360.0 * deg, 0.4) +
                                plant::harmonic(20.0 * urad, 90.0 * deg) +
                                plant::reversal({8.0 * urad}, 0.01);
  return errors;
}

inline TableRequest rich_request(TableFormat format, int comp_file_type = 0) {
  TableRequest request = request_of(format);
  request.comp_file_type = comp_file_type;
  request.tool_length = 120.0 * mm;
  request.spacing = 10.0 * mm;
  request.rotary_spacing = 15.0 * deg;
  if (rules_of(format).components) request.tool_length = 0.0;
  return request;
}

inline TableExport rich_tables(TableFormat format, int comp_file_type = 0) {
  return export_tables(machine_of("[w C' X b Y Z t]"), rich_model(),
                       rich_request(format, comp_file_type));
}

inline std::string fault_of(const TableExport& tables, const std::vector<TextFile>& files) {
  try {
    verify_tables(tables, files);
  } catch (const InputError& error) {
    return error.what();
  }
  return "verified";
}

/// A linear error of X that depends on the direction of travel.
inline plant::ErrorModel reversal_of_x() {
  plant::ErrorModel errors;
  errors.component("EXX"_err) =
      plant::polynomial({0.0, 1e-4}) + plant::reversal({4.0 * um}, 0.1 * mm);
  return errors;
}

inline TableRequest three_points(TableFormat format) {
  TableRequest request = request_of(format);
  request.spacing = 100.0 * mm;
  return request;
}

}  // namespace servomill::sim::tables
