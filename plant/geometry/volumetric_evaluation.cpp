#include "plant/geometry/volumetric_evaluation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <limits>

#include "plant/geometry/turn.h"

namespace servomill::plant {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

static_assert(kMachineJoints == kJoints && kErrorComponents == kErrorDirections);
static_assert(kStraightAxes == kLinearJoints);
static_assert(sizeof(Joints) == kMachineJoints * sizeof(double));  // poses lie without gaps

VolumetricKernel kernel_of(SimdLevel level, bool in_frames) {
  const auto make = [in_frames](SimdLevel of) {
    return at_simd_level(of, [&]<SimdLevel l>() { return make_volumetric_kernel<l>(in_frames); });
  };
  VolumetricKernel kernel = make(level);
  if (level == SimdLevel::avx512) {
    // The axes of one pose fill half a register of AVX-512, whose use slows the processor down.
    const VolumetricKernel narrow = make(SimdLevel::avx2);
    kernel.tool = narrow.tool;
    kernel.error = narrow.error;
    kernel.offset = narrow.offset;
  }
  return kernel;
}

StraightKernel straight_kernel_of(const StraightProgram& program, SimdLevel level) {
  return at_simd_level(level, [&]<SimdLevel l>() { return make_straight_kernel<l>(program); });
}

Vector3d turn_of_location(const ChainAxis& axis, const ErrorModel& errors) {
  Vector3d angles;
  for (int i = 0; i < 3; ++i) {
    angles[i] = errors.location({kAllAxes[static_cast<std::size_t>(i) + 3], axis.axis, true});
  }
  return angles;
}

using Functions = std::array<ErrorFunction, kErrorDirections>;

// The errors of an axis that grow with its coordinate: [direction]. A linear axis goes along L d
// instead of d, whose location errors thus count as well.
Functions functions_of(const ChainAxis& axis, const ErrorModel& errors) {
  Functions all;
  for (const Axis direction : kAllAxes) {
    all[static_cast<std::size_t>(index_of(direction))] =
        errors.component({direction, axis.axis, false});
  }
  const Vector3d angles = turn_of_location(axis, errors);
  if (!is_linear(axis.axis) || angles.isZero(0.0)) return all;
  const Vector3d d = Vector3d::Unit(index_of(axis.axis)), Ld = TurnOf(angles).matrix() * d;
  for (int i = 0; i < 3; ++i) {
    ErrorFunction& f = all[static_cast<std::size_t>(i)];
    f = f + polynomial({0.0, Ld[i] - d[i]});
  }
  return all;
}

// Geometric errors of one axis.
struct Faults {
  Vector3d shift, angles;  // location errors
  bool has_functions = false, has_angles = false;

  Faults(const ChainAxis& axis, const ErrorModel& errors, const Functions& functions)
      : angles(turn_of_location(axis, errors)) {
    for (std::size_t i = 0; i < kErrorComponents; ++i) {
      if (functions[i].is_zero()) continue;
      has_functions = true;
      if (i >= 3) has_angles = true;
    }
    for (int i = 0; i < 3; ++i) {
      shift[i] = errors.location({kAllAxes[static_cast<std::size_t>(i)], axis.axis, true});
    }
  }
  bool has_location() const { return !shift.isZero(0.0) || !angles.isZero(0.0); }
};

void write(const Matrix3d& R, double (&out)[3][3]) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) out[i][j] = R(i, j);
  }
}

// C L J L^-1 C^-1 with C = Trans(centre), L = Rot(R) Trans(t), and J = one of three constant
// matrices, as each coordinate of a turned vector has a part that stays, one that goes with the
// cosine, and one that goes with the sine.
void write_tilted_turn(const Matrix3d& R, const Vector3d& t, VolumetricStep& step) {
  const Vector3d axis = Vector3d::Unit(step.direction), centre = Vector3d::Map(step.centre);
  const auto part = [&](const Matrix3d& J, const Vector3d& d, double* out) {
    const Matrix3d M = R * J * R.transpose();
    for (int i = 0; i < 3; ++i) Vector3d::Map(out + 3 * i) = M.row(i);
    Vector3d::Map(out + 9) = d - M * centre - R * (J * t);
  };
  const Matrix3d still = axis * axis.transpose();
  Matrix3d across;
  for (int i = 0; i < 3; ++i) across.col(i) = axis.cross(Vector3d::Unit(i));
  part(still, centre + R * t, step.still);
  part(Matrix3d::Identity() - still, Vector3d::Zero(), step.turning[0]);
  part(across, Vector3d::Zero(), step.turning[1]);
}

