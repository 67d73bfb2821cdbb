#include "plant/geometry/volumetric_kernel.h"

#include "plant/geometry/geometric_errors_kernel.h"
#include "plant/geometry/tool_steps.h"

namespace servomill::plant {
namespace {

// --- one pose: axes in lanes --------------------------------------------------------------------

// Sines and cosines of the turned joints.
struct Turned {
  double sine[kTurnedJoints], cosine[kTurnedJoints];
};

[[gnu::noinline]] void turn_far(const VolumetricProgram& program, const double* q, Turned& turned) {
  for (std::size_t n = 0; n < kTurnedJoints; ++n) {
    const double at = program.senses[n] * q[n];
    const auto [s, c] = is_large(at) ? large_sine_and_cosine(at) : sine_and_cosine(at);
    turned.sine[n] = s;
    turned.cosine[n] = c;
  }
}

SERVOMILL_INLINE void turn(const VolumetricProgram& program, const double* Q, Turned& turned) {
  const double* const q = Q + kMachineJoints - kTurnedJoints;
  if (is_large(q[0]) || is_large(q[1])) {
    turn_far(program, q, turned);
    return;
  }
  const auto [s, c] = sine_and_cosine<Register>(lanes_from(
      [&](std::size_t n) { return n < kTurnedJoints ? program.senses[n] * q[n] : 0.0; }));
  for (std::size_t n = 0; n < kTurnedJoints; ++n) {
    turned.sine[n] = s[n];
    turned.cosine[n] = c[n];
  }
}

// Faults of all joints, one of which is read where it lies.
struct OnePoseFaults {
  LaneArray w_[3], a_[3], h_[3];

  template <std::size_t block>
  SERVOMILL_INLINE void put(const Fault& f, bool has_angles) {
    constexpr std::size_t first = block * kRegister;
    repeat<3>([&](auto i) { store(f.w_[i], w_[i], first); });
    if (!has_angles) return;
    repeat<3>([&](auto i) { store(f.a_[i], a_[i], first); });
    repeat<3>([&](auto i) { store(f.h_[i], h_[i], first); });
  }
};
struct FaultInMemory {
  const OnePoseFaults& all;
  std::size_t joint;

  SERVOMILL_INLINE const double& w(std::size_t i) const { return all.w_[i][joint]; }
  SERVOMILL_INLINE const double& a(std::size_t i) const { return all.a_[i][joint]; }
  SERVOMILL_INLINE const double& h(std::size_t i) const { return all.h_[i][joint]; }
};

struct OnePose {
  const Turned& turned;
  const double* Q;
  const OnePoseFaults& faults;

  SERVOMILL_INLINE double q(std::size_t joint) const { return Q[joint]; }
  SERVOMILL_INLINE double cosine(std::size_t joint) const { return turned.cosine[place(joint)]; }
  SERVOMILL_INLINE double sine(std::size_t joint) const { return turned.sine[place(joint)]; }
  SERVOMILL_INLINE FaultInMemory fault(const VolumetricStep& step, double) const {
    return {faults, step.joint};
  }
};

// False where this way does not lead to the end.
template <Way way, Wanted wanted>
SERVOMILL_INLINE bool try_one(const VolumetricProgram& program, const OnePoseData* data,
                              const double* Q, const double* p_ST, double* out) {
  Turned turned;
  if (program.has_turns) turn(program, Q, turned);
  OnePoseFaults faults;
  const VolumetricPower* const tables = data != nullptr ? &data->tables : nullptr;
  const VolumetricFunctions& functions = program.functions;
  const auto keep = [&](auto block, const Register&, const Fault& f) {
    faults.put<block()>(f, functions.has_angles);
  };
  if (!find_faults<way, kMachineJoints>(functions, functions.has_angles, tables, Q, keep)) {
    return false;
  }
  OnePose at{turned, Q, faults};
  solve<wanted>(program, at, p_ST, out);
  return true;
}

template <Wanted wanted>
[[gnu::noinline]] void one_in_general(const VolumetricProgram& program, const OnePoseData* data,
                                      const double* Q, const double* p_ST, double* out) {
  try_one<Way::general, wanted>(program, data, Q, p_ST, out);
}

template <Wanted wanted>
void one(const VolumetricProgram& program, const OnePoseData* data, const double* Q,
         const double* p_ST, double* out) {
  if (program.functions.is_cubic && try_one<Way::cubic, wanted>(program, data, Q, p_ST, out))
    return;
  one_in_general<wanted>(program, data, Q, p_ST, out);
}

// --- many poses: poses in lanes -----------------------------------------------------------------

using Coordinates = Register[kMachineJoints];
using ManyTerms = Register[kMachineJoints][kErrorComponents];

[[gnu::noinline]] void turn_far(const Register& q, SineAndCosine<Register>& turned) {
  for (std::size_t lane = 0; lane < kRegister; ++lane) {
    if (!is_large(q[lane])) continue;
    const auto [s, c] = large_sine_and_cosine(q[lane]);
    turned.sine[lane] = s;
    turned.cosine[lane] = c;
  }
}

SERVOMILL_INLINE void turn(const Register& q, SineAndCosine<Register>& turned) {
  turned = sine_and_cosine(q);
  const bool are_all_near = xsimd::all(xsimd::abs(Batch(q)) < Batch(kLargestAngle));
  if (!are_all_near) turn_far(q, turned);
}

template <Way way>
struct PosesInLanes {
  const VolumetricProgram& program;
  const Coordinates& Q;
  const SineAndCosine<Register> (&turned)[kTurnedJoints];
  const ManyTerms& sums;
  Register t2_max;

