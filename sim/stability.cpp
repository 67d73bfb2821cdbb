#include "sim/stability.h"

#include <Eigen/Eigenvalues>
#include <limits>
#include <vector>

#include "plant/drives/drive_bank.h"
#include "sim/schedule.h"

namespace servomill::sim {
namespace {

// State of one axis with its loops, as a vector.
struct AxisState {
  plant::DriveState drive;
  controllers::CascadeState loop;
  double reading = 0.0;

  template <class Visit>
  void each(std::size_t lane, Visit visit) {
    for (double* x :
         {&drive.i[lane], &drive.w[lane], &drive.delta[lane], &drive.v[lane], &drive.x[lane],
          &loop.v_cmd, &loop.integral, &loop.phi, &loop.i_next, &loop.i_cmd, &reading}) {
      visit(*x);
    }
  }
};
constexpr int kStates = 11;

// States that the loop can move. Those that stand still have an eigenvalue of 1 that says nothing
// about stability, and several of them cost the digits that tell a stable loop from an unstable.
std::vector<int> moving_states(const plant::FeedDriveParams& drive,
                               const controllers::CascadeParams& loop) {
  enum : int { kCurrentLag, kMotorSpeed, kWindUp, kIntegral = 6 };
  const bool rigid = drive.kind == plant::DriveKind::rigid;  // motor and slide are one
  std::vector<int> moving;
  for (int k = 0; k < kStates; ++k) {
    const bool still = (k == kCurrentLag && drive.T_i == 0.0) || (k == kMotorSpeed && rigid) ||
                       (k == kWindUp && rigid) || (k == kIntegral && loop.Ki == 0.0);
    if (!still) moving.push_back(k);
  }
  return moving;
}

}  // namespace

double spectral_radius(const MachineSettings& machine, int joint, Tick reading_delay) {
  const auto lane = static_cast<std::size_t>(joint);
  const LoopPeriods& p = machine.nc.periods;
  const Tick phase = (p.position - reading_delay % p.position) % p.position;
  const std::vector<Rate> rates = {{kSample, p.position, phase},
                                   {kPositionLoop, p.position, 0},
                                   {kVelocityLoop, p.velocity, 0},
                                   {kCurrentLoop, p.current, 0}};
  const std::vector<Instant> schedule = make_schedule(rates);
  std::vector<Tick> steps;
  for (const Instant& instant : schedule) steps.push_back(instant.step);

  auto drives = machine.drives;
  drives[lane].F_load = 0.0;
  std::array<bool, kJoints> present{};
  present[lane] = true;
  const plant::DriveBank bank(drives, present, p.base, steps);
  controllers::CascadeParams params = machine.nc.cascade[lane];
  params.i_max = std::numeric_limits<double>::infinity();

  // one column for each state that is 1 at the beginning
  Eigen::Matrix<double, kStates, kStates> monodromy;
  for (int column = 0; column < kStates; ++column) {
    AxisState s;
    int k = 0;
    s.each(lane, [&](double& x) { x = k++ == column ? 1.0 : 0.0; });
    plant::DriveInput input;
    input.command[lane] = s.loop.i_cmd;
    for (const Instant& instant : schedule) {
      if (instant.due & kSample) s.reading = s.drive.x[lane];
      if (instant.due & kPositionLoop) {
        controllers::position_loop(params, s.loop, 0.0, s.reading, 0.0, 0.0);
      }
      if (instant.due & kCurrentLoop) {
        controllers::current_loop(s.loop);
        input.command[lane] = s.loop.i_cmd;
      }
      if (instant.due & kVelocityLoop) {
        controllers::velocity_loop(params, s.loop, bank.motor_angle(s.drive, lane));
      }
      bank.advance(s.drive, input, instant.step);
    }
    int row = 0;
    s.each(lane, [&](double& x) { monodromy(row++, column) = x; });
  }
  const std::vector<int> moving = moving_states(drives[lane], params);
  const Eigen::MatrixXd reduced = monodromy(moving, moving);
  return reduced.eigenvalues().cwiseAbs().maxCoeff();
}

}  // namespace servomill::sim
