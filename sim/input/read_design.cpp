#include "sim/input/read_design.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/config/written_number.h"
#include "sim/input/drawn_errors.h"
#include "sim/input/machine_document.h"
#include "sim/input/scenario_document.h"
#include "sim/model/joint_normal.h"

namespace servomill::sim::input {
namespace {

constexpr std::array<std::string_view, 3> kDesigns = {"random", "latin_hypercube", "sobol"};
constexpr std::array<std::string_view, 2> kRanges = {"linear", "log"};
constexpr std::array<std::string_view, 4> kDistributions = {"uniform", "log_uniform", "normal",
                                                            "choice"};
// The first names of keys that say what is swept, read or compared: they are the same at all
// points.
constexpr std::array<std::string_view, 3> kFixed = {"sweep", "based_on", "quantity"};

// A scalar as TOML that any reader of numbers understands: 1_000 and 0x10 become 1000 and 16.
std::string plain_toml(const config::Value& value) {
  const bool plain = value.written.find_first_of("_xob") == std::string::npos;
  if (value.type == config::Value::Type::integer && !plain) return fmt::format("{}", value.integer);
  if (value.type == config::Value::Type::real && !plain) return fmt::format("{}", value.real);
  const bool lines =
      value.type == config::Value::Type::text && value.written.find('\n') != std::string::npos;
  return lines ? config::quoted_text(value.text) : config::inline_toml(value);
}

model::ValueTexts texts_of(const config::Value& list) {
  model::ValueTexts texts;
  for (const config::Value& one : list.children) texts.push_back(plain_toml(one));
  return texts;
}

// The key as --set takes it; a name with its signs is quoted.
std::string step(const std::string& path, const std::string& name) {
  const bool plain = name.find_first_of(".[=\"' ") == std::string::npos;
  const std::string quoted = plain ? name : fmt::format("\"{}\"", name);
  return path.empty() ? quoted : path + "." + quoted;
}

class DesignReader {
 public:
  explicit DesignReader(InputFiles& files) : files_(files) {}

  SweepReading read(config::Reader& table) {
    if (table.has("samples")) {
      config::Reader samples = table.table("samples");
      read_samples(samples);
    }
    const std::vector<config::Reader> together = table.tables_or_none("zip");
    for (const std::string& key : table.keys()) {
      // at the root a key stands as --set takes it: "program.feed_override"
      if (key != "samples" && key != "zip") read_key(table, key, key);
    }
    for (config::Reader one : together) read_together(one);
    if (design_.sampled_dimensions > 0 && !has_samples_ && table.faults() == 0) {
      table.fault(
          "samples is missing: keys with a distribution need, for example, samples = "
          "{ design = \"latin_hypercube\", count = 100 }");
    }
    if (design_.sampled_dimensions == 0 && has_samples_ && table.faults() == 0) {
      table.fault("samples", "has no key with a distribution to sample");
    }
    if (table.faults() == 0) refuse_too_many(table);
    return {std::move(design_), std::move(identified_)};
  }

 private:
  void read_samples(config::Reader& table) {
    has_samples_ = true;
    design_.samples.sampling = static_cast<model::Sampling>(table.choice_or("design", 0, kDesigns));
    design_.samples.count =
        static_cast<std::uint64_t>(table.integer("count", {config::at_least(1)}));
    design_.samples.seed =
        static_cast<std::uint64_t>(table.integer_or("seed", 1, {config::at_least(0)}));
    const std::size_t before = table.faults();
    read_sample_files(table);
    read_identified_values(table);
    if (table.faults() > before || !draws_into_other_model(table)) return;
    for (const IdentifiedValues& values : identified_) add_joint(table, values);
  }

