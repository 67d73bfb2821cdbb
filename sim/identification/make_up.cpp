#include "sim/identification/make_up.h"

#include <set>

#include "sim/identification/parameter_space.h"
#include "sim/identification/prediction.h"
#include "sim/recordings/write_recording.h"

namespace servomill::sim::identification {
namespace {

// Base of the samples: that of the records before, if they have the same instants.
std::size_t base_of(const Record& record, recordings::Recording& out) {
  recordings::Base base;
  for (std::size_t k = 0; k < record.size(); ++k) {
    base.values.push_back(record.period * static_cast<double>(k));
  }
  for (std::size_t b = 0; b < out.bases.size(); ++b) {
    if (out.bases[b].values == base.values) return b;
  }
  out.bases.push_back(std::move(base));
  return out.bases.size() - 1;
}

// Disturbances of the n-th recording: those of several axes are independent.
NoiseSettings noise_of(const Experiment& experiment, int joint, std::size_t n) {
  NoiseSettings noise = joint < kLinearJoints ? experiment.noise : experiment.rotary_noise;
  noise.seed += n;
  return noise;
}

void add_axis(const Record& made, const std::string& letter, bool is_linear,
              recordings::Recording& out) {
  const std::string length = is_linear ? "m" : "rad", force = is_linear ? "N" : "Nm";
  const std::size_t base = base_of(made, out);
  out.channels.push_back({letter + " command", length, made.command, base});
  out.channels.push_back({letter + " feedback", length, made.feedback, base});
  out.channels.push_back({letter + " force", force, made.force, base});
}

}  // namespace

void make_up(const Experiment& experiment, const std::string& path, bool force) {
  const ModelOfValues model =
      model_of(with_values(experiment.document, experiment.estimates), {}, {});
  recordings::Recording out;
  out.file = experiment.path;
  out.format = "made up";
  std::set<int> joints;
  for (const AxisRecord& motion : experiment.records) {
    if (motion.record.command.empty()) {
      throw InputError(motion.place,
                       "has no command; a recording is synthesised from the commanded motion");
    }
    if (!joints.insert(motion.joint).second) continue;
    AxisModel axis = axis_model(model, motion.joint);
    axis.position = motion.record.command.front();
    const Record made =
        synthesize(motion.record, axis, noise_of(experiment, motion.joint, joints.size() - 1));
    add_axis(made, std::string(1, letter_of(experiment, motion.joint)),
             motion.joint < kLinearJoints, out);
  }
  recordings::write_recording(out, path, force);
}

}  // namespace servomill::sim::identification
