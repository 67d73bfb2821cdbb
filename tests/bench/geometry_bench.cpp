/// The volumetric error beside plain C, with the 21 functions of the reference problem: one pose,
/// poses in blocks as the recorder has them, and the most that a five-axis machine can have.
///
/// The last lines are ratios, from medians of turns taken by all: time of plain C / time of ours.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "plant/geometry/volumetric.h"
#include "plant/vocabulary/simd.h"
#include "tests/bench/htm_plain.h"

namespace servomill::plant {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kPoses = 1024;
const Vector3d kTool{0.0, 0.0, -0.15};

// The lines of vol.csv after the heading: name, c0, c1, c2, c3.
std::vector<std::array<double, 4>> read_cubics() {
  const std::string path = SERVOMILL_SOURCE_DIR "/tests/known_answers/reference_problem/vol.csv";
  std::ifstream file(path);
  std::vector<std::array<double, 4>> cubics;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#' || line.starts_with("name")) continue;
    std::istringstream fields(line);
    std::string field;
    std::getline(fields, field, ',');
    auto& cubic = cubics.emplace_back();
    for (double& c : cubic) {
      std::getline(fields, field, ',');
      c = std::stod(field);
    }
  }
  if (cubics.size() != 21) throw std::runtime_error(path + ": wanted 21 functions");
  return cubics;
}

htm_machine plain_machine() {
  const auto cubics = read_cubics();
  htm_machine m{};
  for (std::size_t n = 0; n < 18; ++n) {
    std::copy(cubics[n].begin(), cubics[n].end(), m.cubic[n / 6][n % 6]);
  }
  m.xy = cubics[18][0];
  m.xz = cubics[19][0];
  m.yz = cubics[20][0];
  std::copy_n(kTool.data(), 3, m.tool);
  return m;
}

MachineChain chain_of(std::string_view text) { return make_chain(parse_structure(text)); }

ErrorModel reference_errors() {
  const htm_machine m = plain_machine();
  ErrorModel errors;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t n = 0; n < 6; ++n) {
      const double* c = m.cubic[axis][n];
      errors.components[axis][n] = polynomial({c[0], c[1], c[2], c[3]});
    }
  }
  errors.location("EC0Y"_err) = m.xy;
  errors.location("EB0Z"_err) = m.xz;
  errors.location("EA0Z"_err) = m.yz;
  return errors;
}

// Errors of the rotary axes B and C as well, and their location: 43 numbers and functions.
ErrorModel full_errors() {
  ErrorModel errors = reference_errors();
  for (const std::size_t axis : {4U, 5U}) {
    for (std::size_t n = 0; n < 6; ++n) {
      errors.components[axis][n] = polynomial({1e-6, -2e-6, 3e-6, -1e-6});
    }
  }
  for (const ErrorName& name : {"EX0B"_err, "EZ0B"_err, "EA0B"_err, "EC0B"_err, "EX0C"_err,
                                "EY0C"_err, "EA0C"_err, "EB0C"_err}) {
    errors.location(name) = 5e-6;
  }
  return errors;
}

// A harmonic for each straightness and a table of 31 points for each positioning.
ErrorModel mixed_errors() {
  ErrorModel errors = reference_errors();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<double> s, e;
    for (int i = -15; i <= 15; ++i) {
      s.push_back(0.02 * i);
      e.push_back(1e-6 * std::sin(i));
    }
    for (std::size_t n = 0; n < 3; ++n) {
      ErrorFunction& f = errors.components[axis][n];
      f = f + (n == axis ? linear_table(s, e)
                         : harmonic(1e-6, 0.05 + 0.01 * static_cast<double>(n), 0.3));
    }
  }
  return errors;
}

std::vector<Joints> poses() {
  std::vector<Joints> Q(kPoses, Joints::Zero());
  for (std::size_t n = 0; n < kPoses; ++n) {
    const double t = 0.01 * static_cast<double>(n);
    Q[n] << 0.05 * (1.0 - std::cos(t)), 0.05 * std::sin(t), 0.12 * std::sin(0.3 * t),
        0.3 * std::sin(0.8 * t), 0.2 * std::sin(t);
  }
  return Q;
}

const std::vector<Joints>& all_poses() {
  static const std::vector<Joints> kQ = poses();
  return kQ;
}

// --- the candidates: each evaluates all poses once ---------------------------------------------

using Pass = std::function<void()>;

