#include "plant/cutting/removed_volume.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

#include "plant/cutting/chord_margin.h"
#include "plant/cutting/step_crossing.h"
#include "plant/vocabulary/interrupt.h"

namespace servomill::plant {
namespace {

using Eigen::Array3d;
using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNothing = 1e-9;  // m
constexpr std::uint32_t kRunSteps = 64;
constexpr std::size_t kRunMargins = kRunSteps - 1;  // parts of two steps and more

// Not below x.
float rounded_up(double x) {
  return std::nextafter(static_cast<float>(x), std::numeric_limits<float>::infinity());
}

// From the nearest point of a node's box to x.
template <class Node>
Array3d away(const Array3d& x, const Node& node) {
  return x - x.max(node.low).min(node.high);
}

template <class Node>
bool nearer(const Array3d& x, const Node& a, const Node& b) {
  const double of_a = away(x, a).square().sum(), of_b = away(x, b).square().sum();
  if (of_a != of_b) return of_a < of_b;
  return (2.0 * x - a.low - a.high).square().sum() <= (2.0 * x - b.low - b.high).square().sum();
}

// Returns true if a ray beyond `from` may come as near to the box of a node as its radius.
template <class Node>
bool meets(const Ray& ray, double from, const Node& node) {
  const Array3d x = ray.at(from), d = ray.direction, apart = away(x, node);
  const double distance_2 = apart.square().sum(), radius_2 = node.radius * node.radius;
  if (distance_2 <= radius_2) return true;
  if ((apart * d).sum() >= 0.0) return false;  // the distance is convex
  double to = ray.length;
  for (int i = 0; i < 3; ++i) {
    const double low = node.low[i] - node.radius, high = node.high[i] + node.radius;
    const double o = ray.start[i];
    if (d[i] == 0.0) {
      if (o < low || o > high) return false;
      continue;
    }
    const double a = (low - o) / d[i], b = (high - o) / d[i];
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
  return from <= to;
}

struct Halves {
  std::uint32_t middle;
  std::size_t left, right;
};

Halves halves(std::size_t node, std::uint32_t first, std::uint32_t last) {
  return {first + (last - first) / 2, 2 * node + 1, 2 * node + 2};
}

}  // namespace

RemovedVolume::RemovedVolume(const std::vector<CutterPass>& passes) {
  for (const CutterPass& pass : passes) add(pass);
  if (runs_.empty()) return;
  margins_.resize(runs_.size() * kRunMargins);
  for (const Run& run : runs_) add_margins(run, 0, run.first, run.last);
  std::vector<std::uint32_t> order(runs_.size());
  std::iota(order.begin(), order.end(), 0U);
  nodes_.reserve(2 * runs_.size());
  add_node(order.data(), order.data() + order.size());
}

// The first place of a pass is there twice, so that what a single position removes is a step, too.
void RemovedVolume::add(const CutterPass& pass) {
  if (pass.positions.empty()) return;
  assert(implausible(pass.cutter).empty());
  const auto first_place = static_cast<std::uint32_t>(places_.size());
  const double reach = envelope(pass.cutter).reach();
  cutters_.push_back(pass.cutter);
  places_.push_back(pass.positions.front());
  const CutterPosition* before = &pass.positions.front();
  for (const CutterPosition& position : pass.positions) {
    throw_if_interrupted();
    assert(position.tip.allFinite() && std::abs(position.axis.norm() - 1.0) < 1e-9);
    assert(before->axis.dot(position.axis) > 0.0);
    const double deviation = turn_deviation(*before, position, reach);
    const double parts = std::ceil(std::sqrt(deviation / kTurnTolerance));
    for (double part = 1.0; part < parts; ++part) {
      places_.push_back(between(*before, position, part / parts));
    }
    assert(places_.size() < std::numeric_limits<std::uint32_t>::max());
    place_of_.push_back(static_cast<std::uint32_t>(places_.size()));
    places_.push_back(position);
    before = &position;
  }
  add_runs(first_place);
}

void RemovedVolume::add_runs(std::uint32_t first_place) {
  const auto last_place = static_cast<std::uint32_t>(places_.size() - 1);
  const auto cutter = static_cast<std::uint32_t>(cutters_.size() - 1);
  for (std::uint32_t first = first_place; first < last_place; first += kRunSteps) {
    const std::uint32_t last = std::min(first + kRunSteps, last_place);
    runs_.push_back({first, last, cutter, places_[first], places_[last]});
  }
}

void RemovedVolume::add_margins(const Run& run, std::size_t node, std::uint32_t first,
                                std::uint32_t last) {
  if (last - first < 2) return;
  const std::size_t r = static_cast<std::size_t>(&run - runs_.data());
  margins_[r * kRunMargins + node] = rounded_up(
      distance_from_chord(&places_[first], &places_[last], envelope(cutters_[run.cutter])));
  const auto [middle, left, right] = halves(node, first, last);
  add_margins(run, left, first, middle);
  add_margins(run, right, middle, last);
}

RemovedVolume::Node RemovedVolume::box_of(const Run& run) const {
  const Envelope body = envelope(cutters_[run.cutter]);
  Node node;
  node.low = Array3d::Constant(kInfinity);
  node.high = -node.low;
  node.radius = body.corner + 2.0 * kTurnTolerance;
  node.first_step = run.first;
  node.right = 0;
  node.run = static_cast<std::uint32_t>(&run - runs_.data());
  for (std::uint32_t place = run.first; place <= run.last; ++place) {
    const auto& [tip, axis] = places_[place];
    const Array3d disc = body.disc * (1.0 - axis.array().square()).max(0.0).sqrt();
    const Array3d centre = tip + body.centre * axis, top = tip + body.top * axis;
    node.low = node.low.min(centre.min(top) - disc);
    node.high = node.high.max(centre.max(top) + disc);
  }
  return node;
}

// Runs are halved at the middle of the longest side of the box of their centres.
std::uint32_t RemovedVolume::add_node(std::uint32_t* begin, std::uint32_t* end) {
  const auto number = static_cast<std::uint32_t>(nodes_.size());
  if (end - begin == 1) {
    nodes_.push_back(box_of(runs_[*begin]));
    return number;
  }
  const auto centre = [&](std::uint32_t run) {
    return places_[(runs_[run].first + runs_[run].last) / 2].tip.array();
  };
  Array3d low = centre(*begin), high = low;
  for (const std::uint32_t* run = begin; run != end; ++run) {
    low = low.min(centre(*run));
    high = high.max(centre(*run));
  }
  Eigen::Index side = 0;
  (high - low).maxCoeff(&side);
  std::uint32_t* middle = begin + (end - begin) / 2;
  std::nth_element(begin, middle, end, [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(centre(a)[side], a) < std::pair(centre(b)[side], b);
  });
  nodes_.emplace_back();
  const std::uint32_t left = add_node(begin, middle), right = add_node(middle, end);
  nodes_[number] = {nodes_[left].low.min(nodes_[right].low),
                    nodes_[left].high.max(nodes_[right].high),
                    std::max(nodes_[left].radius, nodes_[right].radius),
                    std::min(nodes_[left].first_step, nodes_[right].first_step),
                    right,
                    0};
  return number;
}

SweptCutter RemovedVolume::swept(const Run& run, std::size_t run_node, std::uint32_t first,
                                 std::uint32_t last) const {
  const std::size_t r = static_cast<std::size_t>(&run - runs_.data());
  const double margin =
      last - first > 1 ? static_cast<double>(margins_[r * kRunMargins + run_node]) : 0.0;
  return {envelope(cutters_[run.cutter], margin), places_[first], places_[last]};
}

bool RemovedVolume::contains(const Vector3d& point) const {
  return contains(point, position_count());
}

bool RemovedVolume::contains(const Vector3d& point, std::size_t n) const {
  assert(n <= position_count());
  if (n == 0) return false;
  const std::uint32_t end = place_of_[n - 1];  // steps before this one
  const Array3d x = point.array();
  std::uint32_t waiting[64];  // the tree is balanced: no deeper than 32
  std::size_t count = 0;
  waiting[count++] = 0;
  while (count > 0) {
    const std::uint32_t number = waiting[--count];
    const Node& node = nodes_[number];
    if (node.first_step >= end || away(x, node).square().sum() > node.radius * node.radius)
      continue;
    if (node.right == 0) {
      if (run_contains(node.run, point, end)) return true;
    } else {
      waiting[count++] = node.right;
      waiting[count++] = number + 1;
    }
  }
  return false;
}

bool RemovedVolume::run_contains(std::uint32_t number, const Vector3d& point,
                                 std::uint32_t end) const {
  const Run& run = runs_[number];
  struct Waiting {
    std::size_t node;
    std::uint32_t first, last;
  };
  Waiting waiting[16];  // a run is halved six times
  std::size_t count = 0;
  waiting[count++] = {0, run.first, run.last};
  while (count > 0) {
    const auto [node, first, last] = waiting[--count];
    if (first >= end) continue;
    const bool bounded = last - first == 1 || std::isfinite(margins_[number * kRunMargins + node]);
    if (bounded && !swept(run, node, first, last).contains(point)) continue;
    if (last - first == 1) return true;
    const auto [middle, left, right] = halves(node, first, last);
    waiting[count++] = {left, first, middle};
    waiting[count++] = {right, middle, last};
  }
  return false;
}

// On the way along a ray: everything up to `end` is removed once the start is known to be.
struct RemovedVolume::Advance {
  struct Stretch {
    double from, to;
    std::uint32_t step;
  };
  bool inside = false;
  double end = 0.0;
  std::uint32_t step = 0;
  std::vector<Stretch> beyond;  // not connected yet

