// Parameters of cycles that turn the drilling axis, give others another meaning, or leave holes
// out. [C], from memory
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "controllers/siemens/translator.h"

namespace servomill::controllers::siemens {
namespace {

// Indices of parameters; _AMODE follows _DMODE.
struct Places {
  std::string_view name;
  std::size_t GMODE, DMODE, AXN;  // 0: the cycle has none
};

constexpr auto kPlaces = std::to_array<Places>({{"CYCLE81", 6, 7, 0},
                                                {"CYCLE82", 6, 7, 0},
                                                {"CYCLE83", 17, 18, 12},
                                                {"CYCLE84", 21, 22, 12},
                                                {"CYCLE840", 17, 18, 11},
                                                {"CYCLE85", 8, 9, 0},
                                                {"CYCLE86", 11, 12, 0},
                                                {"CYCLE87", 6, 7, 0},
                                                {"CYCLE88", 7, 8, 0},
                                                {"CYCLE89", 6, 7, 0}});

}  // namespace

void Translator::refuse_options(const Call& call) const {
  const auto* at = std::find_if(kPlaces.begin(), kPlaces.end(),
                                [&](const Places& one) { return one.name == call.name; });
  value_of(call, 0, {}, "RTP");
  if (value_of(call, at->GMODE, 0.0, "_GMODE") != 0.0) {
    fail(call.place, fmt::format("{}: a depth referred to the shank or a diameter (_GMODE) is not "
                                 "supported; program the depth of the tip",
                                 call.name));
  }
  refuse_alternatives(call, value_of(call, at->DMODE + 1, 0.0, "_AMODE"));
  const double plane = std::fmod(value_of(call, at->DMODE, 0.0, "_DMODE"), 10.0);
  const double axis = at->AXN == 0 ? 0.0 : value_of(call, at->AXN, 0.0, "_AXN");
  if ((plane == 0.0 || plane == 3.0 - modes_.normal) &&
      (axis == 0.0 || axis == modes_.normal + 1.0))
    return;
  fail(call.place, fmt::format("{}: drilling along an axis other than that of the active plane "
                               "(_DMODE, _AXN) is not supported; program G17, G18 or G19",
                               call.name));
}

// Digits of _AMODE, from the last: 1 takes the depth from DPR, 2 from DP; 1 is a dwell DTB in
// seconds, 2 in revolutions; those before them belong to further parameters.
void Translator::refuse_alternatives(const Call& call, double AMODE) const {
  const double depth = std::fmod(AMODE, 10.0), dwell = std::fmod(std::floor(AMODE / 10.0), 10.0);
  if (AMODE < 0.0 || AMODE >= 100.0 || depth > 2.0 || dwell > 2.0 || AMODE != std::floor(AMODE)) {
    fail(call.place, fmt::format("{}: _AMODE {:.0f} changes the meaning of other parameters, which "
                                 "is not supported; program the cycle without _AMODE",
                                 call.name, AMODE));
  }
  const bool has_DPR = value_of(call, 4, 0.0, "DPR") != 0.0;
  if ((depth == 1.0 && !has_DPR) || (depth == 2.0 && has_DPR)) {
    fail(call.place, fmt::format("{}: _AMODE selects the depth {}, but the call specifies {}",
                                 call.name, has_DPR ? "DP" : "DPR", has_DPR ? "DPR" : "DP"));
  }
  if (dwell == 2.0 && call.name != "CYCLE81" && call.name != "CYCLE82") {
    fail(
        call.place,
        fmt::format("{}: dwell in revolutions selected by _AMODE is not supported; program DTB < 0",
                    call.name));
  }
}

// Behind NUM: the order and the way between the holes, and those that are left out.
void Translator::refuse_pattern_options(const Call& call) const {
  constexpr std::size_t kFirst = 6;
  for (std::size_t i = kFirst; i < call.arguments.size(); ++i) {
    const auto& value = call.arguments[i].value;
    const bool is_set = value && (value->text ? !value->text->empty() : value->number != 0.0);
    if (!is_set) continue;
    fail(call.place,
         fmt::format("{}: parameters after NUM are not supported; program the positions",
                     call.name));
  }
}

}  // namespace servomill::controllers::siemens
