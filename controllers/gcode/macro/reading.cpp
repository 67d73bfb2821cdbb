#include "controllers/gcode/macro/reading.h"

#include <utility>

namespace servomill::controllers::macro {

void MacroReading::refuse(const Place& place, std::string message) const {
  throw InputError(place, std::move(message));
}

void MacroReading::fail(const Place& place, std::string message) const {
  if (is_trial_) throw Undetermined();
  refuse(place, std::move(message));
}

int MacroReading::choose(WordDifference difference, const Place& place) const {
  const auto own = reading_of(difference, reader_);
  if (!own) fail(place, both_readings(difference));
  return *own;
}

void MacroReading::apply(ReaderRule rule, const Place& place) {
  if (applied_.insert(rule).second) warnings_.push_back({place, sentence(rule)});
}

void MacroReading::warn(const Place& place, std::string message) {
  if (!warned_.insert(to_string(place)).second) return;
  warnings_.push_back({place, std::move(message)});
}

}  // namespace servomill::controllers::macro
