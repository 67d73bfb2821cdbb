// Strategies that go wrong in the function and in the manner that their keys say.
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <limits>
#include <stdexcept>

#include "strategies/plugin_c.h"

namespace {

// Values of the keys; tests/cli/plugins.py has the same.
enum Where { kCreate, kSettle, kStep, kDestroy };
enum How {
  kThrow,
  kThrowNumber,
  kReturnText,
  kNan,
  kSegmentationFault,
  kAbort,
  kOverflow,
  kExit,
  kQuickExit,
  kEndAtOnce,
  kLoop,
  kAbsurd,
};

struct Run {
  int where, how;
};

volatile int always = 1;

int recurse(int depth) {
  volatile char room[4096] = {};
  room[0] = static_cast<char>(depth);
  return always != 0 ? recurse(depth + 1) + room[0] : 0;
}

// Returns a text, or does not return.
const char* go_wrong(int how) {
  switch (how) {
    case kThrow:
      throw std::runtime_error("thrown on purpose");
    case kThrowNumber:
      throw 42;
    case kReturnText:
      return "returned on purpose";
    case kSegmentationFault:
      std::raise(SIGSEGV);
      break;
    case kAbort:
      std::abort();
    case kOverflow:
      recurse(0);
      break;
    case kExit:
      std::exit(0);
    case kQuickExit:
      std::quick_exit(0);
    case kEndAtOnce:
      _exit(7);
    case kLoop:
      while (always != 0) usleep(1000);  // leaves the processor to the other tests
      break;
    default:
      break;
  }
  return nullptr;
}

const char* create(const servomill_setup* setup, void** state) {
  auto* run =
      new Run{static_cast<int>(setup->parameters[0]), static_cast<int>(setup->parameters[1])};
  *state = run;
  return run->where == kCreate ? go_wrong(run->how) : nullptr;
}

void destroy(void* state) {
  const Run run = *static_cast<Run*>(state);
  delete static_cast<Run*>(state);
  if (run.where == kDestroy) go_wrong(run.how);
}

const char* settle(void* state, const servomill_reading*) {
  const Run& run = *static_cast<Run*>(state);
  return run.where == kSettle ? go_wrong(run.how) : nullptr;
}

// Goes wrong from the middle of the program on.
const char* step(void* state, const servomill_reading* now, double out[SERVOMILL_JOINTS]) {
  const Run& run = *static_cast<Run*>(state);
  out[1] = 1e-6;
  if (run.where != kStep || now->Q_ref[0] < 5e-3) return nullptr;
  if (run.how == kNan) out[1] = std::numeric_limits<double>::quiet_NaN();
  if (run.how == kAbsurd) out[1] = -1e12;
  return go_wrong(run.how);
}

// Half of the first motion by a block, then the other half, unless it goes wrong in between.
const char* rewrite(void* state, const servomill_program* program) {
  const Run& run = *static_cast<Run*>(state);
  servomill_block block{};
  block.size = sizeof block;
  block.feed_factor = 1.0;
  for (const double share : {0.5, 1.0}) {
    block.share = share;
    program->position(program->host, 0, share, block.end);
    if (run.where == kStep && share == 1.0) {
      if (run.how == kNan) block.end[1] = std::numeric_limits<double>::quiet_NaN();
      if (const char* why = go_wrong(run.how)) return why;
    }
    program->add_block(program->host, &block);
  }
  return nullptr;
}

constexpr servomill_parameter kWhere = {
    sizeof(servomill_parameter), "where", "function that goes wrong", "", "0", 0.0, kDestroy};
constexpr servomill_parameter kHow = {
    sizeof(servomill_parameter), "how", "manner in which it does", "", "0", 0.0, kAbsurd};
const servomill_parameter* const kParameters[] = {&kWhere, &kHow};

constexpr servomill_strategy strategy(const char* name) {
  servomill_strategy out{};
  out.size = sizeof out;
  out.name = name;
  out.summary = "goes wrong on purpose";
  out.parameters = kParameters;
  out.parameter_count = 2;
  out.create = create;
  out.destroy = destroy;
  out.settle = settle;
  return out;
}
constexpr servomill_strategy displacing() {
  servomill_strategy out = strategy("wrong_displacement");
  out.displacement = step;
  return out;
}
constexpr servomill_strategy offsetting() {
  servomill_strategy out = strategy("wrong_offset");
  out.offset = step;
  return out;
}
constexpr servomill_strategy rewriting() {
  servomill_strategy out = strategy("wrong_rewrite");
  out.rewrite = rewrite;
  return out;
}

constexpr servomill_strategy in_position_loop() {
  servomill_strategy out = strategy("wrong_position_loop");
  out.position_loop = step;
  return out;
}

constexpr servomill_strategy kDisplacing = displacing(), kOffsetting = offsetting(),
                             kRewriting = rewriting(), kInLoop = in_position_loop();
const servomill_strategy* const kStrategies[] = {&kDisplacing, &kOffsetting, &kRewriting, &kInLoop};
constexpr servomill_plugin_c kPlugin = {
    SERVOMILL_PLUGIN_ABI, 0, sizeof(servomill_plugin_c), "wrong", "0", kStrategies, 4};

}  // namespace

extern "C" const servomill_plugin_c* servomill_plugin_c_entry() { return &kPlugin; }