Pass plain_pass() {
  return [m = plain_machine()] {
    double e[3];
    for (const Joints& Q : all_poses()) {
      htm_error(&m, Q.data(), e);
      benchmark::DoNotOptimize(e);
    }
  };
}

enum class What { offset, error, pose };

Pass single_pass(std::string_view chain, const ErrorModel& errors, What what) {
  return [model = VolumetricModel(chain_of(chain), errors), what] {
    for (const Joints& Q : all_poses()) {
      if (what == What::offset) benchmark::DoNotOptimize(model.joint_offset(Q, kTool));
      if (what == What::error) benchmark::DoNotOptimize(model.error(Q, kTool));
      if (what == What::pose) benchmark::DoNotOptimize(model.forward(Q, kTool));
    }
  };
}

Pass batch_pass(std::string_view chain, const ErrorModel& errors, What what) {
  return [model = VolumetricModel(chain_of(chain), errors), what,
          offsets = std::vector<Vector3d>(kPoses), e = std::vector<VolumetricError>(kPoses),
          P = std::vector<ToolPose>(kPoses)]() mutable {
    if (what == What::offset) model.joint_offsets(all_poses(), kTool, offsets);
    if (what == What::error) model.errors(all_poses(), kTool, e);
    if (what == What::pose) model.poses(all_poses(), kTool, P);
    benchmark::ClobberMemory();
  };
}

struct Candidate {
  std::string name;
  Pass pass;
};

std::vector<Candidate> candidates() {
  const std::string linear = "[w b X Y Z t]", tables = "[w C' B' b X Y Z t]",
                    head = "[w b X Y Z C B t]";
  const ErrorModel reference = reference_errors(), full = full_errors(), mixed = mixed_errors();
  return {{"plain C, 21 functions", plain_pass()},
          {"joint_offset, 21 functions", single_pass(linear, reference, What::offset)},
          {"joint_offset, table of two axes", single_pass(tables, reference, What::offset)},
          {"error, 21 functions", single_pass(linear, reference, What::error)},
          {"forward, 21 functions", single_pass(linear, reference, What::pose)},
          {"joint_offset, 43 functions", single_pass(head, full, What::offset)},
          {"error, 43 functions", single_pass(head, full, What::error)},
          {"joint_offset, 6 harmonics 3 tables", single_pass(linear, mixed, What::offset)},
          {"joint_offsets, 21 functions", batch_pass(linear, reference, What::offset)},
          {"joint_offsets, table of two axes", batch_pass(tables, reference, What::offset)},
          {"errors, 21 functions", batch_pass(linear, reference, What::error)},
          {"poses, 21 functions", batch_pass(linear, reference, What::pose)},
          {"joint_offsets, 43 functions", batch_pass(head, full, What::offset)},
          {"errors, 43 functions", batch_pass(head, full, What::error)},
          {"joint_offsets, 6 harmonics 3 tables", batch_pass(linear, mixed, What::offset)}};
}

// ns for each pose, median of many passes of all candidates in turn.
std::vector<double> medians(const std::vector<Candidate>& all, int rounds) {
  std::vector<std::vector<double>> times(all.size());
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t n = 0; n < all.size(); ++n) {
      all[n].pass();
      const auto begin = std::chrono::steady_clock::now();
      all[n].pass();
      const std::chrono::duration<double, std::nano> time =
          std::chrono::steady_clock::now() - begin;
      times[n].push_back(time.count() / static_cast<double>(kPoses));
    }
  }
  std::vector<double> result;
  for (auto& t : times) {
    std::nth_element(t.begin(), t.begin() + rounds / 2, t.end());
    result.push_back(t[static_cast<std::size_t>(rounds / 2)]);
  }
  return result;
}

}  // namespace
}  // namespace servomill::plant

int main(int argc, char** argv) {
  using namespace servomill::plant;
  const std::vector<Candidate> all = candidates();
  for (const Candidate& c : all) {
    benchmark::RegisterBenchmark(c.name.c_str(), [&c](benchmark::State& state) {
      for (auto _ : state) c.pass();
      state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kPoses));
    });
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  const std::vector<double> time = medians(all, 301);
  fmt::print("\n{}\n{:<38}{:>10}{:>12}\n", name_of(servomill::simd_level()), "", "ns a pose",
             "x plain C");
  for (std::size_t n = 0; n < all.size(); ++n) {
    fmt::print("{:<38}{:>10.2f}{:>12.2f}\n", all[n].name, time[n], time[0] / time[n]);
  }
}
