#include "controllers/path/chain_memory.h"

#include <bit>
#include <utility>

namespace servomill::controllers {
namespace {

// Calls visit(64 bits) for all that a plan depends on, until it returns false. Numbers of moves
// count from the first one: a plan only distinguishes them.
template <class Visit>
void look_at(const Polyline& vertices, const ChainSpeeds& speeds, Visit visit) {
  const std::uint32_t first = speeds.spans.empty() ? 0 : speeds.spans.front().move;
  bool goes_on = visit(std::uint64_t{vertices.size()});
  const auto whole = [&](std::uint64_t number) { goes_on = goes_on && visit(number); };
  const auto real = [&](double value) { whole(std::bit_cast<std::uint64_t>(value)); };
  for (std::size_t i = 0; goes_on && i < vertices.size(); ++i) {
    for (int j = 0; j < kJoints; ++j) real(vertices.u(i)[j]);
    real(vertices.speed(i));
    const Polyline::Traits& traits = vertices.traits(i);
    real(traits.tolerance_linear);
    real(traits.tolerance_rotary);
    whole(traits.arc < 0 ? 0 : static_cast<std::uint64_t>(traits.arc) - first + 1);
    whole(std::uint64_t{traits.is_exact});
  }
  whole(speeds.spans.size());
  for (std::size_t n = 0; goes_on && n < speeds.spans.size(); ++n) {
    const ChainSpeeds::Span& span = speeds.spans[n];
    for (const std::uint32_t number : {span.move - first, span.first, span.last, span.share,
                                       span.feed, std::uint32_t{span.rapid}}) {
      whole(number);
    }
  }
  whole(speeds.feeds.size());
  for (const FeedLimit& feed : speeds.feeds) {
    for (const double value : {feed.linear, feed.rotary, feed.path}) real(value);
  }
  whole(speeds.times.size());
  for (const double time : speeds.times) real(time);
}

// A step of MurmurHash3 for each number.
std::uint64_t number_of(const Polyline& vertices, const ChainSpeeds& speeds) {
  std::uint64_t hash = 0;
  look_at(vertices, speeds, [&hash](std::uint64_t number) {
    hash ^= number;
    hash = (hash ^ (hash >> 33U)) * 0xff51afd7ed558ccdULL;
    hash = (hash ^ (hash >> 33U)) * 0xc4ceb9fe1a85ec53ULL;
    hash ^= hash >> 33U;
    return true;
  });
  return hash;
}

bool is_of(const std::vector<std::uint64_t>& key, const Polyline& vertices,
           const ChainSpeeds& speeds) {
  std::size_t place = 0;
  bool same = true;
  look_at(vertices, speeds, [&](std::uint64_t number) {
    same = place < key.size() && key[place] == number;
    ++place;
    return same;
  });
  return same && place == key.size();
}

}  // namespace

ChainMemory::Plan ChainMemory::plan(const Polyline& vertices, const ChainSpeeds& speeds,
                                    const std::function<Plan()>& make) {
  const auto [place, is_new] = known_.try_emplace(number_of(vertices, speeds));
  if (is_new) return make();
  std::unique_ptr<Known>& known = place->second;
  if (known != nullptr) return is_of(known->key, vertices, speeds) ? known->plan : make();
  known = std::make_unique<Known>();
  look_at(vertices, speeds, [&](std::uint64_t number) {
    known->key.push_back(number);
    return true;
  });
  known->plan = make();
  return known->plan;
}

}  // namespace servomill::controllers
