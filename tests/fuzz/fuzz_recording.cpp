// The reader of recordings in text. Laws: faults have their places; what is accepted obeys the laws
// of recordings, and what the survey finds is there.
#include <cmath>

#include "sim/recordings/csv_reader.h"
#include "sim/recordings/survey.h"
#include "tests/fuzz/fuzz.h"

namespace servomill::fuzz {
namespace {

bool are_same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

}  // namespace

void run(std::string_view text) {
  using namespace sim::recordings;
  try {
    const Recording recording = parse_csv(text, "record.csv");
    check(recording);
    require(!survey(recording).empty(), "a recording has a survey");
    for (const Channel& channel : recording.channels) {
      for (const Clipping& one : clipping(channel)) {
        require(are_same(channel.samples.at(one.first), one.level),
                "clipped samples are at the level");
      }
    }
  } catch (const InputError& error) {
    require_places(error.faults(), text, "record.csv");
  }
}

}  // namespace servomill::fuzz
