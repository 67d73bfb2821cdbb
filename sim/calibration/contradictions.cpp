#include "sim/calibration/contradictions.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "plant/vocabulary/progress.h"

namespace servomill::sim::calibration {
namespace {

using readings::Group;
using Squares = std::function<double(const Observations&)>;

constexpr double kContradiction = 6.0;  // standard deviations of the whitened squares
constexpr double kMuchBetter = 0.3;     // of the contradiction is left by the right factor
constexpr double kAsGood = 0.05;        // of the contradiction, beside the best explanation
// Numbers that are made small agree with everything: they are none of these.
constexpr double kFactors[] = {-1.0, 1e3, 25.4};

// Numbers of spheres are places; none of them has a sign or unit of its own.
bool has_factor(const Group& group) { return !readings::is_of_spheres(group.kind); }

class Search {
 public:
  Search(const Observations& observations, const Adjustment& found, const Squares& squares)
      : observations_(observations), squares_(squares), redundancy_(found.redundancy) {
    excess_ = found.squares - found.redundancy;
  }

  bool is_needed() const {
    return excess_ > kContradiction * std::sqrt(2.0 * std::max(redundancy_, 1.0));
  }

  // The best factor of these groups, if it explains the contradiction.
  void attempt(const std::vector<std::size_t>& groups, std::vector<Suspect>& out) const {
    Suspect best{.groups = groups, .squares = redundancy_ + kMuchBetter * excess_};
    const double limit = best.squares;
    for (const double factor : kFactors) {
      tried_.advance();
      const double squares = squares_(multiplied(groups, factor));
      if (squares < best.squares) best = {groups, factor, squares};
    }
    if (best.squares < limit) out.push_back(std::move(best));
  }

  // Leaves the best explanations.
  void keep_best(std::vector<Suspect>& out) const {
    double best = std::numeric_limits<double>::infinity();
    for (const Suspect& one : out) best = std::min(best, one.squares);
    std::erase_if(out, [&](const Suspect& one) { return one.squares > best + kAsGood * excess_; });
  }

 private:
  // Multiplies the numbers of the file, not their corrections.
  Observations multiplied(const std::vector<std::size_t>& groups, double factor) const {
    Observations out = observations_;
    for (Observation& one : out.all) {
      if (std::find(groups.begin(), groups.end(), one.group) == groups.end()) continue;
      one.d = factor * (one.d - one.correction) + one.correction;
    }
    return out;
  }

  const Observations& observations_;
  const Squares& squares_;
  double redundancy_;
  double excess_ = 0.0;
  mutable Stage tried_{"factors tried", 0.0, Steps::unlike};
};

}  // namespace

std::vector<Suspect> contradictions(const readings::Readings& readings,
                                    const Observations& observations, const Adjustment& found,
                                    const Squares& squares) {
  std::vector<Suspect> out;
  const Search search(observations, found, squares);
  if (!search.is_needed()) return out;
  const std::vector<Group>& groups = readings.groups;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (has_factor(groups[g])) search.attempt({g}, out);
  }
  std::vector<bool> is_tried(groups.size(), false);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (is_tried[g] || !has_factor(groups[g])) continue;
    std::vector<std::size_t> alike;
    for (std::size_t other = g; other < groups.size(); ++other) {
      const Group& one = groups[other];
      if (one.kind != groups[g].kind || one.axis != groups[g].axis ||
          one.direction != groups[g].direction) {
        continue;
      }
      is_tried[other] = true;
      alike.push_back(other);
    }
    if (alike.size() > 1) search.attempt(alike, out);
  }
  search.keep_best(out);
  return out;
}

}  // namespace servomill::sim::calibration
