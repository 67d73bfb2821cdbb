#include "sim/programs/compensate/motion_printer.h"

#include <cmath>

#include "controllers/gcode/number_text.h"
#include "plant/vocabulary/units.h"

namespace servomill::sim::programs {
namespace {

constexpr int kDecimalsOfDegrees = 6;
constexpr int kMoreOfInches = 2;

char axis_letter(int i) { return letter(kAllAxes[static_cast<std::size_t>(i)]); }

}  // namespace

double unit_of(int axis, double unit) { return axis < kLinearJoints ? unit : deg; }

MotionWords MotionPrinter::print(const FittedBlock& block, bool is_rapid, const AxisWords& at) {
  words_ = {};
  words_.code = is_rapid ? "G0" : !block.arc ? "G1" : block.arc->turns > 0 ? "G3" : "G2";
  end_ = at;
  for (int i = 0; i < kAxisWords; ++i) axis(i, block.end[i], at[i]);
  if (block.arc) {
    centre(block, at);
    const int turns = std::abs(block.arc->turns);
    if (turns > 1 || keeps('P', turns, 0.0)) number('P', turns, 0);
  }
  return words_;
}

void MotionPrinter::feed(MotionWords& words, double F) const {
  if (line_ != nullptr && is_constant('F') && line_->value('F') == F) return;
  words.words.emplace_back('F', controllers::significant_text(F));
}

bool MotionPrinter::is_named(char letter) const {
  return line_ != nullptr && !line_->is_cycle && line_->has_word(letter);
}

bool MotionPrinter::keeps(char letter, double value, double half) const {
  return is_constant(letter) && std::abs(line_->value(letter) - value) <= half;
}

int MotionPrinter::decimals(int axis) const {
  if (axis >= kLinearJoints) return kDecimalsOfDegrees;
  return modes_.unit == mm ? decimals_ : decimals_ + kMoreOfInches;
}

double MotionPrinter::number(char letter, double value, int digits) {
  const double grid = std::pow(10.0, -digits);
  if (keeps(letter, value, kHalf * grid)) {
    words_.kept += letter;
    return line_->value(letter);
  }
  words_.words.emplace_back(letter, controllers::fixed_text(value, digits));
  return std::round(value / grid) * grid;
}

void MotionPrinter::axis(int i, double target, double at) {
  const double unit = unit_of(i, modes_.unit);
  const double grid = std::pow(10.0, -decimals(i));
  const bool changes = std::abs(target - at) > kHalf * grid * unit;
  if (!changes && !is_named(axis_letter(i))) return;
  const double from = modes_.is_incremental ? at : 0.0;
  end_[i] = from + unit * number(axis_letter(i), (target - from) / unit, decimals(i));
}

void MotionPrinter::centre(const FittedBlock& block, const AxisWords& at) {
  for (int k = 1; k <= 2; ++k) {
    const int i = (block.arc->normal_axis + k) % 3;
    const double from = modes_.is_centre_absolute ? 0.0 : at[i];
    number("IJK"[i], (block.arc->centre[i] - from) / modes_.unit, decimals(i));
  }
}

}  // namespace servomill::sim::programs