  // from: one name or a list of them.
  void read_sample_files(config::Reader& table) {
    if (!table.has("from")) return;
    std::vector<std::string> names;
    if (table.is("from", config::Value::Type::text)) {
      names = {table.text("from")};
    } else if (table.is("from", config::Value::Type::list)) {
      names = table.texts("from");
    } else {
      table.raw("from");
      table.fault("from", "must be a file name, or a list of file names");
    }
    for (std::string& name : names) {
      design_.sample_files.push_back({std::move(name), table.place("from")});
    }
  }

  // A complete document holds the values itself.
  void read_identified_values(config::Reader& table) {
    if (table.has("identified") && !is_outdated_copy(table, "from", "identified")) {
      for (config::Reader& one : table.tables("identified")) {
        identified_.push_back(read_identified_table(one));
      }
      return;
    }
    if (table.has("identified")) table.raw("identified");
    for (const model::SampleFile& file : design_.sample_files) {
      const std::string path = beside(file.place, file.name);
      MachineDocument machine = machine_document(path, files_, file.place);
      if (machine.identified) {
        identified_.push_back(std::move(*machine.identified));
      } else {
        table.fault(
            "from",
            fmt::format("has no table [identified]: there are no identified values to sample{}",
                        design_.sample_files.size() > 1 ? " in " + file.name : ""));
      }
    }
  }

  // into: identified errors keep their model, and a copy of it is drawn.
  bool draws_into_other_model(config::Reader& table) {
    if (!table.has("into")) return true;
    const std::size_t before = table.faults();
    const std::string into = table.text("into");
    std::vector<std::string> models;
    for (const IdentifiedValues& values : identified_) {
      for (std::string& one : models_of_keys(values.keys)) models.push_back(std::move(one));
    }
    if (table.faults() > before) return false;
    if (models.size() != 1) {
      table.fault("into", models.empty()
                              ? "has no effect: no identified key belongs to an error model"
                              : "is one error model; errors of several models are identified");
    } else if (into.empty() || into == models.front() ||
               into.find_first_of(".\"' []=") != std::string::npos) {
      table.fault(
          "into",
          fmt::format("must be a new name of letters, digits and '_'; {} is the identified model",
                      models.front()));
    }
    if (table.faults() > before) return false;
    drawn_into_ = into;
    return true;
  }

  // Keys that are drawn together: the first dimensions of the samples.
  void add_joint(config::Reader& table, const IdentifiedValues& values) {
    model::JointNormal joint{
        Eigen::Map<const Eigen::VectorXd>(values.values.data(),
                                          static_cast<Eigen::Index>(values.values.size())),
        model::covariance_factor(values.covariance)};
    const std::string_view source = table.has("from") ? "from" : "identified";
    for (std::size_t k = 0; k < values.keys.size(); ++k) {
      const std::string path =
          "machine." +
          (drawn_into_.empty() ? values.keys[k] : key_in_model(values.keys[k], drawn_into_));
      if (refuse_key(table, std::string(source), path)) return;
      const std::string& unit = values.units[k];
      const model::JointMember member{design_.joint.size(), static_cast<Eigen::Index>(k),
                                      unit == kPlainNumber ? "" : unit};
      design_.keys.push_back({path, table.place(source), member, true, design_.sampled_dimensions});
    }
    design_.sampled_dimensions += joint.dimensions();
    design_.joint.push_back(std::move(joint));
  }

  void read_key(config::Reader& table, const std::string& key, const std::string& path) {
    if (refuse_key(table, key, path)) return;
    if (table.is(key, config::Value::Type::list)) {
      read_list(table, key, path, design_.grid.size());
      if (!design_.keys.empty() && design_.keys.back().key == path) new_dimension();
      return;
    }
    if (!table.is(key, config::Value::Type::table)) return refuse_form(table, key);
    config::Reader form = table.table(key);
    const std::vector<std::string> names = form.keys();
    const auto is_one_of = [&](const auto& words) {
      return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
        return std::find(words.begin(), words.end(), name) != words.end();
      });
    };
    if (is_one_of(kRanges)) return read_range(table, key, form, path);
    if (is_one_of(kDistributions)) return read_distribution(table, key, form, path);
    if (names.empty()) return refuse_form(table, key);
    for (const std::string& name : names) read_key(form, name, step(path, name));
  }

