// Programs of scenarios, of any length.
#include "sim/input/read_program.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "sim/input/read_scenario.h"
#include "sim/model/scenario.h"

namespace servomill::sim::input::read_program_test {
namespace {

constexpr std::size_t kPiece = StoredText::kPiece;

class Program : public testing::Test {
 protected:
  ~Program() override { std::filesystem::remove(path_); }

  model::Scenario read(const std::string& text, std::shared_ptr<const StoredText> stored = nullptr,
                       const std::string& more = "") const {
    std::ofstream(path_, std::ios::binary) << text;
    return read_resolved_scenario("machine = \"machines/hsm600u.toml\"\n[program]\nfile = \"" +
                                      path_ + "\"\n" + more + "[[case]]\nname = \"none\"\n",
                                  SERVOMILL_SOURCE_DIR "/scenarios/small.toml", std::move(stored));
  }
  std::string refusal(const std::string& text) const {
    try {
      read(text);
    } catch (const InputError& error) {
      const std::string message = error.what();
      return message.starts_with(path_) ? message.substr(path_.size()) : message;
    }
    return "accepted";
  }

  std::string path_ = testing::TempDir() + "read_program_" + std::to_string(getpid()) + ".ngc";
};

// Comments, more than three pieces of them.
std::string long_program() {
  std::string text;
  while (text.size() <= 3 * kPiece) text += "(a line of thirty characters)\n";
  return text;
}

std::string place_of(const std::string& text, std::size_t at) {
  const auto lines =
      1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
  const std::size_t before = at == 0 ? text.npos : text.rfind('\n', at - 1);
  const std::size_t column = before == text.npos ? at + 1 : at - before;
  return ":" + std::to_string(lines) + ":" + std::to_string(column);
}

TEST_F(Program, HasCharactersOfAnyLengthWhereverItsPiecesEnd) {
  for (const std::string& character :
       {std::string("\xC3\xA4"), std::string("\xE2\x82\xAC"), std::string("\xF0\x9F\x98\x80")}) {
    for (std::size_t before = 0; before <= character.size(); ++before) {
      std::string text = long_program();
      text.insert(2 * kPiece - before, character);
      const model::Scenario scenario = read(text);
      EXPECT_TRUE(scenario.program.text() == text) << before;
    }
  }
}

TEST_F(Program, IsRefusedWhereItIsNotUtf8) {
  const std::string good = long_program();
  const std::string why = " is not UTF-8; save the program as UTF-8";
  for (const std::size_t at : {std::size_t{0}, kPiece - 2, kPiece - 1, kPiece, good.size() - 1}) {
    std::string text = good;
    text[at] = '\xE4';  // Latin-1
    EXPECT_EQ(refusal(text), place_of(text, at) + ": error: byte 0xe4" + why);
    text[at] = '\0';
    EXPECT_EQ(refusal(text), place_of(text, at) + ": error: byte 0x00 is not allowed in a program");
  }
  EXPECT_EQ(refusal(good + "\xE2\x82"), place_of(good, good.size()) + ": error: byte 0xe2" + why);
}

// A resolved document holds the checksum of a long program; the text is in the same result file or
// in the file of the program.
TEST_F(Program, OfAResultFileMustBeTheOneOfItsDocument) {
  const std::string text = long_program();
  const auto stored = std::make_shared<const StoredText>(text, 0);
  const std::string key = "text_checksum = \"" + checksum_text(*stored) + "\"\n";
  EXPECT_NE(read(text).resolved.find(checksum_text(*stored)), std::string::npos);
  EXPECT_EQ(read("M2\n", stored, key).program.shared_text, stored);
  EXPECT_TRUE(read(text, nullptr, key).program.text() == text);
  EXPECT_THROW(read("M2\n", nullptr, key), InputError);
}

}  // namespace
}  // namespace servomill::sim::input::read_program_test
