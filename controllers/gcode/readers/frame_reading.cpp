// G15 G16, G50 G51, G50.1 G51.1, G54.1, G68 G69: program coordinates before work coordinates.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

#include "controllers/gcode/readers/reading_step.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

bool is_arc(int motion) { return motion == 20 || motion == 30; }

}  // namespace

void ReadingStep::frame_codes() {
  const bool was_flipped = memory.frame.flips(normal_axis());
  polar_mode();
  additional_offset();
  scaling();
  mirror();
  mirror_of_haas();
  rotation();
  // an arc that stays in force is the other one in LinuxCNC
  const bool flips_other = memory.frame.flips(normal_axis()) != was_flipped;
  if (!flips_other || !is_arc(state.motion) || memory.pending_motion >= 0) return;
  memory.pending_motion = was_flipped ? 50 - state.motion : state.motion;
}

void ReadingStep::frames() {
  polar_words();
  frame_words();
}

void ReadingStep::refuse_frame_change(const BlockWord& code) const {
  if (!state.compensation.is_on) return;
  fail(code.column, fmt::format("{} with cutter compensation active; program G40 first",
                                code_name('G', tenths_of(code.value))));
}

void ReadingStep::polar_mode() {
  for (const int tenths : {150, 160}) {
    BlockWord* code = words.code('G', tenths);
    if (code == nullptr) continue;
    if (words.has('H'))
      fail(words.column('H'), "H with G15 or G16 is a work coordinate system on Okuma");
    need(ReaderRule::polar_coordinates, code->column);
    memory.polar = {};
    memory.polar.is_on = tenths == 160;
    if (memory.polar.is_on) polar_origin(code->column);
    words.erase(*code);
  }
}

// Fanuc takes the origin of the work system, Mach the position of the tool.
void ReadingStep::polar_origin(int column) {
  const int n = normal_axis();
  const Eigen::Vector3d now = memory.frame.from_work(state.programmed().head<3>());
  const Eigen::Vector2d here(now[(n + 1) % 3], now[(n + 2) % 3]);
  if (here.isZero() || choose(WordDifference::polar_centre, column) == 0) return;
  if (is_incremental()) fail(column, "G16 with G91 is not defined on Mach; use G90");
  memory.polar.origin = here;
}

// G51 X2 Y2: of Mach the words are factors, which act from the origin of the work system.
void ReadingStep::scale_inputs(BlockWord& code) {
  PlaneFrame& frame = memory.frame;
  for (const char letter : {'P', 'I', 'J', 'K'}) {
    if (!words.has(letter)) continue;
    fail(words.column(letter),
         fmt::format("{} with G51: on Mach the factors are X, Y and Z", letter));
  }
  need(ReaderRule::scaling, code.column);
  for (int i = 0; i < 3; ++i) {
    const char axis = "XYZ"[i];
    if (words.has(axis) && words[axis] == 0.0) {
      fail(words.column(axis), fmt::format("G51 {}0", axis));
    }
    if (words.has(axis)) frame.scale[i] = words[axis];
    words.erase(axis);
  }
  frame.scale_centre.setZero();
  frame.is_scaled = true;
  words.erase(code);
}

// G51 X Y Z P, or I J K for each axis; G50.
void ReadingStep::scaling() {
  PlaneFrame& frame = memory.frame;
  if (BlockWord* off = words.code('G', 500)) {
    refuse_frame_change(*off);
    if (words.has('S')) fail(off->column, "G50 S limits the spindle speed of a lathe");
    need(ReaderRule::scaling, off->column);
    if (frame.is_scaled) frame.scale.setOnes();
    frame.is_scaled = false;
    words.erase(*off);
  }
  BlockWord* on = words.code('G', 510);
  if (on == nullptr) return;
  refuse_frame_change(*on);
  if (options.reader == Reader::mach) return scale_inputs(*on);
  const bool has_factors = words.has('I') || words.has('J') || words.has('K');
  if (!words.has('P') && !has_factors) {
    fail(on->column,
         "G51 without P, I, J or K: X, Y and Z are factors (Mach), or a centre with the "
         "factor of a setting (Haas); write P");
  }
  if (frame.is_rotated || frame.is_mirrored) {
    fail(on->column, "G51 is not supported with G68 or G51.1 active; program G51 first");
  }
  need(ReaderRule::scaling, on->column);
  const Eigen::Vector3d now = frame.from_work(state.programmed().head<3>());
  const auto factor = [&](char letter) {
    const BlockWord& word = *words.find(letter);
    const bool is_factor = word.has_point || choose(WordDifference::scale_factor, word.column) == 0;
    const double value = word.value * (is_factor ? 1.0 : 1e-3);
    if (value == 0.0) fail(word.column, fmt::format("G51 {}0", letter));
    return value;
  };
  for (int i = 0; i < 3; ++i) {
    const char axis = "XYZ"[i], own = "IJK"[i];
    frame.scale[i] = words.has('P') ? factor('P') : words.has(own) ? factor(own) : 1.0;
    frame.scale_centre[i] =
        words.has(axis) ? words[axis] * unit() + (is_incremental() ? now[i] : 0.0) : now[i];
  }
  frame.is_scaled = true;
  for (const char letter : {'X', 'Y', 'Z', 'I', 'J', 'K', 'P'}) words.erase(letter);
  words.erase(*words.code('G', 510));
}

