#include "sim/model/scenario.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>

#include "controllers/conversational/conversational.h"
#include "controllers/gcode/called_subroutines.h"
#include "plant/vocabulary/units.h"
#include "sim/config/reader.h"
#include "sim/evaluation/ball_quantities.h"
#include "sim/evaluation/comparison.h"
#include "sim/evaluation/probe_quantities.h"
#include "sim/input/read_ball.h"
#include "sim/input/read_cutter.h"
#include "sim/input/read_cutting.h"
#include "sim/input/read_design.h"
#include "sim/input/read_errors.h"
#include "sim/input/read_machine.h"
#include "sim/input/read_nominal_part.h"
#include "sim/input/read_probes.h"
#include "sim/input/scenario_document.h"
#include "sim/input/scenario_source.h"
#include "sim/input/subroutine_files.h"
#include "sim/model/schedule.h"
#include "sim/system/base64.h"

namespace servomill::sim {
namespace {

constexpr double kNoBound = 1e300;           // of a parameter's specification
constexpr double kLongestPeriod = 60.0;      // s
constexpr double kLongestSettling = 3600.0;  // s
constexpr std::array<std::string_view, 2> kSigns = {"generate", "correct"};
constexpr std::array<std::string_view, 2> kStorages = {"float64", "float32"};
constexpr double kCoarsestResolution = 1 * um;
constexpr std::array<std::string_view, 2> kServos = {"cascade", "ideal"};
constexpr std::array<std::string_view, 4> kKinds = {"identified", "predicted", "chosen", "bound"};

template <class Names>
std::string listed(const Names& names) {
  return fmt::format("{}", fmt::join(names, ", "));
}

template <class Names>
std::string all_there_are(const Names& names) {
  return names.empty() ? std::string("; there is none") : "; there are: " + listed(names);
}

// A name that must be one of a list; a fault with the nearest one if it is not.
template <class Names>
bool must_be_known(Reader& table, std::string_view key, const std::string& name,
                   std::string_view what, const Names& names) {
  if (std::find(names.begin(), names.end(), name) != names.end()) return true;
  const std::vector<std::string_view> views(names.begin(), names.end());
  const std::string near = did_you_mean(name, views);
  table.fault(key, fmt::format("no such {}{}", what, near.empty() ? all_there_are(names) : near));
  return false;
}

class ScenarioReader {
 public:
  ScenarioReader(Document document, InputFiles& files, Scenario& out)
      : document_(std::move(document)), files_(files), out_(out) {}

  void read() {
    Reader root(document_);
    root.raw("based_on");  // still there in result files of earlier versions
    if (root.place("based_on").file.starts_with("--set")) {
      root.fault("based_on", "is none of the keys that --set changes: name the other scenario");
    }
    root.raw("machine_override");  // is in the machine by now
    out_.title = root.text_or("title", out_.name);
    out_.source = root.text_or("source", "");
    Reader machine = root.table("machine");
    out_.machine = read_machine(machine, &out_.errors);
    Reader program = root.table("program");
    read_program(program);
    read_error_models(root);
    read_hardware(root);
    read_record(root);
    out_.cmm = read_cmm(root);
    out_.probes = read_probes(root, !out_.program.cutters.empty());
    check_periods(root);
    read_cut(root);
    refuse_unused(root);
    const std::size_t before = root.faults();
    std::vector<Reader> cases = root.tables("case");
    cases_are_known_ = root.faults() == before;
    for (Reader& table : cases) read_case(table);
    connect_hardware();
    for (Reader& table : root.tables_or_none("quantity")) read_quantity(table);
    if (root.has("sweep")) {
      Reader sweep = root.table("sweep");
      out_.sweep = read_sweep(sweep);
    }
    root.finish();
    check_plan();
    read_case_machines();
    document_.merge(with_contents_of_files());
    out_.resolved = document_.to_toml();
  }

 private:
  static Value text_value(const std::string& key, const std::string& text) {
    Value value;
    value.type = Value::Type::text;
    value.key = key;
    value.text = text;
    value.written = quoted_text(text);
    return value;
  }