  static void refuse_form(config::Reader& table, const std::string& key) {
    table.raw(key);
    table.fault(key,
                "must be a list of at least one value, a range such as { linear = [0.5, 2.0], "
                "count = 4 } or a distribution such as { normal = [1.0, 0.1] }");
  }

  bool refuse_key(config::Reader& table, const std::string& key, const std::string& path) {
    const std::string first = path.substr(0, path.find_first_of(".["));
    const bool fixed = std::find(kFixed.begin(), kFixed.end(), first) != kFixed.end();
    const bool again = std::any_of(design_.keys.begin(), design_.keys.end(),
                                   [&](const model::SweepKey& one) { return one.key == path; });
    if (!fixed && !again) return false;
    table.raw(key);
    table.fault(key, fixed ? fmt::format("is common to all points; {} cannot be swept", first)
                     : path.ends_with(key) ? "is varied twice"
                                           : fmt::format("varies {} a second time", path));
    return true;
  }

  void add(config::Reader& table, const std::string& key, const std::string& path,
           model::SweepValues values, bool sampled, std::size_t dimension) {
    design_.keys.push_back({path, table.place(key), std::move(values), sampled, dimension});
  }

  // The dimension of the grid that the last key varies along.
  void new_dimension() {
    const auto& values = design_.keys.back().values;
    const auto* range = std::get_if<model::SweepRange>(&values);
    design_.grid.push_back(range ? range->count : std::get<model::ValueTexts>(values).size());
  }

  void read_list(config::Reader& table, const std::string& key, const std::string& path,
                 std::size_t dimension) {
    const config::Value* value = table.raw(key);
    if (value->children.empty()) return refuse_form(table, key);
    add(table, key, path, texts_of(*value), false, dimension);
  }

  void read_together(config::Reader& table) {
    const std::size_t before = design_.keys.size();
    for (const std::string& key : table.keys()) read_member(table, key, key);
    if (design_.keys.size() == before) {
      if (table.faults() == 0) table.fault("does not name a key");
      return;
    }
    new_dimension();
  }

  void read_member(config::Reader& table, const std::string& key, const std::string& path) {
    if (refuse_key(table, key, path)) return;
    if (table.is(key, config::Value::Type::table)) {
      config::Reader nested = table.table(key);
      for (const std::string& name : nested.keys()) read_member(nested, name, step(path, name));
      return;
    }
    const std::size_t dimension = design_.grid.size();
    const config::Value* value = table.raw(key);
    if (value == nullptr || value->type != config::Value::Type::list || value->children.empty()) {
      table.fault(key, "must be a list of at least one value");
      return;
    }
    const bool first = design_.keys.empty() || design_.keys.back().sampled ||
                       design_.keys.back().dimension != dimension;
    const std::size_t wanted = first
                                   ? value->children.size()
                                   : std::get<model::ValueTexts>(design_.keys.back().values).size();
    if (value->children.size() != wanted) {
      table.fault(key, fmt::format("has {} values, {} has {}: zipped lists must have equal length",
                                   value->children.size(), design_.keys.back().key, wanted));
      return;
    }
    add(table, key, path, texts_of(*value), false, dimension);
  }

  // Two numbers, both plain or both texts with the same unit.
  struct Pair {
    double a, b;
    std::string unit;
  };
  static std::optional<Pair> read_pair(config::Reader& form, std::string_view word,
                                       std::string_view rule) {
    const config::Value* value = form.raw(word);
    const bool two = value->type == config::Value::Type::list && value->children.size() == 2;
    const auto a = two ? config::written_number(plain_toml(value->children[0])) : std::nullopt;
    const auto b = two ? config::written_number(plain_toml(value->children[1])) : std::nullopt;
    if (a && b && a->unit == b->unit) return Pair{a->value, b->value, a->unit};
    form.fault(word, fmt::format("must be two numbers, {}, in one unit", rule));
    return std::nullopt;
  }