bool is_turn(const VolumetricStep& step) {
  return step.move == VolumetricMove::turn || step.move == VolumetricMove::tilted_turn;
}
bool is_frame(const VolumetricStep& step) {
  return step.move == VolumetricMove::enter_frame || step.move == VolumetricMove::leave_frame;
}
bool is_shift(const VolumetricStep& step) {
  return step.move == VolumetricMove::shift || step.move == VolumetricMove::faulty_shift;
}

}  // namespace

// --- tables -------------------------------------------------------------------------------------

TableLookup::TableLookup(const LinearTable& table)
    : first_(table.s.front()), last_(table.s.back()), last_error_(table.error.back()) {
  const std::size_t points = table.s.size();
  for (std::size_t i = 0; i + 1 < points; ++i) {
    const double slope = (table.error[i + 1] - table.error[i]) / (table.s[i + 1] - table.s[i]);
    intervals_.push_back({table.s[i], table.error[i], slope});
  }
  if (points == 1) intervals_.push_back({first_, last_error_, 0.0});
  const std::size_t buckets = 2 * points;
  const double width = (last_ - first_) / static_cast<double>(buckets);
  buckets_per_s_ = width > 0.0 ? 1.0 / width : 0.0;
  for (std::size_t b = 0; b <= buckets; ++b) {
    // one bucket early, so that rounding of the bucket's number does no harm
    const double begin = first_ + width * (static_cast<double>(b) - 1.0);
    const auto above = std::upper_bound(table.s.begin(), table.s.end() - 1, begin);
    const auto interval = std::max<std::ptrdiff_t>(above - table.s.begin() - 1, 0);
    interval_of_bucket_.push_back(static_cast<std::uint32_t>(interval));
  }
}

double TableLookup::value(double at) const {
  if (!(at >= first_)) return intervals_.front().error;
  if (at >= last_) return last_error_;
  const auto bucket = static_cast<std::size_t>((at - first_) * buckets_per_s_);
  std::size_t i = interval_of_bucket_[std::min(bucket, interval_of_bucket_.size() - 1)];
  while (i + 1 < intervals_.size() && intervals_[i + 1].s <= at) ++i;
  return intervals_[i].error + intervals_[i].slope * (at - intervals_[i].s);
}

// --- functions ----------------------------------------------------------------------------------

void PreparedFunctions::add(std::size_t axis, std::size_t component, std::size_t joint,
                            const ErrorFunction& f) {
  if (f.is_zero()) return;
  for (std::size_t i = 0; i < f.polynomial.size(); ++i) {
    add_coefficient(i, component, axis, f.polynomial[i]);
  }
  for (const Harmonic& h : f.harmonics) {
    all_waves_.push_back({axis, component, h.amplitude, h.omega(), h.phase});
  }
  for (const LinearTable& t : f.tables) tables_.push_back({axis, component, joint, TableLookup(t)});
  functions_.axes = std::max(functions_.axes, axis + 1);
  functions_.has_angles = functions_.has_angles || component >= 3;
}

void PreparedFunctions::add_reversals(std::size_t axis, std::size_t component, std::size_t joint,
                                      const ErrorFunction& f) {
  for (const Reversal& r : f.reversals) {
    if (r.is_zero()) continue;
    const Play play{static_cast<int>(joint), r.distance};
    const auto place = std::find(plays_.begin(), plays_.end(), play) - plays_.begin();
    if (static_cast<std::size_t>(place) == plays_.size()) plays_.push_back(play);
    Reversal half = r;
    for (double& w : half.width) w *= 0.5;
    reversals_.push_back({axis, component, joint, static_cast<std::size_t>(place), half});
  }
}

void PreparedFunctions::add_coefficient(std::size_t power, std::size_t component, std::size_t axis,
                                        double value) {
  if (value == 0.0) return;  // does not raise the degree
  if (power >= powers_.size()) powers_.resize(power + 1);
  powers_[power].e[component][axis] += value;
}

