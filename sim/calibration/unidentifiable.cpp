#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "sim/calibration/calibration.h"

namespace servomill::sim::calibration {
namespace {

std::string list(const std::vector<std::string>& names) {
  if (names.size() == 1) return names.front();
  const std::vector<std::string> most(names.begin(), names.end() - 1);
  return fmt::format("{} and {}", fmt::join(most, ", "), names.back());
}

void add_once(std::vector<std::string>& names, const std::string& name) {
  if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
}

// "+ 0.3 EC0Y": factors in m and rad; one is not printed.
std::string term(double factor, const std::string& name) {
  const double size = std::abs(factor);
  const std::string sign = factor < 0.0 ? "-" : "+";
  if (std::abs(size - 1.0) < 1e-3) return fmt::format("{} {}", sign, name);
  return fmt::format("{} {:.3g} {}", sign, size, name);
}

bool is_error(const Unknowns& unknowns, int unknown) {
  return unknown >= unknowns.first_location();
}
bool is_location(const Unknowns& unknowns, int unknown) {
  return is_error(unknowns, unknown) && unknown < unknowns.first_function();
}

// Everything of a function that is left out, by what holds it.
struct LeftOutOfFunction {
  int functions = 0;                // of its basis that are left out
  std::vector<std::string> errors;  // that hold a part of it
  std::vector<std::string> set_up;
};

class Sentences {
 public:
  explicit Sentences(const Calibration& calibration)
      : calibration_(calibration), unknowns_(calibration.adjustment.unknowns) {
    for (const LeftOut& one : calibration.adjustment.left_out) {
      if (!is_error(unknowns_, one.unknown)) {
        add_set_up(one);
      } else if (is_location(unknowns_, one.unknown)) {
        add_location(one);
      } else {
        add_function(one);
      }
    }
  }

  std::vector<std::string> all() {
    for (const SoughtFunction& function : unknowns_.functions) {
      const auto found = functions_.find(plant::to_string(function.name));
      if (found != functions_.end()) add_sentence(found->first, function.basis, found->second);
    }
    for (const SoughtGrid& grid : unknowns_.grids) {
      const auto found = functions_.find(name_of(grid));
      if (found != functions_.end()) add_sentence(found->first, grid.basis, found->second);
    }
    add_hardly_determined();
    if (!without_effect_.empty()) {
      out_.push_back(fmt::format("no reading depends on {}", list(without_effect_)));
    }
    add_unmoved();
    return std::move(out_);
  }

 private:
  std::string name(int unknown) const { return unknowns_.name(unknown, calibration_.readings); }

  // The first few of many.
  static std::string some(const std::vector<std::string>& names) {
    constexpr std::size_t kShown = 2;
    if (names.size() <= kShown + 1) return list(names);
    return fmt::format("{}, {} and {} more", names[0], names[1], names.size() - kShown);
  }

  // The parts that matter to a reader.
  static std::vector<NormalEquations::Part> shown(const LeftOut& one) {
    constexpr double kShown = 0.1;
    std::vector<NormalEquations::Part> out;
    double most = 0.0;
    for (const auto& part : one.parts) most = std::max(most, std::abs(part.share));
    for (const auto& part : one.parts) {
      if (std::abs(part.share) >= kShown * most) out.push_back(part);
    }
    return out;
  }

  // Errors of which the readings say little more than what was expected of them.
  void add_hardly_determined() {
    constexpr double kHardly = 0.5;  // of the expected standard deviation
    std::vector<std::string> whole, part;
    const Adjustment& adjustment = calibration_.adjustment;
    for (std::size_t k = 0; k < unknowns_.locations.size(); ++k) {
      const int unknown = unknowns_.first_location() + static_cast<int>(k);
      const SoughtLocation& location = unknowns_.locations[k];
      if (std::sqrt(adjustment.covariance(unknown, unknown)) > kHardly * location.size) {
        whole.push_back(plant::to_string(location.name));
      }
    }
    for (const KnownFunction& known : functions_along_travel(adjustment)) {
      std::size_t hardly = 0;
      for (std::size_t i = 0; i < known.s.size(); ++i) {
        hardly += known.sigma[i] > kHardly * known.expected[i] ? 1 : 0;
      }
      if (hardly == 0) continue;
      (hardly == known.s.size() ? whole : part).push_back(plant::to_string(known.name));
    }
    constexpr std::string_view kWhy = "its uncertainty is the prior one";
    if (!whole.empty()) out_.push_back(fmt::format("hardly determined: {}; {}", list(whole), kWhy));
    if (!part.empty()) {
      out_.push_back(fmt::format("hardly determined in places: {}; {} there", list(part), kWhy));
    }
  }

