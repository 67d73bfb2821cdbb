/// Errors as functions of axes, laid out for the kernels.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "plant/geometry/error_function.h"
#include "plant/geometry/reversal_memory.h"
#include "plant/geometry/table_lookup.h"
#include "plant/geometry/volumetric_kernel.h"
#include "plant/vocabulary/axes.h"

namespace servomill::plant {

/// The functions of axes, laid out for kernels.
class PreparedFunctions {
 public:
  explicit PreparedFunctions(const JointLayout& layout) : layout_(layout) {}

  /// Adds the function of an error.
  /// @param axis   as the program counts axes
  /// @param joint  its place in Joints
  void add(std::size_t axis, std::size_t component, std::size_t joint, const ErrorFunction& f);
  /// Adds its reversals, which `add` leaves out.
  void add_reversals(std::size_t axis, std::size_t component, std::size_t joint,
                     const ErrorFunction& f);

  /// All that were added. Points into this.
  VolumetricFunctions finish();

  /// Plays of the reversals, each once.
  const std::vector<Play>& plays() const { return plays_; }
  /// add(axis, component, value) for the value of each reversal at q(joint).
  /// @param directions  of each play
  template <class Coordinate, class Add>
  void reversals_at(const Coordinate& q, std::span<const double> directions,
                    const Add& add_value) const {
    for (const HalfReversal& r : reversals_) {
      add_value(r.axis, r.component, directions[r.play] * r.half.value(q(r.joint)));
    }
  }

  bool has_tables() const { return !tables_.empty() || !grids_.empty(); }
  /// add(axis, component, value) for the value of each table and grid at q(joint).
  template <class Coordinate, class Add>
  void tables_at(const Coordinate& q, const Add& add_value) const {
    for (const Table& t : tables_) add_value(t.axis, t.component, t.lookup.value(q(t.joint)));
    for (const Grid& g : grids_) add_value(g.axis, g.component, g.value(q));
  }

 private:
  struct Table {
    std::size_t axis, component, joint;
    TableLookup lookup;
  };
  struct Grid {
    std::size_t axis, component;
    std::vector<std::size_t> joints;  // of the arguments
    GridFunction function;
    template <class Coordinate>
    double value(const Coordinate& q) const {
      std::array<double, GridFunction::kMaxArguments> arguments;
      for (std::size_t k = 0; k < joints.size(); ++k) arguments[k] = q(joints[k]);
      return function.value(std::span(arguments).first(joints.size()));
    }
  };
  struct HalfReversal {
    std::size_t axis, component, joint, play;
    Reversal half;  // of its width
  };
  struct Wave {
    std::size_t axis, component;
    double amplitude, omega, phase;
  };

  void add_coefficient(std::size_t power, std::size_t component, std::size_t axis, double value);
  void join_waves();
  std::vector<std::size_t> joints_of(const GridFunction& grid) const;

  JointLayout layout_;
  std::vector<VolumetricPower> powers_;  // c0, c1, ...
  std::vector<Wave> all_waves_;
  std::vector<VolumetricWaves> waves_;
  std::vector<VolumetricHarmonic> harmonics_;
  std::vector<Table> tables_;
  std::vector<Grid> grids_;
  std::vector<HalfReversal> reversals_;
  std::vector<Play> plays_;
  VolumetricFunctions functions_{};
};

}  // namespace servomill::plant
