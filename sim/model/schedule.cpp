#include "sim/model/schedule.h"

#include <cassert>
#include <map>
#include <numeric>

#include "sim/model/machine.h"

namespace servomill::sim::model {

Tick hyperperiod(const std::vector<Rate>& rates) {
  Tick total = 1;
  for (const Rate& rate : rates) {
    if (rate.period > kMaxHyperperiod) return 0;
    total = std::lcm(total, rate.period);
    if (total > kMaxHyperperiod) return 0;
  }
  return total;
}

bool can_be_scheduled(const std::vector<Tick>& periods) {
  std::vector<Rate> rates;
  for (const Tick period : periods) rates.push_back({0, period, 0});
  return hyperperiod(rates) > 0;
}

std::vector<Instant> make_schedule(const std::vector<Rate>& rates) {
  const Tick total = hyperperiod(rates);
  assert(total > 0);
  std::map<Tick, std::uint8_t> due;
  for (const Rate& rate : rates) {
    for (Tick n = rate.phase; n < total; n += rate.period) due[n] |= rate.due;
  }
  assert(due.contains(0));
  std::vector<Instant> schedule;
  Tick last = 0;
  for (const auto& [n, what] : due) {
    if (n > 0 && what == kErrorModel) {
      schedule.back().stops.push_back(n - last);
      continue;
    }
    if (n > 0) schedule.back().step = n - last;
    schedule.push_back({what});
    last = n;
  }
  schedule.back().step = total - last;
  return schedule;
}

}  // namespace servomill::sim::model
