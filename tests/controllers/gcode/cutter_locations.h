/// Cutter locations, machines and options that the tests of the post-processor share.
#pragma once

#include <array>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_real_distribution.hpp>

#include "controllers/gcode/post_processor.h"
#include "controllers/gcode/printer.h"
#include "tests/controllers/gcode/program.h"

namespace servomill::controllers {

inline constexpr double kPrintTol = 1e-9;  // m, rad: seven decimals of mm and deg, seen from 0.3 m
inline constexpr const char* kTableTable = "[w C' A' b X Y Z t]";
inline constexpr std::array<const char*, 4> kStructures = {
    kTableTable, "[w C' B' X b Y Z (C1) t]", "[w C' X' b Y Z B t]", "[w X' b Y Z C A t]"};

inline plant::InverseKinematics machine(const char* structure, double a_lower = -2.0) {
  plant::InverseSettings settings;
  settings.lower << -0.5, -0.5, -0.5, a_lower, -50.0;
  settings.upper << 0.5, 0.5, 0.5, 2.0, 50.0;
  return plant::InverseKinematics(plant::make_chain(plant::parse_structure(structure)), settings);
}

inline PostOptions usual_options() {
  PostOptions options;
  options.approach = Approach::direct;
  options.tools = usual_setup().tools;
  options.tool = 1;
  options.work_offset << 0.03, -0.02, 0.05;
  options.feed = 0.02;
  options.tolerance = {1.0 * um, 20.0 * urad};
  return options;
}

inline ClData cl(std::string_view text) { return read_cl_data(text, "p.cls"); }

// Locations every few millimetres with a tool axis that wanders, away from the vertical.
inline ClData wandering(unsigned seed, int count = 30) {
  boost::random::mt19937 engine(seed);
  boost::random::uniform_real_distribution<double> part(-1.0, 1.0);
  ClData data;
  Eigen::Vector3d p(0.02, 0.03, 0.04), k(0.5, 0.3, 0.8);
  for (int n = 0; n < count; ++n) {
    ClRecord& record = data.records.emplace_back();
    record.line = n + 1;
    record.P = {p, k.normalized()};
    p += 3.0 * mm * Eigen::Vector3d(part(engine), part(engine), part(engine));
    k += 0.05 * Eigen::Vector3d(part(engine), part(engine), part(engine));
  }
  return data;
}

// The made program as servomill reads it again.
inline std::vector<Move> read_again(const PostProcessed& made, const PostOptions& options) {
  ProgramSetup setup;
  setup.tools = options.tools;
  setup.work_offset[0].head<3>() = options.work_offset;
  std::vector<Move> motions;
  for (const Move& move : interpret(print_program(made.moves, {}, "").text, "p.ngc", setup)) {
    if (is_motion(move.kind)) motions.push_back(move);
  }
  return motions;
}

}  // namespace servomill::controllers
