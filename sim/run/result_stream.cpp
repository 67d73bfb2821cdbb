#include "sim/run/result_stream.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace servomill::sim::run {
namespace {

using strategies::PluginChild;
using strategies::ProcessPipe;

constexpr std::size_t kRowsAtOnce = 1024;

template <class Value>
requires std::is_trivially_copyable_v<Value>
void write(ProcessPipe& to, const Value& value) { to.write(&value, sizeof value); }

void write(ProcessPipe& to, const std::string& text) {
  write(to, text.size());
  to.write(text.data(), text.size());
}

std::string read_text(PluginChild& from) {
  std::string text(from.read<std::size_t>(), '\0');
  from.read(text.data(), text.size());
  return text;
}

void write(ProcessPipe& to, const records::Signal& one) {
  for (const std::string& text : {one.name, one.units, one.long_name, one.labels, one.scale}) {
    write(to, text);
  }
  write(to, one.storage);
  write(to, one.quantum);
}

records::Signal read_signal(PluginChild& from) {
  records::Signal one;
  for (std::string* text : {&one.name, &one.units, &one.long_name, &one.labels, &one.scale}) {
    *text = read_text(from);
  }
  one.storage = from.read<records::Storage>();
  one.quantum = from.read<double>();
  return one;
}

void write(ProcessPipe& to, const records::Series& series) {
  write(to, series.signals().size());
  for (const records::Signal& one : series.signals()) write(to, one);
  write(to, series.rows());
  std::vector<double> rows;
  for (std::size_t first = 0; first < series.rows(); first += kRowsAtOnce) {
    rows.clear();
    const std::size_t end = std::min(first + kRowsAtOnce, series.rows());
    for (std::size_t row = first; row < end; ++row) {
      for (std::size_t c = 0; c < series.width(); ++c) rows.push_back(series.at(row, c));
    }
    to.write(rows.data(), rows.size() * sizeof(double));
  }
}

records::Series read_series(PluginChild& from, const records::RowKeeping& keeping) {
  std::vector<records::Signal> signals(from.read<std::size_t>());
  for (records::Signal& one : signals) one = read_signal(from);
  const std::size_t width = records::Series(signals).width();
  const auto count = from.read<std::size_t>();
  records::RowKeeper keeper(signals, keeping, count);
  std::vector<double> rows;
  for (std::size_t first = 0; first < count; first += kRowsAtOnce) {
    rows.resize(std::min(kRowsAtOnce, count - first) * width);
    from.read(rows.data(), rows.size() * sizeof(double));
    keeper.add(rows);
  }
  return keeper.take();
}

void write(ProcessPipe& to, const engine::HeatCourse& course) {
  write(to, course.step);
  write(to, course.bodies);
  write(to, course.power.size());
  for (const double P : course.power) write(to, P);
}

engine::HeatCourse read_heat_course(PluginChild& from) {
  engine::HeatCourse out;
  out.step = from.read<double>();
  out.bodies = from.read<std::size_t>();
  out.power.resize(from.read<std::size_t>());
  for (double& P : out.power) P = from.read<double>();
  return out;
}

}  // namespace

void write_result(const engine::CaseResult& result, ProcessPipe& to) {
  const auto& [finished, interrupted, reason, axis, time] = result.outcome;
  write(to, finished);
  write(to, interrupted);
  write(to, reason);
  write(to, axis);
  write(to, time);
  write(to, result.servo);
  write(to, result.last_ticks);
  write(to, result.saturations.size());
  for (const strategies::Saturation& one : result.saturations) write(to, one);
  for (const engine::HeatCourse* course : {&result.heat, &result.known_heat}) write(to, *course);
  write(to, result.left_out.size());
  for (const std::size_t rows : result.left_out) write(to, rows);
  write(to, result.off_path);
  write(to, result.demands);
  write(to, result.simulated_time);
}

engine::CaseResult read_result(PluginChild& from, records::RowKeeping keeping) {
  keeping.thinning.reset();
  engine::CaseResult result;
  auto& [finished, interrupted, reason, axis, time] = result.outcome;
  finished = from.read<bool>();
  interrupted = from.read<bool>();
  reason = read_text(from);
  axis = from.read<char>();
  time = from.read<double>();
  result.servo = read_series(from, keeping);
  keeping.encodes = false;
  result.last_ticks = read_series(from, keeping);
  result.saturations.resize(from.read<std::size_t>());
  for (strategies::Saturation& one : result.saturations) one = from.read<strategies::Saturation>();
  for (engine::HeatCourse* course : {&result.heat, &result.known_heat}) {
    *course = read_heat_course(from);
  }
  result.left_out.resize(from.read<std::size_t>());
  for (std::size_t& rows : result.left_out) rows = from.read<std::size_t>();
  result.off_path = from.read<double>();
  result.demands = from.read<engine::AxisDemands>();
  result.simulated_time = from.read<double>();
  return result;
}

}  // namespace servomill::sim::run
