#include "tools/python/strategy.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <exception>
#include <limits>
#include <string_view>
#include <utility>

#include "plant/vocabulary/checksum.h"
#include "plant/vocabulary/input_error.h"
#include "sim/input/plugins.h"
#include "strategies/plugin_file.h"
#include "tools/python/computing.h"
#include "tools/python/strategy_parts.h"
#include "tools/python/strategy_setup.h"

namespace servomill::python {
namespace {

namespace py = pybind11;

class PythonStrategy final : public strategies::Strategy {
 public:
  explicit PythonStrategy(Made made) : made_(std::move(made)) {}

  bool rewrites() const override { return made_->declared->has_rewrite; }
  void rewrite(const MoveRange& moves, const PutMove& put) const override {
    if (!rewrites()) return Strategy::rewrite(moves, put);
    put_rewritten(made_, moves, put);
  }
  std::unique_ptr<strategies::SetpointPart> setpoint() const override {
    if (!made_->declared->has_offset) return nullptr;
    return offset_part(made_);
  }
  bool displaces_feedback() const override { return made_->declared->has_step; }
  bool displaces_rotary() const override { return made_->declared->displaces_rotary; }
  std::unique_ptr<strategies::FeedbackPart> feedback(double model_period) const override {
    if (!displaces_feedback()) return nullptr;
    return feedback_part(made_, model_period);
  }

 private:
  Made made_;
};

void complete(DeclaredStrategy& declared) {
  declared.label = "strategy " + declared.name + " (Python)";
  for (const DeclaredKey& key : declared.keys) {
    declared.specs.push_back({.name = key.name,
                              .help = key.help,
                              .unit = key.unit,
                              .default_text = key.default_text,
                              .min = key.min,
                              .max = key.max});
  }
  sim::input::refuse_unknown_units(declared.specs, declared.name, "servomill.strategy");
  strategies::Entry& entry = declared.entry;
  entry.name = declared.name;
  entry.summary = declared.summary;
  entry.parameters = declared.specs;
  entry.plugin = declared.label;
  entry.reads_errors = declared.knows_errors;
  entry.uses_feedback_hardware = declared.has_step;
  entry.make = [&declared](const Parameters& parameters, strategies::Action action,
                           const strategies::IdentifiedMachine& identified) {
    return make_strategy(declared, parameters, action, identified);
  };
}

// Never destroyed: the interpreter may end before what refers to its objects.
std::deque<DeclaredStrategy>& all_declared() {
  static auto* const all = new std::deque<DeclaredStrategy>;
  return *all;
}

void register_strategy(const py::dict& of) {
  DeclaredStrategy one;
  one.name = of["name"].cast<std::string>();
  one.summary = of["summary"].cast<std::string>();
  one.source = of["source"].cast<std::string>();
  one.make = of["make"];
  one.has_offset = of["has_offset"].cast<bool>();
  one.has_step = of["has_step"].cast<bool>();
  one.has_rewrite = of["has_rewrite"].cast<bool>();
  one.keeps_no_state = of["keeps_no_state"].cast<bool>();
  one.knows_errors = of["knows_errors"].cast<bool>();
  one.displaces_rotary = of["displaces_rotary"].cast<bool>();
  for (const py::handle key : of["keys"]) {
    const auto t = key.cast<py::tuple>();
    one.keys.push_back({t[0].cast<std::string>(), t[1].cast<std::string>(),
                        t[2].cast<std::string>(), t[3].cast<std::string>(), t[4].cast<double>(),
                        t[5].cast<double>()});
  }
  while_idle([&] {
    DeclaredStrategy& declared = all_declared().emplace_back(std::move(one));
    complete(declared);
    strategies::add_plugin({.file = declared.name + ".py",
                            .name = declared.name,
                            .version = "in Python",
                            .checksum = crc64(declared.source),
                            .entries = {&declared.entry}});
  });
}

}  // namespace

std::unique_ptr<strategies::Strategy> make_strategy(
    const DeclaredStrategy& declared, const Parameters& parameters, strategies::Action action,
    const strategies::IdentifiedMachine& identified) {
  MadeStrategy made{&declared, {}, action, identified};
  for (const DeclaredKey& key : declared.keys) {
    made.parameters.emplace(key.name, parameters.number(key.name));
  }
  return std::make_unique<PythonStrategy>(std::make_shared<const MadeStrategy>(std::move(made)));
}

void bind_strategies(py::module_& module) {
  bind_setup(module);
  bind_program_view(module);
  module.def("register_strategy", &register_strategy);
}

}  // namespace servomill::python