// G51.1 X0: mirrored about X = 0; G50.1 X0 ends it.
void ReadingStep::mirror() {
  for (const int tenths : {501, 511}) {
    BlockWord* code = words.code('G', tenths);
    if (code == nullptr) continue;
    refuse_frame_change(*code);
    PlaneFrame& frame = memory.frame;
    if (frame.is_rotated || frame.is_scaled) {
      fail(code->column, fmt::format("{} with G68 or G51 active", code_name('G', tenths)));
    }
    need(ReaderRule::mirror_image, code->column);
    const bool ends_all = tenths == 501 && !words.has_axis();
    for (int i = 0; i < 3; ++i) {
      const char axis = "XYZ"[i];
      if (!words.has(axis) && !ends_all) continue;
      frame.scale[i] = tenths == 511 ? -1.0 : 1.0;
      if (tenths == 511) frame.scale_centre[i] = words[axis] * unit();
      words.erase(axis);
    }
    frame.is_mirrored = frame.scale.minCoeff() < 0.0;
    words.erase(*words.code('G', tenths));
  }
}

// G68 A12 B25 R45: of Mach, A is X and B is Y of the centre.
void ReadingStep::centre_of_mach(const BlockWord& code) {
  const bool is_mach = options.reader == Reader::mach;
  const bool can_be = is_mach || options.reader == Reader::any;
  for (const auto& [letter, axis] : {std::pair{'A', 'X'}, std::pair{'B', 'Y'}}) {
    if (is_mach && words.has(axis)) {
      fail(words.column(axis), fmt::format("{} with G68: on Mach the centre is A and B", axis));
    }
    if (!words.has(letter)) continue;
    const int column = words.column(letter);
    if (!can_be || words.has(axis) || is_incremental() || normal_axis() != 2) {
      fail(column,
           fmt::format("{} with {}: the {} of the centre (Mach in G17, G90) or a rotary axis",
                       letter, code_name('G', tenths_of(code.value)), axis));
    }
    const double value = words[letter];
    words.erase(letter);
    words.add(axis, value, column);
  }
}

// G68 X Y R, about the point X Y of the plane.
void ReadingStep::rotation() {
  PlaneFrame& frame = memory.frame;
  if (BlockWord* off = words.code('G', 690); off != nullptr && frame.is_rotated) {
    refuse_frame_change(*off);
    need(ReaderRule::rotation, off->column);
    frame.is_rotated = false;
    words.erase(*off);
  }
  BlockWord* on = words.code('G', 680);
  if (on == nullptr) return;
  refuse_frame_change(*on);
  if (!words.has('R') || words.has('I') || words.has('J') || words.has('K')) {
    fail(on->column, "G68 requires R, an angle in the plane; for a tilted plane use G68.2");
  }
  if (frame.is_rotated) fail(on->column, "G68 is already active; program G69 first");
  need(ReaderRule::rotation, on->column);
  centre_of_mach(*on);
  const int n = normal_axis();
  const Eigen::Vector3d now = frame.from_work(state.programmed().head<3>());
  Eigen::Vector3d centre = now;
  for (int i = 0; i < 3; ++i) {
    const char axis = "XYZ"[i];
    if (i == n && words.has(axis))
      fail(words.column(axis), "the axis of G68 must be normal to the plane");
    if (words.has(axis)) centre[i] = words[axis] * unit() + (is_incremental() ? now[i] : 0.0);
    words.erase(axis);
  }
  const Eigen::Vector3d scaled =
      frame.scale_centre + frame.scale.cwiseProduct(centre - frame.scale_centre);
  frame.rotation_centre = scaled;
  frame.angle = words['R'] * deg;
  frame.normal_axis = n;
  frame.is_rotated = true;
  memory.before_rotation = now;
  words.erase('R');
  words.erase(*words.code('G', 680));
}

