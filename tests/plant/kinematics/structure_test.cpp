#include "plant/kinematics/structure.h"

#include <gtest/gtest.h>

#include "tests/plant/kinematics/all_structures.h"

namespace servomill::plant::structure_test {
namespace {

std::string message(std::string_view text) {
  try {
    parse_structure(text);
  } catch (const InputError& e) {
    return e.what();
  }
  return "accepted";
}

TEST(Structure, OfTheHsm600uIsRead) {
  const Structure s = parse_structure("[w C' B' X b Y Z (C1) t]");
  const std::vector<StructureAxis> axes = {{Axis::C, Side::workpiece},
                                           {Axis::B, Side::workpiece},
                                           {Axis::X, Side::workpiece},
                                           {Axis::Y, Side::tool},
                                           {Axis::Z, Side::tool}};
  EXPECT_EQ(s.axes, axes);
  EXPECT_EQ(s.spindle, Axis::C);
  const JointLayout layout{{Axis::X, Axis::Y, Axis::Z, Axis::B, Axis::C}};
  EXPECT_EQ(s.layout(), layout);
}

TEST(Structure, LayoutHasGapsForMissingLinearAxesAndRotaryOnesInAlphabeticalOrder) {
  const JointLayout layout{{std::nullopt, Axis::Y, std::nullopt, Axis::A, Axis::C}};
  EXPECT_EQ(parse_structure("[w C' b Y A t]").layout(), layout);
  const JointLayout one{{std::nullopt, std::nullopt, std::nullopt, Axis::C, std::nullopt}};
  EXPECT_EQ(parse_structure("[w C' b t]").layout(), one);
}

TEST(Structure, PrimesAndBlanksAreOptional) {
  const Structure s = parse_structure("[w C' B' X' b Y Z t]");
  EXPECT_EQ(parse_structure("[w C B X b Y Z t]"), s);
  EXPECT_EQ(parse_structure("[wC'B'XbYZt]"), s);
  EXPECT_EQ(parse_structure("  [w C' B' X b\tY Z t] "), s);
}

TEST(Structure, IsPrintedWithAllPrimes) {
  EXPECT_EQ(to_string(parse_structure("[wC'B'XbYZ(C1)t]")), "[w C' B' X' b Y Z (C1) t]");
  EXPECT_EQ(to_string(parse_structure("[w X b t]")), "[w X' b t]");
  EXPECT_EQ(to_string(parse_structure("[w b t]")), "[w b t]");
}

TEST(Structure, EveryOneIsReadAsItIsPrinted) {
  const auto all = all_structures();
  // n axes: (n + 1)! orders of axes and bed; 1, 6, 15, 19, 12, 3 sets of n = 0 .. 5 axes
  EXPECT_EQ(all.size(), 1U + 6U * 2U + 15U * 6U + 19U * 24U + 12U * 120U + 3U * 720U);
  for (const Structure& s : all) ASSERT_EQ(parse_structure(to_string(s)), s) << to_string(s);
}

TEST(Structure, FaultsAreNamedWithTheirColumn) {
  EXPECT_EQ(message(""),
            "structure:1:1: error: structure '': must start with '['\n"
            "structure:1:1: error: structure '': must end with ']'\n"
            "structure:1:1: error: structure '': w (workpiece) is missing\n"
            "structure:1:1: error: structure '': b (bed) is missing\n"
            "structure:1:1: error: structure '': t (tool) is missing");
  EXPECT_EQ(message("w X b Y Z t]"),
            "structure:1:1: error: structure 'w X b Y Z t]': must start with '['");
  EXPECT_EQ(message("[w X b Y Z t"),
            "structure:1:13: error: structure '[w X b Y Z t': must end with ']'");
  EXPECT_EQ(message("[w X b Y U t]"),
            "structure:1:10: error: structure '[w X b Y U t]': 'U' is not an axis; must be one of "
            "X Y Z A B C");
  EXPECT_EQ(message("[w x b Y t]"),
            "structure:1:4: error: structure '[w x b Y t]': 'x' is not an axis; must be one of "
            "X Y Z A B C");
  EXPECT_EQ(message("[w X b Y X t]"),
            "structure:1:10: error: structure '[w X b Y X t]': axis X appears twice");
  EXPECT_EQ(message("[X b Y t]"),
            "structure:1:2: error: structure '[X b Y t]': w (workpiece) is missing");
  EXPECT_EQ(message("[w X Y t]"),
            "structure:1:9: error: structure '[w X Y t]': b (bed) is missing");
  EXPECT_EQ(message("[w X b Y]"),
            "structure:1:9: error: structure '[w X b Y]': t (tool) is missing");
  EXPECT_EQ(message("[w X b b Y t]"),
            "structure:1:8: error: structure '[w X b b Y t]': b (bed) appears twice");
  EXPECT_EQ(message("[X w b Y t]"),
            "structure:1:4: error: structure '[X w b Y t]': w (workpiece) must come first");
  EXPECT_EQ(message("[w X b t Y]"),
            "structure:1:8: error: structure '[w X b t Y]': t (tool) must come last");
  EXPECT_EQ(message("[w A B b C X t]"),
            "structure:1:10: error: structure '[w A B b C X t]': C is rotary axis number 3; at "
            "most 2 are allowed");
  EXPECT_EQ(message("[w X' b Y' t]"),
            "structure:1:9: error: structure '[w X' b Y' t]': Y' has a prime but is on the tool "
            "side of b");
  EXPECT_EQ(message("[w' X b Y t]"),
            "structure:1:3: error: structure '[w' X b Y t]': a prime must follow an axis");
  EXPECT_EQ(message("[w X'' b t]"),
            "structure:1:6: error: structure '[w X'' b t]': a prime must follow an axis");
  EXPECT_EQ(message("[w X b (C2) t]"),
            "structure:1:8: error: structure '[w X b (C2) t]': a spindle must be written (A1), "
            "(B1) or (C1)");
  EXPECT_EQ(message("[w X (C1) b Y t]"),
            "structure:1:6: error: structure '[w X (C1) b Y t]': spindle (C1) must come directly "
            "before t");
}

TEST(Structure, AllFaultsOfAStringAreReportedInOrderOfColumn) {
  EXPECT_EQ(
      message("[w Q X b X' t]"),
      "structure:1:4: error: structure '[w Q X b X' t]': 'Q' is not an axis; must be one of X Y Z "
      "A B C\nstructure:1:10: error: structure '[w Q X b X' t]': X' has a prime but is on the tool "
      "side of b\nstructure:1:10: error: structure '[w Q X b X' t]': axis X appears twice");
}

TEST(Structure, FaultsCountColumnsFromThePlaceOfTheString) {
  try {
    parse_structure("[w X b U t]", {"m.toml", 3, 14});
    FAIL();
  } catch (const InputError& e) {
    EXPECT_EQ(e.faults().at(0).place, (Place{"m.toml", 3, 21}));
  }
}

}  // namespace
}  // namespace servomill::plant::structure_test
