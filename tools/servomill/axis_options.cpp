#include "tools/servomill/axis_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <sstream>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/config/option_value.h"
#include "sim/input/read_scenario.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"

namespace servomill::tools {

namespace po = boost::program_options;

void add_axis_options(Options& options) {
  options.add()("axis,a", po::value<std::string>()->value_name("Y"),
                "axis, several axes (X,Y), or all");
  options.add()("case", po::value<std::string>()->value_name("NAME"),
                "uses the machine of this case of the scenario");
  add_plugin_option(options);
  options.add()("set", po::value<std::vector<std::string>>()->value_name("KEY=VALUE"),
                "changes a key of the scenario, as for servomill run, such as "
                "machine_override.axis.Y.Kv=\"4 m/min/mm\"");
}

void restrict_to_case(const Options& options, sim::model::Scenario& scenario) {
  if (!options.has("case")) return;
  const auto& name = options.get<std::string>("case");
  const sim::model::CaseSpec* found = scenario.find_case(name);
  if (found == nullptr) {
    std::vector<std::string_view> names;
    for (const sim::model::CaseSpec& one : scenario.cases) names.push_back(one.name);
    throw InputError({"--case"}, fmt::format("the scenario has no case '{}'{}; it has {}", name,
                                             did_you_mean(name, names), fmt::join(names, ", ")));
  }
  const sim::model::CaseSpec one = *found;
  scenario.machine = scenario.machine_of(one);
  scenario.cases = {one};
}

std::shared_ptr<const sim::model::Scenario> scenario_for_axes(const Options& options) {
  load_plugins(options);
  const auto scenario = std::make_shared<sim::model::Scenario>(
      sim::input::read_scenario(options.word(), options.list("set")));
  restrict_to_case(options, *scenario);
  return scenario;
}

std::vector<int> chosen_joints(const Options& options, const sim::model::MachineSettings& machine) {
  const JointLayout& layout = machine.chain.layout;
  std::vector<std::string> letters;
  for (const int j : machine.joints()) letters.emplace_back(1, layout.letter_of(j));
  const std::string there_are = fmt::format("the machine has {}", fmt::join(letters, ", "));
  if (!options.has("axis")) {
    throw InputError({"--axis"}, fmt::format("is missing; {}", there_are));
  }
  const auto& text = options.get<std::string>("axis");
  if (text == "all") return machine.joints();
  std::vector<int> joints;
  std::stringstream words(text);
  std::string word;
  constexpr std::array<std::string_view, 1> kAll = {"all"};
  while (std::getline(words, word, ',')) {
    const auto axis = word.size() == 1 ? axis_of(word.front()) : std::nullopt;
    const auto joint = axis ? layout.joint_of(*axis) : std::nullopt;
    if (!joint) {
      throw InputError(
          {"--axis"}, fmt::format("no axis '{}'{}; {}", word, did_you_mean(word, kAll), there_are));
    }
    if (std::find(joints.begin(), joints.end(), *joint) == joints.end()) joints.push_back(*joint);
  }
  if (joints.empty()) throw InputError({"--axis"}, fmt::format("is empty; {}", there_are));
  return joints;
}

std::optional<double> quantity_option(const Options& options, const std::string& name,
                                      sim::config::Quantity quantity, std::string_view bare_unit) {
  if (!options.has(name)) return std::nullopt;
  const auto& text = options.get<std::string>(name);
  const sim::config::ScaledText scaled = sim::config::scale_option(text, quantity, bare_unit);
  if (scaled.complaint.empty()) return scaled.si;
  throw InputError({"--" + name},
                   fmt::format("'{}'{} {}", text, scaled.complaint.front() == '\'' ? ":" : "",
                               scaled.complaint));
}

std::optional<double> positive_option(const Options& options, const std::string& name,
                                      sim::config::Quantity quantity, std::string_view bare_unit) {
  const auto value = quantity_option(options, name, quantity, bare_unit);
  if (value && !(*value > 0.0)) {
    throw InputError({"--" + name},
                     fmt::format("'{}' must be > 0", options.get<std::string>(name)));
  }
  return value;
}

std::optional<double> retract_option(const Options& options) {
  if (!options.has("retract")) return std::nullopt;
  const auto& text = options.get<std::string>("retract");
  const bool names_Z = text.size() > 2 && (text[0] == 'Z' || text[0] == 'z') && text[1] == '=';
  if (names_Z) {
    const sim::config::ScaledText scaled =
        sim::config::scale_option(text.substr(2), sim::config::kLength, "mm");
    if (scaled.complaint.empty()) return scaled.si;
  }
  throw InputError({"--retract " + text},
                   "must be Z=NUMBER, a machine coordinate, such as Z=-5 (in mm) or \"Z=-5 mm\"");
}

std::string_view bare_unit(sim::config::Quantity quantity) {
  if (quantity == sim::config::kLength) return "mm";
  if (quantity == sim::config::kVelocity) return "mm/s";
  if (quantity == sim::config::kForce) return "N";
  if (quantity == sim::config::kAngle) return "deg";
  if (quantity == sim::config::kAngularVelocity) return "deg/s";
  assert(quantity == sim::config::kTorque);
  return "Nm";
}

double positive_number(const Options& options, const std::string& name) {
  const double value = options.get<double>(name);
  if (value > 0.0 && std::isfinite(value)) return value;
  throw InputError({"--" + name}, fmt::format("{:g}; must be > 0", value));
}

double decibel_option(const Options& options, const std::string& name) {
  const auto& text = options.get<std::string>(name);
  std::string_view number = text;
  if (number.ends_with("dB")) number.remove_suffix(2);
  while (number.ends_with(' ')) number.remove_suffix(1);
  const auto value = sim::config::plain_number(number);
  if (value && *value > 0.0) return *value;
  throw InputError({"--" + name},
                   fmt::format("'{}' must be a ratio > 0 dB such as \"8 dB\"", text));
}

std::size_t choice_option(const Options& options, const std::string& name,
                          std::span<const std::string_view> words) {
  const auto& word = options.get<std::string>(name);
  const auto found = std::find(words.begin(), words.end(), word);
  if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
  throw InputError({"--" + name}, fmt::format("'{}' is not allowed; must be one of {}{}", word,
                                              fmt::join(words, ", "), did_you_mean(word, words)));
}

std::string axis_headline(const sim::model::MachineSettings& machine, int joint,
                          Tick reading_delay) {
  const sim::model::LoopPeriods& p = machine.nc.periods;
  const auto ms_of = [&](Tick ticks) { return p.seconds(ticks) / ms; };
  const controllers::CascadeParams& c = machine.nc.cascade[static_cast<std::size_t>(joint)];
  std::string out = fmt::format(
      "axis {} of {}: Kv {:.4g} 1/s, velocity loop {:.4g} rad/s{}, periods {:g}, {:g}, {:g} ms",
      machine.chain.layout.letter_of(joint), machine.name, c.Kv, c.Kp / c.J,
      c.Ki > 0.0 ? fmt::format(" with reset time {:.4g} ms", c.Kp / c.Ki / ms) : "",
      ms_of(p.position), ms_of(p.velocity), ms_of(p.current));
  if (reading_delay > 0)
    out += fmt::format(", feedback delay {:g} us", p.seconds(reading_delay) / us);
  return out;
}

double decibel(double ratio) { return 20.0 * std::log10(ratio); }

}  // namespace servomill::tools