// G54 P3 is G54.1 P3 of Fanuc, where no other word of the block takes P.
bool ReadingStep::is_additional_G54() const {
  if (!words.has_code('G', 540) || !words.has('P')) return false;
  const bool is_taken = words.has_code('G', 40) || words.has_code('G', 100) ||
                        words.has_code('G', 640) || words.has_code('G', 541) ||
                        is_canned_cycle(motion_in_block()) || words.has('M') ||
                        motion_in_block() == 20 || motion_in_block() == 30;
  return !is_taken;
}

// The work system in force stays; its distance to that of G54.1 P is added.
void ReadingStep::additional_offset() {
  PlaneFrame& frame = memory.frame;
  for (int tenths = 540; tenths <= 593; ++tenths) {
    if (tenths == 541 || !words.has_code('G', tenths) || is_additional_G54()) continue;
    frame.translation.setZero();
    frame.is_translated = false;
    frame.is_translation_known = true;
    frame.additional_system = 0;
  }
  BlockWord* code = words.code('G', 541);
  if (code == nullptr) code = words.code('G', 1540);
  if (code == nullptr && is_additional_G54()) code = words.code('G', 540);
  if (code == nullptr) return;
  refuse_frame_change(*code);
  need(ReaderRule::additional_work_offset, code->column);
  const std::string name = code_name('G', tenths_of(code->value));
  if (!words.has('P')) fail(code->column, fmt::format("{} requires P", name));
  const int P = static_cast<int>(std::lround(words['P']));
  const auto found = memory.additional_offsets.find(P);
  frame.is_translation_known = found != memory.additional_offsets.end();
  if (!frame.is_translation_known) refuse_unknown_system(name, P);
  const AxisWords off =
      frame.is_translation_known ? AxisWords(found->second - state.work_offset) : AxisWords::Zero();
  if (off.tail<3>().cwiseAbs().maxCoeff() > 0.0 || state.sin_rotation != 0.0) {
    fail(words.column('P'), fmt::format("{} P{} has rotary axes or a rotation", name, P));
  }
  frame.translation = off.head<3>();
  frame.is_translated = true;
  frame.additional_system = P;
  words.erase('P');
  words.erase(*code);
}

// X is the radius, Y the angle (G17).
void ReadingStep::polar_words() {
  PolarMode& polar = memory.polar;
  const int n = normal_axis();
  const int first = (n + 1) % 3, second = (n + 2) % 3;
  const char radius = "XYZ"[first], angle = "XYZ"[second];
  const bool has_words = words.has(radius) || words.has(angle);
  const bool is_of_machine = words.has_code('G', 530) || has_axis_taker();
  if (!polar.is_on || !has_words || is_of_machine) return;
  if (words.has('L') && words['L'] > 1.0) {
    fail(words.column('L'), "repetitions with G16 are not supported; program each hole");
  }
  const Eigen::Vector3d now = memory.frame.from_work(state.programmed().head<3>());
  if (words.has(radius)) {
    polar.centre = is_incremental() ? Eigen::Vector2d(now[first], now[second]) : polar.origin;
    polar.radius = words[radius] * unit();
    polar.has_radius = true;
  }
  if (words.has(angle)) {
    polar.angle = words[angle] * deg + (is_incremental() && polar.has_angle ? polar.angle : 0.0);
    polar.has_angle = true;
  }
  if (!polar.has_radius || !polar.has_angle) {
    const char lacks = polar.has_radius ? angle : radius;
    fail(words.all().front().column, fmt::format("{} not programmed since G16; it is the {}", lacks,
                                                 polar.has_radius ? "angle" : "radius"));
  }
  Eigen::Vector2d target =
      polar.centre + polar.radius * Eigen::Vector2d(std::cos(polar.angle), std::sin(polar.angle));
  if (is_incremental()) target -= Eigen::Vector2d(now[first], now[second]);
  const int column = words.has(radius) ? words.column(radius) : words.column(angle);
  words.set(radius, target.x() / unit(), column);
  words.set(angle, target.y() / unit(), column);
}

