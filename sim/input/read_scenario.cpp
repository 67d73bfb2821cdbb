#include "sim/input/read_scenario.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "plant/vocabulary/units.h"
#include "sim/config/reader.h"
#include "sim/input/drawn_errors.h"
#include "sim/input/known_name.h"
#include "sim/input/machine_document.h"
#include "sim/input/plugins.h"
#include "sim/input/read_case.h"
#include "sim/input/read_cutting.h"
#include "sim/input/read_day.h"
#include "sim/input/read_design.h"
#include "sim/input/read_errors.h"
#include "sim/input/read_machine.h"
#include "sim/input/read_machine_test.h"
#include "sim/input/read_nominal_part.h"
#include "sim/input/read_probes.h"
#include "sim/input/read_program.h"
#include "sim/input/read_quantity.h"
#include "sim/input/read_record.h"
#include "sim/input/read_ticks.h"
#include "sim/input/read_touch_probe.h"
#include "sim/input/scenario_document.h"
#include "sim/input/scenario_source.h"
#include "sim/input/test_faults.h"
#include "sim/input/uncertain_errors.h"
#include "sim/metrology/circular_test.h"
#include "sim/model/run_settings.h"
#include "sim/model/scenario.h"
#include "sim/model/schedule.h"
#include "sim/system/base64.h"
#include "strategies/registry.h"

namespace servomill::sim::input {
namespace {

class ScenarioReader {
 public:
  ScenarioReader(config::Document document, InputFiles& files, model::Scenario& out)
      : document_(std::move(document)), files_(files), out_(out) {}

  void read() {
    config::Reader root(document_);
    root.raw("based_on");  // still there in result files of earlier versions
    if (root.place("based_on").file.starts_with("--set")) {
      root.fault("based_on", "cannot be changed by --set: name the other scenario");
    }
    root.raw("machine_override");  // is in the machine by now
    out_.title = root.text_or("title", out_.name);
    out_.source = root.text_or("source", "");
    const std::string plugins = read_plugins(root);
    config::Reader machine = root.table("machine");
    out_.machine = read_machine(machine, &out_.errors);
    read_covariance(machine);
    read_tests_and_program(root);
    read_error_models(root);
    read_hardware(root);
    read_record(root, out_);
    check_rows_of_tests(root);
    out_.day = read_day(root, out_);
    out_.cmm = read_cmm(root);
    out_.probes = read_probes(root, !out_.program.cutters.empty());
    check_record(root, out_);
    check_periods(root);
    read_cut(root);
    refuse_averaged_teeth(root);
    out_.touch_probe = read_touch_probe(root, out_.stock, out_.part);
    refuse_unused(root);
    const std::size_t before = root.faults();
    std::vector<config::Reader> cases = root.tables("case");
    const bool has_cases = root.faults() == before;
    CaseReader case_reader(error_models_, hardware_is_chosen_, out_);
    for (config::Reader& table : cases) case_reader.read(table);
    case_reader.connect_hardware();
    const bool checks_cases = has_cases && case_reader.names_are_known();
    for (config::Reader& table : root.tables_or_none("quantity")) {
      read_quantity(table, checks_cases, out_);
    }
    if (root.has("sweep")) {
      config::Reader sweep = root.table("sweep");
      SweepReading reading = read_sweep(sweep, files_);
      out_.sweep = std::move(reading.design);
      identified_ = std::move(reading.identified);
    }
    root.finish();
    check_plan();
    case_reader.read_machines(document_);
    document_.merge(with_contents_of_files());
    document_.merge(with_identified_values().root());
    if (!plugins.empty()) document_.set(plugins);
    out_.resolved = document_.to_toml();
  }

 private:
  static config::Value text_value(const std::string& key, const std::string& text) {
    config::Value value;
    value.type = config::Value::Type::text;
    value.key = key;
    value.text = text;
    value.written = config::quoted_text(text);
    return value;
  }

  // { program = { text = "..." }, part = { ... } }: a resolved document needs no other file but a
  // long program.
  config::Value with_contents_of_files() const {
    config::Value program;
    program.key = "program";
    // the program of [[test]] follows from its keys
    const StoredText& code = *out_.program.shared_text;
    constexpr std::size_t kLongest = 1'000'000;  // bytes
    if (out_.tests.empty() && code.size() <= kLongest) {
      program.children.push_back(text_value("text", code.all()));
    } else if (out_.tests.empty()) {
      program.children.push_back(text_value("text_checksum", checksum_text(code)));
    }
    if (!out_.program.subroutines.empty()) {
      config::Value subroutines;
      subroutines.key = "subroutines";
      for (const auto& [name, text] : out_.program.subroutines) {
        subroutines.children.push_back(text_value(name, text));
      }
      program.children.push_back(std::move(subroutines));
    }
    config::Value root;
    root.children.push_back(std::move(program));
    if (out_.part) {
      config::Value part;
      part.key = "part";
      part.children.push_back(text_value("stl", out_.part->file));
      part.children.push_back(text_value("stl_base64", system::base64(out_.part->bytes)));
      root.children.push_back(std::move(part));
    }
    return root;
  }

