#include "tools/python/bode.h"

#include <pybind11/complex.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <string>
#include <utility>
#include <vector>

#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/progress.h"
#include "plant/vocabulary/units.h"
#include "sim/frequency/bode.h"
#include "sim/run/servo_store.h"
#include "tools/python/computing.h"
#include "tools/python/option_arguments.h"
#include "tools/python/scenario.h"
#include "tools/servomill/axis_options.h"
#include "tools/servomill/bode_options.h"

namespace servomill::python {
namespace {

namespace py = pybind11;
namespace frequency = sim::frequency;

template <class T>
py::array array_of(const std::vector<T>& values) {
  return py::array_t<T>(static_cast<py::ssize_t>(values.size()), values.data());
}

py::dict curve_of(const frequency::BodeCurve& curve) {
  py::dict out;
  out["name"] = curve.name;
  out["long_name"] = curve.long_name;
  out["frequency"] = array_of(curve.f);
  out["exact"] = array_of(curve.exact_at);
  out["measured"] = curve.measured.empty() ? py::object(py::none()) : array_of(curve.measured);
  out["fine_frequency"] = array_of(curve.exact.f);
  out["fine_exact"] = array_of(curve.exact.y);
  return out;
}

py::dict loop_of(char axis, const frequency::BodeResult& result) {
  py::dict out;
  out["axis"] = std::string(1, axis);
  out["loop"] = sim::run::name_of(result.loop);
  out["stable"] = result.stable;
  out["slowest_time_constant_s"] = result.time_constant;
  out["gain_margin"] = result.margins.gain;
  out["gain_margin_Hz"] = result.margins.gain_frequency;
  out["phase_margin_deg"] = result.margins.phase / deg;
  out["crossover_Hz"] = result.margins.crossover;
  out["sensitivity_peak"] = result.margins.sensitivity;
  out["bandwidth_Hz"] = result.closed.bandwidth;
  out["peak"] = result.closed.peak;
  out["peak_Hz"] = result.closed.peak_frequency;
  out["fault"] = result.fault;
  py::list curves;
  for (const frequency::BodeCurve& one : result.curves) curves.append(curve_of(one));
  out["curves"] = curves;
  return out;
}

py::list bode(const LoadedScenario& loaded, const py::object& progress, const py::kwargs& given) {
  tools::Options options("bode", "", "", "FILE");
  tools::add_bode_options(options);
  options.parse(arguments_of(loaded.path, given, {"json", "output", "plugin"}));
  sim::model::Scenario scenario = loaded.scenario;
  tools::restrict_to_case(options, scenario);
  const sim::model::MachineSettings& machine = scenario.machine;
  const std::vector<tools::BodeTask> tasks = tools::bode_tasks(options, machine);
  const Tick delay = frequency::reading_delay_of(scenario);
  const auto results = computed(progress, [&] {
    std::vector<frequency::BodeResult> out;
    Stage loops("loops", static_cast<double>(tasks.size()), Steps::unlike);
    for (const auto& [joint, settings] : tasks) {
      out.push_back(frequency::bode(machine, joint, delay, settings));
      throw_if_interrupted();
      loops.advance();
    }
    return out;
  });
  py::list out;
  for (std::size_t n = 0; n < results.size(); ++n) {
    out.append(loop_of(machine.chain.layout.letter_of(tasks[n].joint), results[n]));
  }
  return out;
}

}  // namespace

void bind_bode(py::module_& module) {
  module.def("bode", &bode, py::arg("scenario"), py::arg("progress") = py::none());
}

}  // namespace servomill::python