  // { program = { text = "..." }, part = { ... } }: a resolved document needs no other file.
  Value with_contents_of_files() const {
    Value program;
    program.key = "program";
    program.children.push_back(text_value("text", out_.program.text()));
    if (!out_.program.subroutines.empty()) {
      Value subroutines;
      subroutines.key = "subroutines";
      for (const auto& [name, text] : out_.program.subroutines) {
        subroutines.children.push_back(text_value(name, text));
      }
      program.children.push_back(std::move(subroutines));
    }
    Value root;
    root.children.push_back(std::move(program));
    if (out_.part) {
      Value part;
      part.key = "part";
      part.children.push_back(text_value("stl", out_.part->file));
      part.children.push_back(text_value("stl_base64", base64(out_.part->bytes)));
      root.children.push_back(std::move(part));
    }
    return root;
  }

  void read_program(Reader& table) {
    ProgramSpec& program = out_.program;
    program.file = table.text("file");
    if (table.has("text") && !is_outdated_copy(table, "file", "text")) {
      program.shared_text = std::make_shared<const std::string>(table.text("text"));
      if (table.has("subroutines")) {
        Reader texts = table.table("subroutines");
        for (const std::string& name : texts.keys()) program.subroutines[name] = texts.text(name);
      }
    } else if (!program.file.empty()) {
      for (const char* stored : {"text", "subroutines"}) table.raw(stored);
      const Place at = table.place("file");
      program.file = beside(at, program.file);
      program.shared_text = files_.text(program.file, at, "program");
      read_subroutines(program, program.shared_text, at);
    }
    if (table.is("file", Value::Type::text) && table.text("file").empty()) {
      table.fault("file", "must name the program");
    }
    refuse_unwritable(program.file, program.text());
    const NcSettings& nc = out_.machine.nc;
    program.reader = static_cast<controllers::Reader>(table.choice_or(
        "reader", static_cast<std::size_t>(nc.program_reader), controllers::kReaders));
    program.decimal_point = static_cast<controllers::DecimalPoint>(table.choice_or(
        "decimal_point", static_cast<std::size_t>(nc.decimal_point), controllers::kDecimalPoints));
    if (table.has("first_feed"))
      program.first_feed = table.real("first_feed", kVelocity, {above(0.0)});
    program.feed_override = table.real_or("feed_override", 1.0, kNumber, {above(0.0)});
    if (table.has("parameters")) {
      Reader parameters = table.table("parameters");
      for (const std::string& key : parameters.keys()) {
        program.parameters[key] = parameters.real(key, kNumber);
        if (!is_parameter_name(key)) {
          parameters.fault(key, "must be named #N or #<name>, or QN in a conversational program");
        }
      }
    }
    const JointLayout& layout = out_.machine.chain.layout;
    if (table.has("work_offset")) {
      Reader words = table.table("work_offset");
      program.work_offset = read_offsets(words, layout);
    }
    program.start_place = table.place("start");
    if (table.has("start")) {
      Reader words = table.table("start");
      program.start = read_offsets(words, layout);
    }
    for (Reader& tool : table.tables_or_none("tool")) read_tool(tool);
  }

  // The files of subroutines that the program may call, and those that they may call.
  void read_subroutines(ProgramSpec& program, const std::shared_ptr<const std::string>& text,
                        const Place& at) {
    for (const std::string& name : controllers::called_subroutines(
             controllers::ProgramText::of_shared_text(text, program.file))) {
      const std::string file = subroutine_file(program.file, name);
      if (program.subroutines.contains(name) || !std::filesystem::is_regular_file(file)) continue;
      const std::shared_ptr<const std::string> called = files_.text(file, at, "subroutine");
      program.subroutines[name] = *called;
      refuse_unwritable(file, *called);
      read_subroutines(program, called, at);
    }
  }

  // "#101", "#<name>" or "Q5"
  static bool is_parameter_name(std::string_view key) {
    if (key.starts_with('Q')) return controllers::conversational::is_parameter_name(key);
    if (key.starts_with("#<")) return key.size() > 3 && key.ends_with('>');
    return key.size() > 1 && key.size() < 8 && key[0] == '#' &&
           key.find_first_not_of("0123456789", 1) == std::string_view::npos;
  }

  // A program becomes a text of the result file, which is UTF-8 without NUL.
  static void refuse_unwritable(const std::string& file, std::string_view text) {
    int line = 1, column = 1;
    for (std::size_t i = 0; i < text.size();) {
      const std::size_t length = utf8_length(text.substr(i));
      const auto byte = static_cast<unsigned char>(text[i]);
      if (length == 0) {
        throw InputError(
            {file, line, column},
            fmt::format("byte 0x{:02x} is not UTF-8; save the program as UTF-8", byte));
      }
      if (byte == 0) throw InputError({file, line, column}, "byte 0x00 in a program");
      i += length;
      column = byte == '\n' ? 1 : column + 1;
      if (byte == '\n') ++line;
    }
  }

