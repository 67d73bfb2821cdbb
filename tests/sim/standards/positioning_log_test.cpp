// Tests from raw logs: the reading of the shared regression vector comes out of a log made of it.
#include "sim/standards/positioning_log.h"

#include <gtest/gtest.h>

#include <cmath>

#include "plant/vocabulary/units.h"
#include "tests/text.h"

namespace servomill::sim::standards::positioning_log_test {
namespace {

// Targets 0, 10, 20 mm, approached from places 5 mm outside; the position moves 0.3 s after the
// target and lies off it by 2 um upwards, -1 um downwards, and 1 um a run.
class Log {
 public:
  explicit Log(double zero = 0.0, double unit = 1.0) : zero_(zero), unit_(unit) {
    out_.file = "log.txt";
    out_.bases = {{}, {}};
    out_.channels = {{"ioc:M1-PosSet", "", {}, 0}, {"ioc:Enc01-PosAct", "", {}, 1}};
    stand(-5.0, 0.0);
    for (int run = 0; run < 3; ++run) {
      for (const double target : {0.0, 10.0, 20.0}) stand(target, 0.002 + 0.001 * run);
      stand(25.0, 0.0);
      for (const double target : {20.0, 10.0, 0.0}) stand(target, -0.001 + 0.001 * run);
      stand(-5.0, 0.0);
    }
  }
  const recordings::Recording& recording() const { return out_; }

 private:
  void add(int channel, double time, double value) {
    out_.bases[std::size_t(channel)].values.push_back(time);
    out_.channels[std::size_t(channel)].samples.push_back(value);
  }
  // A ramp of a second, then a standstill of four; nothing is sent where nothing changes.
  void stand(double target, double off) {
    for (int k = 1; k <= 10; ++k) {
      const double now = last_ + (target - last_) * k / 10.0;
      add(0, time_ + 0.1 * k, k == 10 ? target : now);
      add(1, time_ + 0.3 + 0.1 * k, (now + off) * unit_ + zero_);
    }
    add(1, time_ + 4.0, (target + off) * unit_ + zero_);
    last_ = target;
    time_ += 5.0;
  }

  recordings::Recording out_;
  double zero_, unit_, time_ = 0.0, last_ = -20.0;
};

TEST(PositioningLog, TakesOneReadingFromEachStandstill) {
  const PositioningFile file = positioning_of(Log().recording(), {"PosSet", "PosAct", "", 1.0});
  ASSERT_EQ(file.test.targets.size(), 3);
  ASSERT_EQ(file.test.up.cols(), 3);
  for (Eigen::Index i = 0; i < 3; ++i) {
    for (Eigen::Index run = 0; run < 3; ++run) {
      EXPECT_NEAR(file.test.up(i, run), (2.0 + double(run)) * um, 1e-12);
      EXPECT_NEAR(file.test.down(i, run), (-1.0 + double(run)) * um, 1e-12);
    }
  }
}

TEST(PositioningLog, NamesWhatItLeavesOut) {
  const auto remarks = positioning_of(Log().recording(), {"PosSet", "PosAct", "", 1.0}).remarks;
  std::string all;
  for (const std::string& one : remarks) all += one + "\n";
  EXPECT_EQ(all,
            "log.txt: ioc:M1-PosSet has no unit: mm is assumed\n"
            "log.txt: ioc:Enc01-PosAct has no unit: that of the target is assumed\n"
            "log.txt: 25 standstills of ioc:M1-PosSet; the first one, -5, has no direction and "
            "does not count\n"
            "log.txt: target -5 is approached in one direction only, 3 times: treated as a "
            "reversal point, not evaluated\n"
            "log.txt: target 25 is approached in one direction only, 3 times: treated as a "
            "reversal point, not evaluated\n");
}

TEST(PositioningLog, TakesTheZeroOfTheInstrumentAwayAndItsUnit) {
  const PositioningFile file =
      positioning_of(Log(126e6, 1e6).recording(), {"PosSet", "PosAct", "nm", 1.0});
  EXPECT_NEAR(file.test.up(0, 0) - file.test.down(0, 0), 3.0 * um, 1e-10);
  EXPECT_TRUE(std::any_of(file.remarks.begin(), file.remarks.end(), [](const std::string& one) {
    return one.find("position minus target is 126.0015") != std::string::npos;
  }));
}

TEST(PositioningLog, RefusesChannelsThatAreNotThereAndUnitsThatCannotBe) {
  EXPECT_EQ(fault_messages([] {
              positioning_of(Log().recording(), {"PosSt", "PosAct", "", 1.0});
            }),
            "has no channel PosSt (--target); it has ioc:M1-PosSet, ioc:Enc01-PosAct\n");
  EXPECT_TRUE(fault_messages([] {
                positioning_of(Log(0.0, 1000.0).recording(), {"PosSet", "PosAct", "", 1.0});
              }).starts_with("deviates by "));
  EXPECT_EQ(fault_messages([] {
              positioning_of(Log().recording(), {"PosSet", "PosAct", "", 30.0});
            }),
            "has 0 standstills of ioc:M1-PosSet that last 30 s or more; change the time with "
            "--standstill\n");
}

TEST(PositioningLog, ReadsListsOfAssignments) {
  const std::string text =
      "TEST_DATA=# from a log\n# more\nUNIT=um\nCYCLES=2\nTGT_DATA[1]=0\nTGT_DATA[2]=1000\n"
      "REF_DATA_FWD[1,1]=1\nREF_DATA_FWD[2,1]=1002\nREF_DATA_FWD[1,2]=2\nREF_DATA_FWD[2,2]=1003\n"
      "REF_DATA_BWD[1,1]=.5\nREF_DATA_BWD[2,1]=1000.5\nREF_DATA_BWD[1,2]=0\nREF_DATA_BWD[2,2]="
      "1001\n";
  EXPECT_TRUE(is_list_of_readings(text));
  const PositioningFile file = parse_list_of_readings(text, "a.dat");
  EXPECT_NEAR(file.test.up(1, 1), 3.0 * um, 1e-12);
  EXPECT_NEAR(file.test.down(0, 0), 0.5 * um, 1e-12);
  EXPECT_EQ(fault_messages([&] {
              parse_list_of_readings("TGT_DATA[1]=0\nREF_DATA_FWD[1]=2\nREF_DATA_FWD[3,1]=2\n",
                                     "a.dat");
            }),
            "must be REF_DATA_FWD[position,run]= or REF_DATA_BWD and a number\n"
            "is a reading at position 3 without TGT_DATA[3]\n");
}

}  // namespace
}  // namespace servomill::sim::standards::positioning_log_test
