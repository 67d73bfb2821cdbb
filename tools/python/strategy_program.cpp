#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "plant/vocabulary/interrupt.h"
#include "strategies/c_program.h"
#include "strategies/plugin_child.h"
#include "tools/python/computing.h"
#include "tools/python/strategy_parts.h"

namespace servomill::python {
namespace {

namespace py = pybind11;

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Numbers = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;

// The motions of a program as Python sees them, for one call of rewrite.
struct ProgramView {
  const servomill_program* program;

  const servomill_program& get() const {
    if (program == nullptr) throw std::runtime_error("the program is there during rewrite only");
    return *program;
  }
  std::size_t size() const { return get().move_count; }

  template <class Value>
  py::array column(Value value) const {
    py::array_t<double> out(static_cast<py::ssize_t>(size()));
    for (std::size_t n = 0; n < size(); ++n) {
      out.mutable_data()[n] = static_cast<double>(value(*get().moves[n]));
    }
    return out;
  }

  py::array ends() const {
    py::array_t<double> out({static_cast<py::ssize_t>(size()), py::ssize_t{kJoints}});
    double* to = out.mutable_data();
    for (std::size_t n = 0; n < size(); ++n) to = std::copy_n(get().moves[n]->end, kJoints, to);
    return out;
  }

  py::array start() const { return py::array_t<double>(kJoints, get().start); }

  py::array position(const Numbers& move, const Doubles& share) const {
    if (move.size() != share.size()) throw py::value_error("move and share differ in length");
    py::array_t<double> out({share.size(), py::ssize_t{kJoints}});
    double* to = out.mutable_data();
    for (py::ssize_t n = 0; n < share.size(); ++n, to += kJoints) {
      get().position(get().host, static_cast<std::size_t>(move.data()[n]), share.data()[n], to);
    }
    return out;
  }
};

// Blocks of the arrays (move, share, end, feed_factor) that servomill.strategies has checked.
void add_blocks(const servomill_program& program, const py::tuple& arrays) {
  const auto move = arrays[0].cast<Numbers>();
  const auto share = arrays[1].cast<Doubles>(), end = arrays[2].cast<Doubles>(),
             feed_factor = arrays[3].cast<Doubles>();
  for (py::ssize_t n = 0; n < move.size(); ++n) {
    servomill_block block{};
    block.size = sizeof block;
    block.move = static_cast<std::size_t>(move.data()[n]);
    block.share = share.data()[n];
    std::copy_n(end.data() + n * kJoints, kJoints, block.end);
    block.feed_factor = feed_factor.data()[n];
    program.add_block(program.host, &block);
  }
}

// Asks an object of its own for the blocks.
void ask_for_blocks(const Made& made, const servomill_program& program) {
  const InsideComputation mark;
  const Held object = instance_of(made, std::nan(""));
  const py::object view = py::cast(ProgramView{&program});
  const py::object blocks = object->attr("rewrite")(view);
  const py::object arrays =
      py::module_::import("servomill.strategies").attr("_arrays_of_blocks")(blocks);
  view.cast<ProgramView&>().program = nullptr;
  add_blocks(program, arrays);
}

std::string why_no_blocks(const Made& made, const servomill_program& program) {
  const py::gil_scoped_acquire acquired;
  try {
    ask_for_blocks(made, program);
    return {};
  } catch (const py::error_already_set& error) {
    return in_one_line(error);
  } catch (const std::exception& error) {
    return error.what();
  }
}

}  // namespace

void put_rewritten(const Made& made, const MoveRange& moves, const PutMove& put) {
  const strategies::IdentifiedMachine& identified = made->identified;
  std::vector<servomill_block> blocks;
  std::string wrong;
  {
    strategies::CProgram program(moves, identified.layout, identified.reference);
    wrong = why_no_blocks(made, *program.program());
    throw_if_interrupted();
    blocks = program.take_blocks();
  }
  if (wrong.empty()) {
    wrong = strategies::put_with_blocks(moves, blocks, identified.layout, identified.reference,
                                        made->declared->displaces_rotary, put);
  }
  if (wrong.empty()) return;
  throw strategies::PluginFailed("strategy " + made->declared->name + ": rewrite: " + wrong);
}

void bind_program_view(py::module_& module) {
  using Move = servomill_move;
  py::class_<ProgramView>(module, "Program", "Motions of a program, in machine coordinates.")
      .def("__len__", &ProgramView::size)
      .def_property_readonly(
          "kind",
          [](const ProgramView& v) { return v.column([](const Move& m) { return m.kind; }); },
          "(n) 0 rapid, 1 line, 2 arc")
      .def_property_readonly(
          "line",
          [](const ProgramView& v) { return v.column([](const Move& m) { return m.line; }); },
          "(n) line of the program")
      .def_property_readonly(
          "s_begin",
          [](const ProgramView& v) { return v.column([](const Move& m) { return m.s_begin; }); },
          "(n; m) arc length on the original path where a motion begins")
      .def_property_readonly(
          "s_end",
          [](const ProgramView& v) { return v.column([](const Move& m) { return m.s_end; }); },
          "(n; m) the same where it ends")
      .def_property_readonly(
          "feed",
          [](const ProgramView& v) { return v.column([](const Move& m) { return m.feed; }); },
          "(n; m/s, rad/s where X, Y and Z stand still) 0: rapid")
      .def_property_readonly("end", &ProgramView::ends, "(n, 5; m, rad) ends of the motions")
      .def_property_readonly("start", &ProgramView::start,
                             "(5; m, rad) where the first motion begins")
      .def("position", &ProgramView::position, py::arg("move"), py::arg("share"),
           "Programmed positions (k, 5; m, rad) at shares (k; 0 to 1) of motions (k).");
}

}  // namespace servomill::python