  SERVOMILL_INLINE Register q(std::size_t joint) const { return Q[joint]; }
  SERVOMILL_INLINE Register cosine(std::size_t joint) const { return turned[place(joint)].cosine; }
  SERVOMILL_INLINE Register sine(std::size_t joint) const { return turned[place(joint)].sine; }
  SERVOMILL_INLINE Fault fault(const VolumetricStep& step, const Register& q) {
    const std::size_t joint = step.joint;
    const auto coefficient = [&](std::size_t power, std::size_t component) {
      return all<Register>(program.functions.polynomial[power].e[component][joint]);
    };
    const auto terms = [&](std::size_t component) { return sums[joint][component]; };
    Fault f;
    find_fault<way>(program.functions, step.has_angles, q, coefficient, terms, f, t2_max);
    return f;
  }
};

template <Wanted wanted>
constexpr std::size_t kNumbers = wanted.number == Number::offset ? 3 : 6;

// False where this way does not lead to the end.
template <Way way, Wanted wanted>
SERVOMILL_INLINE bool try_many(const VolumetricProgram& program, const EightPosesData* data,
                               std::size_t first, const double* Q, const double* p_ST,
                               double* out) {
  Coordinates q;
  repeat<kMachineJoints>([&](auto joint) {
    q[joint] = lanes_from([&](std::size_t lane) { return Q[kMachineJoints * lane + joint]; });
  });
  ManyTerms sums;
  if constexpr (way != Way::cubic) {
    const VolumetricPower* const tables = data != nullptr ? data->tables : nullptr;
    if (program.functions.has_terms) find_terms(program.functions, tables, first, q, sums);
  }
  SineAndCosine<Register> turned[kTurnedJoints];
  if (program.has_turns) {
    repeat<kTurnedJoints>([&](auto n) SERVOMILL_INLINE_LAMBDA {
      turn(program.senses[n] * q[kMachineJoints - kTurnedJoints + n], turned[n]);
    });
  }
  PosesInLanes<way> at{program, q, turned, sums, Register{}};
  Register result[kNumbers<wanted>];
  solve<wanted>(program, at, p_ST, result);
  if (way != Way::general && !are_small_turns(at.t2_max)) return false;
  alignas(64) double lanes[kNumbers<wanted>][kRegister];
  for (std::size_t i = 0; i < kNumbers<wanted>; ++i) store(result[i], lanes[i]);
  for (std::size_t n = 0; n < kRegister; ++n) {
    for (std::size_t i = 0; i < kNumbers<wanted>; ++i) *out++ = lanes[i][n];
  }
  return true;
}

template <Wanted wanted>
[[gnu::noinline]] void many_in_general(const VolumetricProgram& program, const EightPosesData* data,
                                       std::size_t first, const double* Q, const double* p_ST,
                                       double* out) {
  try_many<Way::general, wanted>(program, data, first, Q, p_ST, out);
}

template <Wanted wanted>
void many(const VolumetricProgram& program, const EightPosesData* data, const double* Q,
          std::size_t blocks, const double* p_ST, double* out) {
  const std::size_t poses = blocks * kLaneWidth;
  for (std::size_t n = 0; n < poses; n += kRegister) {
    const EightPosesData* const block = data != nullptr ? data + n / kLaneWidth : nullptr;
    const std::size_t first = n % kLaneWidth;
    if (!(program.functions.is_cubic &&
          try_many<Way::cubic, wanted>(program, block, first, Q, p_ST, out))) {
      many_in_general<wanted>(program, block, first, Q, p_ST, out);
    }
    Q += kMachineJoints * kRegister;
    out += kNumbers<wanted> * kRegister;
  }
}

template <bool in_frames>
constexpr VolumetricKernel kKernel = {
    &one<Wanted{Number::tool, in_frames}>,   &one<Wanted{Number::error, in_frames}>,
    &one<Wanted{Number::offset, in_frames}>, &many<Wanted{Number::tool, in_frames}>,
    &many<Wanted{Number::error, in_frames}>, &many<Wanted{Number::offset, in_frames}>};

}  // namespace

template <>
VolumetricKernel make_volumetric_kernel<SERVOMILL_LEVEL>(bool in_frames) {
  return in_frames ? kKernel<true> : kKernel<false>;
}

}  // namespace servomill::plant
