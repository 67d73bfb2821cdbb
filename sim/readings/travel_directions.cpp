#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "sim/readings/read_rows.h"

namespace servomill::sim::readings {
namespace {

constexpr double kSlack = 1e-9;  // m, rad

int sign_of(double x) { return std::abs(x) < kSlack ? 0 : x > 0.0 ? 1 : -1; }

void set_on_circle(Group& group, const JointLayout& layout, const std::vector<int>& travel) {
  const int a = *layout.joint_of(group.plane[0]), b = *layout.joint_of(group.plane[1]);
  for (std::size_t i = 0; i < travel.size(); ++i) {
    Reading& reading = group.rows[i];
    reading.direction[std::size_t(a)] = -travel[i] * sign_of(reading.Q[b] - group.at[b]);
    reading.direction[std::size_t(b)] = travel[i] * sign_of(reading.Q[a] - group.at[a]);
  }
}

void set_on_path(Group& group, const std::vector<int>& travel) {
  const Joints path = group.rows.back().Q - group.rows.front().Q;
  for (std::size_t i = 0; i < travel.size(); ++i) {
    for (int j = 0; j < kJoints; ++j) {
      group.rows[i].direction[std::size_t(j)] = travel[i] * sign_of(path[j]);
    }
  }
}

// The one rotary joint at which rows differ, or nothing.
std::optional<int> turning_joint(const Group& group) {
  std::optional<int> found;
  for (int j = kLinearJoints; j < kJoints; ++j) {
    const bool turns =
        std::any_of(group.rows.begin(), group.rows.end(), [&](const Reading& reading) {
          return std::abs(reading.Q[j] - group.rows.front().Q[j]) > kSlack;
        });
    if (turns && found) return std::nullopt;
    if (turns) found = j;
  }
  return found;
}

// Linear axes follow the rotary one: their direction is that from the place before to the one
// behind it, in the order of its angles.
void set_while_turning(Group& group, int joint, const std::vector<int>& travel) {
  std::vector<const Reading*> by_angle;
  for (const Reading& reading : group.rows) by_angle.push_back(&reading);
  const auto less = [joint](const Reading* x, const Reading* y) {
    return x->Q[joint] < y->Q[joint] - kSlack;
  };
  std::stable_sort(by_angle.begin(), by_angle.end(), less);
  for (std::size_t i = 0; i < travel.size(); ++i) {
    Reading& reading = group.rows[i];
    const auto same = std::equal_range(by_angle.begin(), by_angle.end(), &reading, less);
    const Reading* before = same.first == by_angle.begin() ? &reading : *(same.first - 1);
    const Reading* behind = same.second == by_angle.end() ? &reading : *same.second;
    for (int j = 0; j < kJoints; ++j) {
      reading.direction[std::size_t(j)] = travel[i] * sign_of(behind->Q[j] - before->Q[j]);
    }
  }
}

}  // namespace

std::optional<int> direction_of(std::string_view word) {
  static const std::set<std::string_view> kUp = {"forward", "up", "positive", "pos", "fwd",
                                                 "+",       "1",  "+1",       "ccw"};
  static const std::set<std::string_view> kDown = {"backward", "down", "negative", "neg",
                                                   "bwd",      "-",    "-1",       "cw"};
  std::string lower(word);
  for (char& c : lower) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  if (kUp.contains(lower)) return 1;
  if (kDown.contains(lower)) return -1;
  return std::nullopt;
}

void set_directions(Group& group, const JointLayout& layout, const std::vector<int>& travel) {
  if (group.rows.size() != travel.size()) return;  // a fault was found
  if (std::all_of(travel.begin(), travel.end(), [](int one) { return one == 0; })) return;
  if (group.kind == Kind::circle) return set_on_circle(group, layout, travel);
  if (group.axis) {
    const auto joint = std::size_t(*layout.joint_of(*group.axis));
    for (std::size_t i = 0; i < travel.size(); ++i) group.rows[i].direction[joint] = travel[i];
    return;
  }
  if (group.kind == Kind::positioning) return set_on_path(group, travel);
  const auto joint = turning_joint(group);
  const bool follows = group.kind == Kind::r_test || group.kind == Kind::ball_bar;
  if (joint && follows) return set_while_turning(group, *joint, travel);
  group.directions_unused = true;
}

}  // namespace servomill::sim::readings
