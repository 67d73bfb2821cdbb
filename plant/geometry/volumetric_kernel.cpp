#include "plant/geometry/volumetric_kernel.h"

#include "plant/geometry/volumetric_faults.h"

namespace servomill::plant {
namespace {

// --- the way of the tool ------------------------------------------------------------------------

template <class N>
SERVOMILL_INLINE void add(int direction, const N& q, N (&v)[3]) {
  if (direction == 0) {
    v[0] = v[0] + q;
  } else if (direction == 1) {
    v[1] = v[1] + q;
  } else {
    v[2] = v[2] + q;
  }
}

SERVOMILL_INLINE bool is_frame(const VolumetricStep& step) {
  return step.move >= VolumetricMove::enter_frame;
}

// The motion of a tilted turn.
SERVOMILL_INLINE void find_motion(const VolumetricStep& step, double c, double s, double* M) {
  const Register cosine = all<Register>(c), sine = all<Register>(s);
  for (std::size_t i = 0; i < kMotionNumbers; i += kRegister) {
    store(fma(sine, load(step.turning[1] + i),
              fma(cosine, load(step.turning[0] + i), load(step.still + i))),
          M + i);
  }
}
SERVOMILL_INLINE void find_motion(const VolumetricStep& step, const Register& c, const Register& s,
                                  Register* M) {
  repeat<12>([&](auto i) SERVOMILL_INLINE_LAMBDA {
    M[i] = fma(s, all<Register>(step.turning[1][i]),
               fma(c, all<Register>(step.turning[0][i]), all<Register>(step.still[i])));
  });
}

// The true tool, and the ideal one where it is asked for; the axis where it is asked for.
template <class N, bool kAxis, bool kIdeal>
struct Tools {
  static constexpr bool kHasIdeal = kIdeal;
  Vector<N> p, k, p_ideal, k_ideal;