// Waves that differ in amplitude only share a sine.
void PreparedFunctions::join_waves() {
  const auto same = [](const Wave& a, const Wave& b) {
    return a.axis == b.axis && a.omega == b.omega && a.phase == b.phase;
  };
  std::size_t wave = 0;
  for (std::size_t i = 0; i < all_waves_.size(); ++i) {
    const Wave& first = all_waves_[i];
    const auto begin = all_waves_.begin(), here = begin + static_cast<std::ptrdiff_t>(i);
    if (std::any_of(begin, here, [&](const Wave& w) { return same(w, first); })) continue;
    const std::size_t lane = wave % kLaneWidth;
    if (lane == 0) waves_.emplace_back(VolumetricWaves{});
    waves_.back().omega[lane] = first.omega;
    waves_.back().phase[lane] = first.phase;
    waves_.back().axis[lane] = static_cast<std::uint8_t>(first.axis);
    std::for_each(here, all_waves_.end(), [&](const Wave& w) {
      if (!same(w, first)) return;
      VolumetricHarmonic& h = harmonics_.emplace_back(VolumetricHarmonic{wave, w.component, {}});
      h.amplitude[w.axis] = w.amplitude;
    });
    ++wave;
  }
  functions_.number_of_waves = wave;
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  harmonics_.emplace_back(VolumetricHarmonic{kNone, 0, {}});
}

VolumetricFunctions PreparedFunctions::finish() {
  join_waves();
  constexpr std::size_t kCubic = 4;  // coefficients
  powers_.resize(std::max(powers_.size(), kCubic));
  functions_.polynomial = powers_.data();
  functions_.degree = powers_.size() - 1;
  functions_.waves = waves_.data();
  functions_.harmonics = harmonics_.data();
  functions_.has_terms = !waves_.empty() || !tables_.empty() || !reversals_.empty();
  functions_.is_cubic = powers_.size() == kCubic && !functions_.has_terms;
  return functions_;
}

// --- preparation --------------------------------------------------------------------------------

VolumetricEvaluation::VolumetricEvaluation(const MachineChain& chain, const ErrorModel& errors,
                                           SimdLevel level)
    : kernel_(kernel_of(level, std::any_of(chain.axes.begin(), chain.axes.end(),
                                           [](const ChainAxis& a) { return a.is_inclined; }))) {
  for (auto a = chain.axes.rbegin(); a != chain.axes.rend(); ++a) {
    if (a->is_inclined) {
      add_inclined_steps_of(*a, errors);
    } else {
      add_steps_of(*a, errors);
    }
    if (!is_linear(a->axis)) rotary_.push_back(*a);
  }
  find_ends();
  program_.steps = steps_.data();
  program_.number_of_steps = steps_.size();
  program_.functions = functions_.finish();
  find_straight_way(chain, errors);
  if (is_straight_) straight_kernel_ = straight_kernel_of(straight_, level);
}

// In the frame of an inclined axis, of which the centre is the origin, nothing is inclined.
void VolumetricEvaluation::add_inclined_steps_of(const ChainAxis& axis, const ErrorModel& errors) {
  VolumetricStep frame{};
  frame.joint = static_cast<std::uint8_t>(axis.joint);
  Vector3d::Map(frame.centre) = axis.centre;
  write(axis.R_MA, frame.R);
  ChainAxis upright = axis;
  upright.centre.setZero();
  frame.move = VolumetricMove::enter_frame;
  steps_.push_back(frame);
  add_steps_of(upright, errors);
  frame.move = VolumetricMove::leave_frame;
  steps_.push_back(frame);
}

