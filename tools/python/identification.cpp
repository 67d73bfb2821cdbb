#include "tools/python/identification.h"

#include <pybind11/stl.h>

#include <memory>
#include <string>
#include <vector>

#include "sim/identification/experiment.h"
#include "sim/identification/identification.h"
#include "sim/identification/identified_machine.h"
#include "sim/identification/identify.h"
#include "sim/identification/report.h"
#include "sim/identification/store_identification.h"
#include "sim/system/output_name.h"
#include "tools/python/computing.h"

namespace servomill::python {
namespace {

namespace py = pybind11;
namespace identification = sim::identification;

struct IdentifyRequest {
  std::string experiment;
  identification::RecordingFiles files;
  std::string output, signals;  // empty: not written
  bool force = false;
  unsigned threads = 0;
};

struct Identified {
  identification::Experiment experiment;
  identification::Identification result;
  std::string report;
};

Identified identified(const IdentifyRequest& request) {
  for (const std::string& path : {request.output, request.signals}) {
    if (path.empty()) continue;
    sim::system::output_target(path, sim::system::existing_of(request.force));
  }
  Identified out{identification::read_experiment(request.experiment, request.files), {}, {}};
  out.result = identification::identify(out.experiment, request.threads);
  out.report = identification::report(out.experiment, out.result);
  if (!request.output.empty()) {
    sim::input::write_identified_file(
        request.output,
        identification::identified_machine(out.experiment, out.result, request.output),
        request.force);
  }
  if (!request.signals.empty()) {
    identification::store_identification(out.experiment, out.result, request.signals,
                                         request.force);
  }
  return out;
}

py::list estimates_of(const identification::Identification& result) {
  py::list out;
  for (std::size_t n = 0; n < result.estimates.size(); ++n) {
    const bool known = result.uncertainty.identifiable[n];
    out.append(py::make_tuple(
        result.estimates[n].keys, result.fit.values[n], result.estimates[n].unit,
        known ? py::object(py::float_(result.uncertainty.half_width(n))) : py::none()));
  }
  return out;
}

py::list records_of(const std::vector<identification::RecordResult>& records) {
  py::list out;
  for (const identification::RecordResult& one : records) {
    out.append(py::make_tuple(one.feedback_rms, one.force_rms));
  }
  return out;
}

py::dict identify(const std::string& experiment, const std::vector<std::string>& recording,
                  const std::vector<std::string>& validation, const std::string& output,
                  const std::string& signals, bool force, unsigned threads,
                  const py::object& progress) {
  const IdentifyRequest request{experiment, {recording, validation}, output, signals, force,
                                threads};
  const auto found =
      computed(progress, [&] { return std::make_shared<Identified>(identified(request)); });
  py::dict out;
  out["estimates"] = estimates_of(found->result);
  out["estimation"] = records_of(found->result.estimation);
  out["validation"] = records_of(found->result.validation);
  out["converged"] = found->result.fit.converged;
  out["unidentifiable"] = identification::unidentifiable_sentences(found->result);
  out["warnings"] = identification::warnings(found->result);
  out["report"] = found->report;
  return out;
}

}  // namespace

void bind_identification(py::module_& module) {
  module.def("identify", &identify, py::arg("experiment"), py::arg("recording"),
             py::arg("validation"), py::arg("output"), py::arg("signals"), py::arg("force"),
             py::arg("threads"), py::arg("progress") = py::none());
}

}  // namespace servomill::python
