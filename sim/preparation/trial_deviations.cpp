/// CaseTrials: deviations as tip, scales or a recording show them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plant/kinematics/chain.h"
#include "plant/sensing/noise.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/engine/setpoint.h"
#include "sim/preparation/recorded_columns.h"
#include "sim/preparation/trial_runs.h"
#include "strategies/pose_compensation.h"

namespace servomill::sim::preparation {
namespace {

constexpr std::uint32_t kNoiseStream = 1000;  // beyond those of the encoders
constexpr double kStandstill = 1e-9;          // m, rad

}  // namespace

// Joints that all recordings have get an offset. What moves and is not recorded is not known.
void CaseTrials::take_recorded_joints() {
  if (sees_part()) {  // which shows no rotary axis apart
    std::erase_if(joints_, [](int j) { return j >= kLinearJoints; });
    return;
  }
  const PlannedInstants path = planned_instants();
  const auto is_recorded = [](const RecordedRun& run, int j) {
    return std::find(run.joints.begin(), run.joints.end(), j) != run.joints.end();
  };
  for (const RecordedRun& run : recordings_) {
    for (const int j : actual().joints()) {
      if (is_recorded(run, j) || (j >= kLinearJoints && !setting_.setup.turns)) continue;
      const double first = path.Q.front()[j];
      const bool moves = std::any_of(path.Q.begin(), path.Q.end(), [&](const Joints& Q) {
        return std::abs(Q[j] - first) > kStandstill;
      });
      if (!moves) continue;
      throw InputError({run.file}, fmt::format("axis {} moves in {} and is not recorded",
                                               actual().chain.layout.letter_of(j), path.program));
    }
    std::erase_if(joints_, [&](int j) { return !is_recorded(run, j) || !is_seen(run, j, path); });
  }
}

// At a tip a joint is seen if, wherever it goes, it moves the tip along recorded coordinates alone.
bool CaseTrials::is_seen(const RecordedRun& run, int joint, const PlannedInstants& path) const {
  if (run.sees == model::SeenBy::scales) return true;
  if (joint >= kLinearJoints) return false;
  // m per m, the misalignment of a nominal chain that is rounding of its angles.
  constexpr double kAlong = 1e-6;
  for (std::size_t n = 0; n < path.Q.size(); n += times_->every) {
    const Eigen::Matrix3d J = plant::linear_jacobian(actual().chain, path.Q[n]);
    for (int k = 0; k < 3; ++k) {
      const bool is_recorded = std::find(run.seen.begin(), run.seen.end(), k) != run.seen.end();
      if (!is_recorded && std::abs(J(k, joint)) > kAlong) return false;
    }
  }
  return true;
}

// The path as the NC interpolates and filters it.
PlannedInstants CaseTrials::planned_instants() const {
  const controllers::Trajectory& path = setting_.motion.trajectory;
  engine::Setpoint setpoint(actual().nc, path, {});
  setpoint.settle();
  const double end = path.duration() + setpoint.delay();
  PlannedInstants out{.h = times_->h, .Q = {}, .feeds = {}, .lines = {}};
  out.program = setting_.scenario.program.file;
  controllers::Trajectory::Cursor cursor{};
  for (std::size_t n = 0; n < times_->s.size(); ++n) {
    const double t = static_cast<double>(n) * times_->h;
    const auto now = path.at(t, cursor);
    out.Q.push_back(setpoint.advance(now).Q_ref);
    out.feeds.push_back(!now.rapid && !now.dQ_ref.isZero(0.0));
    out.lines.push_back(now.line);
    if (t <= end) out.end = n;
  }
  return out;
}

// Deviation from the wanted path: from the interpolated one, which is recorded, and of that one
// from the wanted path, as the filter rounds it.
strategies::TrialRun CaseTrials::recorded_run(const RecordedRun& run) const {
  const PlannedInstants path = planned_instants();
  double longest = 0.0;
  for (std::size_t n = 1; n < run.t.size(); ++n) {
    longest = std::max(longest, run.t[n] - run.t[n - 1]);
  }
  // Twice Nyquist at the cut-off, where the low-pass still passes one half.
  constexpr double kSamplesPerSwing = 4.0;
  if (longest * kSamplesPerSwing * setting_.setup.cutoff > 1.0 + 1e-6) {
    throw InputError(
        {run.file},
        fmt::format("has a sampling period of {:.4g} ms; cutoff_Hz = {:g} requires {:.4g} ms",
                    longest / ms, setting_.setup.cutoff,
                    1.0 / (kSamplesPerSwing * setting_.setup.cutoff) / ms));
  }
  const std::vector<double> instants = instants_of(run, path, actual().chain.layout);
  strategies::TrialRun out{run.sees == model::SeenBy::tip ? read_at_tip(run, instants, path)
                                                          : read_by_scales(run, instants),
                           {}};
  for (std::size_t n = 0; n < out.deviation.size(); ++n) {
    out.deviation[n] += path.Q[n * times_->every] - wanted_[n].Q;
    for (int j = 0; j < kJoints; ++j) {
      if (std::find(joints_.begin(), joints_.end(), j) == joints_.end()) out.deviation[n][j] = 0.0;
    }
  }
  return out;
}

// Row by row.
std::vector<Joints> CaseTrials::read_by_scales(const RecordedRun& run,
                                               const std::vector<double>& instants) const {
  std::vector<Joints> off;
  for (std::size_t n = 0; n < run.t.size(); ++n) {
    off.emplace_back(run.measured[n] - run.reference[n]);
  }
  return deviations_at(off, instants, times_->every, wanted_.size());
}

// The same of a tip: its way from the standstill before the program less that of the ideal machine
// at the recorded setpoints. The coordinates of the grid encoder may lie anywhere.
std::vector<Joints> CaseTrials::read_at_tip(const RecordedRun& run,
                                            const std::vector<double>& instants,
                                            const PlannedInstants& path) const {
  const plant::MachineChain& chain = actual().chain;
  const auto ideal = [&](std::size_t n) -> Eigen::Vector3d {
    const auto instant = static_cast<std::size_t>(instants[n]);
    Joints Q = path.Q[instant];
    for (const int j : run.joints) Q[j] = run.reference[n][j];
    const std::size_t row = std::min(instant / times_->every, wanted_.size() - 1);
    return plant::forward(chain, Q, wanted_[row].p_ST).p_WT;
  };
  const Eigen::Vector3d tip_0 = run.measured.front().head<3>(), ideal_0 = ideal(0);
  std::vector<Joints> off(run.t.size(), Joints::Zero());
  for (std::size_t n = 0; n < run.t.size(); ++n) {
    const Eigen::Vector3d read = run.measured[n].head<3>();
    const Eigen::Vector3d all = (read - tip_0) - (ideal(n) - ideal_0);
    for (const int k : run.seen) off[n][k] = all[k];
  }
  std::vector<Joints> out = deviations_at(off, instants, times_->every, wanted_.size());
  for (std::size_t n = 0; n < out.size(); ++n) {
    const Eigen::Vector3d at_tip = out[n].head<3>();
    out[n] = in_linear_joints(wanted_[n], at_tip);
  }
  return out;
}

std::vector<Joints> CaseTrials::seen_by_scales(const records::Series& rows,
                                               const std::vector<double>& places) const {
  const JointColumns measured(rows, actual().chain.layout, "meas");
  std::vector<Joints> out;
  for (std::size_t n = 0; n < wanted_.size(); ++n) {
    out.push_back(between_rows(places[n], [&](std::size_t row) { return measured.at(row); }) -
                  wanted_[n].Q);
  }
  return out;
}

std::vector<Joints> CaseTrials::seen_at_tip(const records::Series& rows,
                                            const std::vector<double>& places) const {
  const VectorColumns tip(rows, "tool_position_true", "XYZ"), axis(rows, "tool_axis_true", "IJK");
  std::vector<Joints> out;
  for (std::size_t n = 0; n < wanted_.size(); ++n) {
    const Eigen::Vector3d p = between_rows(places[n], [&](std::size_t row) { return tip.at(row); });
    const Eigen::Vector3d k =
        between_rows(places[n], [&](std::size_t row) { return axis.at(row); });
    out.push_back(in_joints(wanted_[n], {p * mm, k.normalized()}));
  }
  return out;
}

// Displacement of the joints that would put the ideal machine where the tool was seen.
Joints CaseTrials::in_joints(const Wanted& wanted, const ToolPose& seen) const {
  const plant::MachineChain& chain = actual().chain;
  const ToolPose ideal = plant::forward(chain, wanted.Q, wanted.p_ST);
  const Eigen::Vector3d off = seen.p_WT - ideal.p_WT;
  if (setting_.setup.turns) {
    return strategies::displacement_for(chain, wanted.Q, wanted.p_ST, setting_.setup.sigma_0, off,
                                        seen.k_W - ideal.k_W);
  }
  return in_linear_joints(wanted, off);
}

// Linear joints that move the tip by `off` (m), or as near as they can.
Joints CaseTrials::in_linear_joints(const Wanted& wanted, const Eigen::Vector3d& off) const {
  Joints out = Joints::Zero();
  out.head<kLinearJoints>() =
      plant::least_squares(plant::linear_jacobian(actual().chain, wanted.Q), off).x;
  return out;
}

void CaseTrials::add_noise(std::vector<Joints>& deviation) const {
  if (setting_.setup.noise == 0.0) return;
  const std::uint64_t seed = actual().scale[0].in_run(static_cast<std::uint64_t>(runs_)).seed();
  for (std::size_t n = 0; n < deviation.size(); ++n) {
    for (const int j : joints_) {
      if (j >= kLinearJoints) continue;
      deviation[n][j] += setting_.setup.noise *
                         plant::white_noise({seed, kNoiseStream + static_cast<std::uint32_t>(j)}, 0,
                                            static_cast<Tick>(n))[0];
    }
  }
}

}  // namespace servomill::sim::preparation
