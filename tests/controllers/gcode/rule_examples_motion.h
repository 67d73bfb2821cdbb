/// Examples of dwells, arcs, homing, feeds, subprograms and codes without effect. Private to
/// rule_examples_test.cpp.
#pragma once

#include "rule_examples.h"

namespace servomill::controllers {

inline const std::string kFormats15i = "Fanuc B-63324EN/03 p. 759",
                         kSpiral15i = "Fanuc B-63324EN/01, section 4.4",
                         kHome15i = "Fanuc B-63784EN/01 p. 183",
                         kCall0i = "Fanuc B-64124EN/01 p. 136 and 137",
                         kCallHaas = "Haas 96-8000 p. 217", kMemory = "from memory",
                         kCorner = "NCT 2000M programmer's manual, section 16.1";

inline std::vector<RuleExample> motion_examples() {
  const Given increments = {.decimal_point = DecimalPoint::increments};
  const Given homes = {.has_homes = true}, fed = {.feed = 100.0};
  return {
      {ReaderRule::dwell_word, Reader::fanuc, "G0 X1.\nG4 X2.5\nX2.\nM2\n",
       "R 1 0 0 | W 2.5 | R 2 0 0", "p.nc:2:4", kFormats15i},
      {ReaderRule::dwell_word, Reader::any, "G20 G0 X1.\nG91 G04 U1.5\nM2\n", "R 25.4 0 0 | W 1.5",
       "p.nc:2:9", kMemory},
      {ReaderRule::dwell_word, Reader::fanuc, "G4 X1500\nM2\n", "W 1.5", "p.nc:1:4", kMemory,
       increments},
      {ReaderRule::given_feed, Reader::any, "G1 X1.\nY1.\nM2\n", "F 1 0 0 f100 | F 1 1 0",
       "p.nc:1:1", kMemory, fed},
      {ReaderRule::given_feed, Reader::mach, "G20\nG91 G2 X.2 I.1\nG1 X1. F10\nM2\n",
       "CW 5.08 0 0 o 2.54 0 0 f100 | F 30.48 0 0 f254", "p.nc:2:5", kMemory, fed},
      // radii of 5.04 and 4.96 mm about X5.04
      {ReaderRule::arc_radii, Reader::fanuc, "G2 X10. Y0. I5.04 F100.\nG1 X0.\nM2\n",
       "CW 10 0 0 o 5.04 0 0 f100 | F 0 0 0", "p.nc:1:1", kSpiral15i},
      {ReaderRule::arc_radii, Reader::any, "G91 G18 G3 X10. I5.04 F100.\nG1 Z1.\nM2\n",
       "CCW18 10 0 0 o 5.04 0 0 f100 | F 10 0 1", "p.nc:1:9", kSpiral15i},
      {ReaderRule::arc_radii, Reader::fanuc, "G19 G2 Y10. Z0. J5.04 X3. F100.\nM2\n",
       "CW19 3 10 0 o 3 5.04 0 f100", "p.nc:1:5", kSpiral15i},
      // radii of 5.1308 and 5.0292 mm
      {ReaderRule::arc_radii, Reader::haas, "G20 G2 X.4 I.202 F10.\nM2\n",
       "CW 10.16 0 0 o 5.1308 0 0 f254", "p.nc:1:5", kMemory},
      // a feed without F is an alarm, so that it is a rapid
      {ReaderRule::rapid_at_start, Reader::fanuc, "Z5.\nG91 X1.\nG1 Y1. F100.\nM2\n",
       "R 0 0 5 | R 1 0 5 | F 1 1 5 f100", "p.nc:1:1", kMemory},
      {ReaderRule::rapid_at_start, Reader::grbl, "G20X1\nM2\n", "R 25.4 0 0", "p.nc:1:1",
       "grbl 1.1, gcode.c, gc_init()"},
      // words of the centre are taken for the axes of the plane, others are thrown away
      {ReaderRule::centre_off_plane, Reader::grbl, "G2X2I1J0K0F100\nG1X0\nM2\n",
       "CW 2 0 0 o 1 0 0 f100 | F 0 0 0", "p.nc:1:9", "grbl 1.1, gcode.c, step 3"},
      {ReaderRule::centre_off_plane, Reader::grbl, "G91G18G3X2J0I1K0F100\nG1Z1\nM2\n",
       "CCW18 2 0 0 o 1 0 0 f100 | F 2 0 1", "p.nc:1:11", "grbl 1.1, gcode.c, step 3"},
      {ReaderRule::circular_pocket, Reader::mach, "G91 G0 X1. Y2.\nG13 I5. F100.\nX1.\nM2\n",
       "R 1 2 0 | F 6 2 0 f100 | CCW 6 2 0 o 1 2 0 | F 1 2 0 | R 2 2 0", "p.nc:2:1", kMemory},
      {ReaderRule::circular_pocket, Reader::mach, "G20\nG12 I.1 F10.\nM2\n",
       "F 2.54 0 0 f254 | CW 2.54 0 0 o 0 0 0 | F 0 0 0", "p.nc:2:1", kMemory},
      // tangents of 5 mm at a right angle; legs of 2 mm of the chamfer
      {ReaderRule::corner, Reader::fanuc, "G1 X30. ,R5. F100.\nY20. ,C2.\nX0.\nM2\n",
       "F 25 0 0 f100 | CCW 30 5 0 o 25 5 0 | F 30 18 0 | F 28 20 0 | F 0 20 0", "p.nc:1:9",
       kCorner},
      // a corner of 60 deg: 5 / tan 30 deg = 8.660 mm of each line, the centre above the first
      {ReaderRule::corner, Reader::haas,
       "G20\nG1 X-3.,r.5 F10.\n\n(back)\nX-1.5 Y2.598076211353\nM2\n",
       "F -54.202955 0 0 f254 | CW -65.201477 19.05 0 o -54.202955 12.7 0 | F -38.1 65.991136 0",
       "p.nc:2:8", kCorner},
      {ReaderRule::repeated_group, Reader::fanuc, "G90 G17 G18 G17 G0 X1.\nX2.\nM2\n",
       "R 1 0 0 | R 2 0 0", "p.nc:1:9", kMemory},
      {ReaderRule::repeated_group, Reader::fanuc, "G0 G1 X1. F100.\nX2.\nM2\n",
       "F 1 0 0 f100 | F 2 0 0", "p.nc:1:4", kMemory},
      {ReaderRule::repeated_group, Reader::fanuc, "G0 X1.\nG90 G91 X1.\nX1.\nM2\n",
       "R 1 0 0 | R 2 0 0 | R 3 0 0", "p.nc:2:5", kMemory},
      // by way of X1 to machine zero; G0 stays in force
      {ReaderRule::home_with_motion, Reader::fanuc, "G0 G28 X1.\nX2.\nM2\n",
       "R 1 0 0 | R -10 0 0 | R 2 0 0", "p.nc:1:1", kHome15i, homes},
      {ReaderRule::home_with_motion, Reader::fanuc,
       "G1 X5. Y5. Z8. F100.\nG91 G1 G28 Z2.\nG90 X7.\nM2\n",
       "F 5 5 8 f100 | R 5 5 10 | R 5 5 -30 | F 7 5 -30", "p.nc:2:5", kHome15i, homes},
      {ReaderRule::home_with_motion, Reader::haas, "G0 X5.\nG1 G92 X1. F100.\nX2.\nM2\n",
       "R 5 0 0 | F 6 0 0 f100", "p.nc:2:1", kMemory},
      {ReaderRule::second_home_number, Reader::fanuc, "G30 P2 X1. Y1.\nG0 X3.\nM2\n",
       "R 1 1 0 | R -1 -2 0 | R 3 -2 0", "p.nc:1:5", kHome15i, homes},
      {ReaderRule::second_home_number, Reader::fanuc, "G0 Z5.\nG91 G30 P2 Z0.\nG90 G0 Z1.\nM2\n",
       "R 0 0 5 | R 0 0 -3 | R 0 0 1", "p.nc:2:9", kHome15i, homes},
      // Z first whatever the order of the words, whose values do not count
      {ReaderRule::homing_cycle, Reader::any, "G0 X1. Y2. Z3.\nG28.2 X0. Z5.\nX4.\nM2\n",
       "R 1 2 3 | R 1 2 0 | R 0 2 0 | R 4 2 0", "p.nc:2:1", "TinyG wiki, TinyG Homing"},
      {ReaderRule::homing_cycle, Reader::any, "G91 G0 X1. Y2.\nG28.2 Y0.\nY4.\nM2\n",
       "R 1 2 0 | R 1 0 0 | R 1 4 0", "p.nc:2:1", "TinyG wiki, TinyG Homing"},
      // five times 1002 is the manual's example
      {ReaderRule::subprogram_repeats, Reader::fanuc,
       "G91 G0\nM98 P51002\nY1.\nM2\nO1002\nX1.\nM99\n",
       "R 1 0 0 | R 2 0 0 | R 3 0 0 | R 4 0 0 | R 5 0 0 | R 5 1 0", "p.nc:2:5", kCall0i},
      {ReaderRule::subprogram_repeats, Reader::fanuc,
       "G0 X1.\nM98 P00021002\nX3.\nM30\nO1002\nG91 Y1.\nG90\nM99\n",
       "R 1 0 0 | R 1 1 0 | R 1 2 0 | R 3 2 0", "p.nc:2:5", kMemory},
      // X1000.0 M98 P1200: called behind the move of X
      {ReaderRule::call_with_words, Reader::fanuc, "G0 X2. M98 P1200\nX9.\nM2\nO1200\nY1.\nM99\n",
       "R 2 0 0 | R 2 1 0 | R 9 1 0", "p.nc:1:8", kCall0i},
      {ReaderRule::call_with_words, Reader::haas, "G91 G0 X2. M98 P100 L2\nM2\nO100\nY1.\nM99\n",
       "R 2 0 0 | R 2 1 0 | R 2 2 0", "p.nc:1:12", kCallHaas},
      // the manual's example, in millimetres, twice, for a tool of 10 mm
      {ReaderRule::local_subprogram,
       Reader::haas,
       "T1 M06\nG00 G90 G54 X0. Y0. S1000 M03\nG43 H01 Z1.\nG01 Z0. F20.\nM97 P1000 L2\n"
       "G00 G90 Z1.\nM30\nN1000 (runs behind M97 P1000)\nG01 G91 Z-0.1\nG90 X2.\nG91 Z-0.1\n"
       "G90 X0.\nM99\n",
       "T1 | S+1000 | R 0 0 11 | F 0 0 10 f20 | F 0 0 9.9 | F 2 0 9.9 | F 2 0 9.8 | F 0 0 9.8 | "
       "F 0 0 9.7 | F 2 0 9.7 | F 2 0 9.6 | F 0 0 9.6 | R 0 0 11",
       "p.nc:5:1",
       kCallHaas,
       {.has_tools = true}},
      {ReaderRule::local_subprogram, Reader::any, "M97 P7\nG0 Y1.\nM2\nN7 G0 X1.\nM99\n",
       "R 1 0 0 | R 1 1 0", "p.nc:1:1", kCallHaas},
      {ReaderRule::local_subprogram, Reader::haas, "G91 G0 X2. M97 P7 L2\nM2\nN7 Y1.\nM99\n",
       "R 2 0 0 | R 2 1 0 | R 2 2 0", "p.nc:1:12", kCallHaas},
      {ReaderRule::smoothing, Reader::fanuc,
       "G5.1 Q1\nG05 P10000\nG8 P1\nG0 X1.\nG5.1 Q0\nG1 X2. F100.\nM2\n", "R 1 0 0 | F 2 0 0 f100",
       "p.nc:1:1", kMemory},
      {ReaderRule::smoothing, Reader::haas, "G187 P1 E0.01\nG0 X1.\nG187\nX2.\nM2\n",
       "R 1 0 0 | R 2 0 0", "p.nc:1:1", "Helman CNC, Haas address codes (E)"},
      {ReaderRule::machine_function, Reader::haas, "S100 M3\nM88\nG0 X1.\nM89\nM19 P90\nX2.\nM2\n",
       "S+100 | R 1 0 0 | S0 | R 2 0 0", "p.nc:2:1", kMemory},
      {ReaderRule::machine_function, Reader::fanuc, "M10\nG0 X1.\nM11\nM29 S100\nM2\n", "R 1 0 0",
       "p.nc:1:1", kMemory},
      {ReaderRule::smoothing, Reader::haas, "G103 P1\nG0 X1.\nG103\nX2.\nM2\n", "R 1 0 0 | R 2 0 0",
       "p.nc:1:1", kMemory},
      {ReaderRule::ignored_function,
       Reader::fanuc,
       "M82\nG0 X1. M82\nM2\n",
       "R 1 0 0",
       "p.nc:1:1",
       "no control: as the user says",
       {.ignored_code = 82}},
      {ReaderRule::cancel_codes, Reader::fanuc, "G67 G50.2\nG54.2 P0\nG0 X1. G13.1\nM2\n",
       "R 1 0 0", "p.nc:1:1", kMemory},
      {ReaderRule::cancel_codes, Reader::haas, "G0 X1.\nG255\nX2.\nM2\n", "R 1 0 0 | R 2 0 0",
       "p.nc:2:1", "Haas online manual, G254"},
      {ReaderRule::check_codes, Reader::fanuc, "G23 G25\nG0 X1.\nM2\n", "R 1 0 0", "p.nc:1:1",
       kMemory},
      {ReaderRule::check_codes, Reader::fanuc,
       "G0 X1.\nG22 X90. Y90. Z50. I0. J0. K0.\nG26\nX2.\nM2\n", "R 1 0 0 | R 2 0 0", "p.nc:2:1",
       kMemory},
      // mist is 1, flood 2
      {ReaderRule::coolant_codes, Reader::mach, "M7 M8\nG0 X1\nM9\nM2\n", "C2 | C3 | R 1 0 0 | C0",
       "p.nc:1:4", kMemory},
      {ReaderRule::exact_stop, Reader::fanuc, "G9 G1 X1. F100.\nX2.\nM2\n",
       "F 1 0 0 f100 | F 2 0 0", "p.nc:1:1", kMemory},
      {ReaderRule::spindle_power, Reader::any, "M3 P100\nG0 X1.\nM5\nM2\n", "S+0 | R 1 0 0",
       "p.nc:1:4", "Snapmaker, G-code reference, M3"},
      {ReaderRule::skip_behind_number, Reader::haas, "N10 /G0 X1.\nN20 G0 Y2.\nM2\n",
       "R 1 0 0 | R 1 2 0", "p.nc:1:5", kMemory},
      {ReaderRule::skip_behind_number,
       Reader::fanuc,
       "G0 Y2.\nN5/X1.\nM2\n",
       "R 0 2 0",
       "p.nc:2:3",
       kMemory,
       {.skips_blocks = true}},
      {ReaderRule::unit_codes, Reader::mach, "G70\nG0 X1.\nG91 X1.\nG71 X1.\nM2\n",
       "R 25.4 0 0 | R 50.8 0 0 | R 51.8 0 0", "p.nc:1:1", kMemory},
  };
}

}  // namespace servomill::controllers