  // Bytes of the character at the beginning; 0: none of UTF-8.
  static std::size_t utf8_length(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const std::size_t length = byte(0) < 0x80   ? 1
                               : byte(0) < 0xC2 ? 0
                               : byte(0) < 0xE0 ? 2
                               : byte(0) < 0xF0 ? 3
                               : byte(0) < 0xF5 ? 4
                                                : 0;
    if (length > text.size()) return 0;
    for (std::size_t i = 1; i < length; ++i) {
      if ((byte(i) & 0xC0) != 0x80) return 0;
    }
    const bool overlong =
        (byte(0) == 0xE0 && byte(1) < 0xA0) || (byte(0) == 0xF0 && byte(1) < 0x90);
    const bool surrogate = byte(0) == 0xED && byte(1) >= 0xA0;
    const bool beyond = byte(0) == 0xF4 && byte(1) >= 0x90;
    return overlong || surrogate || beyond ? 0 : length;
  }

  // Words of axes; anything goes when the machine's axes are not known.
  AxisWords read_offsets(Reader& table, const JointLayout& layout) const {
    if (layout == JointLayout{}) {
      for (const std::string& key : table.keys()) table.raw(key);
    }
    return read_words(table, layout);
  }

  void read_tool(Reader& table) {
    controllers::ToolEntry tool;
    tool.number = static_cast<int>(table.integer("number", {at_least(1), at_most(99999)}));
    tool.pocket = tool.number;
    tool.offset[index_of(Axis::Z)] = table.real("length_mm", kLength, {at_least(0.0)});
    tool.diameter = table.real_or("diameter_mm", 0.0, kLength, {at_least(0.0)});
    const auto cutter = read_cutter(table, tool.diameter);
    if (out_.program.tools.find(tool.number) != nullptr) {
      table.fault("number", "is the number of an earlier tool");
      return;
    }
    out_.program.tools.add(tool);
    if (cutter) out_.program.cutters[tool.number] = *cutter;
  }

