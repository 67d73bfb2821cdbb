#include "controllers/path/polyline.h"

namespace servomill::controllers {

void Polyline::push_back(const PathVertex& vertex) {
  u_.push_back(vertex.u);
  speed_.push_back(vertex.speed);
  index_.push_back(
      index_of({vertex.tolerance_linear, vertex.tolerance_rotary, vertex.arc, vertex.is_exact}));
}

void Polyline::set_last_arc(int arc) {
  Traits traits = traits_[index_.back()];
  traits.arc = arc;
  index_.back() = index_of(traits);
}

void Polyline::clear() { *this = {}; }

// The last ones are those that come again: the inside of an arc, and its end.
std::uint32_t Polyline::index_of(const Traits& traits) {
  has_arcs_ = has_arcs_ || traits.arc >= 0;
  // Few, as it is asked for each vertex: a miss costs memory, never a result.
  constexpr std::size_t kLookedAt = 3;
  for (std::size_t back = 1; back <= kLookedAt && back <= traits_.size(); ++back) {
    const std::size_t i = traits_.size() - back;
    if (traits_[i] == traits) return static_cast<std::uint32_t>(i);
  }
  traits_.push_back(traits);
  return static_cast<std::uint32_t>(traits_.size() - 1);
}

}  // namespace servomill::controllers
