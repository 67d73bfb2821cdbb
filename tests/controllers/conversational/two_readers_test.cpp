// Programs in the form that `compensate --dialect heidenhain` writes: the interpreter and the
// verification reader, which share the lexer only, must make the same motions of them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "controllers/dialects/heidenhain_reader.h"
#include "controllers/gcode/interpreter.h"
#include "heidenhain_examples.h"
#include "plant/vocabulary/units.h"
#include "same_motions.h"

namespace servomill::controllers::two_readers_test {
namespace {

// @return the number of motions; 0 where one of the two refuses the program
std::size_t expect_same(const std::string& program, const ControlSetup& control,
                        HeidenhainSettings settings = {}) {
  settings.is_feed_of_all_axes = false;  // the interpreter's reading, of which it warns
  std::vector<MachineAction> actions;
  std::vector<Move> moves;
  try {
    actions = read_heidenhain(program, "t.h", control, settings);
    moves = interpret(program, "t.h", setup_of(control, Reader::heidenhain));
  } catch (const InputError&) {
    return 0;
  }
  return expect_same_motions(std::move(moves), std::move(actions));
}

TEST(TwoReaders, AgreeOnTheExamplesOfTheVerificationReader) {
  int programs = 0, refused = 0;
  const auto check = [&](const HeidenhainExample& example, bool has_frame) {
    SCOPED_TRACE(example.name);
    if (!example.settings.is_rapid_straight) return;
    const std::string text = has_frame ? heidenhain_program(example.program) : example.program;
    expect_same(text, example.setup, example.settings) > 0 ? ++programs : ++refused;
  };
  for (const auto& one : heidenhain_line_examples()) check(one, true);
  for (const auto& one : heidenhain_circle_examples()) check(one, true);
  for (const auto& one : heidenhain_cycle_examples()) check(one, true);
  for (const auto& one : heidenhain_whole_examples()) check(one, false);
  EXPECT_GE(programs, 40);
  EXPECT_LE(refused, 40);
}

class Generator {
 public:
  explicit Generator(unsigned seed) : random_(seed) {}

  std::string program() {
    text_ = "0 BEGIN PGM T MM\n";
    number_ = 1;
    for (const char* line :
         {"CYCL DEF 7.0 DATUM SHIFT", "CYCL DEF 7.1 X+0", "CYCL DEF 7.2 Y+0", "CYCL DEF 7.3 Z+0",
          "CYCL DEF 8.0 MIRROR IMAGE", "CYCL DEF 8.1", "CYCL DEF 10.0 ROTATION",
          "CYCL DEF 10.1 ROT+0", "CYCL DEF 11.0 SCALING", "CYCL DEF 11.1 SCL 1", "CYCL DEF 26.0",
          "CYCL DEF 26.1 X 1 Y 1 Z 1", "CYCL DEF 32.0 TOLERANCE", "CYCL DEF 32.1", "M137",
          "L Z-5 R0 FMAX M91"}) {
      put(line);
    }
    change_tool(1);
    for (int i = 0; i < 40; ++i) block();
    for (const char* line : {"L Z-5 R0 FMAX M91 M9", "L M5", "L M30"}) put(line);
    put("END PGM T MM");
    return text_;
  }

 private:
  void put(const std::string& line) { text_ += fmt::format("{} {}\n", number_++, line); }
  int pick(int n) { return std::uniform_int_distribution<int>(0, n - 1)(random_); }
  double real(double from, double to) {
    return std::round(std::uniform_real_distribution<double>(from, to)(random_) * 1e4) / 1e4;
  }
  void change_tool(int tool) {
    put(fmt::format("TOOL CALL {} Z S1000", tool));
    x_ = real(-100, 100), y_ = real(-100, 100);
    put(fmt::format("L X{:+.4f} Y{:+.4f} R0 FMAX M3", x_, y_));
    put(fmt::format("L Z{:+.4f} FMAX M8", real(1, 50)));
    has_feed_ = false;
  }
  std::string feed() {
    if (has_feed_ && pick(3) > 0) return "";
    has_feed_ = true;
    return fmt::format(" F{:.3f}", real(1, 5000));
  }
  void block() {
    switch (pick(8)) {
      case 0:
        return put(fmt::format("L Z{:+.4f} FMAX", real(-20, 50)));
      case 1:
        put(fmt::format("CYCL DEF 9.0 DWELL TIME"));
        return put(fmt::format("CYCL DEF 9.1 DWELL {:.3f}", real(0.1, 3)));
      case 2:
        return change_tool(1 + pick(2));
      case 3:
      case 4:
        return circle();
      case 5:
        return helix();
      default:
        return line();
    }
  }
  void line() {
    std::string words;
    if (pick(3) > 0) words += fmt::format(" X{:+.4f}", x_ = real(-100, 100));
    if (words.empty() || pick(3) > 0) words += fmt::format(" Y{:+.4f}", y_ = real(-100, 100));
    if (pick(3) == 0) words += fmt::format(" Z{:+.4f}", real(-20, 20));
    put("L" + words + feed());
  }
  void centre(double& cx, double& cy) {
    do {
      cx = real(-100, 100), cy = real(-100, 100);
    } while (std::hypot(x_ - cx, y_ - cy) < 1.0);
    put(fmt::format("CC X{:+.4f} Y{:+.4f}", cx, cy));
  }
  void circle() {
    double cx = 0.0, cy = 0.0;
    centre(cx, cy);
    if (pick(4) > 0) {
      const double r = std::hypot(x_ - cx, y_ - cy);
      const double angle = std::atan2(y_ - cy, x_ - cx) + real(0.1, 6.1);
      x_ = std::round((cx + r * std::cos(angle)) * 1e4) / 1e4;
      y_ = std::round((cy + r * std::sin(angle)) * 1e4) / 1e4;
    }
    put(fmt::format("C X{:+.4f} Y{:+.4f} DR{}{}", x_, y_, pick(2) == 0 ? '+' : '-', feed()));
  }
  // behind it both axes are named
  void helix() {
    double cx = 0.0, cy = 0.0;
    centre(cx, cy);
    const bool is_left = pick(2) == 0;
    put(fmt::format("CP IPA{}{:.4f} Z{:+.4f} DR{}{}", is_left ? '+' : '-', real(1, 1500),
                    real(-20, 20), is_left ? '+' : '-', feed()));
    x_ = real(-100, 100), y_ = real(-100, 100);
    put(fmt::format("L X{:+.4f} Y{:+.4f}", x_, y_));
  }

  std::mt19937 random_;
  std::string text_;
  int number_ = 0;
  double x_ = 0.0, y_ = 0.0;
  bool has_feed_ = false;
};

TEST(TwoReaders, AgreeOnRandomProgramsInTheWritersForm) {
  const ControlSetup control = heidenhain_example_setup();
  std::size_t motions = 0;
  for (unsigned seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(fmt::format("seed {}", seed));
    const std::string program = Generator(seed).program();
    const std::size_t found = expect_same(program, control);
    EXPECT_GT(found, 0u) << program;
    motions += found;
    if (::testing::Test::HasFailure()) break;
  }
  EXPECT_GT(motions, 10000u);
}

}  // namespace
}  // namespace servomill::controllers::two_readers_test
