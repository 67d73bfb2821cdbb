#include "plant/geometry/volumetric_evaluation.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "plant/geometry/turn.h"

namespace servomill::plant {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

static_assert(kMachineJoints == kJoints && kErrorComponents == kErrorDirections);
static_assert(sizeof(Joints) == kMachineJoints * sizeof(double));  // poses lie without gaps

VolumetricKernel kernel_of(SimdLevel level) {
  const auto make = [](SimdLevel of) {
    return at_simd_level(of, []<SimdLevel l>() { return make_volumetric_kernel<l>(); });
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

// What an axis has.
struct Faults {
  Vector3d shift, angles;  // location errors
  bool has_components = false, has_component_angles = false;

  Faults(const ChainAxis& axis, const ErrorModel& errors) {
    for (const Axis direction : kAllAxes) {
      if (!errors.component({direction, axis.axis, false}).is_zero()) {
        has_components = true;
        if (!is_linear(direction)) has_component_angles = true;
      }
    }
    for (int i = 0; i < 3; ++i) {
      const auto k = static_cast<std::size_t>(i);
      shift[i] = errors.location({kAllAxes[k], axis.axis, true});
      angles[i] = errors.location({kAllAxes[k + 3], axis.axis, true});
    }
  }
  bool has_location() const { return !shift.isZero(0.0) || !angles.isZero(0.0); }
};

bool is_turn(const VolumetricStep& step) {
  return step.move == VolumetricMove::turn || step.move == VolumetricMove::tilted_turn;
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

// --- preparation --------------------------------------------------------------------------------

VolumetricEvaluation::VolumetricEvaluation(const MachineChain& chain, const ErrorModel& errors,
                                           SimdLevel level)
    : kernel_(kernel_of(level)), powers_(4) {
  for (auto a = chain.axes.rbegin(); a != chain.axes.rend(); ++a) {
    add_steps_of(*a, errors);
    add_functions_of(*a, errors);
    if (!is_linear(a->axis)) rotary_.push_back(*a);
  }
  add_harmonics();
  find_ends();
  if (powers_.size() % 2 == 1) powers_.emplace_back();
  program_.steps = steps_.data();
  program_.number_of_steps = steps_.size();
  program_.polynomial = powers_.data();
  program_.pairs = powers_.size() / 2;
  program_.waves = waves_.data();
  program_.wave_blocks = waves_.size();
  program_.harmonics = harmonics_.data();
  program_.number_of_harmonics = harmonics_.size();
  program_.has_terms = !harmonics_.empty() || !tables_.empty();
  program_.is_cubic = powers_.size() == 4 && !program_.has_terms;
}

void VolumetricEvaluation::add_coefficient(std::size_t power, std::size_t component, int joint,
                                           double value) {
  if (value == 0.0) return;  // does not raise the degree
  if (power >= powers_.size()) powers_.resize(power + 1);
  powers_[power].e[component][static_cast<std::size_t>(joint)] += value;
}

void VolumetricEvaluation::add_steps_of(const ChainAxis& axis, const ErrorModel& errors) {
  const Faults faults(axis, errors);
  VolumetricStep step{};
  step.direction = static_cast<std::uint8_t>(index_of(axis.axis) % 3);
  step.joint = static_cast<std::uint8_t>(axis.joint);
  step.has_angles = faults.has_component_angles;
  Vector3d::Map(step.centre) = axis.centre;
  // L = Rot(angles) Trans(shift)
  const Matrix3d R = TurnOf(faults.angles).matrix();
  for (int i = 0; i < 3; ++i) {
    step.t[i] = faults.shift[i];
    for (int j = 0; j < 3; ++j) step.R[i][j] = R(i, j);
  }
  const bool linear = is_linear(axis.axis), workpiece = axis.side == Side::workpiece;
  if (linear) {
    step.move = VolumetricMove::shift;
    if (faults.has_components || faults.has_location()) step.move = VolumetricMove::faulty_shift;
    // L T(q) L^-1 is a shift along R d; what it differs from d is counted as errors growing with q
    const Vector3d d = Vector3d::Unit(step.direction), Rd = R * d;
    if (!faults.angles.isZero(0.0)) {
      for (int i = 0; i < 3; ++i) {
        add_coefficient(1, static_cast<std::size_t>(i), axis.joint, Rd[i] - d[i]);
      }
    }
    if (workpiece) Vector3d::Map(step.lever_slope) = Rd;
    step.has_lever = workpiece || !axis.centre.isZero(0.0);
    steps_.push_back(step);
  } else {
    step.has_lever = !axis.centre.isZero(0.0);
    VolumetricStep fault = step;
    fault.move = VolumetricMove::fault;
    step.move = faults.has_location() ? VolumetricMove::tilted_turn : VolumetricMove::turn;
    if (faults.has_components && !workpiece) steps_.push_back(fault);
    steps_.push_back(step);
    if (faults.has_components && workpiece) steps_.push_back(fault);
  }
  if (faults.has_components || (linear && faults.has_location())) {
    program_.joints = std::max(program_.joints, static_cast<std::size_t>(axis.joint) + 1);
  }
  program_.has_angles = program_.has_angles || faults.has_component_angles;
}

void VolumetricEvaluation::add_functions_of(const ChainAxis& axis, const ErrorModel& errors) {
  const auto joint = static_cast<std::size_t>(axis.joint);
  for (const Axis direction : kAllAxes) {
    const ErrorFunction& f = errors.component({direction, axis.axis, false});
    if (f.is_zero()) continue;
    const auto component = static_cast<std::size_t>(index_of(direction));
    for (std::size_t i = 0; i < f.polynomial.size(); ++i) {
      add_coefficient(i, component, axis.joint, f.polynomial[i]);
    }
    for (const Harmonic& h : f.harmonics) {
      all_waves_.push_back({component, joint, h.amplitude, h.omega(), h.phase});
    }
    for (const LinearTable& t : f.tables) tables_.push_back({joint, component, TableLookup(t)});
  }
}

// Waves that differ in amplitude only share a sine.
void VolumetricEvaluation::add_harmonics() {
  const auto same = [](const Wave& a, const Wave& b) {
    return a.joint == b.joint && a.omega == b.omega && a.phase == b.phase;
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
    waves_.back().joint[lane] = static_cast<std::uint8_t>(first.joint);
    std::for_each(here, all_waves_.end(), [&](const Wave& w) {
      if (same(w, first)) harmonics_.push_back({wave, w.component, w.joint, w.amplitude});
    });
    ++wave;
  }
}

void VolumetricEvaluation::find_ends() {
  const auto behind_last = [&](auto condition) {
    const auto last = std::find_if(steps_.rbegin(), steps_.rend(), condition);
    return static_cast<std::size_t>(steps_.rend() - last);
  };
  program_.linear_end = behind_last(is_shift);
  program_.offset_steps =
      behind_last([](const VolumetricStep& step) { return step.move != VolumetricMove::turn; });
  const auto end = steps_.begin() + static_cast<std::ptrdiff_t>(program_.offset_steps);
  offset_rotary_ = static_cast<std::size_t>(std::count_if(steps_.begin(), end, is_turn));
}

// --- evaluation ---------------------------------------------------------------------------------

void VolumetricEvaluation::one_with_data(VolumetricKernel::One call, std::size_t turned,
                                         const Joints& Q, const Vector3d& p_ST, double* out) const {
  OnePoseData data;
  for (std::size_t n = 0; n < turned; ++n) {
    const JointMotion m = motion_at(rotary_[n], Q[rotary_[n].joint]);
    const auto joint = static_cast<std::size_t>(rotary_[n].joint);
    data.cosine[joint] = m.cosine;
    data.sine[joint] = m.sine;
  }
  if (program_.has_terms) data.tables = {};
  for (const Table& t : tables_) {
    data.tables.e[t.component][t.joint] += t.lookup.value(Q[static_cast<int>(t.joint)]);
  }
  call(program_, &data, Q.data(), p_ST.data(), out);
}

// Eight poses, with what the kernel does not compute.
void VolumetricEvaluation::eight(VolumetricKernel::Many call, std::size_t turned, const Joints* Q,
                                 const Vector3d& p_ST, double* out) const {
  EightPosesData data;
  for (std::size_t n = 0; n < turned; ++n) {
    const ChainAxis& axis = rotary_[n];
    const auto joint = static_cast<std::size_t>(axis.joint);
    JointMotion m;
    for (std::size_t lane = 0; lane < kLaneWidth; ++lane) {
      // a rotary axis often stands still
      const double q = Q[lane][axis.joint];
      if (lane == 0 || q != Q[lane - 1][axis.joint]) m = motion_at(axis, q);
      data.cosine[joint][lane] = m.cosine;
      data.sine[joint][lane] = m.sine;
    }
  }
  if (program_.has_terms) {
    for (std::size_t joint = 0; joint < program_.joints; ++joint) data.tables[joint] = {};
  }
  for (const Table& t : tables_) {
    LaneArray& sum = data.tables[t.joint].e[t.component];
    for (std::size_t lane = 0; lane < kLaneWidth; ++lane) {
      sum[lane] += t.lookup.value(Q[lane][static_cast<int>(t.joint)]);
    }
  }
  call(program_, &data, Q->data(), 1, p_ST.data(), out);
}

void VolumetricEvaluation::many(VolumetricKernel::Many call, std::size_t turned,
                                std::size_t numbers, std::span<const Joints> Q,
                                const Vector3d& p_ST, double* out) const {
  const std::size_t blocks = Q.size() / kLaneWidth, rest = Q.size() % kLaneWidth;
  const bool alone = turned == 0 && tables_.empty();
  if (alone && blocks > 0) call(program_, nullptr, Q.front().data(), blocks, p_ST.data(), out);
  for (std::size_t block = 0; !alone && block < blocks; ++block) {
    eight(call, turned, &Q[block * kLaneWidth], p_ST, out + block * kLaneWidth * numbers);
  }
  if (rest == 0) return;
  // the last ones with their last repeated
  std::array<Joints, kLaneWidth> filled;
  filled.fill(Q.back());
  std::copy(Q.end() - static_cast<std::ptrdiff_t>(rest), Q.end(), filled.begin());
  std::array<double, kLaneWidth * 6> result;
  eight(call, turned, filled.data(), p_ST, result.data());
  std::copy_n(result.begin(), rest * numbers, out + blocks * kLaneWidth * numbers);
}

void VolumetricEvaluation::tools(std::span<const Joints> Q, const Vector3d& p_ST,
                                 double* out) const {
  many(kernel_.tools, rotary_.size(), 6, Q, p_ST, out);
}
void VolumetricEvaluation::errors(std::span<const Joints> Q, const Vector3d& p_ST,
                                  double* out) const {
  many(kernel_.errors, rotary_.size(), 6, Q, p_ST, out);
}
void VolumetricEvaluation::offsets(std::span<const Joints> Q, const Vector3d& p_ST,
                                   double* out) const {
  many(kernel_.offsets, offset_rotary_, 3, Q, p_ST, out);
}

}  // namespace servomill::plant
