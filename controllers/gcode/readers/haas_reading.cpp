// Codes that Haas has with a meaning of its own: G12 and G13, G100 and G101.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controllers/gcode/number_text.h"
#include "controllers/gcode/readers/reading_step.h"

namespace servomill::controllers {

// Radii of the wall, program units.
struct HaasCircles {
  double first, last, step, tool_radius;
};

namespace {

constexpr int kClockwise = 120, kCounterclockwise = 130;
constexpr int kMaxCircles = 1000;

std::string number_of(double value) { return word_text('I', value).substr(1); }

}  // namespace

// A full circle from I away (Mach), or a pocket with D, Z, K and Q (Haas).
void ReadingStep::circular_pocket() {
  const bool is_clockwise = words.has_code('G', kClockwise);
  BlockWord* code = words.code('G', is_clockwise ? kClockwise : kCounterclockwise);
  if (code == nullptr) return;
  const bool has_words_of_haas =
      words.has('D') || words.has('K') || words.has('Q') || words.has('Z') || words.has('L');
  const bool is_of_haas = options.reader == Reader::haas ||
                          (has_words_of_haas && options.reader == Reader::any) ||
                          choose(WordDifference::circular_pocket, code->column) == 1;
  is_of_haas ? circular_pocket_of_haas(*code, is_clockwise)
             : circular_pocket_of_mach(*code, is_clockwise);
  if (memory.pending_motion < 0 && state.motion <= 30) memory.pending_motion = state.motion;
  memory.is_pending_known = true;
}

// Mach leaves the centre along +X, and comes back to it.
void ReadingStep::circular_pocket_of_mach(BlockWord& code, bool is_clockwise) {
  need(ReaderRule::circular_pocket, code.column);
  if (!words.has('I') || words['I'] <= 0.0 || words.has_axis() || normal_axis() != 2) {
    fail(code.column, fmt::format("{} requires I > 0, G17, and no axis words",
                                  code_name('G', is_clockwise ? kClockwise : kCounterclockwise)));
  }
  const std::string I = number_of(words['I']);
  behind.push_back("G91 G1 X" + I);
  behind.push_back(fmt::format("{} I-{}", is_clockwise ? "G2" : "G3", I));
  behind.push_back("G1 X-" + I);
  if (!is_incremental()) behind.emplace_back("G90");
  words.erase(code);
  words.erase('I');
}

// Circles of radius I, I + Q, ... and K of the wall. The control goes there and back on half
// circles, here it goes straight, within the pocket. Source: Haas 96-8000, June 1999, p. 237;
// gcodes.net, Haas G12 and G13.
void ReadingStep::circular_pocket_of_haas(BlockWord& code, bool is_clockwise) {
  const int column = code.column;
  const std::string name = code_name('G', is_clockwise ? kClockwise : kCounterclockwise);
  need(ReaderRule::haas_pocket, column);
  const double I = words.has('I') ? words['I'] : 0.0, K = words.has('K') ? words['K'] : I;
  const double Q = words.has('Q') ? words['Q'] : 0.0;
  if (normal_axis() != 2 || I <= 0.0 || K < I || (K > I && Q <= 0.0)) {
    fail(column, fmt::format("{} requires G17, I > 0, and Q > 0 with K > I", name));
  }
  if (!words.has('D')) fail(column, fmt::format("{} requires D, the tool offset", name));
  const double L = words.has('L') ? words['L'] : 1.0;
  const bool can_repeat = is_incremental() && words.has('Z') && L == std::floor(L) && L >= 1.0;
  if (L != 1.0 && !can_repeat) {
    fail(words.column('L'),
         fmt::format("{} with L repeats it deeper by Z: requires G91, Z and an integer L", name));
  }
  if (memory.frame.is_active() || memory.polar.is_on || state.compensation.is_on) {
    fail(column, fmt::format("{} is not supported with G16, G41, G51, G54.1 or G68", name));
  }
  if (L * (1.0 + (K - I) / (Q > 0.0 ? Q : 1.0)) > kMaxCircles)
    fail(column, name + " with too many circles");
  const int D = static_cast<int>(std::lround(words['D']));
  const double R = D > 0 && options.radius_of ? options.radius_of(D) / unit() : 0.0;
  if (D > 0 && R == 0.0) {
    reading_.notes_.push_back(
        {column, name + ": the tool diameter is 0; the path is not compensated"});
  }
  if (R > I) {
    fail(column, fmt::format("{}: the tool of radius {:g} does not fit in I{:g}", name, R, I));
  }
  for (int turn = 0; turn < static_cast<int>(L); ++turn) {
    if (words.has('Z')) behind.push_back("G1 Z" + number_of(words['Z']));
    circles_of_haas({I, K, Q, R}, is_clockwise);
  }
  if (!is_incremental()) behind.emplace_back("G90");
  words.erase(*words.code('G', is_clockwise ? kClockwise : kCounterclockwise));
  for (const char letter : {'Z', 'I', 'K', 'Q', 'D', 'L'}) words.erase(letter);
  std::string centre;
  for (const char axis : {'X', 'Y'}) {
    if (!words.has(axis)) continue;
    centre += " " + word_text(axis, words[axis]);
    words.erase(axis);
  }
  if (!centre.empty()) before.push_back("G0" + centre);
}

void ReadingStep::circles_of_haas(const HaasCircles& circles, bool is_clockwise) {
  behind.emplace_back("G91");
  for (double radius = circles.first;; radius = std::min(radius + circles.step, circles.last)) {
    if (radius > circles.tool_radius) {
      const std::string r = number_of(radius - circles.tool_radius);
      behind.push_back("G1 X" + r);
      behind.push_back(fmt::format("{} I-{}", is_clockwise ? "G2" : "G3", r));
      behind.push_back("G1 X-" + r);
    }
    if (radius >= circles.last) return;
  }
}

// G101 X0 mirrors X about the origin of the work system, G100 X0 ends it.
void ReadingStep::mirror_of_haas() {
  constexpr int kOff = 1000, kOn = 1010;
  if (options.reader != Reader::haas) return;
  for (const int tenths : {kOff, kOn}) {
    BlockWord* code = words.code('G', tenths);
    if (code == nullptr) continue;
    refuse_frame_change(*code);
    PlaneFrame& frame = memory.frame;
    if (frame.is_rotated || frame.is_scaled) {
      fail(code->column,
           fmt::format("{} is not supported with G68 or G51 active", code_name('G', tenths)));
    }
    if (!words.has_axis()) fail(code->column, code_name('G', tenths) + " requires an axis word");
    need(ReaderRule::haas_mirror, code->column);
    for (int i = 0; i < 3; ++i) {
      const char axis = "XYZ"[i];
      if (!words.has(axis)) continue;
      frame.scale[i] = tenths == kOn ? -1.0 : 1.0;
      frame.scale_centre[i] = 0.0;
      words.erase(axis);
    }
    frame.is_mirrored = frame.scale.minCoeff() < 0.0;
    words.erase(*words.code('G', tenths));
  }
}

}  // namespace servomill::controllers
