/// Runs of the program of a case before the case itself runs: strategies that predict or repeat
/// learn from them.
#pragma once

#include <complex>
#include <memory>
#include <string>
#include <vector>

#include "plant/vocabulary/axes.h"
#include "strategies/lesson.h"
#include "strategies/path_offset.h"

namespace servomill::strategies {

/// Treatment of limits of the axes that path and offset exceed together.
enum class OffsetLimit : std::uint8_t {
  ignore,  // they are exceeded, and that is reported
  smooth,  // the offset is smoothed where the path leaves too little of them
  slow,    // the path is planned with lower ones
};

/// Choices of a strategy for its runs, which show the deviation from the interpolated path.
struct TrialSetup {
  int runs = 1;             // of the program, at most
  bool sees_tip = true;     // of tip and tool axis in the workpiece; else of the scales
  double noise = 0.0;       // m, standard deviation of what is seen of each linear joint
  bool turns = false;       // rotary joints are offset, too, for the orientation of the tool
  double sigma_0 = 0.0;     // then: of PoseCompensation
  bool on_actual = false;   // the program runs on the machine of the case, else on the known one
  double feed = 1.0;        // of the runs, as a share of that of the case
  bool as_program = false;  // the offset is written into the program, which is planned anew
  OffsetLimit limit = OffsetLimit::ignore;
  double cutoff = 100.0;  // Hz, of the offset
};

/// One run of the program.
struct TrialRun {
  /// In each row of an offset: displacement of the joints that would make what was seen (5; m,
  /// rad).
  std::vector<Joints> deviation;
  std::string stopped;  // why; empty: it came to its end
};

class TrialRuns {
 public:
  virtual ~TrialRuns() = default;
  virtual std::shared_ptr<const PathTimes> times() const = 0;
  /// Rows that are judged: of feed motion.
  virtual const std::vector<bool>& in_feed() const = 0;
  /// Joints that can be offset.
  virtual const std::vector<int>& joints() const = 0;
  /// Response of what is seen of a joint to an offset of its setpoint (1; f in Hz, >= 0): of the
  /// machine as the strategy knows it, and of that on which the program runs.
  virtual std::complex<double> known_response(int joint, double f) const = 0;
  virtual std::complex<double> response(int joint, double f) const = 0;
  /// Number of runs that were recorded, which are all there are; 0: as many as are asked for.
  virtual int recorded() const { return 0; }
  /// The offset as the limits of the axes admit it.
  virtual std::vector<Joints> admissible(std::vector<Joints> offset) const = 0;
  /// Runs the program with an offset. Each run has noise of its own. Recorded runs come in their
  /// order, whatever the offset.
  virtual TrialRun run(const std::shared_ptr<const PathOffset>& offset) = 0;
};

/// A strategy that has the program run before it acts. Before it has learnt it displaces nothing.
class LearningStrategy : public Strategy {
 public:
  const LearningStrategy* learning() const final { return this; }
  virtual TrialSetup trials() const = 0;
  /// @throws InputError without a place if the runs teach nothing
  virtual Lesson learn(TrialRuns& runs) const = 0;
  /// As it acts with an offset.
  virtual std::shared_ptr<const Strategy> with_offset(
      std::shared_ptr<const PathOffset> offset) const = 0;
};

}  // namespace servomill::strategies