  static bool refuse_log(config::Reader& form, std::string_view word, bool log, const Pair& pair) {
    if (!log || (pair.a > 0.0 && pair.b > 0.0)) return false;
    form.fault(word, "must have numbers > 0");
    return true;
  }

  void read_range(config::Reader& table, const std::string& key, config::Reader& form,
                  const std::string& path) {
    const bool log = form.has("log");
    const std::string_view word = log ? "log" : "linear";
    if (log && form.has("linear")) form.fault("log", "excludes linear; choose one");
    const auto pair = read_pair(form, word, "the first and the last");
    const std::int64_t count = form.integer("count", {config::at_least(2)});
    if (!pair || refuse_log(form, word, log, *pair) || count < 2) return;
    if (pair->a == pair->b) return form.fault(word, "must be two different numbers");
    add(table, key, path,
        model::SweepRange{pair->a, pair->b, static_cast<std::uint64_t>(count), log, pair->unit},
        false, design_.grid.size());
    new_dimension();
  }

  void read_distribution(config::Reader& table, const std::string& key, config::Reader& form,
                         const std::string& path) {
    const std::vector<std::string> names = form.keys();
    const auto word = *std::find_if(names.begin(), names.end(), [](const std::string& name) {
      return std::find(kDistributions.begin(), kDistributions.end(), name) != kDistributions.end();
    });
    const std::size_t dimension = design_.sampled_dimensions;
    if (dimension == model::kMaxDimensions) {
      form.raw(word);
      return table.fault(
          key, fmt::format("exceeds the limit of {} sampled keys", model::kMaxDimensions));
    }
    if (word == "choice") {
      const config::Value* value = form.raw(word);
      if (value->type != config::Value::Type::list || value->children.empty()) {
        return form.fault(word, "must be a list of at least one value");
      }
      add(table, key, path, texts_of(*value), true, dimension);
      ++design_.sampled_dimensions;
      return;
    }
    const auto kind = word == "uniform"       ? model::NumberDistribution::Kind::uniform
                      : word == "log_uniform" ? model::NumberDistribution::Kind::log_uniform
                                              : model::NumberDistribution::Kind::normal;
    const bool normal = kind == model::NumberDistribution::Kind::normal;
    const auto pair =
        read_pair(form, word, normal ? "the mean and the standard deviation" : "the two ends");
    if (!pair ||
        refuse_log(form, word, kind == model::NumberDistribution::Kind::log_uniform, *pair)) {
      return;
    }
    if (normal && !(pair->b > 0.0)) return form.fault(word, "must have a standard deviation > 0");
    if (!normal && !(pair->a < pair->b)) {
      return form.fault(word, "must be [lower, upper] with lower < upper");
    }
    add(table, key, path, model::NumberDistribution{kind, pair->a, pair->b, pair->unit}, true,
        dimension);
    ++design_.sampled_dimensions;
  }

  void refuse_too_many(config::Reader& table) const {
    double points = design_.sampled_dimensions > 0 ? static_cast<double>(design_.samples.count) : 1;
    for (const std::uint64_t length : design_.grid) points *= static_cast<double>(length);
    if (points <= static_cast<double>(model::kMaxPoints)) return;
    constexpr double kCountable = 1e15;
    table.fault(points < kCountable
                    ? fmt::format("has {:.0f} points; must be <= {}", points, model::kMaxPoints)
                    : fmt::format("has {:.3g} points; must be <= {}", points, model::kMaxPoints));
  }

  InputFiles& files_;
  model::SweepDesign design_;
  std::vector<IdentifiedValues> identified_;
  std::string drawn_into_;  // error model; empty: the identified one itself
  bool has_samples_ = false;
};

}  // namespace

SweepReading read_sweep(config::Reader& table, InputFiles& files) {
  return DesignReader(files).read(table);
}

}  // namespace servomill::sim::input
