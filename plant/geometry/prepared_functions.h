/// Errors as functions of axes, laid out for the kernels.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "plant/geometry/error_function.h"
#include "plant/geometry/reversal_memory.h"
#include "plant/geometry/table_lookup.h"
#include "plant/geometry/volumetric_kernel.h"

namespace servomill::plant {

/// The functions of axes, laid out for kernels.
class PreparedFunctions {
 public:
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

  bool has_tables() const { return !tables_.empty(); }
  /// add(axis, component, value) for the value of each table at q(joint).
  template <class Coordinate, class Add>
  void tables_at(const Coordinate& q, const Add& add_value) const {
    for (const Table& t : tables_) add_value(t.axis, t.component, t.lookup.value(q(t.joint)));
  }

 private:
  struct Table {
    std::size_t axis, component, joint;
    TableLookup lookup;
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

  std::vector<VolumetricPower> powers_;  // c0, c1, ...
  std::vector<Wave> all_waves_;
  std::vector<VolumetricWaves> waves_;
  std::vector<VolumetricHarmonic> harmonics_;
  std::vector<Table> tables_;
  std::vector<HalfReversal> reversals_;
  std::vector<Play> plays_;
  VolumetricFunctions functions_{};
};

}  // namespace servomill::plant
