// Any mode may be in force when a program starts, and after a tool change any that a builder's
// macro leaves: every word that ends one is needed, and a program without it is refused.
#include <set>

#include "sim/programs/verification/verification.h"
#include "tests/sim/programs/compensate/dialect_trial.h"

namespace servomill::sim::programs::start_modes_test {
namespace {

// Modes and the word of the written program that ends or sets them.
struct Mode {
  const char* name;
  const char* word;
};

struct Case {
  Dialect dialect;
  bool changes_tool = false;
  std::vector<Mode> modes;
  /// Words that leave every position as it is: corners, smoothing; G80, which G0 implies.
  std::set<std::string> without_effect;
};

const std::string kFiveAxes = SERVOMILL_SOURCE_DIR "/scenarios/machines/hsm600u.toml";

// A rapid, a feed, an arc, rotary axes and the spindle.
CompensateRequest request_of(const Case& one) {
  const std::string tool = one.changes_tool ? "T1 M6\nG43 H1\n" : "";
  Trial trial = dialect_trial(one.dialect, "G21 G90 G17 G54\n" + tool +
                                               "S1000 M3\nG0 X10 Y0 B0 C0\nZ50\nG1 Z40 F100\n"
                                               "G3 X0 Y10 I-10 J0\nG1 C10 F300\nM5\nM30\n");
  trial.request.machine_file = kFiveAxes;
  return trial.request;
}

// The lines between the begin of the program and the first motion, or those after the tool change.
std::pair<std::size_t, std::size_t> frame_of(const std::string& text, const Case& one) {
  const char* const kRetract = one.dialect == Dialect::fanuc     ? "G90 G49 G53"
                               : one.dialect == Dialect::siemens ? "SUPA"
                                                                 : "FMAX M91";
  const std::size_t retract = text.find('\n', text.find(kRetract));
  if (!one.changes_tool || one.dialect == Dialect::heidenhain) return {0, retract};
  return {text.find('\n', text.find("M6", retract)), text.find("S1000")};
}

bool is_word_end(char c) { return c == ' ' || c == '\n'; }

// Removes a word, or a block of several, from a part of the text. @return how often it was there
int remove_word(std::string& text, std::pair<std::size_t, std::size_t> part,
                const std::string& word) {
  int count = 0;
  for (std::size_t at = text.find(word, part.first); at != std::string::npos;
       at = text.find(word, at)) {
    if (at + word.size() > part.second) break;
    if (!is_word_end(text[at - 1]) || !is_word_end(text[at + word.size()])) {
      at += word.size();
      continue;
    }
    text.replace(at, word.size(), std::string(word.size(), ' '));
    ++count;
  }
  return count;
}

bool is_taken(const CompensateRequest& request, const std::string& text) {
  try {
    verify_compensated(request, text);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

// G90 is there twice: with the modes and with the retract. Without F no feed is known, so that G94
// is needed; the plane is that of the arc.
const std::vector<Mode> kFanucAtStart = {{"inches", "G21"},
                                         {"another plane", "G17"},
                                         {"cutter radius", "G40"},
                                         {"increments", "G90"},
                                         {"feed per revolution", "G94"},
                                         {"surface speed", "G97"},
                                         {"rotation", "G69"},
                                         {"polar words", "G15"},
                                         {"scaling", "G50"},
                                         {"mirror image of X", "X0."},
                                         {"tool length", "G49"},
                                         {"mirror images", "G50.1 X0. Y0. Z0. B0. C0."},
                                         {"local coordinates", "G52 X0. Y0. Z0. B0. C0."},
                                         {"a shift by G92", "G92.1 X0. Y0. Z0. B0. C0."}};

const std::vector<Mode> kSiemensAtStart = {
    {"another plane", "G17"},        {"cutter radius", "G40"},
    {"increments", "G90"},           {"inches", "G710"},
    {"feed per revolution", "G94"},  {"a programmable frame", "TRANS"},
    {"a transformation", "TRAFOOF"}, {"tool length", "D0"}};

const std::vector<Case> kCases = {{Dialect::fanuc, false, kFanucAtStart, {"G64", "G80"}},
                                  {Dialect::fanuc,
                                   true,
                                   {
                                       {"increments", "G90"},
                                       {"another work system", "G54"},
                                       {"another plane", "G17"},
                                       {"feed per revolution", "G94"},
                                       {"cutter radius", "G40"},
                                   },
                                   {"G64", "G80"}},
                                  {Dialect::siemens, false, kSiemensAtStart, {"G64", "COMPOF"}},
                                  {Dialect::siemens,
                                   true,
                                   {{"another plane", "G17"},
                                    {"cutter radius", "G40"},
                                    {"increments", "G90"},
                                    {"inches", "G710"},
                                    {"feed per revolution", "G94"},
                                    {"a programmable frame", "TRANS"},
                                    {"a transformation", "TRAFOOF"},
                                    {"another work system", "G54"}},
                                   {"G64"}},
                                  {Dialect::heidenhain,
                                   true,
                                   {{"datum shift of X", "CYCL DEF 7.1 X+0"},
                                    {"mirror image", "CYCL DEF 8.1"},
                                    {"rotation", "CYCL DEF 10.1 ROT+0"},
                                    {"scaling", "CYCL DEF 11.1 SCL 1"},
                                    {"scaling of axes", "CYCL DEF 26.1 X 1 Y 1 Z 1"},
                                    {"a tilted plane", "PLANE RESET STAY"},
                                    {"the tool tip", "M129"},
                                    {"feed per revolution", "M137"},
                                    {"feed of rotary axes in mm", "M117"},
                                    {"cutter radius", "R0"}},
                                   {"CYCL DEF 32.1"}}};

TEST(StartModes, EveryModeIsEndedOrTheProgramIsRefused) {
  for (const Case& one : kCases) {
    const CompensateRequest request = request_of(one);
    const std::string written = compensate(request).program;
    const auto frame = frame_of(written, one);
    ASSERT_NE(frame.second, std::string::npos) << written;
    EXPECT_TRUE(is_taken(request, written));
    for (const Mode& mode : one.modes) {
      std::string text = written;
      EXPECT_GT(remove_word(text, frame, mode.word), 0) << mode.word << "\n" << written;
      EXPECT_FALSE(is_taken(request, text)) << mode.name << ":\n" << text;
    }
    for (const std::string& word : one.without_effect) {
      std::string text = written;
      EXPECT_GT(remove_word(text, frame, word), 0) << word << "\n" << written;
    }
  }
}

// No word of the frame is without a reason: each is one of those above, or moves Z up.
TEST(StartModes, NoWordOfTheFrameIsLeftOut) {
  for (const Case& one : kCases) {
    if (one.dialect == Dialect::heidenhain) continue;  // its cycles have lines of names
    std::string text = compensate(request_of(one)).program;
    const auto frame = frame_of(text, one);
    for (const Mode& mode : one.modes) {
      if (std::string(mode.word) != "X0.") remove_word(text, frame, mode.word);
    }
    for (const std::string& word : one.without_effect) remove_word(text, frame, word);
    for (const std::string& line : lines_of(text.substr(frame.first, frame.second - frame.first))) {
      const bool is_comment = line.starts_with('(') || line.starts_with(';');
      const bool is_retract = line.find("Z-2") != std::string::npos;
      const bool is_name = line.starts_with('%') || line.starts_with('O');
      if (is_comment || is_retract || is_name || line.empty()) continue;
      const std::size_t number = line.find(' ');
      EXPECT_EQ(line.find_first_not_of(' ', number), std::string::npos) << line;
    }
  }
}

}  // namespace
}  // namespace servomill::sim::programs::start_modes_test