  // [[sweep.samples.identified]], in place of the files of samples.from.
  config::Document with_identified_values() const {
    std::string toml;
    for (const IdentifiedValues& one : identified_) {
      toml += "[[sweep.samples.identified]]\n" + table_lines(one);
    }
    return config::Document::from_text(toml, "");
  }

  void read_tests_and_program(config::Reader& root) {
    const std::size_t before = root.faults();
    out_.tests = read_machine_tests(root, out_.machine.chain.layout);
    config::Reader program =
        out_.tests.empty() ? root.table("program") : root.table_or_empty("program");
    out_.program = read_program(program, out_.machine, files_, out_.tests);
    if (root.faults() > before) return;
    auto faults = faults_of_tests(out_.tests, out_.machine, out_.program);
    if (!faults.empty()) throw InputError(std::move(faults));
  }

  // [machine.identified], which is there where a quantity needs it.
  void read_covariance(config::Reader& machine) {
    if (!machine.has("identified")) return;
    config::Reader table = machine.table("identified");
    const IdentifiedValues identified = read_identified_table(table);
    const std::vector<std::string> models = models_of_keys(identified.keys);
    if (models.size() != 1 || machine.faults() > 0) return;
    const config::Value* errors = value_at(document_.root(), "machine.errors." + models.front());
    if (errors == nullptr) return;
    if (auto read =
            uncertain_errors(*errors, models.front(), identified, out_.machine.chain.layout)) {
      out_.uncertain = std::make_shared<const model::UncertainErrors>(std::move(*read));
    }
  }

