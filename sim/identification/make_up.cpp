#include "sim/identification/make_up.h"

#include "sim/identification/parameter_space.h"
#include "sim/recordings/write_recording.h"

namespace servomill::sim::identification {

void make_up(const Experiment& experiment, const std::string& path, bool force) {
  const AxisRecord& motion = experiment.records.front();
  if (motion.record.command.empty()) {
    throw InputError(motion.place,
                     "has no command; a recording is synthesised from the commanded motion");
  }
  const ModelOfValues model =
      model_of(with_values(experiment.document, experiment.estimates), {}, {});
  const auto joint = static_cast<std::size_t>(motion.joint);
  const Record made = synthesize(motion.record,
                                 {.drive = model.machine.drives[joint],
                                  .loop = model.loop,
                                  .position = motion.record.command.front()},
                                 experiment.noise);
  const bool linear = motion.joint < kLinearJoints;
  const std::string letter(1, letter_of(experiment, motion.joint));
  recordings::Recording out;
  out.file = experiment.path;
  out.format = "made up";
  out.bases.resize(1);
  for (std::size_t k = 0; k < made.size(); ++k) {
    out.bases.front().values.push_back(made.period * static_cast<double>(k));
  }
  const std::string length = linear ? "m" : "rad", torque = linear ? "N" : "Nm";
  out.channels.push_back({letter + " command", length, made.command, 0});
  out.channels.push_back({letter + " feedback", length, made.feedback, 0});
  out.channels.push_back({letter + " force", torque, made.force, 0});
  recordings::write_recording(out, path, force);
}

}  // namespace servomill::sim::identification
