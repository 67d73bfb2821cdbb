// The example of strategies/README.md, "Strategies out of the tree": blocks that are displaced by
// the errors of the identified model.
#include <algorithm>
#include <cmath>

#include "strategies/plugin.h"

namespace {

using servomill::plugin::Joints;
using servomill::plugin::Program;

constexpr auto kLength =
    servomill::plugin::parameter("max_block_mm", "length of a block", "mm", "1", 1e-3, 1e3);
constexpr const servomill_parameter* kParameters[] = {&kLength};

class Blocks {
 public:
  explicit Blocks(const servomill_setup& setup) : setup_(setup), length_(setup.parameters[0]) {}

  void rewrite(Program& program) {
    for (std::size_t n = 0; n < program.size(); ++n) {
      const servomill_move& move = program[n];
      const bool is_cut = move.kind != SERVOMILL_RAPID;
      const double pieces =
          is_cut ? std::max(1.0, std::ceil((move.s_end - move.s_begin) / length_ - 1e-9)) : 1.0;
      for (double k = 1.0; k <= pieces; ++k) {
        const double share = k < pieces ? k * (1.0 / pieces) : 1.0;
        program.add(n, share, displaced(program.position(n, share)));
      }
    }
  }

 private:
  Joints displaced(Joints Q) const {
    double error[3];
    setup_.error_at(setup_.model, Q.data(), error);
    for (std::size_t j = 0; j < 3; ++j) Q[j] += setup_.sign * error[j];
    return Q;
  }

  servomill_setup setup_;
  double length_;  // m
};

constexpr auto kBlocks = servomill::plugin::knows_errors(servomill::plugin::strategy<Blocks>(
    "blocks", "displaces short blocks by the identified errors", kParameters));

}  // namespace

SERVOMILL_PLUGIN("blocks", "0.1", kBlocks)
