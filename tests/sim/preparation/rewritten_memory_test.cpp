// The memory that a rewritten program takes from the heap: that of a list of moves for the blocks
// that a strategy makes, one for those that are read back, and a piece of the text.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "controllers/gcode/interpreter.h"
#include "controllers/gcode/printer.h"
#include "sim/preparation/rewritten_text.h"
#include "tests/counting_new.h"
#include "tests/strategies/identified_machines.h"

namespace servomill::sim::preparation::rewritten_memory_test {
namespace {

constexpr double kErrorSize = 10e-6;  // m

// Lines of 0.1 mm while both rotary axes turn.
std::shared_ptr<const StoredText> short_lines(std::size_t lines) {
  StoredText text("S3000 M3\nG64 P0.01\nG1 X0 Y0 Z0 B0 C0 F2000\n");
  for (std::size_t n = 1; n <= lines; ++n) {
    const auto u = static_cast<double>(n);
    text.append(fmt::format("G1 X{:.4f} Y{:.4f} Z{:.4f} B{:.4f} C{:.4f}\n",
                            20.0 * std::sin(0.005 * u), 20.0 * std::cos(0.0007 * u),
                            std::sin(0.002 * u), 8.0 * std::sin(0.0011 * u),
                            30.0 * std::sin(0.0005 * u)));
  }
  text.append("M30\n");
  return std::make_shared<const StoredText>(std::move(text));
}

struct Program {
  strategies::IdentifiedMachine identified;
  controllers::ProgramSetup setup;
  MoveList moves;

  explicit Program(std::size_t lines) : identified(identified_machine()) {
    setup.start = identified.layout.words(identified.reference);
    controllers::Interpreter interpreter(
        controllers::ProgramText::of_shared_text(short_lines(lines), "short.ngc"), setup);
    moves = interpreter.rest_held();
  }

  RewrittenText rewritten() const {
    const auto acting = strategies::make_acting(*strategies::find("gcode"),
                                                strategies::Action::compensate, identified);
    return through_text([&](const PutMove& put) { acting.strategy->rewrite(moves, put); },
                        {"short.ngc", "gcode", "memory", identified.layout, setup});
  }

 private:
  static strategies::IdentifiedMachine identified_machine() {
    plant::Uniform random(1);
    return strategies::identified_with(plant::random_errors(random, kErrorSize));
  }
};

TEST(RewrittenMemory, IsThatOfMovesHeldCompactly) {
  constexpr std::size_t kLines = 300'000;
  // both lists with their masks, and pieces of text; arrays of the moves and whole texts take 225
  // MB
  constexpr double kMax = 2.0 * MoveList::kMaxInMemory + 16e6;
  const Program program(kLines);
  ASSERT_GT(program.moves.size(), kLines);
  const std::size_t before = bytes_in_use;
  most_bytes_in_use = before;
  const RewrittenText out = program.rewritten();
  const auto taken = static_cast<double>(most_bytes_in_use - before);
  const auto text = static_cast<double>(out.text->size());
  fmt::print("{} lines, {} blocks, {:.1f} MB of text: {:.1f} MB of memory\n", kLines,
             out.moves.size(), text / 1e6, taken / 1e6);
  EXPECT_GE(out.moves.size(), program.moves.size());
  EXPECT_LE(taken, kMax);
  EXPECT_GT(2.0 * text + static_cast<double>(2 * out.moves.size() * sizeof(Move)), 2.0 * kMax)
      << "what vectors and strings would take";
}

// The text is that of all blocks at once, and it reads back to them.
TEST(RewrittenMemory, HoldsTheSameTextAndMovesAsAnArray) {
  const Program program(3'000);
  const RewrittenText out = program.rewritten();
  const auto acting = strategies::make_acting(*strategies::find("gcode"),
                                              strategies::Action::compensate, program.identified);
  const std::vector<Move> blocks =
      strategies::rewritten_moves(*acting.strategy, program.moves.all());
  const std::string text =
      controllers::print_program(blocks, {.axes = "XYZBC", .start = program.setup.start}, "memory")
          .text;
  EXPECT_TRUE(out.text->all() == text);
  const std::vector<Move> read = controllers::interpret(text, "text.ngc", program.setup);
  ASSERT_EQ(out.moves.size(), read.size());
  std::size_t n = 0;
  for (const Move& move : out.moves) {
    EXPECT_EQ(move.end_machine, read[n].end_machine) << n;
    EXPECT_EQ(move.feed, read[n].feed) << n;
    ++n;
  }
}

}  // namespace
}  // namespace servomill::sim::preparation::rewritten_memory_test
