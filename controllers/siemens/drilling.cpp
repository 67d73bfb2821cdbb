// Drilling, tapping and boring cycles as their moves. [C] "Drilling"; the order of parameters and
// the defaults of those left out are those of the cycles' calls in [C] "External programming".
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "controllers/siemens/translator.h"

namespace servomill::controllers::siemens {
namespace {

constexpr int kMaxStrokes = 10000;

// Pitches of metric coarse threads, mm: DIN 13, and the table of MPIT in [C] CYCLE84.
constexpr auto kPitches = std::to_array<std::pair<int, double>>(
    {{3, 0.5},  {4, 0.7},  {5, 0.8},  {6, 1.0},  {8, 1.25}, {10, 1.5}, {12, 1.75},
     {14, 2.0}, {16, 2.0}, {18, 2.5}, {20, 2.5}, {22, 2.5}, {24, 3.0}, {27, 3.0},
     {30, 3.5}, {33, 3.5}, {36, 4.0}, {39, 4.0}, {42, 4.5}, {45, 4.5}, {48, 5.0}});

}  // namespace

/// Heights of a hole along the axis across the plane, in coordinates of the program (mm).
struct Translator::Hole {
  double retract = 0.0, surface = 0.0, clearance = 0.0, bottom = 0.0;
  double up = 1.0;  // direction out of the hole
};

double Translator::value_of(const Call& call, std::size_t at, std::optional<double> otherwise,
                            std::string_view name) const {
  const bool has = at < call.arguments.size() && call.arguments[at].value;
  if (!has && !otherwise) fail(call.place, fmt::format("{} requires {}", call.name, name));
  if (!has) return *otherwise;
  if (call.arguments[at].value->text) {
    fail(call.place, fmt::format("{}: {} must be a number, not a string", call.name, name));
  }
  return call.arguments[at].value->number;
}

// RTP, RFP, SDIS, DP or DPR, the first five parameters of all of them. DPR counts from the
// reference plane and prevails.
Translator::Hole Translator::hole_of(const Call& call) const {
  Hole out;
  out.surface = value_of(call, 1, {}, "RFP") * unit();
  out.retract = value_of(call, 0, out.surface / unit(), "RTP") * unit();
  const double DPR = value_of(call, 4, 0.0, "DPR") * unit();
  const bool has_DP = call.arguments.size() > 3 && call.arguments[3].value;
  if (!has_DP && DPR == 0.0) fail(call.place, fmt::format("{} requires DP or DPR", call.name));
  out.bottom = DPR != 0.0 ? out.surface - std::abs(DPR) : value_of(call, 3, {}, "DP") * unit();
  out.up = out.bottom <= out.surface ? 1.0 : -1.0;
  out.clearance = out.surface + out.up * std::abs(value_of(call, 2, 0.0, "SDIS")) * unit();
  if (out.up * (out.retract - out.surface) < 0.0) {
    fail(call.place, fmt::format("{}: RTP must not be below RFP", call.name));
  }
  return out;
}

void Translator::cycle_move(const Feed& feed, double height) {
  std::array<std::optional<double>, 3> to{};
  to[static_cast<std::size_t>(modes_.normal)] = height;
  cycle_move(feed, to);
}

void Translator::cycle_move(const Feed& feed, const std::array<std::optional<double>, 3>& to) {
  Block block;
  for (std::size_t i = 0; i < 3; ++i) {
    if (to[i]) block.axes[i] = Number{*to[i] / unit(), Measure::absolute, place_};
  }
  Motion motion;
  motion.place = place_;
  motion.words = ends(block, motion.is_incremental);
  motion.feed = feed;
  add(std::move(motion));
  last_element_.reset();
}

// Seconds, or revolutions where it is negative.
void Translator::cycle_dwell(double time) {
  if (time >= 0.0) return dwell_for(time);
  if (!speed_ || *speed_ <= 0.0) fail("a dwell in revolutions requires an active S");
  dwell_for(-time * 60.0 / *speed_);
}

Feed Translator::cycle_feed(double per_minute) {
  if (modes_.feed_code != 94) {
    fail(fmt::format(
        "a feed rate of the cycle with G{} is not supported; program G94 before the cycle",
        modes_.feed_code));
  }
  if (!(per_minute > 0.0))
    fail(fmt::format("feed rate of the cycle {:g}; must be > 0", per_minute));
  const double unit = unit_of_feed(place_);
  if (unit == 0.0) return {Feed::Kind::unknown};
  return effective({Feed::Kind::per_minute, per_minute * unit}, override_);
}

bool Translator::run_drilling_cycle(const Call& call) {
  using Run = void (Translator::*)(const Call&);
  constexpr auto kCycles = std::to_array<std::pair<std::string_view, Run>>({
      {"CYCLE81", &Translator::drill_82},
      {"CYCLE82", &Translator::drill_82},
      {"CYCLE83", &Translator::drill_83},
      {"CYCLE84", &Translator::tap_84},
      {"CYCLE840", &Translator::tap_840},
      {"CYCLE85", &Translator::ream_85},
      {"CYCLE86", &Translator::bore_86},
      {"CYCLE87", &Translator::bore_88},
      {"CYCLE88", &Translator::bore_88},
      {"CYCLE89", &Translator::bore_89},
  });
  const auto* found = std::find_if(kCycles.begin(), kCycles.end(),
                                   [&](const auto& one) { return one.first == call.name; });
  if (found == kCycles.end()) return false;
  require_no_compensation(call.name);
  if (is_tcp_)
    fail(call.place,
         fmt::format("{} is not allowed with TRAORI; cancel it with TRAFOOF", call.name));
  if (modes_.feed_code == 93) {
    fail(call.place,
         fmt::format("{} is not allowed with G93; program G94 or G95 first", call.name));
  }
  check_length_axis(true);
  refuse_options(call);
  (this->*found->second)(call);
  return true;
}

// In at F, dwell, out at rapid. 2 in the tens of _AMODE is a dwell in revolutions.
void Translator::drill_82(const Call& call) {
  const Hole hole = hole_of(call);
  const double DTB = value_of(call, 5, 0.0, "DTB");
  const bool is_turns = std::fmod(value_of(call, 8, 0.0, "_AMODE") / 10.0, 10.0) >= 2.0;
  cycle_move({}, hole.clearance);
  cycle_move(modal_feed(), hole.bottom);
  cycle_dwell(is_turns ? -std::abs(DTB) : DTB);
  cycle_move({}, hole.retract);
}

// Depths of the strokes: each is that of the one before less DAM (DAM < 0: by a factor), down to
// the least; where none is given, DAM itself, and the last two are equal. [C] CYCLE83
std::vector<double> Translator::strokes_of(const Call& call, const Hole& hole) const {
  const double total = std::abs(hole.surface - hole.bottom);
  const double FDPR = std::abs(value_of(call, 6, 0.0, "FDPR")) * unit();
  double stroke = FDPR;
  if (stroke == 0.0) stroke = std::abs(hole.surface - value_of(call, 5, {}, "FDEP") * unit());
  const double DAM = value_of(call, 7, 0.0, "DAM");
  if (DAM < -1.0) fail(call.place, "CYCLE83: DAM < 0 is a factor and must be >= -1");
  const double least = std::max(value_of(call, 13, 0.0, "_MDEP"), 0.0) * unit();
  const double step = DAM > 0.0 ? DAM * unit() : 0.0;
  if (!(stroke > 0.0)) fail(call.place, "CYCLE83: the first drilling depth must not be 0");
  if (stroke > total * (1.0 + 1e-9)) {
    fail(call.place, "CYCLE83: the first drilling depth must not exceed the final drilling depth");
  }
  const double floor = least > 0.0 ? least : step;
  std::vector<double> out;
  double left = total;
  constexpr double kRounding = 1e-9;  // mm
  while (left > kRounding) {
    if (out.size() == kMaxStrokes) fail(call.place, "CYCLE83: too many strokes");
    if (!out.empty()) {
      stroke = DAM < 0.0 ? stroke * -DAM : stroke - step;
      stroke = std::max(stroke, DAM == 0.0 ? stroke : std::max(floor, 1e-3));
    }
    const bool are_last_two =
        !out.empty() && least == 0.0 && stroke <= step && left > stroke && left < 2.0 * stroke;
    if (are_last_two) {
      out.push_back(left / 2.0);
      out.push_back(left / 2.0);
      break;
    }
    out.push_back(std::min(stroke, left));
    left -= out.back();
  }
  return out;
}

// VARI 1: out to the clearance after each stroke, back to just above the depth; 0: back by _VRT.
void Translator::drill_83(const Call& call) {
  const Hole hole = hole_of(call);
  const std::vector<double> strokes = strokes_of(call, hole);
  const Feed feed = modal_feed();
  const double FRF = value_of(call, 10, 1.0, "FRF");
  if (FRF < 0.0 || FRF > 1.0) fail(call.place, "CYCLE83: FRF must be from 0 to 1");
  const bool is_removal = value_of(call, 11, 0.0, "VARI") != 0.0;
  const double VRT = std::abs(value_of(call, 14, 0.0, "_VRT")) * unit();
  const double back = VRT > 0.0 ? VRT : 1.0;
  const double total = std::abs(hole.surface - hole.bottom);
  const double DIS1 = std::abs(value_of(call, 16, 0.0, "_DIS1")) * unit();
  const double above = DIS1 > 0.0 ? DIS1 : total <= 30.0 ? 0.6 : std::min(total / 50.0, 7.0);
  cycle_move({}, hole.clearance);
  double done = 0.0;
  for (std::size_t i = 0; i < strokes.size(); ++i) {
    Feed own = feed;
    if (i == 0 && FRF > 0.0) own.value *= FRF;
    done += strokes[i];
    const bool is_last = i + 1 == strokes.size();
    cycle_move(own, is_last ? hole.bottom : hole.surface - hole.up * done);
    if (is_last) break;
    cycle_dwell(value_of(call, 8, 0.0, "DTB"));
    if (is_removal) {
      cycle_move({}, hole.clearance);
      cycle_dwell(value_of(call, 9, 0.0, "DTS"));
      if (above < done) cycle_move({}, hole.surface - hole.up * (done - above));
    } else {
      cycle_move(feed, hole.surface - hole.up * (done - std::min(back, done)));
    }
  }
  const double DTD = value_of(call, 15, 0.0, "_DTD");
  cycle_dwell(DTD != 0.0 ? DTD : value_of(call, 8, 0.0, "DTB"));
  cycle_move({}, hole.retract);
}

// mm; the sign is the hand of the thread. MPIT is the size of a metric thread.
double Translator::pitch_of(const Call& call, std::size_t at_MPIT, std::size_t at_unit) const {
  const double PIT = value_of(call, at_MPIT + 1, 0.0, "PIT");
  const double MPIT = value_of(call, at_MPIT, 0.0, "MPIT");
  const double kind = value_of(call, at_unit, 0.0, "_PITA");
  if (PIT != 0.0) {
    if (kind <= 1.0) return PIT * (kind == 0.0 ? unit() : 1.0);
    if (kind == 2.0) return 25.4 / PIT;
    if (kind == 3.0) return 25.4 * PIT;
    fail(call.place, fmt::format("{}: a pitch in modules is not supported", call.name));
  }
  for (const auto& [size, pitch] : kPitches) {
    if (std::abs(MPIT) == size) return std::copysign(pitch, MPIT);
  }
  if (MPIT == 0.0) return 0.0;
  fail(call.place,
       fmt::format("{}: M{:g} is not a metric coarse thread from M3 to M48; program PIT", call.name,
                   std::abs(MPIT)));
}

void Translator::turn_spindle(int direction) {
  if (direction == spindle_) return;
  spindle_ = direction;
  note(direction > 0 ? "M3" : direction < 0 ? "M4" : "M5");
}

// Rigid tapping at SST, out at SST1; the spindle turns back at the depth. SDAC: 3, 4 or 5 behind
// it.
void Translator::tap_84(const Call& call) {
  const Hole hole = hole_of(call);
  const double pitch = pitch_of(call, 7, 13);
  require_lengths_kept(call.name);
  if (pitch == 0.0) fail(call.place, "CYCLE84 requires MPIT or PIT");
  if (std::fmod(value_of(call, 15, 0.0, "_VARI"), 10.0) != 0.0) {
    fail(call.place, "CYCLE84 with chip breaking (_VARI) is not supported; program G331 and G332");
  }
  const double SST = value_of(call, 10, speed_.value_or(0.0), "SST");
  if (!(SST > 0.0)) fail(call.place, "CYCLE84 requires SST");
  const double SST1 = value_of(call, 11, 0.0, "SST1");
  const double out = SST1 > 0.0 ? SST1 : SST;
  const std::optional<double> before = speed_;
  const int direction = pitch > 0.0 ? 1 : -1;
  const auto set_speed_to = [&](double speed) {
    require_speed_in_limits(speed, call.place);
    if (speed_ != speed) note(word('S', speed));
    speed_ = speed;
  };
  cycle_move({}, hole.clearance);
  set_speed_to(SST);
  turn_spindle(direction);
  cycle_move({Feed::Kind::per_minute, std::abs(pitch) * SST}, hole.bottom);
  cycle_dwell(value_of(call, 5, 0.0, "DTB"));
  set_speed_to(out);
  turn_spindle(-direction);
  cycle_move({Feed::Kind::per_minute, std::abs(pitch) * out}, hole.clearance);
  const double SDAC = value_of(call, 6, 5.0, "SDAC");
  turn_spindle(SDAC == 3.0 ? 1 : SDAC == 4.0 ? -1 : 0);
  if (before) set_speed_to(*before);
  cycle_move({}, hole.retract);
}

// Tapping with a compensating chuck: at the pitch, or at F where there is none.
void Translator::tap_840(const Call& call) {
  const Hole hole = hole_of(call);
  if (spindle_ == 0) fail(call.place, "CYCLE840 requires M3 or M4");
  const double pitch = std::abs(pitch_of(call, 9, 12));
  require_lengths_kept(call.name);
  if (pitch > 0.0 && (!speed_ || *speed_ <= 0.0)) fail(call.place, "CYCLE840 requires an active S");
  const Feed feed = pitch > 0.0 ? Feed{Feed::Kind::per_minute, pitch * *speed_} : modal_feed(1.0);
  const int direction = spindle_;
  const double SDR = value_of(call, 6, 0.0, "SDR");
  if (SDR != 0.0 && SDR != (direction > 0 ? 4.0 : 3.0)) {
    fail(call.place, "CYCLE840: SDR must reverse the spindle: 0, 4 after M3, or 3 after M4");
  }
  cycle_move({}, hole.clearance);
  cycle_move(feed, hole.bottom);
  cycle_dwell(value_of(call, 5, 0.0, "DTB"));
  turn_spindle(-direction);
  cycle_move(feed, hole.clearance);
  const double SDAC = value_of(call, 7, 0.0, "SDAC");
  turn_spindle(SDAC == 3.0 ? 1 : SDAC == 4.0 ? -1 : SDAC == 5.0 ? 0 : direction);
  cycle_move({}, hole.retract);
}

// In at FFR, out at RFF.
void Translator::ream_85(const Call& call) {
  const Hole hole = hole_of(call);
  const double FFR = value_of(call, 6, 0.0, "FFR"), RFF = value_of(call, 7, 0.0, "RFF");
  const Feed in = FFR > 0.0 ? cycle_feed(FFR) : modal_feed();
  cycle_move({}, hole.clearance);
  cycle_move(in, hole.bottom);
  cycle_dwell(value_of(call, 5, 0.0, "DTB"));
  cycle_move(RFF > 0.0 ? cycle_feed(RFF) : in, hole.clearance);
  cycle_move({}, hole.retract);
}

// The spindle stops in an orientation, and the tool leaves the wall by RPA, RPO and RPAP.
void Translator::bore_86(const Call& call) {
  const Hole hole = hole_of(call);
  const auto centre = program_point(modes_.normal);
  if (!centre) fail(call.place, "CYCLE86: the position in the plane is unknown here");
  const double SDIR = value_of(call, 6, 3.0, "SDIR");
  turn_spindle(SDIR == 4.0 ? -1 : 1);
  cycle_move({}, hole.clearance);
  cycle_move(modal_feed(), hole.bottom);
  cycle_dwell(value_of(call, 5, 0.0, "DTB"));
  turn_spindle(0);
  const auto axes = plane_axes(modes_.normal);
  std::array<std::optional<double>, 3> away{}, back{};
  for (std::size_t i = 0; i < 2; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    away[axes[i]] = (*centre)[k] + value_of(call, 7 + i, 0.0, "RPA and RPO") * unit();
    back[axes[i]] = (*centre)[k];
  }
  away[static_cast<std::size_t>(modes_.normal)] =
      hole.bottom + value_of(call, 9, 0.0, "RPAP") * unit();
  const bool leaves = away != back && (value_of(call, 7, 0.0, "RPA") != 0.0 ||
                                       value_of(call, 8, 0.0, "RPO") != 0.0 ||
                                       value_of(call, 9, 0.0, "RPAP") != 0.0);
  if (leaves) cycle_move({}, away);
  cycle_move({}, hole.clearance);
  cycle_move({}, hole.retract);
  if (leaves) cycle_move({}, back);
  turn_spindle(SDIR == 4.0 ? -1 : 1);
}

// The spindle stops at the depth and the program waits for the operator; CYCLE88 dwells before.
void Translator::bore_88(const Call& call) {
  const Hole hole = hole_of(call);
  const bool has_dwell = call.name == "CYCLE88";
  const double SDIR = value_of(call, has_dwell ? 6 : 5, 3.0, "SDIR");
  turn_spindle(SDIR == 4.0 ? -1 : 1);
  cycle_move({}, hole.clearance);
  cycle_move(modal_feed(), hole.bottom);
  if (has_dwell) cycle_dwell(value_of(call, 5, 0.0, "DTB"));
  turn_spindle(0);
  note("M0");
  cycle_move({}, hole.retract);
}

// In and out at F.
void Translator::bore_89(const Call& call) {
  const Hole hole = hole_of(call);
  cycle_move({}, hole.clearance);
  cycle_move(modal_feed(), hole.bottom);
  cycle_dwell(value_of(call, 5, 0.0, "DTB"));
  cycle_move(modal_feed(), hole.clearance);
  cycle_move({}, hole.retract);
}

}  // namespace servomill::controllers::siemens
