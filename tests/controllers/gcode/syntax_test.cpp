// Nothing of a line is lost: what is between the pieces of a parsed line are blanks, and the
// pieces are what the line says.
#include <gtest/gtest.h>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_int_distribution.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "controllers/gcode/parser.h"
#include "controllers/gcode/program_text.h"
#include "plant/vocabulary/input_error.h"

namespace servomill::controllers::syntax_test {
namespace {

constexpr int kRandomLines = 100'000;

struct Shown {
  PieceKind kind;
  std::string text;
  bool operator==(const Shown&) const = default;
};

void PrintTo(const Shown& piece, std::ostream* out) {
  *out << static_cast<int>(piece.kind) << " '" << piece.text << "'";
}

std::vector<Shown> pieces_of(const std::string& line) {
  Parser parser;
  parser.keep_pieces(true);
  Block block;
  parser.parse(line, "p.nc", 1, block);
  std::vector<Shown> pieces;
  for (const Piece& piece : block.pieces) {
    pieces.push_back({piece.kind, line.substr(static_cast<std::size_t>(piece.begin),
                                              static_cast<std::size_t>(piece.end - piece.begin))});
  }
  return pieces;
}

// Prints what was read; a line that cannot be read counts as printed.
void expect_lossless(std::string_view line) {
  Parser parser;
  parser.keep_pieces(true);
  Block block;
  try {
    parser.parse(line, "p.nc", 1, block);
  } catch (const InputError&) {
    return;
  }
  EXPECT_EQ(print_line(line, block), line);
}

TEST(Syntax, ALineIsMadeOfPieces) {
  using enum PieceKind;
  EXPECT_EQ(pieces_of("/ N10.5 G1 X 1 0. #3 = [ 1+2 ] (go) Y-2 ; fast"),
            (std::vector<Shown>{{block_delete, "/"},
                                {line_number, "N10.5"},
                                {word, "G1"},
                                {word, "X 1 0."},
                                {assignment, "#3 = [ 1+2 ]"},
                                {comment, "(go)"},
                                {word, "Y-2"},
                                {comment, "; fast"}}));
  EXPECT_EQ(pieces_of("o<a b> call [1] [#2] (x)"),
            (std::vector<Shown>{{o_word, "o<a b> call [1] [#2]"}, {comment, "(x)"}}));
  EXPECT_EQ(pieces_of("o1 call [1] (x) [2]"),
            (std::vector<Shown>{{o_word, "o1 call [1]"}, {comment, "(x)"}, {o_word, "[2]"}}));
  EXPECT_EQ(pieces_of("M98 P100 L2"),
            (std::vector<Shown>{{o_word, "M98"}, {word, "P100"}, {word, "L2"}}));
  EXPECT_EQ(pieces_of(" % "), (std::vector<Shown>{{percent, "%"}}));
}

// Lines made of fragments of programs, so that most lines can be read, and of some that cannot.
TEST(Syntax, RandomLinesPrintAsTheyWereRead) {
  const std::vector<std::string> fragments = {
      " ",        "\t",          "G1",  "g 0",   "X",        "-1.5",  "+.5",        "Y[#1+2]",
      "(note)",   "(msg, a b)",  "#5=", "#<a>=", "[1 + 2]",  "o1 ",   "call",       "if [",
      "]",        "sin[30]",     "N10", "/",     "%",        ";",     "M98 P1",     "Z#<_x>",
      "F1 0",     "atan[1]/[2]", "1e5", "\r",    "\xc3\xa9", "T1 M6", "o<sub> sub", "endsub",
      " return ", "K",           ".",   "2"};
  boost::random::mt19937 random(20261121);
  boost::random::uniform_int_distribution<std::size_t> pick(0, fragments.size() - 1);
  boost::random::uniform_int_distribution<int> length(0, 8);
  for (int i = 0; i < kRandomLines; ++i) {
    std::string line;
    for (int k = length(random); k > 0; --k) line += fragments[pick(random)];
    expect_lossless(line);
  }
}

TEST(Syntax, ProgramsOfTheRepositoryPrintAsTheyWereRead) {
  int lines = 0;
  for (const char* folder : {"tests/conformance/programs", "scenarios"}) {
    const auto root = std::filesystem::path(SERVOMILL_SOURCE_DIR) / folder;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
      if (entry.path().extension() != ".ngc") continue;
      ProgramText text = ProgramText::of_file(entry.path().string());
      for (std::string_view line; text.next(line); ++lines) expect_lossless(line);
    }
  }
  EXPECT_GT(lines, 1000);
}

}  // namespace
}  // namespace servomill::controllers::syntax_test