  SERVOMILL_INLINE void ideal_turn(int about, const N& c, const N& s, const double* centre) {
    if constexpr (kIdeal) {
      p_ideal = plus(turned(about, c, s, minus(p_ideal, centre)), centre);
      if constexpr (kAxis) k_ideal = turned(about, c, s, k_ideal);
    }
  }
  SERVOMILL_INLINE void turn(int about, const N& c, const N& s, const double* centre) {
    p = plus(turned(about, c, s, minus(p, centre)), centre);
    if constexpr (kAxis) k = turned(about, c, s, k);
  }
  SERVOMILL_INLINE void tilted_turn(const N& c, const N& s, const VolumetricStep& step) {
    N M[kMotionNumbers];
    find_motion(step, c, s, M);
    const N* const d = M + 9;
    p = {fma(M[2], p.v[2], fma(M[1], p.v[1], fma(M[0], p.v[0], d[0]))),
         fma(M[5], p.v[2], fma(M[4], p.v[1], fma(M[3], p.v[0], d[1]))),
         fma(M[8], p.v[2], fma(M[7], p.v[1], fma(M[6], p.v[0], d[2])))};
    if constexpr (kAxis) {
      k = {fma(M[2], k.v[2], fma(M[1], k.v[1], M[0] * k.v[0])),
           fma(M[5], k.v[2], fma(M[4], k.v[1], M[3] * k.v[0])),
           fma(M[8], k.v[2], fma(M[7], k.v[1], M[6] * k.v[0]))};
    }
  }
  SERVOMILL_INLINE void enter(const VolumetricStep& frame) {
    p = transpose_times(frame.R, minus(p, frame.centre));
    if constexpr (kAxis) k = transpose_times(frame.R, k);
    if constexpr (kIdeal) p_ideal = transpose_times(frame.R, minus(p_ideal, frame.centre));
    if constexpr (kIdeal && kAxis) k_ideal = transpose_times(frame.R, k_ideal);
  }
  SERVOMILL_INLINE void leave(const VolumetricStep& frame) {
    p = plus(times(frame.R, p), frame.centre);
    if constexpr (kAxis) k = times(frame.R, k);
    if constexpr (kIdeal) p_ideal = plus(times(frame.R, p_ideal), frame.centre);
    if constexpr (kIdeal && kAxis) k_ideal = times(frame.R, k_ideal);
  }
  template <class F>
  SERVOMILL_INLINE void fault(const F& f, const VolumetricStep& step, const N& q) {
    Vector<N> w{f.w(0), f.w(1), f.w(2)};
    if (step.move == VolumetricMove::faulty_shift) {
      add(step.direction, q, w.v);
      if constexpr (kIdeal) add(step.direction, q, p_ideal.v);
    }
    repeat<3>([&](auto i) { w.v[i] = p.v[i] + w.v[i]; });
    if (!step.has_angles) {
      p = w;
      return;
    }
    if (step.has_lever) {
      repeat<3>([&](auto i) {
        p.v[i] = p.v[i] + fms(q, all<N>(step.lever_slope[i]), all<N>(step.centre[i]));
      });
    }
    p = turned_by(f, p, w);
    if constexpr (kAxis) k = turned_by(f, k, k);
  }
};

// Calls f with the direction as a constant.
template <class F>
SERVOMILL_INLINE void about(int direction, F f) {
  if (direction == 0) {
    f(std::integral_constant<int, 0>());
  } else if (direction == 1) {
    f(std::integral_constant<int, 1>());
  } else {
    f(std::integral_constant<int, 2>());
  }
}

// Source: q(joint), cosine(joint), sine(joint), fault(step, q, fault).
template <bool in_frames, class N, class Source, class T>
SERVOMILL_INLINE void go(const VolumetricProgram& program, std::size_t steps, Source& at,
                         T& tools) {
  const VolumetricStep* const end = program.steps + steps;
  for (const VolumetricStep* step = program.steps; step != end; ++step) {
    const std::size_t joint = step->joint;
    if (step->move == VolumetricMove::faulty_shift || step->move == VolumetricMove::fault) {
      const N q = at.q(joint);
      tools.fault(at.fault(*step, q), *step, q);
    } else if (step->move == VolumetricMove::shift) {
      const N q = at.q(joint);
      add(step->direction, q, tools.p.v);
      if constexpr (T::kHasIdeal) add(step->direction, q, tools.p_ideal.v);
    } else if (!in_frames || !is_frame(*step)) {
      const N c = at.cosine(joint), s = at.sine(joint);
      about(step->direction, [&](auto axis) {
        if (step->move == VolumetricMove::turn) {
          tools.turn(axis, c, s, step->centre);
        } else {
          tools.tilted_turn(c, s, *step);
        }
        tools.ideal_turn(axis, c, s, step->centre);
      });
    } else if (step->move == VolumetricMove::enter_frame) {
      tools.enter(*step);
    } else {
      tools.leave(*step);
    }
  }
}

template <class N>
SERVOMILL_INLINE Vector<N> at_tip(const double* p_ST) {
  return {all<N>(p_ST[0]), all<N>(p_ST[1]), all<N>(p_ST[2])};
}

enum class Number { tool, error, offset };

SERVOMILL_INLINE std::size_t place(std::size_t joint) {  // among the turned ones
  return joint - (kMachineJoints - kTurnedJoints);
}

// What a call computes, and for which programs.
struct Wanted {
  Number number;
  bool in_frames;  // of inclined axes
};

// The first `size(wanted)` numbers of the result.
template <Wanted wanted, class N, class Source>
SERVOMILL_INLINE void solve(const VolumetricProgram& program, Source& at, const double* p_ST,
                            N* out) {
  constexpr bool kAxis = wanted.number != Number::offset, kIdeal = wanted.number != Number::tool;
  Tools<N, kAxis, kIdeal> tools;
  tools.p = tools.p_ideal = at_tip<N>(p_ST);
  tools.k = tools.k_ideal = {all<N>(0.0), all<N>(0.0), all<N>(1.0)};
  const std::size_t steps =
      wanted.number == Number::offset ? program.offset_steps : program.number_of_steps;
  go<wanted.in_frames, N>(program, steps, at, tools);
  Vector<N> p = tools.p, k = tools.k;
  if constexpr (kIdeal) p = minus(p, tools.p_ideal);
  if constexpr (wanted.number == Number::error) k = minus(k, tools.k_ideal);
  if constexpr (wanted.number == Number::offset) {
    // the difference is turned back into the frame of the linear axes
    for (std::size_t n = steps; n-- > program.linear_end;) {
      const VolumetricStep& step = program.steps[n];
      if (step.move == VolumetricMove::fault) continue;
      if (wanted.in_frames && is_frame(step)) {
        p = step.move == VolumetricMove::enter_frame ? times(step.R, p)
                                                     : transpose_times(step.R, p);
        continue;
      }
      const N c = at.cosine(step.joint), s = -at.sine(step.joint);
      about(step.direction, [&](auto axis) { p = turned(axis, c, s, p); });
    }
  }
  for (int i = 0; i < 3; ++i) out[i] = p.v[i];
  if constexpr (kAxis) {
    for (int i = 0; i < 3; ++i) out[3 + i] = k.v[i];
  }
}

// --- one pose: axes in lanes --------------------------------------------------------------------

// Of the turned joints.
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