void VolumetricEvaluation::add_steps_of(const ChainAxis& axis, const ErrorModel& errors) {
  const auto functions = functions_of(axis, errors);
  const Faults faults(axis, errors, functions);
  const auto joint = static_cast<std::size_t>(axis.joint);
  for (std::size_t i = 0; i < kErrorComponents; ++i) {
    functions_.add(joint, i, joint, functions[i]);
    functions_.add_reversals(joint, i, joint, functions[i]);
  }
  VolumetricStep step{};
  step.direction = static_cast<std::uint8_t>(index_of(axis.axis) % 3);
  step.joint = static_cast<std::uint8_t>(axis.joint);
  step.has_angles = faults.has_angles;
  Vector3d::Map(step.centre) = axis.centre;
  const Matrix3d R = TurnOf(faults.angles).matrix();  // L = Rot(angles) Trans(shift)
  const bool linear = is_linear(axis.axis), workpiece = axis.side == Side::workpiece;
  if (linear) {
    step.move = VolumetricMove::shift;
    if (faults.has_functions) step.move = VolumetricMove::faulty_shift;
    if (workpiece) Vector3d::Map(step.lever_slope) = R.col(step.direction);
    step.has_lever = workpiece || !axis.centre.isZero(0.0);
    steps_.push_back(step);
  } else {
    step.has_lever = !axis.centre.isZero(0.0);
    VolumetricStep fault = step;
    fault.move = VolumetricMove::fault;
    step.move = faults.has_location() ? VolumetricMove::tilted_turn : VolumetricMove::turn;
    write_tilted_turn(R, faults.shift, step);
    program_.has_turns = true;
    program_.senses[joint - kLinearJoints] = axis.sense == Sense::table ? -1.0 : 1.0;
    if (faults.has_functions && !workpiece) steps_.push_back(fault);
    steps_.push_back(step);
    if (faults.has_functions && workpiece) steps_.push_back(fault);
  }
}

void VolumetricEvaluation::find_ends() {
  const auto behind_last = [&](auto condition) {
    const auto last = std::find_if(steps_.rbegin(), steps_.rend(), condition);
    return static_cast<std::size_t>(steps_.rend() - last);
  };
  program_.linear_end = behind_last(is_shift);
  program_.offset_steps = behind_last([](const VolumetricStep& step) {
    return step.move != VolumetricMove::turn && !is_frame(step);
  });
  const auto end = steps_.begin() + static_cast<std::ptrdiff_t>(program_.offset_steps);
  tip_turns_ = static_cast<std::size_t>(std::count_if(steps_.begin(), end, is_turn));
}

// Turns, which place the tip, and then three linear axes; what follows are turns that do not count.
void VolumetricEvaluation::find_straight_way(const MachineChain& chain, const ErrorModel& errors) {
  const std::size_t end = program_.offset_steps;
  if (end < kStraightAxes) return;
  const std::size_t first = end - kStraightAxes;
  for (std::size_t n = 0; n < end; ++n) {
    const VolumetricStep& step = steps_[n];
    const bool is_ideal_turn = step.move == VolumetricMove::turn || is_frame(step);
    if (n < first ? !is_ideal_turn : !is_shift(step)) return;
  }
  is_straight_ = true;
  for (std::size_t n = 0; n < kStraightAxes; ++n) {
    straight_.joint[n] = steps_[first + n].joint;
  }
  for (std::size_t n = 0; n < kStraightAxes; ++n) {
    add_straight_axis(n, steps_[first + n], chain, errors);
  }
  straight_.functions = straight_functions_.finish();
  straight_.functions.axes = kStraightAxes;
  lay_out_straight_powers();
  is_plain_ = tip_turns_ == 0 && !straight_functions_.has_tables();
}

void VolumetricEvaluation::add_straight_axis(std::size_t n, const VolumetricStep& step,
                                             const MachineChain& chain, const ErrorModel& errors) {
  const auto& order = straight_.joint;
  const bool is_mirrored = (order[0] + 1) % 3 != order[1];
  const auto functions = functions_of(chain.at(kAllAxes[step.direction]), errors);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t k = order[i];
    straight_.levers[n].slope[i] = step.lever_slope[k];
    straight_.levers[n].centre[i] = step.centre[k];
    straight_functions_.add(n, i, step.joint, functions[k]);
    straight_functions_.add(n, 3 + i, step.joint,
                            scaled(functions[3 + k], is_mirrored ? -0.5 : 0.5));
  }
  straight_.has_levers = straight_.has_levers || step.has_lever;
}

