/// Examples of words that two controls read differently. Private to rule_examples_test.cpp.
#pragma once

#include "rule_examples.h"

namespace servomill::controllers {

inline std::vector<DifferenceExample> difference_examples() {
  using enum WordDifference;
  const std::string cycle = "G0 Z5.\nG99 G82 X1. Z-2. R1. ", linuxcnc = "LinuxCNC 2.9, ";
  const std::string drill = "G0 Z5.\nG99 G81 X1. Z-2. R1. F100.\n",
                    drilled = "R 0 0 5 | R 1 0 5 | R 1 0 1 | F 1 0 -2 f100 | R 1 0 1",
                    fanuc = "Fanuc B-63944EN; from memory";
  const Given tools = {.has_tools = true}, offsets = {.has_offsets = true},
              increments = {.decimal_point = DecimalPoint::increments};
  return {
      {dwell_unit, 0, Reader::grbl, "G4 P2\nM2\n", "W 2", "grbl 1.1, gcode.c"},
      {dwell_unit, 0, Reader::linuxcnc, "G4 P0.5\nM2\n", "W 0.5", linuxcnc + "G4"},
      {dwell_unit, 1, Reader::fanuc, "G4 P2000\nG0 X1.\nM2\n", "W 2 | R 1 0 0", fanuc},
      {dwell_unit, 1, Reader::haas, "G4 P500\nG4 P1.5\nM2\n", "W 0.5 | W 1.5", "from memory"},
      {dwell_increments, 0, Reader::fanuc, "G4 X1500\nM2\n", "W 1.5", fanuc, increments},
      {dwell_increments, 1, Reader::fanuc, "G4 X2\nM2\n", "W 2", fanuc},
      {cycle_dwell_unit, 0, Reader::mach, cycle + "P1 F100.\nM2\n",
       "R 0 0 5 | R 1 0 5 | R 1 0 1 | F 1 0 -2 f100 | W 1 | R 1 0 1", "from memory"},
      {cycle_dwell_unit, 1, Reader::haas, cycle + "P500 F100.\nX2.\nM2\n",
       "R 0 0 5 | R 1 0 5 | R 1 0 1 | F 1 0 -2 f100 | W 0.5 | R 1 0 1 | R 2 0 1 | F 2 0 -2 | "
       "W 0.5 | R 2 0 1",
       "from memory"},
      {length_offset_zero, 0, Reader::linuxcnc, "T1 M6\nG43 H0\nG0 Z1.\nM2\n", "T1 | R 0 0 11",
       linuxcnc + "G43", tools},
      {length_offset_zero, 1, Reader::haas, "T1 M6\nG43 H1\nG43 H0\nG0 Z1.\nM2\n", "T1 | R 0 0 1",
       "Haas 96-8000 p. 161", tools},
      {stored_home, 0, Reader::grbl, "G0 X5\nG28.1\nX0\nG28\nM2\n", "R 5 0 0 | R 0 0 0 | R 5 0 0",
       "grbl 1.1, gcode.c"},
      {stored_home, 1, Reader::mach, "G28.1\nM2\n",
       "p.nc:1:1: error: G28.1: the search for the switches is not simulated; G53 names a place "
       "of the machine",
       "from memory"},
      {retract_level, 0, Reader::linuxcnc, "G0 Z5\nG81 X1 Z-2 R1 F100\nM2\n", drilled,
       linuxcnc + "rs274"},
      {retract_level, 1, Reader::fanuc, "G0 Z5.\nG81 X1. Z-2. R1. F100.\nX2.\nM2\n",
       "R 0 0 5 | R 1 0 5 | R 1 0 1 | F 1 0 -2 f100 | R 1 0 5 | R 2 0 5 | R 2 0 1 | F 2 0 -2 | "
       "R 2 0 5",
       fanuc},
      {subprogram_digits, 0, Reader::haas, "M98 P20100\nM2\nO20100\nG0 X9.\nM99\n", "R 9 0 0",
       "Haas 96-8000 p. 217"},
      {subprogram_digits, 1, Reader::fanuc, "G91 G0\nM98 P20100\nM2\nO100\nX1.\nM99\n",
       "R 1 0 0 | R 2 0 0", "Fanuc B-64124EN/01 p. 136 and 137"},
      {lone_machine_coordinates, 0, Reader::fanuc, "G53\nG0 X1.\nM2\n", "R 101 200 300", fanuc,
       offsets},
      {preset_words, 0, Reader::linuxcnc, "G0 X0\nG92 X1 Y2\nG92.1 X0\nG0 X1 Y1\nM2\n", "R 1 1 0",
       linuxcnc + "G92.1"},
      {preset_words, 1, Reader::fanuc, "G92 X1. Y2.\nG92.1 X0.\nG0 X1. Y1.\nM2\n", "R 1 -1 0",
       fanuc},
      {missing_diameter_offset, 0, Reader::mach, "T1 M6\nG41 G1 X10. F100.\nX20.\nG40 Y5.\nM2\n",
       "T1 | F 10 1 0 f100 | F 20 1 0 | F 20 5 0", "from memory", tools},
      {missing_diameter_offset, 1, Reader::fanuc, "T1 M6\nG41 G1 X10. F100.\nX20.\nG40 Y5.\nM2\n",
       "T1 | F 10 0 0 f100 | F 20 0 0 | F 20 5 0",
       "Fanuc B-62764EN/01, cutter compensation: the vector is zero at power-on", tools},
      {missing_diameter_offset, 1, Reader::haas, "T1 M6\nD1\nG42 D0 G1 X10. F100.\nG40\nM2\n",
       "T1 | F 10 0 0 f100", "helmancnc.com, Haas address codes (D00)", tools},
      {tool_table_input, 0, Reader::linuxcnc, "G10 L10 P1 Z-15\nG43 H1\nG0 Z1\nM2\n", "R 0 0 16",
       linuxcnc + "G10 L10", tools},
      {tool_table_input, 1, Reader::haas, "G10 L10 P1 R50.\nG43 H1\nG0 Z1.\nM2\n", "R 0 0 51",
       "from memory", tools},
      {work_offset_input, 0, Reader::grbl, "G0 X2\nG10 L20 P1 X5\nG0 X1\nM2\n",
       "R 2 0 0 | R -2 0 0", "grbl 1.1, gcode.c"},
      {work_offset_input, 1, Reader::fanuc, "G10 L20 P1 X5.\nG0 X1.\nG54.1 P1 X1.\nM2\n",
       "R 1 0 0 | R 6 0 0", fanuc},
      {override_codes, 0, Reader::linuxcnc, "M50 P0\nG0 X1\nM2\n", "R 1 0 0", linuxcnc + "M50"},
      {override_codes, 1, Reader::haas, "M50 P0\nG0 X1.\nM2\n",
       "p.nc:1:1: error: M50 ... M53: switches for overrides (LinuxCNC), or pallet change and "
       "outputs of the builder (Haas, Fanuc); choose with --reader",
       "from memory"},
      {cycle_distance, 0, Reader::linuxcnc, "G0 Z5\nG99 G81 X1 Z-2 R1 F100\nG91 X2\nM2\n",
       drilled + " | R 1 0 6 | R 3 0 6 | F 3 0 4 | R 3 0 6", linuxcnc + "rs274"},
      {cycle_distance, 1, Reader::fanuc, drill + "G91 X2.\nG90 X0. Y1.\nM2\n",
       drilled + " | R 3 0 1 | F 3 0 -2 | R 3 0 1 | R 0 1 1 | F 0 1 -2 | R 0 1 1", "from memory"},
      {cycle_distance, 1, Reader::haas,
       "G0 Z5.\nG99 G81 Z-2. R1. F100.\nG91 X1. L2\nG83 Y1. Q3.\nM2\n",
       "R 0 0 5 | R 0 0 1 | F 0 0 -2 f100 | R 0 0 1 | R 1 0 1 | F 1 0 -2 | R 1 0 1 | R 2 0 1 | "
       "F 2 0 -2 | R 2 0 1 | R 2 1 1 | F 2 1 -2 | R 2 1 1",
       "from memory"},
      {polar_centre, 0, Reader::fanuc, "G0 X10. Y10.\nG16\nX10. Y45.\nG15 X0. Y0.\nM2\n",
       "R 10 10 0 | R 7.071068 7.071068 0 | R 0 0 0", "Fanuc B-62764EN/01, section 9.2"},
      {polar_centre, 1, Reader::mach, "G0 X10. Y10.\nG16\nX10. Y45.\nG15 X0. Y0.\nM2\n",
       "R 10 10 0 | R 17.071068 17.071068 0 | R 0 0 0", "Mach3 Mill, G15 and G16; from memory"},
      {feed_beside_unit, 0, Reader::linuxcnc, "G20 G1 X1 F10\nX2\nM2\n",
       "F 25.4 0 0 f10 | F 50.8 0 0", linuxcnc + "order of execution"},
      {feed_beside_unit, 1, Reader::grbl, "G20 G1 X1 F10\nX2\nG21 X1 F10\nM2\n",
       "F 25.4 0 0 f254 | F 50.8 0 0 | F 1 0 0 f10", "grbl 1.1, gcode.c"},
      {feed_beside_unit, 1, Reader::haas, "G20 G91 G1 X1. F10.\nM2\n", "F 25.4 0 0 f254",
       "from memory"},
      {circular_pocket, 0, Reader::mach, "G0 X1. Y2.\nG12 I5. F100.\nG0 X0. Y0.\nM2\n",
       "R 1 2 0 | F 6 2 0 f100 | CW 6 2 0 o 1 2 0 | F 1 2 0 | R 0 0 0", "from memory"},
      {circular_pocket, 1, Reader::haas, "G12 I5. F100.\nM2\n",
       "p.nc:1:1: error: G12 and G13 of Haas: the way into the wall is the control's; program it "
       "with G2 or G3",
       "Haas 96-8000, June 1999, p. 237"},
      {start_motion, 0, Reader::grbl, "F100\nX1\nG91Y1\nM2\n", "R 1 0 0 | R 1 1 0",
       "grbl 1.1, gcode.c, gc_init()"},
      {start_motion, 0, Reader::haas, "F100.\nX1.\nM2\n", "R 1 0 0", "from memory"},
      {decimal_point, 0, Reader::fanuc, "G0 X1000\nM2\n", "R 1000 0 0", fanuc},
      {decimal_point, 1, Reader::fanuc, "G21 G0 X1000 Y2. A90000\nG2 X1. Y0. I0 J-1000 F100\nM2\n",
       "R 1 2 0 a90 b0 c0 | CW 1 0 0 a90 b0 c0 o 1 1 0 f100", fanuc, increments},
      {decimal_point, 1, Reader::haas, "G20 G0 X10000\nG91 A1000\nM2\n",
       "R 25.4 0 0 | R 25.4 0 0 a1 b0 c0", "helmancnc.com, Haas address codes", increments},
      {scale_factor, 1, Reader::fanuc, "G51 X0. Y0. Z0. P2000\nG0 X1.\nG50\nX1.\nM2\n",
       "R 2 0 0 | R 1 0 0", "Fanuc B-63682EN/01 p. 117"},
  };
}

}  // namespace servomill::controllers
