#include "tools/python/scenario.h"

#include <pybind11/stl.h>

#include <utility>

#include "sim/input/plugins.h"
#include "sim/input/scenario_name.h"
#include "sim/input/scenario_source.h"
#include "sim/preparation/estimate.h"
#include "sim/run/run.h"
#include "tools/python/computing.h"
#include "tools/python/option_arguments.h"

namespace servomill::python {
namespace {

namespace py = pybind11;

std::vector<std::string> case_names(const LoadedScenario& loaded) {
  std::vector<std::string> out;
  for (const sim::model::CaseSpec& one : loaded.scenario.cases) out.push_back(one.name);
  return out;
}

py::dict estimate_of(const LoadedScenario& loaded) {
  const sim::preparation::RunEstimate takes =
      computed(py::none(), [&] { return sim::run::check_scenario(loaded.scenario); });
  py::dict out;
  out["motion_s"] = takes.motion;
  out["rows"] = takes.rows;
  out["size_bytes"] = takes.size;
  out["file_bytes"] = takes.file;
  out["memory_bytes"] = takes.memory;
  out["computing_s"] = takes.computing;
  out["trial_runs"] = takes.trial_runs;
  return out;
}

}  // namespace

LoadedScenario load_scenario(const std::string& path, const py::object& set,
                             std::optional<std::string> text) {
  LoadedScenario out{path, changes_of(set), std::move(text), {}};
  compute(py::none(),
          [&] { out.scenario = sim::input::ScenarioSource(out.path, out.changes, out.text).at(); });
  return out;
}

void bind_scenario(py::module_& module) {
  py::class_<LoadedScenario>(module, "Scenario")
      .def_readonly("path", &LoadedScenario::path)
      .def_readonly("changes", &LoadedScenario::changes)
      .def_readonly("given_text", &LoadedScenario::text)
      .def_property_readonly("name", [](const LoadedScenario& s) { return s.scenario.name; })
      .def_property_readonly("title", [](const LoadedScenario& s) { return s.scenario.title; })
      .def_property_readonly("text", [](const LoadedScenario& s) { return s.scenario.text; })
      .def_property_readonly("resolved",
                             [](const LoadedScenario& s) { return s.scenario.resolved; })
      .def_property_readonly("cases", &case_names)
      .def("estimate", &estimate_of);
  module.def("load", &load_scenario, py::arg("path"), py::arg("set") = py::none(),
             py::arg("text") = py::none());
  // from the folder of the module, which an installation of Python finds anywhere
  module.attr("share") = SERVOMILL_MODULE_SHARE;
  module.def("scenario_file", [](const std::string& word, const std::string& share) {
    return sim::input::scenario_file(word, sim::input::scenario_folders(share));
  });
  module.def("scenario_names", [](const std::string& share) {
    std::vector<std::string> out;
    for (const std::string& folder : sim::input::scenario_folders(share)) {
      const std::vector<std::string> names = sim::input::scenario_names(folder);
      out.insert(out.end(), names.begin(), names.end());
    }
    return out;
  });
  module.def("load_plugin",
             [](const std::string& file) { while_idle([&] { sim::input::load_plugin(file); }); });
}

}  // namespace servomill::python
