#include <algorithm>
#include <cmath>

#include "sim/recordings/survey.h"
#include "sim/system/json.h"

namespace servomill::sim::recordings {
namespace {

using system::JsonObject;

std::string base_json(const Base& base) {
  std::vector<std::string> list;
  for (const Gap& gap : gaps(base)) {
    list.push_back(JsonObject()
                       .number("from", gap.from)
                       .number("to", gap.to)
                       .integer("missing", gap.missing)
                       .line());
  }
  JsonObject out;
  out.text("name", base.name).text("unit", base.unit).integer("samples", base.values.size());
  if (!base.values.empty()) {
    out.number("first", base.values.front()).number("last", base.values.back());
  }
  return out.number("interval", interval(base))
      .number("jitter", jitter(base))
      .raw("gaps", system::json_list(list))
      .line();
}

std::string channel_json(const Channel& channel) {
  std::vector<std::string> list;
  for (const Clipping& one : clipping(channel)) {
    list.push_back(JsonObject()
                       .number("level", one.level)
                       .integer("runs", one.runs)
                       .integer("samples", one.samples)
                       .line());
  }
  double least = std::nan(""), greatest = std::nan("");
  for (const double sample : channel.samples) {  // fmin and fmax pass over NaN
    least = std::fmin(least, sample);
    greatest = std::fmax(greatest, sample);
  }
  return JsonObject()
      .text("channel", channel.name)
      .text_or_null("unit", channel.unit)
      .integer("base", channel.base)
      .integer("samples", channel.samples.size())
      .integer("missing", missing_samples(channel))
      .number("min", least)
      .number("max", greatest)
      .raw("clipping", system::json_list(list))
      .line();
}

}  // namespace

std::string survey_json(const Recording& recording) {
  std::vector<std::string> bases, channels;
  for (const Base& base : recording.bases) bases.push_back(base_json(base));
  for (const Channel& channel : recording.channels) channels.push_back(channel_json(channel));
  return JsonObject()
      .text("file", recording.file)
      .text("format", recording.format)
      .raw("bases", system::json_list(bases))
      .raw("channels", system::json_list(channels))
      .raw("notes", system::json_texts(recording.notes))
      .line();
}

}  // namespace servomill::sim::recordings
