#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "plant/vocabulary/units.h"
#include "sim/calibration/calibration.h"
#include "sim/calibration/identified_errors.h"
#include "sim/calibration/report.h"
#include "sim/calibration/suggestions.h"
#include "sim/input/machine_description.h"
#include "sim/model/machine.h"
#include "sim/model/machine_parts.h"
#include "sim/readings/readings.h"
#include "sim/system/output_name.h"
#include "tools/python/computing.h"
#include "tools/python/identification.h"
#include "tools/servomill/readings_options.h"

namespace servomill::python {
namespace {

namespace py = pybind11;
namespace calibration = sim::calibration;

struct CalibrateRequest {
  std::string readings, machine;  // of the machine empty: the one that the readings name
  std::string output;             // empty: not written
  std::string model;
  bool force = false, accept_contradictions = false;
};

struct Calibrated {
  calibration::Calibration result;
  std::vector<std::string> suggestions;
};

Calibrated calibrated(const CalibrateRequest& request) {
  if (!request.output.empty()) {
    sim::system::output_target(request.output, sim::system::existing_of(request.force));
  }
  const std::string file = tools::measured_machine(request.machine, request.readings);
  const sim::input::MachineDescription description = sim::input::read_machine_description(file);
  const auto& chain = sim::model::chain_of(*description.machine);
  const auto [lower, upper] = sim::model::travel_of(*description.machine);
  Calibrated out{
      calibration::calibrate(sim::readings::read_readings(request.readings, chain, lower, upper,
                                                          sim::readings::Numbers::required),
                             chain, calibration::read_settings(request.readings, chain.layout)),
      {}};
  out.suggestions = calibration::suggestions(out.result, *description.machine);
  if (!request.output.empty()) {
    if (!request.accept_contradictions) calibration::refuse_contradictions(out.result);
    calibration::write_identified_errors(request.output, out.result, file, request.model,
                                         request.force);
  }
  return out;
}

py::array scaled(const std::vector<double>& values, double unit) {
  py::array_t<double> out(static_cast<py::ssize_t>(values.size()));
  double* to = out.mutable_data();
  for (const double value : values) *to++ = value / unit;
  return out;
}

// Component errors along the travel: mm or deg, um or urad.
py::dict functions_of(const calibration::Calibration& result) {
  py::dict out;
  for (const calibration::KnownFunction& one :
       calibration::functions_along_travel(result.adjustment)) {
    const double along = is_linear(one.name.axis) ? mm : deg;
    constexpr double kMicro = 1e-6;  // um and urad
    out[py::str(to_string(one.name))] =
        py::make_tuple(scaled(one.s, along), scaled(one.value, kMicro), scaled(one.sigma, kMicro),
                       calibration::is_combined(result.adjustment, one.name));
  }
  return out;
}

// Location errors that are not left out, with their standard uncertainty: um or urad.
py::dict locations_of(const calibration::Calibration& result) {
  const calibration::Adjustment& adjustment = result.adjustment;
  py::dict out;
  int unknown = adjustment.unknowns.first_location();
  for (const calibration::SoughtLocation& one : adjustment.unknowns.locations) {
    const double variance = adjustment.covariance(unknown, unknown);
    if (variance > 0.0) {
      out[py::str(to_string(one.name))] =
          py::make_tuple(adjustment.values[unknown] / um, std::sqrt(variance) / um,
                         calibration::is_combined(adjustment, one.name));
    }
    ++unknown;
  }
  return out;
}

py::dict calibrate(const std::string& readings, const std::string& machine,
                   const std::string& output, const std::string& model, bool force,
                   bool accept_contradictions, const py::object& progress) {
  const CalibrateRequest request{readings, machine, output, model, force, accept_contradictions};
  const auto found =
      computed(progress, [&] { return std::make_shared<Calibrated>(calibrated(request)); });
  py::dict out;
  out["functions"] = functions_of(found->result);
  out["locations"] = locations_of(found->result);
  out["unidentifiable"] = calibration::unidentifiable_sentences(found->result);
  out["suggestions"] = found->suggestions;
  out["warnings"] = calibration::warnings(found->result);
  out["report"] = calibration::report(found->result);
  return out;
}

}  // namespace

void bind_calibration(py::module_& module) {
  module.def("calibrate", &calibrate, py::arg("readings"), py::arg("machine"), py::arg("output"),
             py::arg("model"), py::arg("force"), py::arg("accept_contradictions"),
             py::arg("progress") = py::none());
}

}  // namespace servomill::python