void VolumetricEvaluation::lay_out_straight_powers() {
  for (std::size_t power = 0; power <= straight_.functions.degree; ++power) {
    StraightPower& p = straight_powers_.emplace_back(StraightPower{});
    const VolumetricPower& from = straight_.functions.polynomial[power];
    for (std::size_t axis = 0; axis < kStraightAxes; ++axis) {
      for (std::size_t i = 0; i < 3; ++i) {
        p.shift[axis][i] = from.e[i][axis];
        p.half_turn[axis][i] = from.e[3 + i][axis];
        if (power > 0) continue;
        straight_.has_constants =
            straight_.has_constants || p.shift[axis][i] != 0.0 || p.half_turn[axis][i] != 0.0;
      }
    }
  }
  straight_.powers = straight_powers_.data();
}

// --- evaluation ---------------------------------------------------------------------------------

void VolumetricEvaluation::one_with_tables(VolumetricKernel::One call, const Joints& Q,
                                           const Vector3d& p_ST, double* out) const {
  OnePoseData data{};
  functions_.tables_at([&](std::size_t joint) { return Q[static_cast<int>(joint)]; },
                       [&](std::size_t axis, std::size_t component, double value) {
                         data.tables.e[component][axis] += value;
                       });
  call(program_, &data, Q.data(), p_ST.data(), out);
}

void VolumetricEvaluation::one_with_reversals(VolumetricKernel::One call, const Joints& Q,
                                              const Vector3d& p_ST,
                                              std::span<const double> directions,
                                              double* out) const {
  assert(directions.size() == plays().size());
  OnePoseData data{};
  const auto at = [&](std::size_t joint) { return Q[static_cast<int>(joint)]; };
  const auto add = [&](std::size_t axis, std::size_t component, double value) {
    data.tables.e[component][axis] += value;
  };
  functions_.tables_at(at, add);
  functions_.reversals_at(at, directions, add);
  call(program_, &data, Q.data(), p_ST.data(), out);
}

void VolumetricEvaluation::eight_with_tables(VolumetricKernel::Many call, const Joints* Q,
                                             const Vector3d& p_ST, double* out) const {
  EightPosesData data{};
  for (std::size_t lane = 0; lane < kLaneWidth; ++lane) {
    functions_.tables_at([&](std::size_t joint) { return Q[lane][static_cast<int>(joint)]; },
                         [&](std::size_t axis, std::size_t component, double value) {
                           data.tables[axis].e[component][lane] += value;
                         });
  }
  call(program_, &data, Q->data(), 1, p_ST.data(), out);
}

namespace {

// Calls f(poses, number of blocks, out) for all whole blocks of eight, and for what is left with
// its last pose repeated.
template <class F>
void in_blocks(std::span<const Joints> Q, std::size_t numbers, double* out, F f) {
  const std::size_t blocks = Q.size() / kLaneWidth, rest = Q.size() % kLaneWidth;
  if (blocks > 0) f(Q.data(), blocks, out);
  if (rest == 0) return;
  std::array<Joints, kLaneWidth> filled;
  filled.fill(Q.back());
  std::copy(Q.end() - static_cast<std::ptrdiff_t>(rest), Q.end(), filled.begin());
  std::array<double, kLaneWidth * 6> result;
  f(filled.data(), std::size_t{1}, result.data());
  std::copy_n(result.begin(), rest * numbers, out + blocks * kLaneWidth * numbers);
}

constexpr std::size_t kTool = 6, kOffset = 3;  // numbers

}  // namespace

void VolumetricEvaluation::many(VolumetricKernel::Many call, std::size_t numbers,
                                std::span<const Joints> Q, const Vector3d& p_ST,
                                double* out) const {
  in_blocks(Q, numbers, out, [&](const Joints* poses, std::size_t blocks, double* to) {
    if (!functions_.has_tables()) {
      call(program_, nullptr, poses->data(), blocks, p_ST.data(), to);
      return;
    }
    for (std::size_t n = 0; n < blocks; ++n) {
      eight_with_tables(call, poses + n * kLaneWidth, p_ST, to + n * kLaneWidth * numbers);
    }
  });
}

void VolumetricEvaluation::tools(std::span<const Joints> Q, const Vector3d& p_ST,
                                 double* out) const {
  many(kernel_.tools, kTool, Q, p_ST, out);
}
void VolumetricEvaluation::errors(std::span<const Joints> Q, const Vector3d& p_ST,
                                  double* out) const {
  many(kernel_.errors, kTool, Q, p_ST, out);
}

// --- offsets ------------------------------------------------------------------------------------

