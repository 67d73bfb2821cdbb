/// The points of a sweep: what the table [sweep] of a scenario describes, as a sequence of which
/// every point is computed from its number alone.
///
/// ```toml
/// [sweep]                                                # a grid: each value with each other
/// "program.feed_override" = [0.5, 1.0]                   # a list
/// "machine.nc.Kv" = { log = ["40 1/s", "160 1/s"], count = 5 }       # a range; or linear
/// samples = { design = "sobol", count = 256, seed = 1 }  # random, latin_hypercube or sobol
/// "errors.identified.EYX.harmonic.amplitude_um" = { normal = [150.0, 3.0] }    # mean, deviation
/// "case.table.strategy.time_constant_ms" = { uniform = [30.0, 50.0] }      # or log_uniform
/// "case.table.strategy.injection_point" = { choice = ["position_command", "feed_forward"] }
/// # in samples: from = "identified.toml" adds the identified keys of a machine, drawn together
///
/// [[sweep.zip]]                                     # lists that go together, one value each
/// "machine.axis.X.v_max" = ["20 m/min", "40 m/min"]
/// "machine.axis.Y.v_max" = ["10 m/min", "20 m/min"]
/// ```
/// Every point of the grid is run with every sample, the same ones for all: 2 x 5 x 2 x 256 points.
/// The samples vary fastest, then the last dimension of the grid. Keys may be written as --set
/// takes them or as TOML nests them; a case, a strategy, a tool is called by its name.
/// (This example is also a test: Design.ReadsTheExampleOfItsHeader.)
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "sim/model/joint_normal.h"
#include "sim/model/sampling.h"

namespace servomill::sim::model {

/// Most points that a sweep may have: far more than a mistake, fewer than a table can hold.
inline constexpr std::uint64_t kMaxPoints = 10'000'000;

/// `count` values from first to last, equally far apart or in equal ratios.
struct SweepRange {
  double first = 0.0, last = 0.0;
  std::uint64_t count = 0;
  bool log = false;
  std::string unit;
};

using ValueTexts = std::vector<std::string>;  // TOML

/// How a sampled number lies: between a and b, or about the mean a with the standard deviation b.
struct NumberDistribution {
  enum class Kind : std::uint8_t { uniform, log_uniform, normal };
  Kind kind = Kind::uniform;
  double a = 0.0, b = 0.0;
  std::string unit;
};

/// One of several sampled numbers that are distributed together.
struct JointMember {
  std::size_t group = 0;  // of SweepDesign::joint
  Eigen::Index row = 0;   // of its mean
  std::string unit;
};

/// File whose identified values are sampled.
struct SampleFile {
  std::string name;  // as written
  Place place;
};

using SweepValues = std::variant<ValueTexts, SweepRange, NumberDistribution, JointMember>;

/// One key that a sweep varies.
struct SweepKey {
  std::string key;  // dotted, as --set takes it
  Place place = {};
  SweepValues values;
  bool sampled = false;  // else on the grid
  /// Dimension of the grid or of the samples; keys of one dimension go together. Of a JointMember:
  /// the first one of its group.
  std::size_t dimension = 0;
};

/// Common type of the values of one key: numbers of one unit, or one of some texts.
struct SweepColumn {
  bool numeric = true;
  std::string unit;
  ValueTexts texts;  // if not numeric: all values there are, in the order of the scenario
};

struct SweepDesign {
  std::vector<SweepKey> keys;          // in the order of the scenario
  std::vector<std::uint64_t> grid;     // lengths of the dimensions, the last varies fastest
  std::size_t sampled_dimensions = 0;  // of the samples
  SampleSettings samples;
  std::vector<JointNormal> joint;
  std::vector<SampleFile> sample_files;

  bool empty() const { return keys.empty(); }
  /// Number of points. @pre there are not more than kMaxPoints
  std::uint64_t size() const;
  /// A value (TOML) for each key at a point. Uses nothing but its arguments.
  /// @pre index < size()
  std::vector<std::string> point(std::uint64_t index) const;
  SweepColumn column(std::size_t key) const;
};

}  // namespace servomill::sim::model