  // One sentence for each axis.
  void add_unmoved() {
    std::map<Axis, std::vector<std::string>> errors;
    for (const plant::ErrorName& name : calibration_.unmoved) {
      errors[name.axis].push_back(plant::to_string(name));
    }
    for (const auto& [axis, names] : errors) {
      out_.push_back(
          fmt::format("no group moves {}: cannot determine {}", letter(axis), list(names)));
    }
  }

  void add_set_up(const LeftOut& one) {
    std::vector<std::string> names;
    for (const auto& part : shown(one)) names.push_back(name(part.unknown));
    out_.push_back(names.empty() ? fmt::format("{} is not determined", name(one.unknown))
                                 : fmt::format("{} is determined only together with {}",
                                               name(one.unknown), some(names)));
  }

  void add_location(const LeftOut& one) {
    if (one.parts.empty()) {
      add_once(without_effect_, name(one.unknown));
      return;
    }
    std::vector<std::string> set_up, errors;
    for (const auto& part : shown(one)) {
      if (is_error(unknowns_, part.unknown)) {
        errors.push_back(fmt::format("{0} holds {0} {1}", name(part.unknown),
                                     term(part.factor, name(one.unknown))));
      } else {
        set_up.push_back(name(part.unknown));
      }
    }
    if (!set_up.empty()) errors.push_back("the set-up does (" + some(set_up) + ")");
    out_.push_back(
        fmt::format("{} is determined only in combination: {}", name(one.unknown), list(errors)));
  }

  void add_function(const LeftOut& one) {
    LeftOutOfFunction& function = functions_[name(one.unknown)];
    ++function.functions;
    for (const auto& part : shown(one)) {
      const std::string other = name(part.unknown);
      if (other == name(one.unknown)) continue;
      add_once(is_error(unknowns_, part.unknown) ? function.errors : function.set_up, other);
    }
  }

  template <typename Basis>
  void add_sentence(const std::string& own, const Basis& basis, const LeftOutOfFunction& left_out) {
    const bool whole = left_out.functions == basis.size();
    if (left_out.errors.empty() && left_out.set_up.empty()) {
      if (whole) {
        without_effect_.push_back(own);
      } else {
        out_.push_back(fmt::format("{} is determined only between some of its knots", own));
      }
      return;
    }
    std::string sentence = whole ? own : "a part of " + own;
    if (left_out.errors.empty()) {
      sentence += fmt::format(" cannot be separated from the set-up ({})", some(left_out.set_up));
    } else {
      sentence += fmt::format(" is determined only in combination with {}, which hold{} it",
                              list(left_out.errors), left_out.errors.size() == 1 ? "s" : "");
    }
    out_.push_back(sentence);
  }

  const Calibration& calibration_;
  const Unknowns& unknowns_;
  std::map<std::string, LeftOutOfFunction> functions_;
  std::vector<std::string> without_effect_, out_;
};

}  // namespace

std::vector<std::string> unidentifiable_sentences(const Calibration& calibration) {
  return Sentences(calibration).all();
}

std::vector<plant::ErrorName> undetermined_errors(const Calibration& calibration) {
  const Adjustment& adjustment = calibration.adjustment;
  const Unknowns& unknowns = adjustment.unknowns;
  std::vector<plant::ErrorName> out;
  const auto is_known = [&](int first, int count) {
    return !adjustment.covariance.block(first, first, count, count).isZero(0.0);
  };
  for (std::size_t k = 0; k < unknowns.locations.size(); ++k) {
    if (!is_known(unknowns.first_location() + static_cast<int>(k), 1)) {
      out.push_back(unknowns.locations[k].name);
    }
  }
  for (const SoughtFunction& function : unknowns.functions) {
    if (!is_known(function.first, function.basis.size())) out.push_back(function.name);
  }
  out.insert(out.end(), calibration.unmoved.begin(), calibration.unmoved.end());
  return out;
}

bool is_combined(const Adjustment& adjustment, const plant::ErrorName& name) {
  const Unknowns& unknowns = adjustment.unknowns;
  const auto is_of = [&](int unknown) {
    if (name.is_location) {
      return is_location(unknowns, unknown) &&
             unknowns.locations[std::size_t(unknown - unknowns.first_location())].name == name;
    }
    return std::any_of(
        unknowns.functions.begin(), unknowns.functions.end(), [&](const SoughtFunction& f) {
          return f.name == name && unknown >= f.first && unknown < f.first + f.basis.size();
        });
  };
  return std::any_of(adjustment.left_out.begin(), adjustment.left_out.end(),
                     [&](const LeftOut& one) {
                       if (is_of(one.unknown)) return true;
                       return std::any_of(one.parts.begin(), one.parts.end(),
                                          [&](const auto& part) { return is_of(part.unknown); });
                     });
}

}  // namespace servomill::sim::calibration
