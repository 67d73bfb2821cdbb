// Programs in the styles of CAM systems and senders, of own words: each is read, or refused with a
// reason that a user can act on. Styles: post-processors of Fusion, FreeCAD, Vectric, Estlcam,
// Mastercam and HSMWorks, bCNC, cncjs, CAMotics, Heidenhain conversational, Siemens, a printer.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "controllers/gcode/interpreter.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::cam_styles_test {
namespace {

struct Style {
  std::string file;
  std::vector<int> warned;  // lines, each once per warning
  int cuts;                 // moves at feed, counted by hand
  double x, y;              // mm, where the last of them ends
  std::string refusal = {};
  bool has_tools = false;
};

const std::vector<Style>& styles() {
  static const std::vector<Style> all = {
      {"bcnc_header.nc",
       {},
       0,
       0,
       0,
       ":3:1: error: '$' is a sender command for grbl or TinyG, or an NCPlot directive, not a "
       "block; remove the line"},
      {"bcnc_probe.nc",
       {},
       0,
       0,
       0,
       ":3:1: error: G38.2: the probed surface is unknown here; simulate it with [touch_probe] of "
       "a scenario"},
      {"camotics_tplang.nc", {5, 6, 12}, 2, 10.0, 0.0},
      {"cncjs_laser.gcode",
       {},
       0,
       0,
       0,
       ":5:8: error: S after M3 S0 or M4 S0 without another M3 or M4: a laser power; only milling "
       "programs are supported"},
      {"cncjs_macro.nc", {2, 4}, 5, 0.0, 0.0},
      {"cncjs_variables.nc",
       {},
       0,
       0,
       0,
       ":2:1: error: '%x0=' is a variable of the sender cncjs, which substitutes it while "
       "streaming; write its value"},
      {"estlcam_grbl.nc", {}, 3, 10.0, 10.0},
      // X and Y of expressions are rounded to 0.001 mm: 40 sin 300 deg
      {"fanuc_bolt_circle.nc", {3, 8, 11}, 6, 20.0, -34.641},
      {"fanuc_corner.nc", {8}, 6, 0.0, 20.0},
      {"fanuc_tap.nc", {4, 6, 8}, 4, 40.0, 20.0},
      {"freecad_grbl.nc", {}, 1, 5.0, 5.0},
      {"freecad_linuxcnc.ngc", {11, 12, 20}, 4, 10.0, 12.5},
      {"freecad_mach3.nc", {6, 6}, 2, 12.0, 0.0},
      {"fusion_fanuc.nc", {10, 15}, 4, 45.0, 30.0},
      {"fusion_grbl.nc", {12}, 4, 6.3, 20.0},
      {"fusion_haas.nc", {9, 14}, 24, 30.0, 30.0},
      {"fusion_linuxcnc.ngc", {9, 14}, 2, 20.0, 0.0},
      {"fusion_mach3.nc", {8, 12}, 2, 0.0, 0.0},
      // two depths; without a table the tool has no diameter: circles of 4, 8, 12 and 16 mm
      {"haas_pocket.nc", {4, 7, 8, 8}, 26, 25.0, 25.0},
      {"heidenhain_hsc.H", {5, 5}, 4, 1.536, 0.616},
      {"heidenhain_plane.H", {7}, 2, 20.0, 0.0, "", true},
      {"hsmworks_3plus2.nc", {4, 7, 8, 11}, 2, 10.0, 0.0},
      {"mastercam_fanuc.nc", {13}, 4, -20.0, 20.0, "", true},
      {"printer.gcode",
       {},
       0,
       0,
       0,
       ":1:1: error: M104: heats the extruder of a 3D printer; only milling programs are "
       "supported"},
      {"sender_mdi.nc", {1, 1, 8}, 2, 20.0, 10.0},
      {"siemens_sinumerik.mpf", {3, 3, 3, 5}, 1, 0.0, 0.0},
      {"smoothieware.nc", {5, 10, 10}, 2, 9.5, 2.5},
      {"vectric_grbl_inch.nc", {1}, 3, 50.8, 38.1},
      {"vectric_mach_mm.txt", {12, 13, 15}, 3, 55.0, 10.0},
  };
  return all;
}

struct Found {
  std::vector<int> warned;
  int cuts = 0;
  double x = 0.0, y = 0.0;
  std::string refusal;
};

bool is_cut(const Move& move) { return move.kind == MoveKind::feed || move.kind == MoveKind::arc; }

Found found(const Style& style) {
  const std::string folder = SERVOMILL_SOURCE_DIR "/tests/controllers/gcode/cam_styles/";
  ProgramSetup setup;
  setup.reader = Reader::any;
  setup.accepts_unknown_lengths = true;
  if (style.has_tools) {
    setup.tools = ToolTable::parse("T2 P2 Z40 D6\nT5 P5 Z50 D12\n", "tools.tbl");
  }
  Found out;
  try {
    Interpreter interpreter(ProgramText::of_file(folder + style.file), std::move(setup));
    while (const Move* move = interpreter.next()) {
      if (!is_cut(*move)) continue;
      ++out.cuts;
      out.x = move->end[0] / mm;
      out.y = move->end[1] / mm;
    }
    for (const Fault& one : interpreter.warnings()) out.warned.push_back(one.place.line);
  } catch (const InputError& error) {
    out.refusal = to_string(error.faults().front()).substr(folder.size() + style.file.size());
  }
  return out;
}

TEST(CamStyles, AreReadOrRefusedWithARemedy) {
  for (const Style& style : styles()) {
    SCOPED_TRACE(style.file);
    const Found now = found(style);
    EXPECT_EQ(now.refusal, style.refusal);
    if (!style.refusal.empty()) continue;
    EXPECT_EQ(now.warned, style.warned);
    EXPECT_EQ(now.cuts, style.cuts);
    EXPECT_NEAR(now.x, style.x, 1e-9);
    EXPECT_NEAR(now.y, style.y, 1e-9);
  }
}

TEST(CamStyles, EveryProgramOfTheFolderIsInTheTable) {
  std::set<std::string> files, named;
  for (const auto& entry : std::filesystem::directory_iterator(
           SERVOMILL_SOURCE_DIR "/tests/controllers/gcode/cam_styles")) {
    files.insert(entry.path().filename().string());
  }
  for (const Style& style : styles()) named.insert(style.file);
  EXPECT_EQ(files, named);
}

}  // namespace
}  // namespace servomill::controllers::cam_styles_test
