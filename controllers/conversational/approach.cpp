// Approach to and departure from a contour: APPR and DEP.
#include <fmt/format.h>

#include "controllers/conversational/translator.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::conversational {
namespace {

struct Kind {
  std::string_view name;
  Run::Kind kind;
  bool is_polar;
};

constexpr auto kKinds = std::to_array<Kind>({{"LT", Run::Kind::LT, false},
                                             {"LN", Run::Kind::LN, false},
                                             {"CT", Run::Kind::CT, false},
                                             {"LCT", Run::Kind::LCT, false},
                                             {"PLT", Run::Kind::LT, true},
                                             {"PLN", Run::Kind::LN, true},
                                             {"PCT", Run::Kind::CT, true},
                                             {"PLCT", Run::Kind::LCT, true}});

const Kind& kind_of(const HeidenhainBlock& block) {
  for (const Kind& kind : kKinds) {
    if (block.words.size() > 1 && block.words[1].text == kind.name) return kind;
  }
  throw InputError(block.place,
                   fmt::format("{} must be followed by LT, LN, CT or LCT, or by one of "
                               "them with P for polar coordinates",
                               block.words.front().text));
}

}  // namespace

// Reads LEN15, R+10, CCA180 and the positioning words after them.
std::pair<Run, Positioning> Translator::read_run(const HeidenhainBlock& block, Run::Kind kind,
                                                 std::string_view name) {
  Words words(std::span(block.words).subspan(2));
  Run run;
  run.kind = kind;
  run.place = place_;
  const auto LEN = words.take_number("LEN");
  const auto CCA = words.take_number("CCA");
  if (words.take("R0") != nullptr) {
    fail(
        fmt::format("{} with R0: iTNC 530 and TNC 640 behave differently; program RL or RR", name));
  }
  const auto R = words.take_number("R");
  if (LEN) run.length = length(*LEN) * frame_.scale;
  if (CCA) run.angle = value(*CCA) * deg;
  if (R) run.radius = length(*R) * frame_.scale;
  if (LEN && !(run.length > 0.0)) fail(LEN->place, fmt::format("{}: LEN must be > 0", name));
  if (CCA && !(run.angle > 0.0 && run.angle <= 2.0 * 180.0 * deg)) {
    fail(CCA->place, fmt::format("{}: CCA must be in 0 ... 360", name));
  }
  if (R && run.radius == 0.0) fail(R->place, fmt::format("{}: R must not be 0", name));
  Positioning p = read_positioning(words, name);
  words.refuse_rest(name);
  const bool is_line = kind == Run::Kind::LT || kind == Run::Kind::LN;
  if (is_line && run.length == 0.0) fail(fmt::format("{} requires LEN", name));
  if (!is_line && run.radius == 0.0) fail(fmt::format("{} requires R", name));
  if (kind == Run::Kind::CT && run.angle == 0.0) fail(fmt::format("{} requires CCA", name));
  return {std::move(run), std::move(p)};
}

void Translator::approach(const HeidenhainBlock& block) {
  const Kind& kind = kind_of(block);
  const std::string name = fmt::format("APPR {}", kind.name);
  auto [run, p] = read_run(block, kind.kind, name);
  if (kind.kind == Run::Kind::LCT && run.radius < 0.0) fail(fmt::format("{}: R must be > 0", name));
  require_arc(p);
  if (!p.side || *p.side == 0) {
    fail(fmt::format("{} requires RL or RR", name));
  }
  if (side_ != 0) fail(fmt::format("{} requires R0; cancel RL or RR first", name));
  if (kind.is_polar) {
    if (!p.polar_radius && !p.polar_angle) fail(fmt::format("{} requires PR or PA", name));
    if (pole_normal_ != 2) fail(fmt::format("{} requires a pole (CC) in the XY plane", name));
    set_program_point(p, 2, *polar_point(p, 2));
  }
  const auto start = work_point(2);
  if (!start) fail(fmt::format("{}: the position in the plane is unknown here", name));
  run.start = *start;
  begin_functions(p);
  set_side(p);
  // from the present position to the auxiliary point: the feed programmed last, rapid after FMAX;
  // APPR LCT: F of its own block. TNC 640 (34059x-05) ISO p. 213
  run.first = was_rapid_ || (!feed_ && !p.feed) ? Feed{} : feed_ ? modal_feed() : *p.feed;
  run.feed = feed_of(p);
  if (kind.kind == Run::Kind::LCT && run.first.kind != Feed::Kind::rapid) run.first = run.feed;
  run.side = frame_.is_mirrored_in_plane() ? -side_ : side_;
  tool_radius(place_);
  bool is_incremental = false;
  const Values end = ends(p, is_incremental);
  if (is_incremental)
    fail(fmt::format("{}: the position is unknown here; program absolute coordinates", name));
  if (end[2]) run.depth = *end[2] + delta_length_;
  for (std::size_t i = 0; i < end.size(); ++i) {
    if (end[i]) work_[i] = end[i];
  }
  path_.approach(run);
  last_element_.reset();
  end_functions(p);
}

void Translator::depart(const HeidenhainBlock& block) {
  const Kind& kind = kind_of(block);
  const std::string name = fmt::format("DEP {}", kind.name);
  auto [run, p] = read_run(block, kind.kind, name);
  if (p.target[2]) {
    fail(
        fmt::format("{} with Z: controls differ, some move Z during the departure, others after "
                    "it; program Z in the next block",
                    name));
  }
  require_arc(p);
  if (kind.kind == Run::Kind::LCT) {
    if (kind.is_polar) set_program_point(p, 2, *polar_point(p, 2));
    bool is_incremental = false;
    const Values end = ends(p, is_incremental);
    const auto now = work_point(2);
    if (!now || is_incremental) fail(fmt::format("{}: the position is unknown here", name));
    run.target = Point(end[0].value_or(now->x()), end[1].value_or(now->y()));
  } else if (p.has_target()) {
    fail(fmt::format("{} does not accept coordinates", name));
  }
  begin_functions(p);
  run.feed = feed_of(p);
  const Point end = path_.depart(run);
  side_ = 0;
  work_[0] = end.x();
  work_[1] = end.y();
  last_element_.reset();
  end_functions(p);
}

}  // namespace servomill::controllers::conversational