// G0 X5, G68 X0 Y0 R90, X10: where Y is then is a parameter of the control, until a block names
// both.
void ReadingStep::refuse_lone_axis(const Eigen::Vector3d& now) {
  const int n = memory.frame.normal_axis, first = (n + 1) % 3, second = (n + 2) % 3;
  const bool has_first = words.has("XYZ"[first]), has_second = words.has("XYZ"[second]);
  if (!memory.frame.is_rotated || !(has_first || has_second)) return;
  Eigen::Vector3d& known = memory.before_rotation;
  if (is_incremental()) {
    for (int i = 0; i < 3; ++i) {
      if (words.has("XYZ"[i])) known[i] += words["XYZ"[i]] * unit();
    }
    return;
  }
  constexpr double kSame = 1e-9;  // m
  const int other = has_first ? second : first;
  if (has_first != has_second && std::abs(now[other] - known[other]) > kSame) {
    const char named = "XYZ"[has_first ? first : second];
    fail(words.column(named),
         fmt::format("{} alone after G68: the control determines whether {} keeps its machine "
                     "position or its coordinate from before G68 (Fanuc 11600#5); program both",
                     named, "XYZ"[other]));
  }
  known = now;
  for (const int i : {first, second}) {
    if (words.has("XYZ"[i])) known[i] = words["XYZ"[i]] * unit();
  }
}

void ReadingStep::frame_words() {
  const PlaneFrame& frame = memory.frame;
  const int motion = motion_in_block();
  if (!frame.is_active() || words.has_code('G', 530)) return;
  if (frame.flips(normal_axis())) {
    constexpr std::array<std::pair<int, int>, 2> kPairs = {{{20, 30}, {410, 420}}};
    for (const auto& [a, b] : kPairs) {
      BlockWord* code = words.code('G', a) != nullptr ? words.code('G', a) : words.code('G', b);
      if (code == nullptr) continue;
      code->value = (tenths_of(code->value) == a ? b : a) / 10.0;
      code->is_changed = true;
    }
  }
  bool is_named = false;
  for (int i = 0; i < 3; ++i) is_named = is_named || (frame.concerns(i) && words.has("XYZ"[i]));
  if (is_named && has_axis_taker()) {
    fail(words.all().front().column,
         "G10, G28, G30, G52 or G92 of an axis affected by G51, G51.1, G54.1 or G68; cancel it "
         "first");
  }
  if (has_axis_taker()) return;
  const bool is_cycle = is_canned_cycle(motion);
  const int n = normal_axis();
  const Eigen::Vector3d work = state.programmed().head<3>();
  const Eigen::Vector3d now = frame.from_work(work);
  refuse_lone_axis(now);
  Eigen::Vector3d target = now;
  for (int i = 0; i < 3; ++i) {
    if (!words.has("XYZ"[i]) || (is_cycle && i == n)) continue;
    target[i] = words["XYZ"[i]] * unit() + (is_incremental() ? now[i] : 0.0);
  }
  const Eigen::Vector3d end = frame.to_work(target);
  constexpr double kStill = 1e-12;  // m, rounding
  for (int i = 0; i < 3 && is_named; ++i) {
    if (is_cycle && i == n) continue;
    const bool moves = words.has("XYZ"[i]) || std::abs(end[i] - work[i]) > kStill;
    if (!moves) continue;
    words.set("XYZ"[i], (end[i] - (is_incremental() ? work[i] : 0.0)) / unit(),
              words.all().front().column);
  }
  if (is_arc(motion)) frame_centre();
  if (is_cycle) {
    for (const char letter : {normal_letter(), 'R'}) {
      if (!words.has(letter) || !frame.concerns(n)) continue;
      if (frame.scale[n] < 0.0) fail(words.column(letter), "a canned cycle with a mirrored depth");
      Eigen::Vector3d p = Eigen::Vector3d::Zero();
      p[n] = words[letter] * unit();
      words.set(letter, (is_incremental() ? frame.scale[n] * p[n] : frame.to_work(p)[n]) / unit());
    }
  }
}

void ReadingStep::frame_centre() {
  const PlaneFrame& frame = memory.frame;
  const int n = normal_axis();
  const double factor = std::abs(frame.scale[(n + 1) % 3]);
  if (factor != std::abs(frame.scale[(n + 2) % 3])) {
    fail(words.all().front().column, "an arc requires equal G51 factors in its plane");
  }
  if (words.has('R')) return words.set('R', words['R'] * factor);
  const bool is_absolute =
      !words.has_code('G', 911) && (words.has_code('G', 901) || state.is_centre_absolute);
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  bool has_centre = false;
  for (int i = 0; i < 3; ++i) {
    if (!words.has("IJK"[i])) continue;
    centre[i] = words["IJK"[i]] * unit();
    has_centre = true;
  }
  if (!has_centre) return;
  const Eigen::Vector3d out = is_absolute ? frame.to_work(centre) : frame.vector_to_work(centre);
  for (int i = 0; i < 3; ++i) {
    if (i != n) words.set("IJK"[i], out[i] / unit(), words.all().front().column);
  }
}

}  // namespace servomill::controllers
