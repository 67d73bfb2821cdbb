#include "controllers/gcode/program_text.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <memory>
#include <vector>

#include "controllers/gcode/interpreter.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/stored_text.h"

namespace servomill::controllers::program_text_test {
namespace {

class TempFile {
 public:
  explicit TempFile(const std::string& text) : path_(testing::TempDir() + "program_text.ngc") {
    std::ofstream(path_, std::ios::binary) << text;
  }
  ~TempFile() { std::remove(path_.c_str()); }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

std::vector<std::string> lines_of(ProgramText text) {
  std::vector<std::string> lines;
  for (std::string_view line; text.next(line);) lines.emplace_back(line);
  return lines;
}

ProgramText shared(const std::string& text, std::size_t most_in_memory = StoredText::kMaxInMemory) {
  return ProgramText::of_shared_text(std::make_shared<const StoredText>(text, most_in_memory),
                                     "p.nc");
}

using Lines = std::vector<std::string>;

TEST(ProgramText, FilesAndSharedTextsReadLikeTheirText) {
  for (const std::string& text : {std::string("a\nb\n"), std::string("a\n\nb"), std::string(),
                                  std::string("\n"), std::string("a\r\nb\r\n")}) {
    const TempFile file(text);
    const Lines lines = lines_of(ProgramText::of_text(text, "p.nc"));
    EXPECT_EQ(lines_of(ProgramText::of_file(file.path())), lines);
    EXPECT_EQ(lines_of(shared(text)), lines);
  }
  EXPECT_EQ(lines_of(ProgramText::of_text("a\n\nb", "p.nc")), (Lines{"a", "", "b"}));
}

TEST(ProgramText, LeavesOutAByteOrderMark) {
  const TempFile file("\xEF\xBB\xBF%\na\n");
  ProgramText program = ProgramText::of_file(file.path());
  for (int pass = 0; pass < 2; ++pass) {
    std::string_view line;
    ASSERT_TRUE(program.next(line));
    EXPECT_EQ(line, "%");
    program.rewind();
  }
  EXPECT_EQ(lines_of(ProgramText::of_text("\xEF\xBB\xBF", "p.nc")), Lines{});
  EXPECT_EQ(lines_of(ProgramText::of_text("a\n\xEF\xBB\xBFG0", "p.nc")),
            (Lines{"a", "\xEF\xBB\xBFG0"}));
}

std::string numbered_lines(int count) {
  std::string text;
  for (int i = 1; i <= count; ++i) text += "line " + std::to_string(i) + "\n";
  return text;
}

void expect_to_go_back(ProgramText program) {
  std::vector<ProgramText::Mark> marks;
  std::string_view line;
  do {
    marks.push_back(program.mark());
  } while (program.next(line));
  for (const int i : {1, 49'999, 7, 25'000, 25'001, 50'000}) {
    program.go_to(marks[static_cast<std::size_t>(i - 1)]);
    ASSERT_TRUE(program.next(line));
    EXPECT_EQ(line, "line " + std::to_string(i));
    EXPECT_EQ(program.number(), i);
  }
  EXPECT_FALSE(program.next(line));
}

TEST(ProgramText, GoesBackToAnyLineOfALongFile) {
  const TempFile file(numbered_lines(50'000));
  expect_to_go_back(ProgramText::of_file(file.path()));
}

TEST(ProgramText, GoesBackToAnyLineOfASharedText) {
  expect_to_go_back(shared(numbered_lines(50'000)));
}

TEST(ProgramText, GoesBackToAnyLineOfATextOnTheDisk) {
  std::string text;
  while (text.size() < 3 * StoredText::kPiece) text += std::string(100, ' ') + "\n";
  const auto lines = static_cast<int>(text.size() / 101);
  text += numbered_lines(50'000);
  ProgramText program = shared(text, 0);
  std::string_view line;
  for (int n = 0; n < lines; ++n) program.next(line);
  const ProgramText::Mark mark = program.mark();
  for (int n = 1; n <= 50'000; ++n) {
    ASSERT_TRUE(program.next(line));
    ASSERT_EQ(line, "line " + std::to_string(n));
  }
  EXPECT_FALSE(program.next(line));
  program.go_to(mark);
  ASSERT_TRUE(program.next(line));
  EXPECT_EQ(line, "line 1");
}

TEST(ProgramText, LeavesOutAByteOrderMarkOfASharedText) {
  ProgramText program = shared("\xEF\xBB\xBF%\na\n");
  EXPECT_EQ(lines_of(std::move(program)), (Lines{"%", "a"}));
}

TEST(ProgramText, ALineWithoutEndDoesNotFillTheMemory) {
  const TempFile file(std::string(1 << 20, 'x') + "\nnext\n");
  const Lines lines = lines_of(ProgramText::of_file(file.path()));
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0], std::string(1 << 15, 'x'));
  EXPECT_EQ(lines[1], "next");
}

TEST(ProgramText, SaysThatAFileCannotBeRead) {
  try {
    ProgramText::of_file("/nowhere/p.ngc");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "/nowhere/p.ngc: error: cannot be read: No such file or directory");
  }
}

// LinuxCNC ends there without a word, and so does the reader that is strict; here no line is lost
// in silence.
TEST(ProgramText, BlocksBehindAClosingPercentAreReported) {
  ProgramSetup setup;
  const auto warnings = [&](const char* text) {
    Interpreter interpreter(text, "p.ngc", setup);
    EXPECT_EQ(interpreter.rest().size(), 1u);
    EXPECT_EQ(interpreter.unread_behind(), interpreter.warnings().empty() ? 0 : 3);
    return interpreter.warnings();
  };
  const auto found = warnings("%\nG0 X1\n%\n(END)\nG0 X2\nM2\n");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(to_string(found[0]),
            "p.ngc:3:1: error: the program ends here: lines after this '%' are not read");
  EXPECT_TRUE(warnings("%\nG0 X1\n%\n(END)\n; of file\n\n").empty());
}

}  // namespace
}  // namespace servomill::controllers::program_text_test
