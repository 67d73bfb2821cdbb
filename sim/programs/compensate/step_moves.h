/// A corrected program as moves, for a model of the machine that runs them.
#pragma once

#include "plant/vocabulary/put_move.h"
#include "sim/programs/compensate/program_corrector.h"
#include "sim/programs/compensate/program_writer.h"

namespace servomill::sim::programs {

/// Takes the steps that the writers of texts print: the same blocks, with their places on the path
/// of the original program. Blocks in which rotary axes turn keep the time of their share of the
/// move, as TimedFeed has it; others keep the feed.
class StepMoves final : public ProgramWriter {
 public:
  /// @param corrector, put  must outlive this
  StepMoves(ProgramCorrector& corrector, const PutMove& put) : corrector_(corrector), put_(put) {}

  void write(const controllers::ExecutedBlock& block) override;
  std::string finish(const std::vector<std::string>&) override { return {}; }

 private:
  void add(const Step& step);
  static double timed_feed(const Step& step, const FittedBlock& block, const AxisWords& begin);

  ProgramCorrector& corrector_;
  const PutMove& put_;
};

}  // namespace servomill::sim::programs
