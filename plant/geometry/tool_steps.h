/// The way of the tool through the steps of a program: the part of the volumetric kernel that one
/// pose and poses in lanes share. Only that kernel includes this.
#pragma once

#include <cstddef>
#include <type_traits>

#include "plant/geometry/geometric_errors_kernel.h"
#include "plant/geometry/volumetric_kernel.h"

namespace servomill::plant {
namespace {  // one copy for each instruction set

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

// Result of a call, and the programs that it is for.
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

}  // namespace
}  // namespace servomill::plant
