/// The linear-axis kernel for many poses: in rows by joint, or one after the other. Only that
/// kernel includes this.
#pragma once

#include <cstddef>
#include <cstring>
#include <utility>

#include "plant/geometry/linear_axis_formulas.h"

namespace servomill::plant {
namespace {  // one copy for each instruction set

// Numbers of poses, a row for each axis in the order of the axes.
struct Rows {
  const double* q[kLinearAxes];
  double* D[kLinearAxes];  // along their directions
};

template <class N>
SERVOMILL_INLINE Vector<N> load_rows(const double* const (&rows)[kLinearAxes], std::size_t n) {
  return {load_number<N>(rows[0] + n), load_number<N>(rows[1] + n), load_number<N>(rows[2] + n)};
}

// The tips of poses from n on.
template <class N>
SERVOMILL_INLINE Vector<N> tips(const LinearAxisProgram& program, const LinearAxisData* data,
                                const double* tip, std::size_t n) {
  const std::size_t j0 = program.joint[0], j1 = program.joint[1], j2 = program.joint[2];
  if (data == nullptr) return {all<N>(tip[j0]), all<N>(tip[j1]), all<N>(tip[j2])};
  return load_rows<N>({&data->tip[j0][0], &data->tip[j1][0], &data->tip[j2][0]}, n);
}

// Poses from n on, as many as N has lanes. Writes what it finds in any case: without that the
// compiler would put off half of the work until it knows the answer.
template <class N, Parts has>
SERVOMILL_INLINE bool try_rows(const LinearAxisProgram& program, const LinearAxisData* data,
                               const double* tip, std::size_t n, const Rows& rows) {
  const Vector<N> q = load_rows<N>(rows.q, n), P = tips<N>(program, data, tip, n);
  Vector<N> D;
  bool is_done;
  if constexpr (has.way == Way::cubic) {
    is_done = try_offset<has>(program, q, P, NoTerms(), D);
  } else {
    Register sums[kLinearAxes][kErrorComponents];
    find_terms(program.functions, data != nullptr ? data->tables : nullptr, n, q.v, sums);
    const auto terms =
        [&](std::size_t axis, std::size_t component)
            SERVOMILL_INLINE_LAMBDA -> const Register& { return sums[axis][component]; };
    is_done = try_offset<has>(program, q, P, terms, D);
  }
  repeat<3>([&](auto i) SERVOMILL_INLINE_LAMBDA { store(D.v[i], rows.D[i] + n); });
  return is_done;
}

[[gnu::noinline]] void rows_in_general(const LinearAxisProgram& program, const LinearAxisData* data,
                                       const double* tip, std::size_t n, const Rows& rows) {
  try_rows<Register, kEverything>(program, data, tip, n, rows);
}

// All `poses`, a multiple of eight; eight where there are data.
template <Parts has>
SERVOMILL_INLINE void solve_rows(const LinearAxisProgram& program, const LinearAxisData* data,
                                 const double* tip, std::size_t poses, const Rows& rows) {
  std::size_t n = 0;
  if constexpr (has.way == Way::cubic) {
    for (; data == nullptr && n + 2 * kRegister <= poses; n += 2 * kRegister) {
      if (try_rows<Pair, has>(program, nullptr, tip, n, rows)) continue;
      rows_in_general(program, nullptr, tip, n, rows);
      rows_in_general(program, nullptr, tip, n + kRegister, rows);
    }
  }
  for (; n < poses; n += kRegister) {
    if (!try_rows<Register, has>(program, data, tip, n, rows)) {
      rows_in_general(program, data, tip, n, rows);
    }
  }
}

template <Parts has>
void lanes(const LinearAxisProgram& program, const LinearAxisData* data, const double* tip,
           const LaneArray* Q, LaneArray* out) {
  const std::size_t j0 = program.joint[0], j1 = program.joint[1], j2 = program.joint[2];
  solve_rows<has>(program, data, tip, kLaneWidth,
                  {{&Q[j0][0], &Q[j1][0], &Q[j2][0]}, {&out[j0][0], &out[j1][0], &out[j2][0]}});
}

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
  // X Y Z - - X Y Z: two poses, without what lies behind the last
  const auto two = [Q](std::size_t n) { return load(Q + kMachineJoints * n); };
  const Register p01 = two(0), p23 = two(2), p45 = two(4), p67 = two(6);
  const Register xy_low = __builtin_shufflevector(p01, p23, 0, 5, 8, 13, 1, 6, 9, 14);
  const Register xy_high = __builtin_shufflevector(p45, p67, 0, 5, 8, 13, 1, 6, 9, 14);
  const Register z_low = __builtin_shufflevector(p01, p23, 2, 7, 10, 15, 2, 7, 10, 15);
  const Register z_high = __builtin_shufflevector(p45, p67, 2, 7, 10, 15, 2, 7, 10, 15);
  xyz[0] = __builtin_shufflevector(xy_low, xy_high, 0, 1, 2, 3, 8, 9, 10, 11);
  xyz[1] = __builtin_shufflevector(xy_low, xy_high, 4, 5, 6, 7, 12, 13, 14, 15);
  xyz[2] = __builtin_shufflevector(z_low, z_high, 0, 1, 2, 3, 12, 13, 14, 15);
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

// Many at a time: each of the three loops keeps the processor busy by itself.
template <Parts has>
void many(const LinearAxisProgram& program, const LinearAxisData* data, const double* tip,
          const double* Q, std::size_t blocks, double* out) {
  constexpr std::size_t kAtATime = 4 * kLaneWidth;
  const std::size_t j0 = program.joint[0], j1 = program.joint[1], j2 = program.joint[2];
  alignas(64) double q[3][kAtATime], D[3][kAtATime];  // X, Y, Z
  const Rows rows{{q[j0], q[j1], q[j2]}, {D[j0], D[j1], D[j2]}};
  for (std::size_t left = blocks * kLaneWidth; left > 0;) {
    const std::size_t poses = left < kAtATime ? left : kAtATime;
    Register xyz[3];
    for (std::size_t n = 0; n < poses; n += kRegister) {
      take_poses(Q + kMachineJoints * n, xyz);
      repeat<3>([&](auto i) SERVOMILL_INLINE_LAMBDA { store(xyz[i], q[i] + n); });
    }
    solve_rows<has>(program, data, tip, poses, rows);
    for (std::size_t n = 0; n < poses; n += kRegister) {
      repeat<3>([&](auto i) SERVOMILL_INLINE_LAMBDA { xyz[i] = load(D[i] + n); });
      put_poses(xyz, out + 3 * n, std::make_index_sequence<kRegister>());
    }
    Q += kMachineJoints * poses;
    out += 3 * poses;
    left -= poses;
  }
}

}  // namespace
}  // namespace servomill::plant
