#include "sim/calibration/make_up.h"

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <vector>

#include "sim/calibration/observations.h"

namespace servomill::sim::calibration {
namespace {

using readings::Group;

constexpr double kSetUp = 10.0;  // units in which an unknown is shown, of one that has no prior
constexpr int kSphereSteps = 3;  // each gains the size of the errors, some 1e-4

class MakeUp {
 public:
  MakeUp(readings::Readings& readings, const plant::MachineChain& chain,
         const plant::ErrorModel& errors, std::uint64_t seed)
      : readings_(readings),
        chain_(chain),
        machine_(chain, errors),
        observations_(observations_of(readings, chain)),
        generator_(seed) {}

  void run() {
    std::vector<double> set_up;
    for (const SetUpUnknown& unknown : observations_.set_up) {
      // an axis that turns round has lost half of its motion, as the machine without direction has
      set_up.push_back(unknown.turning ? 0.0
                                       : normal() * unknown.prior.value_or(kSetUp * unknown.unit));
    }
    std::size_t number = 0;
    for (std::size_t i = 0; i < observations_.all.size(); ++i) {
      const Observation& one = observations_.all[i];
      number = i > 0 && is_same_row(one, observations_.all[i - 1]) ? number + 1 : 0;
      Group& group = readings_.groups[one.group];
      double rest = group.uncertainty.value_or(kMadeUpUncertainty) * normal();
      for (const SetUpPart& part : one.set_up) rest += part.factor * set_up[part.unknown];
      if (readings::is_of_spheres(group.kind)) {
        if (number == 0) along_.clear();
        along_.push_back({&one, rest});
        if (static_cast<int>(along_.size()) == readings::numbers_of(group.kind)) find_joints(group);
      } else {
        group.rows[one.row].deviation[static_cast<Eigen::Index>(number)] =
            machine_.of(one) + rest - one.correction;
      }
    }
  }

 private:
  double normal() { return distribution_(generator_); }
  static bool is_same_row(const Observation& a, const Observation& b) {
    return a.group == b.group && a.row == b.row;
  }

  // A number of a row that holds joints, with what set-up and noise add.
  struct Along {
    const Observation* number;
    double rest;
  };

  // The joints with which the tip, with its error and the rest, stands where it should.
  void find_joints(Group& group) {
    readings::Reading& reading = group.rows[along_.front().number->row];
    const auto tip = [&](const Joints& Q) { return plant::forward(chain_, Q, group.p_ST).p_WT; };
    const Eigen::Vector3d start = tip(reading.Q);
    for (int step = 0; step < kSphereSteps; ++step) {
      Eigen::Vector3d missed = Eigen::Vector3d::Zero();
      for (const auto& [number, rest] : along_) {
        Pose pose = number->poses.front();
        pose.Q = reading.Q;
        const double shift = pose.n_W.dot(tip(reading.Q) - start);
        missed += pose.n_W * (shift - number->d + machine_.at(pose) + rest);
      }
      const auto shift = plant::least_squares(plant::linear_jacobian(chain_, reading.Q), missed);
      if (shift.rank < 3) {
        throw InputError({group.file, reading.line},
                         "the linear axes cannot follow the sphere at these angles");
      }
      reading.Q.head<kLinearJoints>() -= shift.x;
    }
  }

  readings::Readings& readings_;
  const plant::MachineChain& chain_;
  Deviations machine_;
  Observations observations_;
  std::vector<Along> along_;  // of the row at hand
  boost::random::mt19937_64 generator_;
  boost::random::normal_distribution<double> distribution_;
};

}  // namespace

void make_up(readings::Readings& readings, const plant::MachineChain& chain,
             const plant::ErrorModel& errors, std::uint64_t seed) {
  MakeUp(readings, chain, errors, seed).run();
}

}  // namespace servomill::sim::calibration
