/// Examples of the rules of lines. Private to rule_examples_test.cpp.
#pragma once

#include "rule_examples.h"

namespace servomill::controllers {

inline const std::string kProtocol = "grbl 1.1, protocol.c, protocol_main_loop()",
                         kGcode = "grbl 1.1, gcode.c, gc_execute_line()",
                         kWait = "cncjs, issue 118; bCNC, issue 60",
                         kTape = "Fanuc B-64014EN/03 p. 21";

inline std::vector<RuleExample> line_examples() {
  using enum ReaderRule;
  using namespace std::string_literals;
  const Given skipping = {.skips_blocks = true};
  return {
      // grbl runs what it is sent; nothing of it ends a program
      {end_of_text, Reader::grbl, "G0X1\nG1Y2F100", "R 1 0 0 | F 1 2 0 f100", "p.nc:2", kProtocol},
      {end_of_text, Reader::any, "%\nG0 X1.\n", "R 1 0 0", "p.nc:2", kProtocol},
      {end_of_text, Reader::mach, "G91\nG0 X1.\nX1.", "R 1 0 0 | R 2 0 0", "p.nc:3", "from memory"},
      // the end of record: what is behind it is not read
      {percent_at_end, Reader::fanuc, "G0 X1.\n%\nX9.\n", "R 1 0 0", "p.nc:2", kTape},
      {percent_at_end, Reader::haas, "G1 X1. F100.\n%\n", "F 1 0 0 f100", "p.nc:2", "from memory"},
      {percent_title, Reader::fanuc, "% PART X7.\nG0 X1.\n%\n", "R 1 0 0", "p.nc:1:3", kTape},
      {percent_title, Reader::fanuc, "(PART)\n%\nG0 X1.\n%\n", "R 1 0 0", "p.nc:2:1", kTape},
      // what is not above the blank is thrown away
      {control_characters, Reader::grbl, "\0\0G0\x01X1\nM2\n"s, "R 1 0 0", "p.nc:1:1", kProtocol},
      {control_characters, Reader::fanuc, "G0 X1.\x7f Y2.\nM2\n", "R 1 2 0", "p.nc:1:7",
       "from memory"},
      {open_comment, Reader::grbl, "G0 X1 (fast X9\nY2\nM2\n", "R 1 0 0 | R 1 2 0", "p.nc:1:7",
       kProtocol},
      {nested_comment, Reader::any, "G0 (mill (6 mm) long) X1.\nM2\n", "R 1 0 0", "p.nc:1:10",
       "none found"},
      {slash_comment, Reader::any, "// made by hand\nG0 X1.\nM2\n", "R 1 0 0", "p.nc:1:1",
       "none found"},
      // the switch off, and on: one for all levels
      {skip_level, Reader::fanuc, "/3 G0 X1.\nG0 Y2.\nM2\n", "R 1 0 0 | R 1 2 0", "p.nc:1:2",
       "from memory"},
      {skip_level, Reader::fanuc, "G0 Y2.\n/3 X1.\n/9 X3.\nM2\n", "R 0 2 0 | R 1 2 0 | R 3 2 0",
       "p.nc:2:2", "from memory"},
      // the next specification is enabled
      {repeated_word, Reader::fanuc, "G1 X1. F100. F200.\nM2\n", "F 1 0 0 f200", "p.nc:1:14",
       "Fanuc, parameter 3403#6, from memory"},
      {repeated_word, Reader::any, "G0 X1. Y2. X1.0 (X9)\nM2\n", "R 1 2 0", "p.nc:1:12",
       "Fanuc, parameter 3403#6, from memory"},
      {colon_number, Reader::fanuc, ":1000 (PART)\nG0 X1.\nM2\n", "R 1 0 0", "p.nc:1:1",
       "Fanuc B-64124EN/01 p. 136"},
      {colon_number, Reader::fanuc, "M98 P1000\nM2\n:1000\nG0 X1.\nM99\n", "R 1 0 0", "p.nc:3:1",
       "Fanuc B-64124EN/01 p. 136"},
      {number_with_words, Reader::fanuc, "O1000 G0 X1.\nY2.\nM2\n", "R 1 0 0 | R 1 2 0", "p.nc:1:7",
       "from memory"},
      {block_number_anywhere, Reader::grbl, "G0 N10 X1\nG1 Y2 F100 N20\nM2\n",
       "R 1 0 0 | F 1 2 0 f100", "p.nc:1:4", kGcode},
      {tool_without_table, Reader::any, "T5 M6\nG0 X1.\nM2\n", "T5 | R 1 0 0", "p.nc:1:1",
       "no control: the table is not in the program"},
      {tool_without_table, Reader::haas, "M6 T7\nG1 X1. F100.\nM2\n", "T7 | F 1 0 0 f100",
       "p.nc:1:4", "no control: the table is not in the program"},
      {fan_code, Reader::any, "S100 M3\nM106 S255\nG0 X1.\nM107\nM2\n", "S+100 | R 1 0 0",
       "p.nc:2:1", "from memory"},
      {ReaderRule::long_comment, Reader::any,
       "G0 X1. (" + std::string(300, 'x') + ")\nG0 X2.\nM2\n", "R 1 0 0 | R 2 0 0", "p.nc:1:253",
       "no control: a comment has no effect"},
      {ReaderRule::sender_command, Reader::grbl, "$G\n?\n$#\nG0 X1\nM2\n", "R 1 0 0", "p.nc:1:1",
       kProtocol},
      // not the end of the program, as a '%' in its middle would be; also in a program with frame
      {ReaderRule::sender_wait, Reader::grbl, "G0 X1\n%wait\nG1 Y2 F100\nM2\n",
       "R 1 0 0 | F 1 2 0 f100", "p.nc:2:1", kWait},
      {ReaderRule::sender_wait, Reader::any, "%\nG0 X1.\n %wait ; idle\nG0 Y2.\n%\n",
       "R 1 0 0 | R 1 2 0", "p.nc:3:2", kWait},
      {ReaderRule::checksum, Reader::grbl, "N1 G0 X1 *45\nN2 G1 Y2 F100*17\nM2\n",
       "R 1 0 0 | F 1 2 0 f100", "p.nc:1:10", "from memory"},
      {skip_level, Reader::haas, "/2 G0 X1.\n/ G0 X2.\nG0 Y2.\nM2\n", "R 0 2 0", "", "from memory",
       skipping},
  };
}

}  // namespace servomill::controllers
