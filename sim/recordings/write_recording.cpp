#include "sim/recordings/write_recording.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "plant/vocabulary/input_error.h"
#include "sim/recordings/hdf5_reader.h"
#include "sim/records/hdf5_group.h"
#include "sim/records/nexus.h"
#include "sim/records/output_file.h"
#include "sim/system/write_file.h"

namespace servomill::sim::recordings {
namespace {

std::string heading(const std::string& name, const std::string& unit) {
  std::string text = unit.empty() ? name : fmt::format("{} [{}]", name, unit);
  if (text.find_first_of(",\";") == std::string::npos) return text;
  // the reader ends a quoted field at the quote
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? '\'' : c;
  return quoted + "\"";
}

void write_hdf5(const Recording& recording, const std::string& path, bool force) {
  records::OutputFile file(path, force);
  file.remove_unless_committed();
  records::Hdf5Group root = file.root();
  root.attribute(kSourceAttribute, recording.file);
  root.attribute("recording_format", recording.format);
  records::make_nexus_group(root, "NXroot", recording.bases.empty() ? "" : "base_001");
  for (std::size_t b = 0; b < recording.bases.size(); ++b) {
    const Base& base = recording.bases[b];
    records::Hdf5Group group = root.group(fmt::format("base_{:03}", b + 1));
    const std::string scale = base.unit == "Hz" ? "frequency" : "time";
    group.list(scale, base.values, {base.unit, base.name});
    std::size_t number = 0;
    std::string plotted_unit;
    records::Plot plot{"", {scale}, {}};
    for (const Channel& channel : recording.channels) {
      if (channel.base != b) continue;
      const std::string name = fmt::format("channel_{:04}", ++number);
      group.list(name, channel.samples, {channel.unit, channel.name}, scale);
      group.dataset(name).attribute("channel", channel.name);
      if (plot.signal.empty()) {
        plot.signal = name;
        plotted_unit = channel.unit;
      } else if (channel.unit == plotted_unit) {
        plot.others.push_back(name);
      }
    }
    if (!plot.signal.empty()) records::make_nexus_data(group, plot);
  }
  file.commit();
}

}  // namespace

void refuse_unknown_kind(const std::string& path) {
  if (path.ends_with(".csv") || path.ends_with(".h5")) return;
  throw InputError({path}, "recordings are written as .csv or .h5");
}

std::string to_csv(const Recording& recording) {
  if (recording.bases.size() != 1) {
    throw InputError({recording.file},
                     fmt::format("has {} time or frequency bases, a table has one; write .h5",
                                 recording.bases.size()));
  }
  const Base& base = recording.bases.front();
  std::string out =
      base.unit == "1" ? "sample" : heading(base.unit == "s" ? "time" : base.name, base.unit);
  for (const Channel& channel : recording.channels) {
    out += "," + heading(channel.name, channel.unit);
  }
  out += "\n";
  for (std::size_t i = 0; i < base.values.size(); ++i) {
    fmt::format_to(std::back_inserter(out), "{}", base.values[i]);
    for (const Channel& channel : recording.channels) {
      const double sample = channel.samples[i];
      out += ',';
      if (!std::isnan(sample)) fmt::format_to(std::back_inserter(out), "{}", sample);
    }
    out += "\n";
  }
  return out;
}

void write_recording(const Recording& recording, const std::string& path, bool force) {
  refuse_unknown_kind(path);
  if (path.ends_with(".csv")) {
    system::write_text_file(path, to_csv(recording), force);
  } else {
    write_hdf5(recording, path, force);
  }
}

}  // namespace servomill::sim::recordings
