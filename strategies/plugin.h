/// Strategies out of the tree, in C++: classes become what strategies/plugin_c.h asks for. Headers
/// of the standard library are all that this needs, so that any compiler of C++20 builds a plug-in.
///
///     struct Ramp {                                             // state of one run
///       explicit Ramp(const servomill_setup&);
///       void settle(const servomill_reading&);                  // may be left out
///       servomill::plugin::Joints displacement(const servomill_reading&);   // one of these two,
///       servomill::plugin::Joints offset(const servomill_reading&);         // or several
///       servomill::plugin::Joints position_loop(const servomill_reading&);
///       void rewrite(servomill::plugin::Program&);
///     };
///     constexpr auto kRamp = servomill::plugin::strategy<Ramp>("ramp", "displaces Y over X");
///     SERVOMILL_PLUGIN("my plug-in", "1.0", kRamp)
///
/// Exceptions of them end the case with what() as the message.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <exception>
#include <string>

#include "strategies/plugin_c.h"

namespace servomill::plugin {

/// X, Y, Z, then the rotary axes (5; m, rad).
using Joints = std::array<double, SERVOMILL_JOINTS>;

/// A key of the strategy.
/// @param name, unit, default_text  "time_constant_ms", "ms", "1"
/// @param min, max                  inclusive, in `unit`
constexpr servomill_parameter parameter(const char* name, const char* help, const char* unit,
                                        const char* default_text, double min, double max) {
  return {sizeof(servomill_parameter), name, help, unit, default_text, min, max};
}

/// The program that `rewrite` makes blocks of.
class Program {
 public:
  explicit Program(const servomill_program& program) : program_(program) {}

  /// Motions, in their order.
  std::size_t size() const { return program_.move_count; }
  const servomill_move& operator[](std::size_t move) const { return *program_.moves[move]; }
  Joints start() const {
    Joints Q;
    std::copy_n(program_.start, Q.size(), Q.begin());
    return Q;
  }
  /// Programmed position at a share (0 to 1) of a motion.
  Joints position(std::size_t move, double share) const {
    Joints Q;
    program_.position(program_.host, move, share, Q.data());
    return Q;
  }
  /// Adds a block, in the order of the motions; a motion without blocks stays as it is.
  /// @param share  of the motion, at which the block ends: rising, and 1 for the last one
  void add(std::size_t move, double share, const Joints& end, double feed_factor = 1.0) {
    servomill_block block{};
    block.size = sizeof block;
    block.move = move;
    block.share = share;
    std::copy(end.begin(), end.end(), block.end);
    block.feed_factor = feed_factor;
    program_.add_block(program_.host, &block);
  }

 private:
  const servomill_program& program_;
};

/// Text of an exception, until the next one of this thread.
inline const char* keep(const char* what) {
  static thread_local std::string text;
  text = what;
  return text.c_str();
}

/// Calls a function of a plug-in; NULL, or the text of what it has thrown.
template <class Function>
const char* guarded(Function function) noexcept {
  try {
    function();
    return nullptr;
  } catch (const std::exception& error) {
    return keep(error.what());
  } catch (...) {
    return "an exception of unknown type";
  }
}

/// The functions of a class.
template <class Run>
struct Functions {
  static const char* create(const servomill_setup* setup, void** state) {
    return guarded([&] { *state = new Run(*setup); });
  }
  static void destroy(void* state) { delete static_cast<Run*>(state); }
  static const char* settle(void* state, const servomill_reading* now) {
    return guarded([&] { static_cast<Run*>(state)->settle(*now); });
  }
  static const char* displacement(void* state, const servomill_reading* now, double* d) {
    return guarded([&] { write(static_cast<Run*>(state)->displacement(*now), d); });
  }
  static const char* offset(void* state, const servomill_reading* now, double* out) {
    return guarded([&] { write(static_cast<Run*>(state)->offset(*now), out); });
  }
  static const char* position_loop(void* state, const servomill_reading* now, double* velocity) {
    return guarded([&] { write(static_cast<Run*>(state)->position_loop(*now), velocity); });
  }
  static const char* rewrite(void* state, const servomill_program* given) {
    return guarded([&] {
      Program program(*given);
      static_cast<Run*>(state)->rewrite(program);
    });
  }

 private:
  static void write(const Joints& from, double* to) { std::copy(from.begin(), from.end(), to); }
};

/// @param name     lower case, digits and '_'
/// @param summary  one line
template <class Run>
constexpr servomill_strategy strategy(const char* name, const char* summary) {
  servomill_strategy out{};
  out.size = sizeof out;
  out.name = name;
  out.summary = summary;
  out.create = Functions<Run>::create;
  out.destroy = Functions<Run>::destroy;
  if constexpr (requires(Run run, servomill_reading now) { run.settle(now); }) {
    out.settle = Functions<Run>::settle;
  }
  if constexpr (requires(Run run, servomill_reading now) { run.displacement(now); }) {
    out.displacement = Functions<Run>::displacement;
  }
  if constexpr (requires(Run run, servomill_reading now) { run.offset(now); }) {
    out.offset = Functions<Run>::offset;
  }
  if constexpr (requires(Run run, servomill_reading now) { run.position_loop(now); }) {
    out.position_loop = Functions<Run>::position_loop;
  }
  if constexpr (requires(Run run, Program program) { run.rewrite(program); }) {
    out.rewrite = Functions<Run>::rewrite;
  }
  return out;
}

/// The same with keys.
/// @param parameters  pointers to parameter(); must outlive the library's last use
template <class Run, std::size_t kCount>
constexpr servomill_strategy strategy(const char* name, const char* summary,
                                      const servomill_parameter* const (&parameters)[kCount]) {
  servomill_strategy out = strategy<Run>(name, summary);
  out.parameters = parameters;
  out.parameter_count = kCount;
  return out;
}

/// The strategy with the keys model and action, and with error_at in its setup.
constexpr servomill_strategy knows_errors(servomill_strategy one) {
  one.knows_errors = 1;
  return one;
}

/// The strategy with permission to displace rotary axes.
constexpr servomill_strategy displaces_rotary(servomill_strategy one) {
  one.displaces_rotary = 1;
  return one;
}

}  // namespace servomill::plugin

/// SERVOMILL_PLUGIN(NAME, VERSION, STRATEGY...): exports constants made by strategy(). Once a
/// library.
#define SERVOMILL_PLUGIN(plugin_name, plugin_version, ...)                     \
  extern "C" const servomill_plugin_c* servomill_plugin_c_entry() {            \
    static constexpr auto kPointers = [](const auto&... each) {                \
      return std::array<const servomill_strategy*, sizeof...(each)>{&each...}; \
    }(__VA_ARGS__);                                                            \
    static constexpr servomill_plugin_c kPlugin = {SERVOMILL_PLUGIN_ABI,       \
                                                   0,                          \
                                                   sizeof(servomill_plugin_c), \
                                                   plugin_name,                \
                                                   plugin_version,             \
                                                   kPointers.data(),           \
                                                   kPointers.size()};          \
    return &kPlugin;                                                           \
  }
