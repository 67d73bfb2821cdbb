// The readers of recordings in text and XML. Laws: faults have their places; what is accepted obeys
// the laws of recordings, and what the survey finds is there.
#include <array>
#include <cmath>

#include "sim/recordings/camonitor_reader.h"
#include "sim/recordings/csv_reader.h"
#include "sim/recordings/hal_reader.h"
#include "sim/recordings/sinumerik_frequency.h"
#include "sim/recordings/sinumerik_trace.h"
#include "sim/recordings/survey.h"
#include "sim/recordings/tncscope_reader.h"
#include "sim/recordings/twincat_reader.h"
#include "tests/fuzz/fuzz.h"

namespace servomill::fuzz {
namespace {

using namespace sim::recordings;

struct Kind {
  bool (*is)(std::string_view text);
  Recording (*parse)(std::string_view text, const std::string& file);
};

constexpr std::array kKinds = {
    Kind{is_sinumerik_frequency, parse_sinumerik_frequency},
    Kind{is_sinumerik_trace, parse_sinumerik_trace},
    Kind{is_tncscope, parse_tncscope},
    Kind{is_tncscope_csv, parse_tncscope_csv},
    Kind{is_twincat, parse_twincat},
    Kind{is_halscope, parse_halscope},
    Kind{is_camonitor, parse_camonitor},
    Kind{is_halsampler, parse_halsampler},
    Kind{is_csv, parse_csv},
};

bool are_same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

void require_laws(const Recording& recording) {
  check(recording);
  require(!survey(recording).empty(), "a recording has a survey");
  for (const Channel& channel : recording.channels) {
    for (const Clipping& one : clipping(channel)) {
      require(are_same(channel.samples.at(one.first), one.level),
              "clipped samples are at the level");
    }
  }
}

}  // namespace

void run(std::string_view text) {
  for (const Kind& kind : kKinds) {
    if (!kind.is(text)) continue;
    try {
      require_laws(kind.parse(text, "record"));
    } catch (const InputError& error) {
      require_places(error.faults(), text, "record");
    }
  }
}

}  // namespace servomill::fuzz
