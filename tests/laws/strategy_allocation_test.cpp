/// Parts of strategies are called in the tick: they do not touch the heap.
#include <gtest/gtest.h>

#include "tests/counting_new.h"
#include "tests/strategies/known_loops.h"

namespace servomill::strategies::strategy_allocation_test {
namespace {

TEST(EveryStrategy, DoesNotAllocateInARun) {
  plant::Uniform random(41);
  IdentifiedMachine identified = identified_with(plant::random_errors(random, 10e-6));
  const auto loops = known_loops({});
  loops->friction.fill({.Fc_positive = 400.0,
                        .Fc_negative = 400.0,
                        .Fs_positive = 400.0,
                        .Fs_negative = 400.0,
                        .sigma0 = 4e8});
  identified.loops = loops;
  for (const Entry& entry : entries()) {
    for (const Action action : kBothActions) {
      for (const int way : {0, 1, 2, 3, 4, 5}) {
        Parameters parameters = default_parameters(entry);
        if (way % 2 == 1 && parameters.is_word("iterations")) {
          parameters.set("iterations", "converged");
        }
        if (way >= 4 && parameters.is_word("prediction")) {
          parameters.set("prediction", "observer");
        }
        if (way >= 2 && way != 4 && parameters.is_word("axes")) parameters.set("axes", "all");
        if (way >= 2 && parameters.is_word("form")) {
          parameters.set("form", "grid");
          parameters.set("spacing_mm", 52.4288 * mm);
        }
        for (const ParameterSpec& spec : entry.parameters) {  // a lead needs readings of the past
          if (way >= 4) break;
          if (std::find(spec.words.begin(), spec.words.end(), "auto") != spec.words.end()) {
            parameters.set(spec.name, "auto");
          }
        }
        const Acting acting = make_acting(entry, parameters, action, identified);
        Joints Q = identified.reference;
        double sum = 0.0;
        const std::size_t before = allocations;
        if (acting.feedback) sum += acting.feedback->settle(Q).sum();
        for (int n = 0; n < 100; ++n) {
          for (int j = 0; j < kLinearJoints; ++j) Q[j] += 1e-5;
          if (acting.setpoint) sum += acting.setpoint->offset(Q).sum();
          if (acting.feedback) sum += acting.feedback->advance(Q).sum();
        }
        EXPECT_EQ(allocations, before) << entry.name;
        EXPECT_TRUE(std::isfinite(sum));
        ::operator delete(::operator new(1));  // the counter counts
        EXPECT_EQ(allocations, before + 1);
      }
    }
  }
}

}  // namespace
}  // namespace servomill::strategies::strategy_allocation_test