  void read_error_models(Reader& root) {
    std::vector<std::string>& names = error_models_;
    if (root.has("errors")) {
      Reader models = root.table("errors");
      names = models.keys();
      if (out_.machine.chain.layout != JointLayout{}) {
        for (auto& [name, model] : sim::read_error_models(models, out_.machine.chain.layout)) {
          out_.errors[name] = std::move(model);
        }
      } else {  // their errors have no axes
        for (const std::string& name : names) models.raw(name);
      }
    }
    for (const auto& [name, model] : out_.errors) {
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
    for (auto [key, to] : {std::pair{"truth", &out_.truth}, std::pair{"imposed", &out_.imposed}}) {
      *to = root.text_or(key, "");
      if (!to->empty()) must_be_known(root, key, *to, "error model", names);
    }
  }

  void read_hardware(Reader& root) {
    FeedbackHardware& hardware = out_.hardware;
    Reader table = root.table_or_empty("feedback_hardware");
    says_connected_ = table.has("connected");
    hardware.connected = table.boolean_or("connected", false);
    hardware.signal_delay = ticks(table, "signal_delay_us", 10 * us, 0);
    if (table.faults() == 0 &&
        hardware.signal_delay + out_.machine.scale_delay >= out_.machine.nc.periods.position) {
      table.fault(
          fmt::format("signal_delay_us and nc.scale_delay_us together must be shorter than the "
                      "position period of {:g} us",
                      out_.machine.nc.periods.seconds(out_.machine.nc.periods.position) / us));
    }
    hardware.model_period = ticks(table, "model_period_us", 60 * us, 1);
  }

  void read_record(Reader& root) {
    Reader table = root.table_or_empty("record");
    out_.record_period = ticks(table, "period_ms", 1 * ms, 1);
    RecordSpec& record = out_.record;
    record.period_is_given = table.has("period_ms");
    record.format.storage = static_cast<Storage>(table.choice_or("storage", 0, kStorages));
    record.format.resolution = table.real_or("resolution_nm", record.format.resolution, kLength,
                                             {at_least(0.0), at_most(kCoarsestResolution)});
    record.compression = static_cast<int>(table.integer_or(
        "compression", record.compression, {at_least(kNoCompression), at_most(kMostCompression)}));
    record.uncorrectable = table.boolean_or("uncorrectable", false);
    constexpr double kGigabyte = 1e9, kHour = 3600.0, kMostGigabytes = 1e6, kMostHours = 1e4;
    record.max_size = kGigabyte * table.real_or("max_size_GB", record.max_size / kGigabyte, kNumber,
                                                {above(0.0), at_most(kMostGigabytes)});
    record.max_duration = kHour * table.real_or("max_duration_h", record.max_duration / kHour,
                                                kNumber, {above(0.0), at_most(kMostHours)});
    out_.settle_time =
        table.real_or("settle_ms", 100 * ms, kTime, {at_least(0.0), at_most(kLongestSettling)});
  }

  // The static schedule covers one common multiple of all periods.
  void check_periods(Reader& root) {
    const LoopPeriods& p = out_.machine.nc.periods;
    if (!can_be_scheduled({p.position, p.velocity, p.current})) return;  // said with the machine
    if (hyperperiod({{kPositionLoop, p.position},
                     {kVelocityLoop, p.velocity},
                     {kCurrentLoop, p.current},
                     {kErrorModel, out_.hardware.model_period},
                     {kRecord, out_.record_period}}) > 0) {
      return;
    }
    root.table_or_empty("record").fault(fmt::format(
        "the periods of the loops, of the error model and of the recorder meet again only "
        "after more than {:g} s; make them multiples of each other",
        p.seconds(kMaxHyperperiod)));
  }

  void read_cut(Reader& root) {
    if (root.has("part")) {
      Reader part = root.table("part");
      out_.part = read_nominal_part(part, files_);
      out_.stock = read_stock(part);
    }
    if (!root.has("cutting")) return;
    Reader cutting = root.table("cutting");
    out_.cutting = read_cutting(cutting);
    out_.cutting->place = root.place("cutting");
    if (out_.stock.empty() && cutting.faults() == 0) {
      cutting.fault("needs the raw part: [[part.stock]] with a box or a cylinder");
    }
  }

  // Refuses keys that nothing would look at, though the user counts on them.
  void refuse_unused(Reader& root) {
    if (root.faults() > 0 || root.has("probe")) return;
    if (out_.part) {
      root.table("part").fault("stl", "is what probed points are laid on: it needs a [[probe]]");
    }
    if (root.has("cmm")) root.table("cmm").fault("measures nothing: there is no [[probe]]");
    if (!out_.stock.empty() && !out_.cutting) {
      root.table("part").fault(
          "stock is neither cut nor probed: it needs [cutting] or a [[probe]]");
    }
  }

  // Only of a plan that is right in itself.
  void check_plan() const {
    if (!out_.part) return;
    auto faults = faults_of_plan(out_.probes, *out_.part);
    if (!faults.empty()) throw InputError(std::move(faults));
  }

  Tick ticks(Reader& table, std::string_view key, double fallback, Tick least) {
    const Tick harmless = std::max<Tick>(least, 1);
    const std::size_t before = table.faults();
    const double seconds =
        least > 0 ? table.real_or(key, fallback, kTime, {above(0.0), at_most(kLongestPeriod)})
                  : table.real_or(key, fallback, kTime, {at_least(0.0), at_most(kLongestPeriod)});
    if (table.faults() > before) return harmless;
    const double base = out_.machine.nc.periods.base;
    const auto whole = whole_ticks(seconds, base);
    if (whole && *whole >= least) return *whole;
    const std::string rule =
        fmt::format("must be a whole multiple of base_period_us = {:g} of the machine", base / us);
    if (table.has(key)) {
      table.fault(key, rule);
    } else {
      table.fault(fmt::format("{} is not set, and its default {:g} {}", key,
                              fallback / unit_of(key), rule));
    }
    return harmless;
  }

  static double unit_of(std::string_view key) { return key.ends_with("_us") ? us : ms; }

  void read_case(Reader& table) {
    CaseSpec spec;
    const std::size_t before = table.faults();
    spec.name = table.text("name");
    if (table.faults() == before) check_case_name(table, spec.name);
    if (table.faults() > before) cases_are_known_ = false;
    if (table.has("work_offset")) {
      Reader words = table.table("work_offset");
      spec.work_offset = read_offsets(words, out_.machine.chain.layout);
    }
    const bool says_hardware = table.has("feedback_hardware");
    spec.feedback_hardware = table.boolean_or("feedback_hardware", out_.hardware.connected);
    read_case_cutting(table, out_.cutting, spec);
    spec.servo = static_cast<ServoModel>(table.choice_or("servo", 0, kServos));
    if (spec.servo == ServoModel::ideal &&
        out_.record_period % out_.machine.nc.periods.position != 0) {
      table.fault(
          "servo",
          fmt::format("is recorded at its position periods: record.period_ms must "
                      "be a whole multiple of {:g} ms",
                      out_.machine.nc.periods.seconds(out_.machine.nc.periods.position) / ms));
    }
    if (table.has("truth")) {
      spec.truth = table.text("truth");
      if (!spec.truth->empty()) {
        must_be_known(table, "truth", *spec.truth, "error model", error_models_);
      }
    }
    for (Reader& strategy : table.tables_or_none("strategy")) {
      read_strategy(strategy, spec);
    }
    if (table.has("machine_override")) note_machine_override(table);
    if (const strategies::Entry* user = user_of_hardware(spec)) {
      if (says_hardware && !spec.feedback_hardware) {
        table.fault("feedback_hardware",
                    fmt::format("a case with the strategy {} needs its hardware", user->name));
      }
      spec.feedback_hardware = true;
    } else if (!says_hardware && !says_connected_) {
      follows_others_.push_back(out_.cases.size());
    }
    out_.cases.push_back(std::move(spec));
  }

  static const strategies::Entry* user_of_hardware(const CaseSpec& spec) {
    for (const StrategySpec& strategy : spec.strategies) {
      if (strategy.entry->uses_feedback_hardware) return strategy.entry;
    }
    return nullptr;
  }

  // Hardware that one case needs delays the readings of all, as on one machine: unless they say
  // otherwise, cases differ in their strategies alone.
  void connect_hardware() {
    const bool any = std::any_of(out_.cases.begin(), out_.cases.end(),
                                 [](const CaseSpec& one) { return one.needs_feedback_hardware(); });
    for (const std::size_t index : follows_others_) out_.cases[index].feedback_hardware = any;
  }

  // Read when all else is known to be right: on top of a faulty machine nothing can be said.
  void note_machine_override(Reader& table) {
    const Value* override = table.raw("machine_override");
    if (override->type != Value::Type::table) {
      table.fault("machine_override", "must be a table");
      return;
    }
    if (override->find("structure") != nullptr) {
      table.fault("machine_override", "has the key structure, which is common to all cases");
    }
    if (override->find("errors") != nullptr) {
      table.fault("machine_override", "has the key errors; error models are common to all cases");
    }
    case_overrides_.emplace(out_.cases.size(), *override);
  }

  // The machines of cases that override keys of it: that of the scenario, with what they say laid
  // over it.
  void read_case_machines() {
    std::vector<Fault> faults;
    for (const auto& [index, override] : case_overrides_) {
      Document document = document_;
      document.merge(as_machine(override));
      Reader root(document);
      for (const std::string& key : root.keys()) {
        if (key != "machine") root.raw(key);
      }
      try {
        Reader machine = root.table("machine");
        CaseSpec& one = out_.cases[index];
        one.machine = read_machine(machine);
        root.finish();
        if (one.machine->nc.periods != out_.machine.nc.periods ||
            one.machine->scale_delay != out_.machine.scale_delay) {
          faults.push_back({override.place,
                            fmt::format("case {}: machine_override changes the periods of the "
                                        "loops or nc.scale_delay_us, which are common to all cases",
                                        one.name)});
        }
      } catch (const InputError& error) {
        faults.insert(faults.end(), error.faults().begin(), error.faults().end());
      }
    }
    if (!faults.empty()) throw InputError(std::move(faults));
  }

  // The name becomes a group of the result file.
  void check_case_name(Reader& table, const std::string& name) const {
    if (name.empty() || name == "." || name == "..") {
      table.fault("name", "must name the case");
    } else if (name.find('/') != std::string::npos) {
      table.fault("name", "must not contain '/'");
    } else if (out_.find_case(name) != nullptr) {
      table.fault("name", "is the name of an earlier case");
    }
  }

  void read_strategy(Reader& table, CaseSpec& spec) {
    const auto names = strategies::names();
    const std::size_t before = table.faults();
    const std::size_t index = table.choice("type", names);
    if (table.faults() > before) {
      table.skip_rest();
      return;
    }
    StrategySpec strategy;
    strategy.entry = strategies::find(names[index]);
    strategy.place = table.place("type");
    if (strategy.entry->reads_errors) {
      strategy.sign = table.choice_or("sign", 1, kSigns) == 0 ? strategies::Sign::generate
                                                              : strategies::Sign::correct;
      strategy.model = table.text("model");
      if (table.is("model", Value::Type::text)) {
        must_be_known(table, "model", strategy.model, "error model", error_models_);
      }
    }
    for (const ParameterSpec& parameter : strategy.entry->parameters) {
      if (table.has(parameter.name)) {
        strategy.key_places.emplace(parameter.name, table.place(parameter.name));
      }
      read_parameter(table, parameter, strategy.parameters);
    }
    if (strategy.entry->uses_feedback_hardware && spec.needs_feedback_hardware()) {
      table.fault("type", "a case has one feedback hardware: this is the second");
    }
    const auto same = [&](const StrategySpec& other) {
      return other.entry == strategy.entry && other.model == strategy.model;
    };
    const auto adds_start = [](const StrategySpec& one) {
      return one.entry->holds_error_at_reference != nullptr &&
             one.entry->holds_error_at_reference(one.parameters);
    };
    if (adds_start(strategy) &&
        std::any_of(spec.strategies.begin(), spec.strategies.end(),
                    [&](const StrategySpec& other) { return same(other) && adds_start(other); })) {
      table.fault(
          "type",
          fmt::format("a second {} strategy for this model adds the value at the start once "
                      "more; use axis = \"all\", or at_reference = \"zero\" for all but one",
                      strategy.entry->name));
    }
    spec.strategies.push_back(std::move(strategy));
  }

  static void read_parameter(Reader& table, const ParameterSpec& spec, Parameters& out) {
    const bool given = table.has(spec.name);
    const bool is_known_word = [&] {
      if (given && !table.is(spec.name, Value::Type::text)) return false;
      const std::string word = given ? table.text(spec.name) : std::string(spec.default_text);
      if (std::find(spec.words.begin(), spec.words.end(), word) == spec.words.end()) return false;
      out.set(spec.name, std::string_view(word));
      return true;
    }();
    if (is_known_word) return;
    if (!spec.is_number) {
      // numbers stand for words, too: iterations = 1
      if (given && table.is(spec.name, Value::Type::integer)) {
        const std::string word = std::to_string(table.integer(spec.name));
        if (std::find(spec.words.begin(), spec.words.end(), word) != spec.words.end()) {
          out.set(spec.name, std::string_view(word));
          return;
        }
      }
      table.raw(spec.name);
      const std::string near = table.is(spec.name, Value::Type::text)
                                   ? did_you_mean(table.text(spec.name), spec.words)
                                   : std::string();
      table.fault(spec.name, fmt::format("must be one of {}{}", listed(spec.words), near));
      out.set(spec.name, spec.words.front());
      return;
    }
    const ParsedUnit unit = parse_unit(spec.unit);
    const double factor = unit.unit ? unit.unit->factor : 1.0;
    const Quantity quantity = unit.unit ? unit.unit->quantity : kNumber;
    const Rule least = at_least(spec.min * factor);
    const Rules rules = {least, at_most(spec.max * factor)};
    if (given && !spec.words.empty() && is_word(table, spec.name)) {
      const std::string word = table.text(spec.name);
      table.fault(spec.name, fmt::format("must be a number or {}{}", listed(spec.words),
                                         did_you_mean(word, spec.words)));
      out.set(spec.name, 0.0);
    } else if (given || spec.default_text.empty()) {
      const double value = spec.max < kNoBound    ? table.real(spec.name, quantity, rules)
                           : spec.min > -kNoBound ? table.real(spec.name, quantity, {least})
                                                  : table.real(spec.name, quantity);
      out.set(spec.name, value);
    } else {
      out.set(spec.name, std::stod(std::string(spec.default_text)) * factor);
    }
  }

  // Whether a text does not even begin like a number with its unit.
  static bool is_word(Reader& table, std::string_view key) {
    if (!table.is(key, Value::Type::text)) return false;
    const std::string text = table.text(key);
    return text.find_first_of("0123456789") == std::string::npos;
  }

  void read_quantity(Reader& table) {
    QuantitySpec spec;
    const auto names = quantity_names();
    const std::size_t before = table.faults();
    const std::size_t index = table.choice("name", names);
    if (table.faults() > before) {
      table.skip_rest();
      return;
    }
    spec.name = names[index];
    const QuantityInfo& info = quantity_info(spec.name);
    if (info.needs_axis) {
      spec.axis = info.axes[table.choice("axis", letters_of(info.axes))];
      const JointLayout& layout = out_.machine.chain.layout;
      const auto axis = axis_of(spec.axis);
      if (layout != JointLayout{} && table.is("axis", Value::Type::text) && axis &&
          !layout.joint_of(*axis)) {
        table.fault("axis", "the machine has no such axis");
      }
    }
    static constexpr std::array<std::string_view, 4> kStatistics = {"max", "rms", "mean", "range"};
    if (info.has_statistic) {
      spec.statistic = kStatistics[table.choice_or("statistic", 0, kStatistics)];
    }
    std::vector<std::string> all;
    for (const CaseSpec& one : out_.cases) all.push_back(one.name);
    if (info.needs_base || (info.probes > 0 && table.has("base"))) {
      spec.base = table.text("base");
      if (table.is("base", Value::Type::text) && cases_are_known_)
        must_be_known(table, "base", spec.base, "case", all);
    }
    read_cases_of(table, all, spec);
    if (info.needs_imposed && out_.imposed.empty()) {
      table.fault("name", "needs the key 'imposed' of the scenario");
    }
    if (info.probes > 0) {
      read_part(table, info, spec);
    } else if (info.is_of_ball) {
      read_ball(table, out_.machine.chain.layout, spec);
    } else {
      spec.sections = info.circles > 0 ? table.texts("sections") : table.texts_or("sections", {});
      spec.sections_place = table.place("sections");
    }
    spec.reference = table.text_or("reference", "");
    if (table.has("kind")) spec.kind = kKinds[table.choice("kind", kKinds)];
    if (info.circles > 0) {
      add_circles(table, spec, static_cast<std::size_t>(info.circles));
    } else if (spec.name == "ball_bar_deviation") {
      add_bars(spec);
    } else if (spec.name == "location_error") {
      add_location_errors(spec);
    } else {
      out_.quantities.push_back(std::move(spec));
    }
  }

  // A case compared with itself has no row of its own, unless it is asked for.
  void read_cases_of(Reader& table, std::vector<std::string> all, QuantitySpec& spec) {
    std::vector<std::string> others = all;
    if (others.size() > 1) std::erase(others, spec.base);
    spec.cases = table.texts_or("cases", others);
    for (const std::string& name : spec.cases) {
      if (cases_are_known_)
        must_be_known(table, "cases", name, fmt::format("case '{}'", name), all);
    }
  }

  // Features that a quantity is about, and how they are fitted.
  void read_part(Reader& table, const QuantityInfo& info, QuantitySpec& spec) {
    static constexpr std::array<std::string_view, 2> kFits = {"minimum_zone", "least_squares"};
    spec.part.emplace();
    std::vector<std::string> names;
    for (const ProbeSpec& one : out_.probes) names.push_back(one.name);
    const bool all_named = std::find(names.begin(), names.end(), "") == names.end();
    if (info.probes == kEveryProbe) {
      spec.part->probes = table.texts_or("probes", names);
      for (const std::string& name : spec.part->probes) {
        if (all_named) must_be_known(table, "probes", name, fmt::format("probe '{}'", name), names);
      }
      if (spec.part->probes.empty()) table.fault("needs a [[probe]]");
      if (out_.part) spec.part->nominal = out_.part->mesh;
      return;
    }
    for (const char* key : info.probes == 1 ? std::vector{"probe"} : std::vector{"probe", "to"}) {
      const std::size_t before = table.faults();
      const std::string name = table.text(key);
      spec.part->probes.push_back(name);
      if (table.faults() > before || !all_named) continue;
      if (!must_be_known(table, key, name, "probe", names)) continue;
      const auto probe = std::find(names.begin(), names.end(), name) - names.begin();
      const Feature& feature = out_.probes[static_cast<std::size_t>(probe)].feature;
      if (feature.targets.empty()) continue;  // its fault has been told
      const FeatureKind kind = feature.kind;
      const auto kinds = kinds_of(spec.name);
      if (std::find(kinds.begin(), kinds.end(), kind) != kinds.end()) continue;
      std::vector<std::string_view> wanted;
      for (const FeatureKind one : kinds) wanted.push_back(name_of(one));
      table.fault(key,
                  fmt::format("is a {}; {} is of: {}", name_of(kind), spec.name, listed(wanted)));
    }
    if (info.has_fit) spec.part->minimum_zone = table.choice_or("fit", 0, kFits) == 0;
  }

  // Ball bars are evaluated one by one.
  void add_bars(const QuantitySpec& all) {
    for (std::size_t i = 0; i < all.ball->bar_centres.size(); ++i) {
      QuantitySpec one = all;
      one.sections = {all.sections[i]};
      one.ball->bar_centres = {all.ball->bar_centres[i]};
      out_.quantities.push_back(std::move(one));
    }
  }

  // The one asked for or every location error of the machine, and what it truly is where no other
  // reference is given.
  void add_location_errors(const QuantitySpec& all) {
    const auto truth = out_.errors.find(out_.truth);
    std::vector<plant::ErrorName> names = location_errors(out_.machine.chain);
    if (all.ball->error) names = {*all.ball->error};
    const bool is_true_of_each =
        std::none_of(out_.cases.begin(), out_.cases.end(),
                     [](const CaseSpec& one) { return one.truth.has_value(); });
    for (const plant::ErrorName& name : names) {
      QuantitySpec one = all;
      one.ball->error = name;
      if (one.reference.empty() && truth != out_.errors.end() && is_true_of_each) {
        const double unit = is_linear(name.direction) ? um : urad;
        one.reference = fmt::format("{:g} {} true", truth->second.location(name) / unit,
                                    unit_of_location(name));
      }
      out_.quantities.push_back(std::move(one));
    }
  }

  // Circles are evaluated one by one, or in pairs of directions: a quantity for each.
  void add_circles(Reader& table, const QuantitySpec& all, std::size_t together) {
    if (table.has("sections") && (all.sections.empty() || all.sections.size() % together != 0)) {
      table.fault("sections", together == 1
                                  ? "must name at least one turn of a circle"
                                  : "must name pairs of turns of a circle, one in each direction");
    }
    for (std::size_t i = 0; i + together <= all.sections.size(); i += together) {
      QuantitySpec one = all;
      const auto first = all.sections.begin() + static_cast<std::ptrdiff_t>(i);
      one.sections.assign(first, first + static_cast<std::ptrdiff_t>(together));
      out_.quantities.push_back(std::move(one));
    }
  }

  static std::vector<std::string_view> letters_of(std::string_view axes) {
    std::vector<std::string_view> out;
    for (std::size_t i = 0; i < axes.size(); ++i) out.push_back(axes.substr(i, 1));
    return out;
  }

  Document document_;
  InputFiles& files_;
  Scenario& out_;
  std::vector<std::string> error_models_;        // names, as far as read
  bool cases_are_known_ = true;                  // all have names of their own
  bool says_connected_ = false;                  // [feedback_hardware] does
  std::vector<std::size_t> follows_others_;      // cases that have the hardware if any needs it
  std::map<std::size_t, Value> case_overrides_;  // machine_override, by index of the case
};

}  // namespace

bool CaseSpec::needs_feedback_hardware() const {
  return std::any_of(strategies.begin(), strategies.end(),
                     [](const StrategySpec& one) { return one.entry->uses_feedback_hardware; });
}

const CaseSpec* Scenario::find_case(std::string_view case_name) const {
  for (const CaseSpec& one : cases) {
    if (one.name == case_name) return &one;
  }
  return nullptr;
}

std::optional<double> Scenario::signal_delay_of(const CaseSpec& one) const {
  if (one.servo == ServoModel::ideal) return std::nullopt;
  return machine.nc.periods.seconds(one.feedback_hardware ? hardware.signal_delay : 0);
}

Scenario read_document(ScenarioDocument scenario, const std::string& name, InputFiles& files) {
  Scenario out;
  out.name = name;
  out.machine_text = std::move(scenario.machine_text);
  ScenarioReader(std::move(scenario.document), files, out).read();
  return out;
}

Scenario read_scenario(const std::string& path, const std::vector<std::string>& changes) {
  return ScenarioSource(path, changes).at();
}

Scenario read_resolved_scenario(const std::string& resolved, const std::string& name) {
  InputFiles files;
  return read_document(with_machine(Document::from_text(resolved, name), {}, files), name, files);
}

MachineSettings read_machine_file(const std::string& path) {
  const Document document = Document::from_file(path);
  Reader root(document);
  MachineSettings machine = read_machine(root);
  root.finish();
  return machine;
}

}  // namespace servomill::sim
