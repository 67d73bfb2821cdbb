#include "sim/programs/compensate/servo_prediction.h"

#include <fmt/format.h>

#include "plant/vocabulary/units.h"
#include "sim/system/json.h"

namespace servomill::sim::programs {
namespace {

double percent(double after, double before) {
  return before > 0.0 ? 100.0 * (after / before - 1.0) : 0.0;
}

std::string change(const char* what, double before, double after) {
  return fmt::format("{} {:.2f} um, after {:.2f} um ({:+.1f} %)", what, before / um, after / um,
                     percent(after, before));
}

std::string figures_json(const ServoFigures& one) {
  constexpr int kSmall = 4, kTime = 6;
  return system::JsonObject(system::JsonSpacing::none)
      .fixed("contour_um", one.contour / um, kSmall)
      .fixed("tip_um", one.tip / um, kSmall)
      .fixed("tip_rms_um", one.tip_rms / um, kSmall)
      .fixed("motion_s", one.duration, kTime)
      .line();
}

}  // namespace

std::vector<std::string> ServoPrediction::report() const {
  return {
      fmt::format("against the prediction by {} up to {:g} Hz, from {} runs of the model", model,
                  cutoff, runs),
      "predicted " + change("largest contour error", before.contour, after.contour),
      "predicted " + change("largest deviation of the tip at the same place of the path",
                            before.tip, after.tip),
      "predicted " + change("rms of that deviation", before.tip_rms, after.tip_rms),
      fmt::format("predicted motion {:.3f} s, after {:.3f} s ({:+.2f} %), within the limits of the "
                  "axes",
                  before.duration, after.duration, percent(after.duration, before.duration)),
  };
}

std::string ServoPrediction::json() const {
  constexpr int kSmall = 4;
  return system::JsonObject(system::JsonSpacing::none)
      .text("model", model)
      .fixed("cutoff_Hz", cutoff, kSmall)
      .integer("runs", runs)
      .raw("before", figures_json(before))
      .raw("after", figures_json(after))
      .line();
}

}  // namespace servomill::sim::programs