  void read_error_models(config::Reader& root) {
    std::vector<std::string>& names = error_models_;
    if (root.has("errors")) {
      config::Reader models = root.table("errors");
      names = models.keys();
      if (out_.machine.chain.layout != JointLayout{}) {
        for (auto& [name, model] : input::read_error_models(models, MachineAxes(out_.machine))) {
          out_.errors[name] = std::move(model);
        }
      } else {  // their errors have no axes
        for (const std::string& name : names) models.raw(name);
      }
    }
    for (const auto& [name, model] : out_.errors) {
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
    for (auto [key, to] :
         {std::pair{"machine_errors", &out_.machine_errors}, std::pair{"imposed", &out_.imposed}}) {
      *to = root.text_or(key, "");
      if (!to->empty()) must_be_known(root, key, *to, "error model", names);
    }
  }

  void read_hardware(config::Reader& root) {
    model::FeedbackHardware& hardware = out_.hardware;
    const double base = out_.machine.nc.periods.base;
    config::Reader table = root.table_or_empty("feedback_hardware");
    hardware_is_chosen_ = table.has("connected");
    hardware.connected = table.boolean_or("connected", false);
    hardware.signal_delay = read_ticks(table, "signal_delay_us", 10 * us, base, 0);
    if (table.faults() == 0 &&
        hardware.signal_delay + out_.machine.scale_delay >= out_.machine.nc.periods.position) {
      table.fault(
          fmt::format("signal_delay_us and nc.scale_delay_us together must be shorter than the "
                      "position period of {:g} us",
                      out_.machine.nc.periods.seconds(out_.machine.nc.periods.position) / us));
    }
    hardware.model_period = read_ticks(table, "model_period_us", 60 * us, base, 1);
  }

  // Several rows in the half of each dwell in which the device is read, and one for each reading of
  // a circle.
  void check_rows_of_tests(config::Reader& root) {
    constexpr double kMaxShare = 0.1;  // of the dwell
    const double period = out_.machine.nc.periods.seconds(out_.record_period);
    for (const auto& test : out_.tests) {
      if (!test->moves()) continue;  // its keys have faults
      const bool is_turned = test->readings > 0 && (test->is_rotary() || test->radius > 0.0);
      const double spacing = std::min(metrology::kRecordedSpacing, test->reading_spacing());
      const double turned = period * (test->is_rotary() ? test->feed : test->feed / test->radius);
      if (period > kMaxShare * test->dwell) {
        root.table_or_empty("record").fault(
            fmt::format("period_ms must be at most {:g} ms, a tenth of the dwell of test {}",
                        kMaxShare * test->dwell / ms, test->name));
      } else if (is_turned && turned > spacing) {
        root.table_or_empty("record").fault(
            fmt::format("period_ms must be at most {:.3g} ms: {:g} deg of {} of test {}",
                        period * spacing / turned / ms, spacing / deg,
                        test->is_rotary() ? "the turn" : "the circle", test->name));
      }
    }
  }

  // The static schedule covers one common multiple of all periods.
  void check_periods(config::Reader& root) {
    const model::LoopPeriods& p = out_.machine.nc.periods;
    if (!model::can_be_scheduled({p.position, p.velocity, p.current}))
      return;  // said with the machine
    if (model::hyperperiod({{model::kPositionLoop, p.position},
                            {model::kVelocityLoop, p.velocity},
                            {model::kCurrentLoop, p.current},
                            {model::kErrorModel, out_.hardware.model_period},
                            {model::kRecord, out_.record_period}}) > 0) {
      return;
    }
    root.table_or_empty("record").fault(
        fmt::format("the common period of the loops, the error model and the recorder exceeds {:g} "
                    "s; make the periods multiples of each other",
                    p.seconds(model::kMaxHyperperiod)));
  }

  void read_cut(config::Reader& root) {
    if (root.has("part")) {
      config::Reader part = root.table("part");
      out_.part = read_nominal_part(part, files_);
      out_.stock = read_stock(part);
    }
    if (!root.has("cutting")) return;
    config::Reader cutting = root.table("cutting");
    out_.cutting = read_cutting(cutting);
    out_.cutting->place = root.place("cutting");
    if (out_.stock.empty() && cutting.faults() == 0) {
      cutting.fault("needs stock: [[part.stock]] with a box or a cylinder");
    }
    if (!out_.cutting->teeth) return;
    for (const int tool : out_.program.assumed_teeth) {
      cutting.fault("force", fmt::format("needs the number of teeth of tool {}", tool));
    }
  }

  // Keys of single teeth have no effect on an average.
  void refuse_averaged_teeth(config::Reader& root) const {
    if (out_.cutting && out_.cutting->teeth) return;
    if (out_.cmm.tooth_marks) {
      root.table("cmm").fault("tooth_marks", "needs cutting.force = \"instantaneous\"");
    }
    for (const auto& [number, cutter] : out_.program.cutters) {
      if (cutter.runout <= 0.0) continue;
      root.table("program").fault(fmt::format(
          "tool: runout_um of tool {} needs cutting.force = \"instantaneous\"", number));
    }
  }

  // Refuses keys that nothing would look at, though the user counts on them.
  void refuse_unused(config::Reader& root) {
    if (root.faults() > 0 || root.has("probe")) return;
    if (root.has("cmm")) root.table("cmm").fault("has no effect: there is no [[probe]]");
    if (out_.touch_probe) return;
    if (out_.part) {
      root.table("part").fault(
          "stl", "is the reference for the alignment of probed points: it needs a [[probe]]");
    }
    if (!out_.stock.empty() && !out_.cutting) {
      root.table("part").fault(
          "stock is neither cut nor probed: it needs [cutting] or a [[probe]]");
    }
  }

  // Only of a plan that is right in itself.
  void check_plan() const {
    if (!out_.part) return;
    auto faults = evaluation::faults_of_plan(out_.probes, *out_.part);
    if (!faults.empty()) throw InputError(std::move(faults));
  }

  config::Document document_;
  InputFiles& files_;
  model::Scenario& out_;
  std::vector<std::string> error_models_;     // names, as far as read
  std::vector<IdentifiedValues> identified_;  // that the sweep draws samples of
  bool hardware_is_chosen_ = false;           // [feedback_hardware] says if it is connected
};

}  // namespace

model::Scenario read_document(ScenarioDocument scenario, const std::string& name,
                              InputFiles& files) {
  model::Scenario out;
  out.name = name;
  out.machine_text = std::move(scenario.machine_text);
  ScenarioReader(std::move(scenario.document), files, out).read();
  return out;
}

model::Scenario read_scenario(const std::string& path, const std::vector<std::string>& changes) {
  return ScenarioSource(path, changes).at();
}

std::shared_ptr<const model::Scenario> shared_scenario(const std::string& path,
                                                       const std::vector<std::string>& changes) {
  return std::make_shared<const model::Scenario>(read_scenario(path, changes));
}

model::Scenario read_resolved_scenario(const std::string& resolved, const std::string& name,
                                       std::shared_ptr<const StoredText> program) {
  InputFiles files;
  files.provide_program(std::move(program));
  return read_document(with_machine(config::Document::from_text(resolved, name), {}, files), name,
                       files);
}

model::MachineSettings read_machine_file(const std::string& path) {
  InputFiles files;
  const config::Document document = machine_document(path, files).document;
  config::Reader root(document);
  model::MachineSettings machine = read_machine(root);
  root.finish();
  return machine;
}

}  // namespace servomill::sim::input
