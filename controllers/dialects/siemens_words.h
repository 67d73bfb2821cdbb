/// Words of a block in the language of Siemens 840D sl: `X10`, `X=-5.5`, `X=IC(2)`, `CR=3`,
/// `SUPA`, `T="12"`, `CYCLE832(0.01,1,1)`.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace servomill::controllers {

enum class SiemensForm : std::uint8_t {
  bare,         // SUPA
  number,       // X10, X=10
  absolute,     // X=AC(10)
  incremental,  // X=IC(10)
  text,         // T="MILL"
  call,         // MSG("..."), CYCLE832(...)
};

struct SiemensWord {
  std::string name;  // upper case
  SiemensForm form = SiemensForm::bare;
  double value = 0.0;
  std::string text;  // call: between the parentheses; text: between the quotes
  int column = 0;    // from 1
};

struct SiemensLine {
  bool is_skippable = false;  // begins with '/'
  bool is_empty = true;       // has no words
  std::vector<SiemensWord> words;
};

/// The words of one line of a program; its block number and comment are dropped.
/// @throw InputError where the line is none of the language
SiemensLine siemens_words(std::string_view line, int number, const std::string& file);

}  // namespace servomill::controllers
