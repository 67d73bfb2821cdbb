/// Prediction by the model of an experiment for values of its parameters, and how far that is from
/// the recordings.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sim/identification/experiment.h"
#include "sim/identification/parameter_space.h"
#include "sim/identification/simulate_record.h"

namespace servomill::sim::identification {

/// Values of all parameters: those of the estimates in their units, then position (m or rad) and
/// speed (m/s) at the start of each record, which no recording tells exactly.
using Values = std::vector<double>;

/// Samples that count in a comparison, record by record: 1 or 0.
using Mask = std::vector<std::vector<char>>;

/// One axis of the model, at rest at 0; encoders that do not quantise.
AxisModel axis_model(const ModelOfValues& model, int joint);

/// Simulates the records of an experiment for any number of values at once.
class Prediction {
 public:
  /// @param records  of the experiment, by number; must outlive this
  /// @param threads  0: one a core
  Prediction(const config::Document& document, std::vector<Estimate> estimates,
             std::vector<const AxisRecord*> records, unsigned threads = 0);

  std::size_t estimates() const { return estimates_.size(); }
  const std::vector<Estimate>& estimated() const { return estimates_; }
  const std::vector<const AxisRecord*>& records() const { return records_; }
  /// Number of parameters, those of the starts included.
  std::size_t size() const { return estimates_.size() + 2 * records_.size(); }
  /// Samples of all records.
  std::size_t samples() const { return samples_; }
  /// Values that estimation begins with.
  Values start() const;
  /// Bounds of a parameter.
  std::pair<double, double> bounds(std::size_t parameter) const;
  /// All samples but those that a record omits.
  Mask all_samples() const;

  /// The same with another record in place of all.
  Prediction of_one(const AxisRecord& record) const {
    return Prediction(document_, estimates_, {&record}, threads_);
  }

  /// Signals for each of several values; none where the machine refuses them or the drive cannot be
  /// resolved.
  struct Signals {
    std::vector<Simulated> of_record;
  };
  std::vector<std::optional<Signals>> simulate(std::span<const Values> values) const;

  /// Says why values cannot be simulated.
  /// @throws InputError, always
  [[noreturn]] void refuse(const Values& values) const;

  /// Simulated less recorded feedback (m or rad), record after record; 0 where the mask is.
  Eigen::VectorXd residual(const Signals& signals, const Mask& mask) const;

 private:
  std::optional<ModelOfValues> model(const Values& values, std::size_t record) const;
  bool has_own() const;
  /// With the position and speed at the start of the record.
  AxisModel started_axis(const ModelOfValues& model, const Values& values,
                         std::size_t record) const;

  const config::Document& document_;
  std::vector<Estimate> estimates_;
  std::vector<const AxisRecord*> records_;
  unsigned threads_;
  std::size_t samples_ = 0;
};

}  // namespace servomill::sim::identification
