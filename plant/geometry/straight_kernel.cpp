#include "plant/geometry/straight_kernel.h"

#include <cstring>

#include "plant/geometry/volumetric_faults.h"

namespace servomill::plant {
namespace {

// What an axis adds by itself, g, to the deviation. u: lever.
template <bool kAngles>
SERVOMILL_INLINE Vector<Register> gain(const Fault& f, const Vector<Register>& u) {
  const Vector<Register> w{f.w(0), f.w(1), f.w(2)};
  if constexpr (kAngles) return turned_by(f, u, w);
  return w;
}

// The deviation behind an axis.
template <bool kAngles, class N, class F>
SERVOMILL_INLINE Vector<N> behind(const F& f, const Vector<N>& g, const Vector<N>& D) {
  const Vector<N> sum{g.v[0] + D.v[0], g.v[1] + D.v[1], g.v[2] + D.v[2]};
  if constexpr (kAngles) return turned_by(f, D, sum);
  return sum;
}

// Numbers along X, Y, Z in the order of the axes.
template <class N>
SERVOMILL_INLINE Vector<N> in_order(const StraightProgram& program, const N* xyz) {
  return {xyz[program.joint[0]], xyz[program.joint[1]], xyz[program.joint[2]]};
}

// --- one pose -----------------------------------------------------------------------------------

// From the spindle to each axis and on its lever; lanes: axes from `first` on.
template <std::size_t first>
SERVOMILL_INLINE Vector<Register> levers(const StraightProgram& program, const double* tip,
                                         const Vector<double>& q, const Register& own_q) {
  Vector<Register> u;
  repeat<3>([&](auto i) SERVOMILL_INLINE_LAMBDA {
    const double p = tip[program.joint[i]];
    u.v[i] = lanes_from([&](std::size_t lane)
                            SERVOMILL_INLINE_LAMBDA { return first + lane > i ? p + q.v[i] : p; });
    if (program.has_levers) {
      u.v[i] = u.v[i] + fms(own_q, load(program.lever_slope[i], first),
                            load(program.lever_centre[i], first));
    }
  });
  return u;
}

// Gains and turns of all axes, one of which is read where it lies.
struct Gains {
  LaneArray g_[3], a_[3], h_[3];
};
struct TurnInMemory {
  const Gains& all;
  std::size_t axis;

