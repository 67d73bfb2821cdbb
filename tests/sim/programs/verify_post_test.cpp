// Post-processed programs are read back; programs that differ from their cutter locations in any
// way that matters are refused.
#include "sim/programs/verify_post.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <functional>
#include <limits>
#include <sstream>

#include "controllers/gcode/printer.h"
#include "plant/kinematics/structure.h"
#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "tests/text.h"

namespace servomill::sim::programs::verify_post_test {
namespace {

using controllers::Approach;
using controllers::PostMode;

constexpr const char* kTable = "[w C' A' b X Y Z t]";
constexpr const char* kMixed = "[w C' X b Y Z B t]";
constexpr const char* kHead = "[w b X Y Z C A t]";
constexpr const char* kThreeAxes = "[w X b Y Z t]";

// 5-axis and 3-axis work with two tools, dwells, a stop, rapids with and without a new tool axis.
constexpr const char* kLocations =
    "LOADTL/1\nSPINDL/600,CLW\nCOOLNT/ON\nFEDRAT/600\n"
    "RAPID\nGOTO/0,0,30,0.3,0.1,0.95\nGOTO/0,0,10\nGOTO/10,5,8,0.2,0.25,0.94\nDELAY/0.5\n"
    "GOTO/20,0,12,-0.1,0.3,0.9\nRAPID\nGOTO/20,0,40\nRAPID\nGOTO/-20,10,40,0.4,-0.2,0.9\nFEDRAT/"
    "300\n"
    "GOTO/-20,10,10\nSTOP\nGOTO/-25,12,9,0.35,-0.2,0.9\nSPINDL/OFF\nCOOLNT/OFF\nLOADTL/2\n"
    "SPINDL/900,CLW\nRAPID\nGOTO/5,5,20,0.1,0.3,0.9\nGOTO/8,5,20,0.15,0.3,0.9\nFINI\n";
constexpr const char* kUpright =
    "LOADTL/1\nSPINDL/600,CLW\nFEDRAT/600\nRAPID\nGOTO/0,0,30\nGOTO/0,0,10\nDELAY/0.5\nGOTO/"
    "20,0,10\n"
    "RAPID\nGOTO/20,0,40\nSTOP\nRAPID\nGOTO/-20,10,40\nGOTO/-20,10,10\nGOTO/-25,12,9\nFINI\n";

struct Work {
  model::MachineSettings machine;
  controllers::ClData data;
  controllers::PostOptions options;
  std::string program;
};

model::MachineSettings machine_of(const char* structure) {
  model::MachineSettings machine;
  machine.chain = plant::make_chain(plant::parse_structure(structure));
  machine.nc.lower.setConstant(-std::numeric_limits<double>::infinity());
  machine.nc.upper.setConstant(std::numeric_limits<double>::infinity());
  machine.nc.upper[2] = 0.5;
  machine.nc.rotary_tolerance = 1e-4;
  return machine;
}

Work work(const char* structure, Approach approach, PostMode mode, const std::string& text = {}) {
  Work out;
  out.machine = machine_of(structure);
  const bool is_upright = structure == kThreeAxes;
  out.data = controllers::read_cl_data(!text.empty() ? text : (is_upright ? kUpright : kLocations),
                                       "p.cls");
  out.options.approach = approach;
  out.options.mode = mode;
  out.options.safe = {10.0 * mm, 0.5};
  out.options.work_offset << 0.03, -0.02, 0.05;
  out.options.tolerance = {2.0 * um, 200.0 * urad};
  out.options.tools = controllers::ToolTable::parse("T1 P1 Z100 D6\nT2 P2 Z80 D4\n", "tool.tbl");
  plant::InverseSettings settings;
  settings.lower = out.machine.nc.lower;
  settings.upper = out.machine.nc.upper;
  const plant::InverseKinematics inverse(out.machine.chain, settings);
  controllers::PrintOptions print;
  print.axes.clear();
  for (const auto& axis : out.machine.chain.layout.axis) {
    if (axis) print.axes += letter(*axis);
  }
  print.tcp_control = mode == PostMode::tip;
  const auto post_processed = controllers::post(out.data, "p.cls", inverse, out.options);
  out.program = controllers::print_program(post_processed.moves, print, "").text;
  return out;
}

std::string fault_of(const Work& w, const std::string& program) {
  try {
    verify_post(program, w.data, w.machine, w.options, "p.cls");
  } catch (const InputError& error) {
    return error.what();
  }
  return "verified";
}

TEST(VerifyPost, EveryModeOnEveryKindOfMachine) {
  for (const char* structure : {kTable, kMixed, kHead, kThreeAxes}) {
    for (const Approach approach : {Approach::safe, Approach::direct}) {
      for (const PostMode mode : {PostMode::joints, PostMode::locations, PostMode::tip}) {
        if (structure == kThreeAxes && mode == PostMode::tip) continue;
        const Work w = work(structure, approach, mode);
        EXPECT_EQ(fault_of(w, w.program), "verified") << structure << "\n" << w.program;
        const auto verified = verify_post(w.program, w.data, w.machine, w.options, "p.cls");
        EXPECT_EQ(verified.locations, w.data.locations());
        EXPECT_LE(verified.tip, 1.01 * um);  // half of the tolerance is for rounded corners
        EXPECT_LE(verified.axis, 201.0 * urad);
      }
    }
  }
}

// Statements in any order: locations near to each other and far away, feeds, rapids, tools,
// spindle, coolant, dwells and stops.
std::string random_locations(boost::random::mt19937& engine, bool is_upright) {
  boost::random::uniform_real_distribution<double> part(-1.0, 1.0);
  std::string text = "LOADTL/1\nSPINDL/600,CLW\nFEDRAT/600\n";
  Eigen::Vector3d p(10.0, 5.0, 20.0), k(0.3, 0.2, 0.9);
  for (int n = 0; n < 12; ++n) {
    const double kind = 10.0 * std::abs(part(engine));
    if (kind < 0.7) text += "LOADTL/2\n";
    if (kind > 1.0 && kind < 1.5) text += "SPINDL/OFF\n";
    if (kind > 2.0 && kind < 2.5) text += "SPINDL/900,CCLW\n";
    if (kind > 3.0 && kind < 3.5) text += "COOLNT/ON\n";
    if (kind > 4.0 && kind < 4.5) text += "COOLNT/OFF\n";
    if (kind > 5.0 && kind < 5.5) text += "DELAY/0.25\n";
    if (kind > 6.0 && kind < 6.4) text += "STOP\n";
    if (kind > 7.0 && kind < 7.5) text += "FEDRAT/250\n";
    const bool is_rapid = kind > 8.0;
    if (is_rapid) text += "RAPID\n";
    const double reach = is_rapid ? 40.0 : 6.0;
    p += reach * Eigen::Vector3d(part(engine), part(engine), 0.3 * part(engine));
    if (kind < 6.5) k += 0.15 * Eigen::Vector3d(part(engine), part(engine), part(engine));
    const Eigen::Vector3d axis = is_upright ? Eigen::Vector3d::UnitZ() : k.normalized();
    text += fmt::format("GOTO/{:.6f},{:.6f},{:.6f},{:.12f},{:.12f},{:.12f}\n", p[0], p[1], p[2],
                        axis[0], axis[1], axis[2]);
  }
  return text + "FINI\n";
}

// Every program that is written is verified. A few random paths cannot be post-processed: through
// the vertical, say.
TEST(VerifyPost, RandomLocationsAreVerified) {
  boost::random::mt19937 engine(7);
  constexpr int kFiles = 60;
  int post_processed = 0, refused = 0;
  for (int n = 0; n < kFiles; ++n) {
    for (const char* structure : {kTable, kMixed, kHead, kThreeAxes}) {
      const std::string text = random_locations(engine, structure == kThreeAxes);
      const auto approach = static_cast<Approach>(n % 2);
      const auto mode = static_cast<PostMode>(structure == kThreeAxes ? n % 2 : n % 3);
      std::optional<Work> w;
      try {
        w = work(structure, approach, mode, text);
      } catch (const InputError&) {
        ++refused;
        continue;
      }
      ++post_processed;
      ASSERT_EQ(fault_of(*w, w->program), "verified") << structure << " " << n << "\n"
                                                      << text << w->program;
    }
  }
  EXPECT_EQ(post_processed + refused, 4 * kFiles);
  EXPECT_LT(refused, post_processed / 4);
}

// Lines that change nothing where they are: modes that hold already, a retract at the retract
// height, a position that is named again.
bool changes_nothing(const std::string& line) {
  return line.starts_with("(") || line.starts_with("G64") || line == "G54" || line == "G93" ||
         line.starts_with("G21") || line == "M30" || line == "G94";
}

// Dropping any line that acts is found, but for those that another line repeats.
TEST(VerifyPost, DroppedLinesAreFound) {
  std::size_t found = 0, equivalent = 0;
  for (const char* structure : {kTable, kMixed, kHead, kThreeAxes}) {
    const Work w = work(structure, Approach::safe, PostMode::joints);
    const auto lines = lines_of(w.program);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      if (changes_nothing(lines[i])) continue;
      auto mutant = lines;
      mutant.erase(mutant.begin() + static_cast<long>(i));
      const bool was_found = fault_of(w, joined(mutant)) != "verified";
      // a second retract after M6, where the machine of the interpreter has not moved
      const bool is_repeated = lines[i].starts_with("G49 G53");
      EXPECT_TRUE(was_found || is_repeated) << structure << ": " << i + 1 << " " << lines[i];
      (was_found ? found : equivalent) += 1;
    }
  }
  EXPECT_GT(found, 150U);
  EXPECT_EQ(equivalent, 7U);
}

// One word of each line that moves is changed.
TEST(VerifyPost, ChangedWordsAreFound) {
  std::size_t found = 0;
  std::vector<std::string> missed;
  for (const PostMode mode : {PostMode::joints, PostMode::tip}) {
    for (const char* structure : {kTable, kMixed, kHead}) {
      const Work w = work(structure, Approach::safe, mode);
      const auto lines = lines_of(w.program);
      for (std::size_t i = 0; i < lines.size(); ++i) {
        if (changes_nothing(lines[i])) continue;
        for (const char word : {'X', 'Y', 'Z', 'A', 'B', 'C', 'F', 'S', 'H', 'T'}) {
          const std::size_t at = lines[i].find(word);
          if (at == std::string::npos || lines[i].size() <= at + 1) continue;
          const std::size_t end = std::min(lines[i].find(' ', at), lines[i].size());
          const double value = std::strtod(lines[i].c_str() + at + 1, nullptr);
          const bool is_number = word == 'S' || word == 'H' || word == 'T';
          const double other = word == 'F' ? 1.01 * value : value + (is_number ? 1.0 : 0.02);
          for (const double changed : {other, -value}) {
            if (std::abs(changed - value) < 1e-3 || (changed < 0.0 && (is_number || word == 'F')))
              continue;
            auto mutant = lines;
            char text[40];
            std::snprintf(text, sizeof text, "%c%.7g", word, changed);
            mutant[i] = lines[i].substr(0, at) + text + lines[i].substr(end);
            if (fault_of(w, joined(mutant)) == "verified") {
              missed.push_back(lines[i] + " -> " + mutant[i]);
            } else {
              ++found;
            }
          }
        }
      }
    }
  }
  EXPECT_GT(found, 500U);
  EXPECT_EQ(missed, std::vector<std::string>{});
}

// Orders and kinds of motion that reach the same places.
TEST(VerifyPost, DangerousWaysToTheSamePlacesAreFound) {
  const Work w = work(kHead, Approach::safe, PostMode::joints);
  const auto edited = [&](const std::function<void(std::vector<std::string>&)>& edit) {
    auto lines = lines_of(w.program);
    edit(lines);
    return fault_of(w, joined(lines));
  };
  const auto index_of = [&](const std::vector<std::string>& lines, const std::string& start) {
    for (std::size_t i = 0; i < lines.size(); ++i) {
      if (lines[i].starts_with(start)) return i;
    }
    ADD_FAILURE() << start;
    return std::size_t{0};
  };
  // X and Y together with Z: a diagonal down to the part
  EXPECT_EQ(
      edited([&](auto& lines) {
        lines.erase(lines.begin() + static_cast<long>(index_of(lines, "G54 G0 X")));
      }),
      "p.cls:6: error: verification failed: line 12 of the program, 'G0 X32.9588272 Y10.9862757 "
      "Z34.3696194 A-18.4111219 C-71.5650512': the tool moves below the retract height, but "
      "not along its axis");
  // rotary axes after the descent
  EXPECT_NE(edited([&](auto& lines) {
              lines.erase(lines.begin() + static_cast<long>(index_of(lines, "G54 G0 A")));
            }),
            "verified");
  // a feed becomes a rapid
  EXPECT_NE(edited([&](auto& lines) {
              const std::size_t i = index_of(lines, "G1");
              lines[i] = "G0" + lines[i].substr(2, lines[i].find(" F") - 2);
            }),
            "verified");
  // the spindle starts after the cut
  EXPECT_NE(edited([&](auto& lines) {
              std::swap(lines[index_of(lines, "M3")], lines[index_of(lines, "G1")]);
            }),
            "verified");
  // the first retract is missing: X, Y of an unknown place
  EXPECT_NE(edited([&](auto& lines) {
              for (int n = 0; n < 2; ++n) {
                lines.erase(lines.begin() + static_cast<long>(index_of(lines, "G49 G53")));
              }
            }),
            "verified");
  // no retract at the end
  EXPECT_NE(edited([&](auto& lines) { lines.erase(lines.end() - 6, lines.end() - 1); }),
            "verified");
}

// G64 without P would let LinuxCNC round corners as far as its speed asks for.
TEST(VerifyPost, CornersWithoutATolerance) {
  for (const PostMode mode : {PostMode::joints, PostMode::locations, PostMode::tip}) {
    const Work w = work(kTable, Approach::safe, mode);
    std::string without;
    for (const std::string& line : lines_of(w.program)) {
      if (!line.starts_with("G64")) without += line + "\n";
    }
    EXPECT_NE(fault_of(w, without).find("corners are not limited to the tolerance (G64 P)"),
              std::string::npos);
  }
}

// The first rapid under tip control would go down on a diagonal.
TEST(VerifyPost, DescentUnderTipControlMovesNeitherXNorY) {
  const Work w = work(kTable, Approach::safe, PostMode::tip);
  auto lines = lines_of(w.program);
  const auto at = std::find_if(lines.begin(), lines.end(),
                               [](const auto& line) { return line.starts_with("G54 G0 X"); });
  ASSERT_NE(at, lines.end());
  lines.erase(at);
  const std::string fault = fault_of(w, joined(lines));
  EXPECT_TRUE(fault.ends_with("the tool moves below the retract height, but not along its axis"))
      << fault;
}

// Rotary axes that happen to be needed at zero are named, too: they may be anywhere.
TEST(VerifyPost, RotaryAxesAtZeroAreNotAssumed) {
  Work w = work(kTable, Approach::safe, PostMode::joints);
  w.data = controllers::read_cl_data("FEDRAT/600\nRAPID\nGOTO/0,0,20\nGOTO/0,0,10\n", "p.cls");
  w.options.tool = 1;
  const std::string program =
      "G21 G90 G94 G17 G40 G80\nG49 G53 G0 Z500\nT1 M6\nG49 G53 G0 Z500\nG54 G0 A0 C0\n"
      "G54 G0 X0 Y0\nG43 H1\nG64 P0.001\nG0 X0 Y0 Z30 A0 C0\nG0 Z20\nG93\nG1 Z10 F60\nG94\nG0 Z20\n"
      "G49 G53 G0 Z500\nM30\n";
  EXPECT_EQ(fault_of(w, program), "verified");
  std::string mutant = program;
  mutant.erase(mutant.find("G54 G0 A0 C0\n"), 13);
  EXPECT_EQ(fault_of(w, mutant),
            "p.cls:3: error: verification failed: line 8 of the program, 'G0 X0 Y0 Z30 A0 C0': a "
            "rotary axis moves below the retract height");
}

TEST(VerifyPost, SaysWhatWasCompared) {
  const Work w = work(kTable, Approach::safe, PostMode::locations);
  EXPECT_EQ(to_string(verify_post(w.program, w.data, w.machine, w.options, "p.cls")),
            "verified: 10 locations, 29 blocks of motion; between locations nothing was compared "
            "(--classical)");
}

}  // namespace
}  // namespace servomill::sim::programs::verify_post_test
