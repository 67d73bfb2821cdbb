#include "sim/identification/possible_record.h"

#include <gtest/gtest.h>

namespace servomill::sim::identification::possible_record_test {
namespace {

Record record(double factor, double offset = 0.0) {
  Record r;
  r.period = 0.1;
  for (const double q : {0.0, 1.0, 3.0, 4.0}) {
    r.command.push_back(q);
    r.feedback.push_back(factor * q + offset);
  }
  return r;
}

TEST(PossibleRecord, IsOneThatFollows) { EXPECT_EQ(impossible(record(0.98, 7.0)), std::nullopt); }

TEST(PossibleRecord, RefusesStandstill) {
  EXPECT_EQ(impossible(record(0.0, 2.0)),
            "does not move: its feedback is 2 from 0 to 0.3 s; the identification requires motion");
}

TEST(PossibleRecord, RefusesTheWrongSignWithItsInstant) {
  EXPECT_EQ(impossible(record(-1.0)),
            "has a feedback that moves against the command, first at 0.2 s: one of them has the "
            "wrong sign; set factor = -1");
}

TEST(PossibleRecord, RefusesAnotherUnit) {
  EXPECT_EQ(impossible(record(1000.0)),
            "has a feedback that moves 1e+03 times as far as the command, 4000 against 4: one of "
            "them has the wrong unit");
}

}  // namespace
}  // namespace servomill::sim::identification::possible_record_test
