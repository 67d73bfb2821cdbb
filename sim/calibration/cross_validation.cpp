#include <algorithm>
#include <array>
#include <limits>

#include "plant/geometry/error_model.h"
#include "plant/vocabulary/progress.h"
#include "sim/calibration/calibration.h"

namespace servomill::sim::calibration {
namespace {

constexpr std::array kDegrees = {1, 2, 3, 4, 5, 6, 7, 8, 9};
constexpr std::array kKnots = {2, 3, 4, 5, 7, 9, 11, 13, 17};
constexpr double kNearBest = 1.01;  // times the smallest error of prediction

class Chooser {
 public:
  Chooser(CalibrationSettings& settings,
          const std::function<Adjustment(const CalibrationSettings&)>& adjusted)
      : settings_(settings), adjusted_(adjusted) {}

  void choose(const std::string& name, FormSettings& form) {
    if (form.degree_by_data) choose_one(name, false, form.degree, kDegrees);
    if (form.knots_by_data) choose_one(name, true, form.number_of_knots, kKnots);
  }
  std::vector<Smoothness> take() { return std::move(out_); }

 private:
  template <std::size_t N>
  void choose_one(const std::string& name, bool is_of_knots, std::optional<int>& number,
                  const std::array<int, N>& tried) {
    Smoothness one{.form = name, .is_of_knots = is_of_knots, .chosen = tried.front(), .errors = {}};
    double best = std::numeric_limits<double>::infinity();
    Stage stage(is_of_knots ? "numbers of knots" : "degrees", N, Steps::unlike);
    for (const int candidate : tried) {
      number = candidate;
      const double error = adjusted_(settings_).prediction;
      one.errors.emplace_back(candidate, error);
      best = std::min(best, error);
      stage.advance();
    }
    const auto found = std::find_if(one.errors.begin(), one.errors.end(), [&](const auto& entry) {
      return entry.second <= kNearBest * best;
    });
    number = one.chosen = found->first;
    out_.push_back(std::move(one));
  }

  CalibrationSettings& settings_;
  const std::function<Adjustment(const CalibrationSettings&)>& adjusted_;
  std::vector<Smoothness> out_;
};

}  // namespace

std::vector<Smoothness> choose_smoothness(
    CalibrationSettings& settings,
    const std::function<Adjustment(const CalibrationSettings&)>& adjusted) {
  Chooser chooser(settings, adjusted);
  chooser.choose("linear", settings.form_linear);
  chooser.choose("rotary", settings.form_rotary);
  for (auto& [name, form] : settings.forms) chooser.choose(plant::to_string(name), form);
  return chooser.take();
}

}  // namespace servomill::sim::calibration