  // Bodies that reach this far matter. The start must be found to be inside first.
  bool wants(double bound) const { return bound >= (inside ? end + kNothing : 0.0); }

  bool joins(const Stretch& stretch) {
    if (stretch.from > end + kNothing) return false;
    inside = true;
    if (stretch.to > end) end = stretch.to, step = stretch.step;
    return true;
  }
};

// As the axis turns, the part's body may be off by what a ray's points are away from the middle of
// where it may be left: a first bound makes that shorter for a second one.
RemovedVolume::Part RemovedVolume::bounded(Part part, const Ray& ray, double beyond) const {
  const double margin = static_cast<double>(margins_[part.run * kRunMargins + part.node]);
  part.bound = kInfinity;
  if (!std::isfinite(margin)) return part;
  const Run& run = runs_[part.run];
  const CutterPosition& a = part.node == 0 ? run.from : places_[part.first];
  const CutterPosition& b = part.node == 0 ? run.to : places_[part.last];
  const double turn = chord_of_turn(a, b);
  double to = ray.length;
  for (int i = 0; i < 2; ++i) {
    const double half = 0.5 * (to - beyond), off = turn * half;
    const SweptCutter body(envelope(cutters_[run.cutter], margin + off), a, b);
    part.bound = body.leave_bound(ray, beyond + half, beyond);
    if (off < kNothing || part.bound < beyond || part.bound >= to) break;
    to = part.bound;
  }
  return part;
}

void RemovedVolume::pass_step(const Part& part, const Ray& ray, Advance& state) const {
  const SweptCutter step(envelope(cutters_[runs_[part.run].cutter]), places_[part.first],
                         places_[part.last]);
  const double to = leave_step(step, ray);
  if (!state.wants(to)) return;
  const double from = enter_step(step, ray, to);
  if (from > ray.length) return;
  const Advance::Stretch stretch = {from, to, part.first};
  if (!state.joins(stretch)) state.beyond.push_back(stretch);
}

RemovedVolume::Part RemovedVolume::whole(std::uint32_t run) const {
  return {kInfinity, run, 0, runs_[run].first, runs_[run].last};
}

void RemovedVolume::pass(const Part& whole, const Ray& ray, Advance& state) const {
  Part waiting[16];  // a run is halved six times
  std::size_t count = 0;
  waiting[count++] = whole;
  while (count > 0) {
    const Part part = waiting[--count];
    if (!state.wants(part.bound)) continue;
    if (part.last - part.first == 1) {
      pass_step(part, ray, state);
      continue;
    }
    const auto [middle, left, right] = halves(part.node, part.first, part.last);
    const std::size_t before = count;
    for (Part half :
         {Part{part.bound, part.run, static_cast<std::uint32_t>(left), part.first, middle},
          Part{part.bound, part.run, static_cast<std::uint32_t>(right), middle, part.last}}) {
      if (half.last - half.first > 1) half = bounded(half, ray, state.end);
      if (state.wants(half.bound)) waiting[count++] = half;
    }
    // the one that reaches farther first: it may spare the other
    if (count == before + 2 && waiting[before].bound > waiting[before + 1].bound) {
      std::swap(waiting[before], waiting[before + 1]);
    }
  }
}

// Straight down to the run that is nearest to the start.
void RemovedVolume::pass_nearest(const Ray& ray, Advance& state) const {
  std::uint32_t number = 0;
  while (nodes_[number].right != 0) {
    const std::uint32_t left = number + 1, right = nodes_[number].right;
    number = nearer(ray.start, nodes_[left], nodes_[right]) ? left : right;
  }
  pass(bounded(whole(nodes_[number].run), ray, 0.0), ray, state);
}

std::vector<RemovedVolume::Part> RemovedVolume::runs_along(const Ray& ray, double beyond) const {
  std::vector<Part> parts;
  std::uint32_t waiting[64];
  std::size_t count = 0;
  waiting[count++] = 0;
  while (count > 0) {
    const std::uint32_t number = waiting[--count];
    const Node& node = nodes_[number];
    if (!meets(ray, beyond, node)) continue;
    if (node.right == 0) {
      const Part part = bounded(whole(node.run), ray, beyond);
      if (part.bound >= beyond) parts.push_back(part);
    } else {
      waiting[count++] = node.right;
      waiting[count++] = number + 1;
    }
  }
  return parts;
}

std::size_t RemovedVolume::position_of(std::uint32_t step) const {
  return static_cast<std::size_t>(std::lower_bound(place_of_.begin(), place_of_.end(), step + 1) -
                                  place_of_.begin());
}

// The nearest run is what ends the way but for little, so that few others can go on; of these, the
// one that reaches farthest comes first.
FreeWay RemovedVolume::free_way(const Ray& ray) const {
  throw_if_interrupted();
  if (nodes_.empty()) return {};
  Advance state;
  pass_nearest(ray, state);
  std::vector<Part> parts = runs_along(ray, state.end);
  std::sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) {
    return a.bound != b.bound ? a.bound > b.bound : a.first < b.first;
  });
  for (const Part& part : parts) {
    if (!state.wants(part.bound) || state.end >= ray.length) break;
    pass(part, ray, state);
  }
  // what was found before its connection to the start
  std::sort(state.beyond.begin(), state.beyond.end(),
            [](const auto& a, const auto& b) { return a.from < b.from; });
  for (const Advance::Stretch& stretch : state.beyond) {
    if (!state.joins(stretch)) break;
  }
  if (!state.inside) {
    return {state.beyond.empty() ? FreeWay::Kind::untouched : FreeWay::Kind::blocked, 0.0, 0, 0};
  }
  if (state.end >= ray.length) return {FreeWay::Kind::through, ray.length, 0, 0};
  return {FreeWay::Kind::ends, state.end, position_of(state.step), state.step};
}

double RemovedVolume::leave(const FreeWay& way, const Ray& ray) const {
  const auto run = std::upper_bound(runs_.begin(), runs_.end(), way.step,
                                    [](std::uint32_t step, const Run& r) { return step < r.last; });
  const CutterPosition *a = &places_[way.step], *b = a + 1;
  return leave_step(SweptCutter(envelope(cutters_[run->cutter]), *a, *b), ray);
}

}  // namespace servomill::plant
