#include "tools/python/programs.h"

#include <pybind11/stl.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "sim/programs/canonical_moves.h"
#include "sim/programs/compensate/compensate.h"
#include "sim/programs/post_file.h"
#include "tools/python/computing.h"
#include "tools/python/option_arguments.h"
#include "tools/servomill/compensate_options.h"
#include "tools/servomill/post_options.h"
#include "tools/servomill/program_options.h"

namespace servomill::python {
namespace {

namespace py = pybind11;

std::vector<std::string> sentences_of(const std::vector<Fault>& warnings) {
  std::vector<std::string> out;
  for (const Fault& one : warnings) out.push_back(to_string(one.place) + ": " + one.message);
  return out;
}

py::tuple canon(const std::string& program, const py::kwargs& given) {
  tools::Options options("canon", "", "", "PROGRAM");
  tools::add_program_options(options);
  tools::add_machine_option(options);
  options.parse(arguments_of(program, given));
  const sim::programs::ProgramInputs inputs = tools::program_inputs(options);
  std::string lines;
  const auto warnings = computed(py::none(), [&] {
    return sim::programs::canon(program, inputs,
                                [&](std::string_view more) { lines.append(more); });
  });
  return py::make_tuple(lines, sentences_of(warnings));
}

py::dict compensate(const std::string& program, const py::object& progress,
                    const py::kwargs& given) {
  tools::Options options("compensate", "", "", "PROGRAM");
  tools::add_compensate_options(options);
  options.parse(arguments_of(program, given));
  const sim::programs::CompensateRequest request = tools::compensate_request(options);
  const sim::programs::Compensated done =
      computed(progress, [&] { return sim::programs::compensate(request); });
  py::dict out;
  out["name"] = tools::compensated_name(options);
  out["program"] = done.program;
  out["report"] = done.report;
  out["warnings"] = sentences_of(done.warnings);
  out["json"] = done.json;
  return out;
}

py::dict post(const std::string& locations, const py::object& progress, const py::kwargs& given) {
  tools::Options options("post", "", "", "PART.cls");
  tools::add_post_options(options);
  options.parse(arguments_of(locations, given, {"json", "output"}));
  sim::programs::PostRequest request = tools::post_request(options);
  const sim::programs::PostProcessedFile done =
      computed(progress, [&] { return sim::programs::post_file(std::move(request)); });
  std::vector<std::string> warnings;
  for (const auto& one : done.warnings) warnings.push_back(to_string(one));
  py::dict out;
  out["program"] = done.program;
  out["warnings"] = warnings;
  out["locations"] = done.locations;
  out["inserted"] = done.inserted;
  out["verified"] = done.verified;
  return out;
}

}  // namespace

void bind_programs(py::module_& module) {
  module.def("canon", &canon, py::arg("program"));
  module.def("compensate", &compensate, py::arg("program"), py::arg("progress") = py::none());
  module.def("post", &post, py::arg("locations"), py::arg("progress") = py::none());
}

}  // namespace servomill::python