template <class Coordinate>
Vector3d VolumetricEvaluation::tip_before_linear_axes(const Coordinate& q,
                                                      const Vector3d& p_ST) const {
  ToolPose tip{p_ST};
  for (std::size_t n = 0; n < tip_turns_; ++n) {
    const ChainAxis& axis = rotary_[n];
    apply(axis, motion_at(axis, q(static_cast<std::size_t>(axis.joint))), tip);
  }
  return tip.p_WT;
}

// q(lane, joint)
template <class Coordinate>
StraightData VolumetricEvaluation::data_of_eight(const Coordinate& q, const Vector3d& p_ST) const {
  StraightData data{};
  for (std::size_t lane = 0; lane < kLaneWidth; ++lane) {
    const auto at = [&](std::size_t joint) { return q(lane, joint); };
    const Vector3d tip = tip_before_linear_axes(at, p_ST);
    for (std::size_t i = 0; i < kOffset; ++i) data.tip[i][lane] = tip[static_cast<int>(i)];
    straight_functions_.tables_at(at, [&](std::size_t axis, std::size_t component, double value) {
      data.tables[axis].e[component][lane] += value;
    });
  }
  return data;
}

void VolumetricEvaluation::offset(const Joints& Q, const Vector3d& p_ST, double* out) const {
  if (is_plain_) {
    plain_offset(Q, p_ST, out);
    return;
  }
  if (!is_straight_) {
    one(kernel_.offset, Q, p_ST, out);
    return;
  }
  const auto at = [&](std::size_t joint) { return Q[static_cast<int>(joint)]; };
  VolumetricPower tables{};
  straight_functions_.tables_at(at, [&](std::size_t axis, std::size_t component, double value) {
    tables.e[component][axis] += value;
  });
  const Vector3d tip = tip_before_linear_axes(at, p_ST);
  straight_kernel_.one(straight_, &tables, tip.data(), Q.data(), out);
}

void VolumetricEvaluation::offsets(std::span<const Joints> Q, const Vector3d& p_ST,
                                   double* out) const {
  if (is_straight_) {
    straight_offsets(Q, p_ST, out);
  } else {
    many(kernel_.offsets, kOffset, Q, p_ST, out);
  }
}

void VolumetricEvaluation::straight_offsets(std::span<const Joints> Q, const Vector3d& p_ST,
                                            double* out) const {
  in_blocks(Q, kOffset, out, [&](const Joints* poses, std::size_t blocks, double* to) {
    if (is_plain_) {
      straight_kernel_.many(straight_, nullptr, p_ST.data(), poses->data(), blocks, to);
      return;
    }
    for (std::size_t n = 0; n < blocks; ++n, poses += kLaneWidth, to += kOffset * kLaneWidth) {
      const StraightData data = data_of_eight(
          [&](std::size_t lane, std::size_t joint) { return poses[lane][static_cast<int>(joint)]; },
          p_ST);
      straight_kernel_.many(straight_, &data, p_ST.data(), poses->data(), 1, to);
    }
  });
}

void VolumetricEvaluation::offsets(const LaneArray (&Q)[kJoints], const Vector3d& p_ST,
                                   LaneArray (&out)[kLinearJoints]) const {
  if (is_plain_) {
    straight_kernel_.lanes(straight_, nullptr, p_ST.data(), Q, out);
    return;
  }
  if (is_straight_) {
    const StraightData data =
        data_of_eight([&](std::size_t lane, std::size_t joint) { return Q[joint][lane]; }, p_ST);
    straight_kernel_.lanes(straight_, &data, p_ST.data(), Q, out);
    return;
  }
  std::array<Joints, kLaneWidth> poses;
  std::array<double, kOffset * kLaneWidth> result;
  for (std::size_t lane = 0; lane < kLaneWidth; ++lane) {
    for (std::size_t j = 0; j < kMachineJoints; ++j) poses[lane][static_cast<int>(j)] = Q[j][lane];
  }
  offsets(poses, p_ST, result.data());
  for (std::size_t lane = 0; lane < kLaneWidth; ++lane) {
    for (std::size_t i = 0; i < kOffset; ++i) out[i][lane] = result[kOffset * lane + i];
  }
}

}  // namespace servomill::plant
