#include "sim/recordings/hdf5_reader.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <system_error>
#include <utility>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/progress.h"
#include "sim/records/input_file.h"
#include "sim/records/nexus.h"
#include "sim/system/counted.h"

namespace servomill::sim::recordings {
namespace {

constexpr int kDeepest = 16;  // groups in groups; a link to a group above would never end

class Hdf5Walk {
 public:
  explicit Hdf5Walk(const std::string& path) : file_(path) {
    out_.file = path;
    is_recording_ = file_.has_attribute("/", kSourceAttribute);
    out_.format = is_recording_ ? "HDF5, recording of servomill" : "HDF5, result of servomill";
  }

  Recording read() {
    visit("", 0);
    if (out_.bases.empty()) {
      throw InputError({file_.path()},
                       "contains no group with a dataset 'time' or 'frequency': no signals");
    }
    return std::move(out_);
  }

 private:
  void visit(const std::string& group, int depth) {
    if (depth > kDeepest) return;
    for (const char* name : {"time", "frequency"}) {
      const std::string dataset = group + "/" + name;
      if (file_.has(dataset) && file_.shape(dataset).size() == 1) read_group(group, name);
    }
    for (const std::string& name : file_.groups(group.empty() ? "/" : group)) {
      visit(group + "/" + name, depth + 1);
    }
  }

  std::string units_of(const std::string& object) const {
    return file_.has_attribute(object, "units") ? file_.text(object, "units") : "";
  }

  // Before memory is taken for all of it: compression makes a byte into 1032 at most.
  void refuse_impossible_size(const std::string& dataset,
                              const std::vector<std::size_t>& shape) const {
    constexpr double kMaxPerByte = 1032.0;
    double count = 1.0;
    for (const std::size_t extent : shape) count *= static_cast<double>(extent);
    std::error_code fault;
    const auto bytes = std::filesystem::file_size(file_.path(), fault);
    if (fault || count <= kMaxPerByte * static_cast<double>(bytes)) return;
    throw InputError({file_.path()},
                     fmt::format("is damaged: '{}' has {:g} values in a file of {} bytes", dataset,
                                 count, bytes));
  }

  void read_group(const std::string& group, const std::string& base_name) {
    const std::string dataset = group + "/" + base_name;
    refuse_impossible_size(dataset, file_.shape(dataset));
    Base base;
    base.name = group.empty() ? base_name : group.substr(1) + "/" + base_name;
    if (is_recording_ && file_.has_attribute(dataset, "long_name")) {
      base.name = records::unlabelled(file_.text(dataset, "long_name"), units_of(dataset));
    }
    base.unit = units_of(dataset);
    base.values = file_.values(dataset);
    out_.bases.push_back(base);
    for (const std::string& name : file_.datasets(group.empty() ? "/" : group)) {
      if (name != base_name) read_dataset(group, name, base);
    }
  }

  void read_dataset(const std::string& group, const std::string& name, const Base& base) {
    const std::string dataset = group + "/" + name;
    const auto shape = file_.shape(dataset);
    if (shape.empty() || !file_.holds_numbers(dataset)) return;  // one value; labels of columns
    refuse_impossible_size(dataset, shape);
    if (shape[0] != base.values.size()) {
      if (!is_recording_) return;  // another list, not of this base
      throw InputError({file_.path()},
                       fmt::format("channel '{}' has {}, its {} has {}", shown(dataset),
                                   system::counted(shape[0], "sample"), base.name,
                                   system::counted(base.values.size(), "value")));
    }
    std::string own_name = shown(dataset);
    if (file_.has_attribute(dataset, "channel")) own_name = file_.text(dataset, "channel");
    if (shape.size() == 1) {
      add(own_name, dataset, file_.values(dataset));
    } else if (shape.size() == 2) {
      const std::string labels =
          file_.has_attribute(dataset, "columns") ? file_.text(dataset, "columns") : "";
      const std::vector<double> rows =
          file_.values(dataset);  // each column alone would decompress all
      for (std::size_t c = 0; c < shape[1]; ++c) {
        const std::string label =
            labels.size() == shape[1] ? std::string(1, labels[c]) : fmt::format("{}", c + 1);
        std::vector<double> column(shape[0]);
        for (std::size_t k = 0; k < shape[0]; ++k) column[k] = rows[k * shape[1] + c];
        add(own_name + "_" + label, dataset, std::move(column));
      }
    } else {
      out_.notes.push_back(fmt::format("'{}' has {} dimensions: skipped", dataset, shape.size()));
    }
  }

  static std::string shown(const std::string& dataset) { return dataset.substr(1); }

  void add(std::string name, const std::string& dataset, std::vector<double> samples) {
    throw_if_interrupted();
    stage_.advance();
    out_.channels.push_back(
        {std::move(name), units_of(dataset), std::move(samples), out_.bases.size() - 1});
  }

  records::InputFile file_;
  Stage stage_{"channels", 0.0};
  bool is_recording_ = false;
  Recording out_;
};

}  // namespace

Recording read_hdf5(const std::string& path) {
  Recording out = Hdf5Walk(path).read();
  check(out);
  return out;
}

}  // namespace servomill::sim::recordings