  SERVOMILL_INLINE Vector<double> g() const {
    return {all.g_[0][axis], all.g_[1][axis], all.g_[2][axis]};
  }
  SERVOMILL_INLINE const double& a(std::size_t i) const { return all.a_[i][axis]; }
  SERVOMILL_INLINE const double& h(std::size_t i) const { return all.h_[i][axis]; }
};

// False where this way does not lead to the end.
template <Way way, bool kAngles>
SERVOMILL_INLINE bool try_one(const StraightProgram& program, const VolumetricPower* tables,
                              const double* tip, const double* Q, double* out) {
  const Vector<double> q = in_order(program, Q);
  Gains gains;
  const auto keep = [&](auto block, const Register& own_q, const Fault& f) SERVOMILL_INLINE_LAMBDA {
    constexpr std::size_t first = block() * kRegister;
    const auto g = gain<kAngles>(f, levers<first>(program, tip, q, own_q));
    repeat<3>([&](auto i) SERVOMILL_INLINE_LAMBDA {
      store(g.v[i], gains.g_[i], first);
      if constexpr (kAngles) {
        store(f.a_[i], gains.a_[i], first);
        store(f.h_[i], gains.h_[i], first);
      }
    });
  };
  if (!find_faults<way, kStraightAxes>(program.functions, kAngles, tables, q.v, keep)) return false;
  const TurnInMemory first{gains, 0}, second{gains, 1}, third{gains, 2};
  Vector<double> D = first.g();
  D = behind<kAngles>(second, second.g(), D);
  D = behind<kAngles>(third, third.g(), D);
  for (std::size_t n = 0; n < 3; ++n) out[program.joint[n]] = D.v[n];
  return true;
}

[[gnu::noinline]] void one_in_general(const StraightProgram& program, const VolumetricPower* tables,
                                      const double* tip, const double* Q, double* out) {
  try_one<Way::general, true>(program, tables, tip, Q, out);
}

template <Way way, bool kAngles>
void one(const StraightProgram& program, const VolumetricPower* tables, const double* tip,
         const double* Q, double* out) {
  if (!try_one<way, kAngles>(program, tables, tip, Q, out)) {
    one_in_general(program, tables, tip, Q, out);
  }
}

// --- many poses in lanes ------------------------------------------------------------------------

// Some of eight poses: the lanes from `first` on of the data, and X, Y, Z of their joints.
struct Poses {
  const StraightData* data;
  const double* tip;
  std::size_t first;
  Register Q[3];
};

SERVOMILL_INLINE Vector<Register> tip_of(const StraightProgram& program, const Poses& poses) {
  Vector<Register> tip;
  for (std::size_t n = 0; n < 3; ++n) {
    const std::size_t i = program.joint[n];
    tip.v[n] =
        poses.data != nullptr ? load(poses.data->tip[i], poses.first) : all<Register>(poses.tip[i]);
  }
  return tip;
}

template <Way way, bool kAngles>
SERVOMILL_INLINE bool try_many(const StraightProgram& program, const Poses& poses,
                               Register (&out)[3]) {
  const VolumetricFunctions& functions = program.functions;
  const Vector<Register> q = in_order(program, poses.Q);
  Register sums[kStraightAxes][kErrorComponents];
  if constexpr (way != Way::cubic) {
    const VolumetricPower* const tables = poses.data != nullptr ? poses.data->tables : nullptr;
    if (functions.has_terms) find_terms(functions, tables, poses.first, q.v, sums);
  }
  Vector<Register> P = tip_of(program, poses), D;
  Register t2_max{};
  repeat<kStraightAxes>([&](auto axis) SERVOMILL_INLINE_LAMBDA {
    const auto coefficient = [&](std::size_t power, std::size_t component) SERVOMILL_INLINE_LAMBDA {
      return all<Register>(functions.polynomial[power].e[component][axis]);
    };
    const auto terms = [&](std::size_t component)
                           SERVOMILL_INLINE_LAMBDA { return sums[axis][component]; };
    Fault f;
    find_fault<way>(functions, kAngles, q.v[axis], coefficient, terms, f, t2_max);
    Vector<Register> u = P;
    if (program.has_levers) {
      for (std::size_t i = 0; i < 3; ++i) {
        u.v[i] = u.v[i] + fms(q.v[axis], all<Register>(program.lever_slope[i][axis]),
                              all<Register>(program.lever_centre[i][axis]));
      }
    }
    const Vector<Register> g = gain<kAngles>(f, u);
    D = axis == 0 ? g : behind<kAngles>(f, g, D);
    P.v[axis] = P.v[axis] + q.v[axis];
  });
  for (std::size_t n = 0; n < 3; ++n) out[program.joint[n]] = D.v[n];
  return way == Way::general || !kAngles || are_small_turns(t2_max);
}

[[gnu::noinline]] void many_in_general(const StraightProgram& program, const Poses& poses,
                                       Register (&out)[3]) {
  try_many<Way::general, true>(program, poses, out);
}

template <Way way, bool kAngles>
SERVOMILL_INLINE void find_offsets(const StraightProgram& program, const Poses& poses,
                                   Register (&out)[3]) {
  if (!try_many<way, kAngles>(program, poses, out)) many_in_general(program, poses, out);
}

template <Way way, bool kAngles>
void lanes(const StraightProgram& program, const StraightData* data, const double* tip,
           const LaneArray* Q, LaneArray* out) {
  for (std::size_t first = 0; first < kLaneWidth; first += kRegister) {
    const Poses poses{data, tip, first, {load(Q[0], first), load(Q[1], first), load(Q[2], first)}};
    Register offset[3];
    find_offsets<way, kAngles>(program, poses, offset);
    repeat<3>([&](auto i) SERVOMILL_INLINE_LAMBDA { store(offset[i], out[i], first); });
  }
}

// --- poses one behind the other -----------------------------------------------------------------

// X, Y, Z of one pose and the number behind them.
using Pose [[gnu::vector_size(4 * sizeof(double))]] = double;

#if defined(__AVX__)
// Four, or two times four, transposed: pairs of poses first, then pairs of pairs.
SERVOMILL_INLINE Pose pose_at(const double* Q) {
  Pose P;
  std::memcpy(&P, Q, sizeof P);
  return P;
}
#if defined(__AVX512F__)
SERVOMILL_INLINE void take_poses(const double* Q, Register (&xyz)[3]) {
  const auto two = [Q](std::size_t n) {  // poses n and n + 2
    return __builtin_shufflevector(pose_at(Q + kMachineJoints * n),
                                   pose_at(Q + kMachineJoints * (n + 2)), 0, 1, 2, 3, 4, 5, 6, 7);
  };
  const Register p02 = two(0), p13 = two(1), p46 = two(4), p57 = two(5);
  const Register xz_low = __builtin_shufflevector(p02, p13, 0, 8, 2, 10, 4, 12, 6, 14);
  const Register xz_high = __builtin_shufflevector(p46, p57, 0, 8, 2, 10, 4, 12, 6, 14);
  const Register y_low = __builtin_shufflevector(p02, p13, 1, 9, 3, 11, 5, 13, 7, 15);
  const Register y_high = __builtin_shufflevector(p46, p57, 1, 9, 3, 11, 5, 13, 7, 15);
  xyz[0] = __builtin_shufflevector(xz_low, xz_high, 0, 1, 4, 5, 8, 9, 12, 13);
  xyz[1] = __builtin_shufflevector(y_low, y_high, 0, 1, 4, 5, 8, 9, 12, 13);
  xyz[2] = __builtin_shufflevector(xz_low, xz_high, 2, 3, 6, 7, 10, 11, 14, 15);
}
#else
SERVOMILL_INLINE void take_poses(const double* Q, Register (&xyz)[3]) {
  const auto at = [Q](std::size_t n) { return pose_at(Q + kMachineJoints * n); };
  const Register p0 = at(0), p1 = at(1), p2 = at(2), p3 = at(3);
  const Register xz_low = __builtin_shufflevector(p0, p1, 0, 4, 2, 6);
  const Register xz_high = __builtin_shufflevector(p2, p3, 0, 4, 2, 6);
  const Register y_low = __builtin_shufflevector(p0, p1, 1, 5, 3, 7);
  const Register y_high = __builtin_shufflevector(p2, p3, 1, 5, 3, 7);
  xyz[0] = __builtin_shufflevector(xz_low, xz_high, 0, 1, 4, 5);
  xyz[1] = __builtin_shufflevector(y_low, y_high, 0, 1, 4, 5);
  xyz[2] = __builtin_shufflevector(xz_low, xz_high, 2, 3, 6, 7);
}
#endif
#else
SERVOMILL_INLINE void take_poses(const double* Q, Register (&xyz)[3]) {
  repeat<3>([&](auto i) SERVOMILL_INLINE_LAMBDA {
    xyz[i] = lanes_from([&](std::size_t lane) { return Q[kMachineJoints * lane + i]; });
  });
}
#endif

// Number `flat` of the poses one behind the other: among the lanes of X and Y, or of those and Z.
constexpr int place_in_xy(std::size_t flat) {
  const std::size_t direction = flat % 3;
  return static_cast<int>(direction == 2 ? 0 : direction * kRegister + flat / 3);
}
constexpr int place_in_xyz(std::size_t flat, std::size_t lane) {
  return static_cast<int>(flat % 3 == 2 ? kRegister + flat / 3 : lane);
}

template <std::size_t... lane>
SERVOMILL_INLINE void put_poses(const Register (&xyz)[3], double* out,
                                std::index_sequence<lane...>) {
  repeat<3>([&](auto part) SERVOMILL_INLINE_LAMBDA {
    constexpr std::size_t first = part() * kRegister;
    const Register xy = __builtin_shufflevector(xyz[0], xyz[1], place_in_xy(first + lane)...);
    store(__builtin_shufflevector(xy, xyz[2], place_in_xyz(first + lane, lane)...), out + first);
  });
}

template <Way way, bool kAngles>
void many(const StraightProgram& program, const StraightData* data, const double* tip,
          const double* Q, std::size_t blocks, double* out) {
  for (std::size_t n = 0; n < blocks * kLaneWidth; n += kRegister) {
    Poses poses;
    poses.data = data;
    poses.tip = tip;
    poses.first = n % kLaneWidth;
    take_poses(Q, poses.Q);
    Register offset[3];
    find_offsets<way, kAngles>(program, poses, offset);
    put_poses(offset, out, std::make_index_sequence<kRegister>());
    Q += kMachineJoints * kRegister;
    out += 3 * kRegister;
  }
}

template <Way way, bool kAngles>
StraightKernel kernel() {
  return {&one<way, kAngles>, &many<way, kAngles>, &lanes<way, kAngles>};
}

}  // namespace

template <>
StraightKernel make_straight_kernel<SERVOMILL_LEVEL>(const VolumetricFunctions& of) {
  if (of.is_cubic) return of.has_angles ? kernel<Way::cubic, true>() : kernel<Way::cubic, false>();
  return of.has_angles ? kernel<Way::small, true>() : kernel<Way::small, false>();
}

}  // namespace servomill::plant
