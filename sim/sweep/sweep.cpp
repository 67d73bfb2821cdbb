#include "sim/sweep/sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <set>
#include <thread>

#include "plant/vocabulary/interrupt.h"
#include "sim/config/document.h"
#include "sim/input/scenario_document.h"
#include "sim/preparation/estimate.h"
#include "sim/preparation/preparation_cache.h"
#include "sim/system/background.h"

namespace servomill::sim {
namespace {

constexpr auto kProgressPeriod = std::chrono::milliseconds(20);  // an interrupt waits for it, too
constexpr std::uint64_t kProbes = 8;          // points tried before all are given up
constexpr std::uint64_t kMostChecked = 256;   // points that `check` reads
constexpr std::size_t kBatchesPerThread = 4;  // at least, so that threads end together
constexpr std::size_t kWaitingPerThread = 2;  // batches that may wait to be written

// Values of these keys name files, which stand beside the scenario.
bool names_a_file(const std::string& key) {
  return key == "machine" || key == "program.file" || key == "part.stl";
}

std::string unquoted(const std::string& text) { return text.substr(1, text.size() - 2); }

// `count` points of `size`, the first and the last among them, in equal steps.
std::vector<std::uint64_t> spread(std::uint64_t size, std::uint64_t count) {
  std::vector<std::uint64_t> points;
  const std::uint64_t few = std::min(size, count);
  for (std::uint64_t i = 0; i < few; ++i) {
    points.push_back(few == 1 ? 0 : i * (size - 1) / (few - 1));
  }
  return points;
}

// The nearest of the names that the scenario has beside a key that it does not know.
std::string near_key(const std::string& resolved, const std::string& key) {
  const Document document = Document::from_text(resolved, "");
  const Value* table = &document.root();
  std::size_t begin = 0;
  for (std::size_t dot = key.find('.'); dot != std::string::npos && table != nullptr;
       dot = key.find('.', begin)) {
    table = table->find(key.substr(begin, dot - begin));
    begin = dot + 1;
  }
  if (table == nullptr || table->type != Value::Type::table) return {};
  std::vector<std::string_view> names;
  for (const Value& entry : table->children) names.push_back(entry.key);
  return did_you_mean(key.substr(begin), names);
}

// The part of KEY=VALUE before the '=', which may be quoted in it.
std::string key_of(const std::string& change) {
  char quote = 0;
  for (std::size_t i = 0; i < change.size(); ++i) {
    const char c = change[i];
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '=') {
      return change.substr(0, i);
    }
  }
  return change;
}

// Tells if a value of the key is gone once `later` is set: keys have several spellings.
bool is_replaced(const Document& document, const std::string& key, const std::string& later) {
  if (key != later && later == "machine") return false;  // its keys are set after the file is read
  const auto with = [&](const char* value) {
    Document changed = document;
    changed.set(key + "=" + value);
    changed.set(later + "=0");
    return changed.to_toml();
  };
  try {
    return with("1") == with("2");
  } catch (const InputError&) {
    return false;  // it is a table, in which the later key has its place
  }
}

// A value for a key that the sweep varies would never be used.
void refuse_swept(const std::vector<std::string>& changes, const Scenario& base) {
  if (changes.empty()) return;
  const Document document = Document::from_text(base.resolved, "");
  std::vector<Fault> faults;
  for (const std::string& change : changes) {
    for (const SweepKey& varied : base.sweep.keys) {
      if (!is_replaced(document, key_of(change), varied.key)) continue;
      faults.push_back({{"--set " + change},
                        fmt::format("the sweep varies {} ({}); this value would never be used",
                                    varied.key, to_string(varied.place))});
    }
  }
  if (!faults.empty()) throw InputError(std::move(faults));
}

// Without the value in it: the same fault at another point has another one.
std::string without(std::string message, const std::string& value) {
  const std::size_t at = message.find(value);
  return at == std::string::npos ? message : message.erase(at, value.size());
}

}  // namespace

Sweep::Sweep(std::string scenario_path, std::vector<std::string> changes)
    : path_(std::move(scenario_path)),
      changes_(std::move(changes)),
      source_(path_, changes_),
      base_(source_.at()) {
  if (base_.sweep.empty()) {
    throw InputError({path_},
                     "has no [sweep] table; add one such as [sweep] "
                     "\"program.feed_override\" = [0.5, 1.0]");
  }
  refuse_swept(changes_, base_);
  base_.swept_files = swept_files();
}

// The file that a value of a key names, seen from the folder in which the user is.
std::optional<std::string> Sweep::named_file(std::size_t key, const std::string& value) const {
  const SweepKey& one = design().keys[key];
  const bool quoted = value.size() >= 2 && (value.front() == '"' || value.front() == '\'');
  if (!quoted || !names_a_file(one.key)) return std::nullopt;
  return beside(one.place, unquoted(value));
}

std::string Sweep::assignment(std::size_t key, const std::string& value) const {
  const auto file = named_file(key, value);
  return design().keys[key].key + "=" + (file ? quoted_text(*file) : value);
}

std::string Sweep::swept_files() const {
  std::set<std::string> lines;
  for (std::size_t key = 0; key < design().keys.size(); ++key) {
    const auto* values = std::get_if<ValueTexts>(&design().keys[key].values);
    if (values == nullptr) continue;
    for (const std::string& value : *values) {
      const auto file = named_file(key, value);
      if (!file) continue;
      const auto checksum = source_.checksum(*file);
      lines.insert(fmt::format("{} {}", checksum ? fmt::format("{:016x}", *checksum) : "unreadable",
                               unquoted(value)));
    }
  }
  return fmt::format("{}", fmt::join(lines, "\n"));
}

// The user wrote a list in the scenario, not --set: faults of its values stand there.
InputError Sweep::at_the_list(const InputError& error,
                              const std::vector<std::string>& values) const {
  std::vector<Fault> faults = error.faults();
  for (Fault& fault : faults) {
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (fault.place.file != "--set " + assignment(k, values[k])) continue;
      const SweepKey& key = design().keys[k];
      if (fault.message.ends_with("is not known")) {
        fault.message += near_key(base_.resolved, key.key);
      }
      fault.place = key.place;
      fault.message = fmt::format("sweep.\"{}\": {}", key.key, fault.message);
    }
  }
  return InputError(std::move(faults));
}

Scenario Sweep::at(std::uint64_t point) const {
  const std::vector<std::string> values = design().point(point);
  std::vector<std::string> changes;
  for (std::size_t k = 0; k < values.size(); ++k) changes.push_back(assignment(k, values[k]));
  try {
    return source_.at(changes);
  } catch (const InputError& error) {
    throw at_the_list(error, values);
  }
}

std::vector<ComparisonRow> Sweep::quantities() const { return compare(base_.quantities, {}); }

std::optional<RunEstimate> Sweep::refuse_hopeless() const {
  const auto probes = spread(design().size(), kProbes);
  std::vector<Fault> common;  // faults of all probes so far
  std::optional<InputError> first;
  for (const std::uint64_t point : probes) {
    const std::vector<std::string> values = design().point(point);
    try {
      const Scenario scenario = at(point);
      try {
        return check_scenario(scenario);
      } catch (const InputError& error) {
        throw at_the_list(error, values);
      }
    } catch (const InputError& error) {
      std::vector<Fault> faults = error.faults();
      for (Fault& fault : faults) {
        for (const std::string& value : values) fault.message = without(fault.message, value);
      }
      if (!first) {
        first = error;
        common = faults;
      }
      std::erase_if(common, [&](const Fault& one) {
        return std::none_of(faults.begin(), faults.end(), [&](const Fault& other) {
          return one.place == other.place && one.message == other.message;
        });
      });
    } catch (const Interrupted&) {
      throw;
    } catch (const std::exception&) {
      return std::nullopt;  // failed, not refused: its row will say why
    }
  }
  if (!common.empty() || probes.size() == design().size()) throw *first;
  return std::nullopt;
}

void Sweep::check() const {
  for (const std::uint64_t point : spread(design().size(), kMostChecked)) {
    const Scenario scenario = at(point);
    try {
      check_scenario(scenario);
    } catch (const InputError& error) {
      throw at_the_list(error, design().point(point));
    }
  }
}

namespace {

// Hands out batches of neighbours among the points that are to be run.
class Todo {
 public:
  Todo(const Selection& selection, const std::vector<bool>& done)
      : selection_(selection), done_(done) {}

  std::uint64_t count() const {
    return selection_.size() -
           static_cast<std::uint64_t>(std::count(done_.begin(), done_.end(), true));
  }
  std::vector<std::uint64_t> next(std::size_t most) {
    const std::scoped_lock lock(mutex_);
    std::vector<std::uint64_t> points;
    for (; place_ < selection_.size() && points.size() < most; ++place_) {
      if (!done_.empty() && done_[place_]) continue;
      points.push_back(selection_.point(place_));
    }
    return points;
  }

 private:
  const Selection& selection_;
  const std::vector<bool>& done_;
  std::mutex mutex_;
  std::uint64_t place_ = 0;
};

// Batches on their way from the threads that run them to the one that takes the results.
class Results {
 public:
  explicit Results(std::size_t most) : most_(most) {}

  void put(std::vector<SweepPoint> batch) {
    std::unique_lock lock(mutex_);
    room_.wait(lock, [&] { return waiting_.size() < most_ || closed_; });
    waiting_.push_back(std::move(batch));
    news_.notify_one();
  }
  // Nothing, if there was none within some time.
  std::optional<std::vector<SweepPoint>> take(std::chrono::milliseconds patience) {
    std::unique_lock lock(mutex_);
    if (!news_.wait_for(lock, patience, [&] { return !waiting_.empty(); })) return std::nullopt;
    std::vector<SweepPoint> batch = std::move(waiting_.front());
    waiting_.pop_front();
    room_.notify_one();
    return batch;
  }
  // Nobody takes any more: whoever waits for room goes on.
  void close() {
    const std::scoped_lock lock(mutex_);
    closed_ = true;
    room_.notify_all();
  }

 private:
  std::size_t most_;
  std::mutex mutex_;
  std::condition_variable room_, news_;
  std::deque<std::vector<SweepPoint>> waiting_;
  bool closed_ = false;
};

bool same_question(const ComparisonRow& a, const ComparisonRow& b) {
  return a.case_name == b.case_name && a.quantity == b.quantity && a.axis == b.axis &&
         a.statistic == b.statistic && a.sections == b.sections && a.unit == b.unit;
}

// Runs the points of one batch: those that can be read together, the others are refused.
void run_points(const Sweep& sweep, const std::vector<std::uint64_t>& points, const StopFlag& stop,
                std::atomic<float>& progress, const BatchControl& control, Results& results) {
  std::vector<SweepPoint> refused, read;
  std::vector<Scenario> scenarios;
  for (const std::uint64_t point : points) {
    SweepPoint one{point, sweep.design().point(point), {}};
    try {
      scenarios.push_back(sweep.at(point));
      read.push_back(std::move(one));
      continue;
    } catch (const InputError& error) {
      one.result = {PointStatus::refused, in_one_line(error), {}};
    } catch (const Interrupted&) {
      throw;
    } catch (const std::exception& error) {
      one.result = {PointStatus::failed, error.what(), {}};
    }
    refused.push_back(std::move(one));
  }
  if (!refused.empty()) results.put(std::move(refused));
  const std::vector<ComparisonRow> wanted = sweep.quantities();
  const auto tell = [&](std::vector<EndedPoint>&& ended) {
    std::vector<SweepPoint> told;
    for (EndedPoint& one : ended) {
      const auto& rows = one.result.rows;
      if (!rows.empty() &&
          !std::equal(wanted.begin(), wanted.end(), rows.begin(), rows.end(), same_question)) {
        one.result = {PointStatus::refused,
                      "asks for other quantities or cases than the scenario without its sweep",
                      {}};
      }
      told.push_back(std::move(read[one.place]));
      told.back().result = std::move(one.result);
    }
    results.put(std::move(told));
  };
  run_batch(scenarios, stop, progress, tell, control);
}

}  // namespace

void run_sweep(const Sweep& sweep, const Selection& selection, const std::vector<bool>& done,
               const SweepControl& control) {
  static const StopFlag kNever = false;
  const StopFlag& stop = control.stop != nullptr ? *control.stop : kNever;
  Todo todo(selection, done);
  const std::uint64_t count = todo.count();
  const auto threads = static_cast<unsigned>(std::clamp<std::uint64_t>(
      thread_count(control.threads), 1, std::max<std::uint64_t>(count, 1)));
  const std::size_t batch =
      std::clamp<std::size_t>(count / (kBatchesPerThread * threads), 1, control.batch);

  PreparationCache cache;
  const BatchControl batch_control = {control.keep, &cache, rows_at_once(threads)};
  // signals are large: those of few points wait
  Results results(control.keep == Keep::series ? 1 : kWaitingPerThread * threads);
  std::vector<std::atomic<float>> shares(threads);  // of the batches in work
  std::atomic<std::uint64_t> ended = 0;             // points of batches that were
  std::atomic<unsigned> running = threads;
  std::atomic<bool> given_up = false;
  std::vector<std::exception_ptr> failures(threads);
  const auto work = [&](std::size_t thread) {
    try {
      while (!stop && !given_up) {
        const std::vector<std::uint64_t> points = todo.next(batch);
        if (points.empty()) break;
        run_points(sweep, points, stop, shares[thread], batch_control, results);
        shares[thread] = 0.0F;
        ended += points.size();
      }
    } catch (const Interrupted&) {
      given_up = true;  // what has ended is there
    } catch (...) {
      failures[thread] = std::current_exception();
    }
    --running;
  };
  const auto tell_progress = [&] {
    if (!control.progress || count == 0) return;
    double points = static_cast<double>(ended);
    for (const auto& share : shares) points += static_cast<double>(batch) * share;
    control.progress(std::min(1.0, points / static_cast<double>(count)));
  };
  std::vector<std::jthread> pool;
  // should the results not be writable, no further batch begins
  struct NoMore {
    std::atomic<bool>& given_up;
    Results& results;
    ~NoMore() {
      given_up = true;
      results.close();
    }
  };
  {
    const NoMore no_more{given_up, results};
    for (std::size_t t = 0; t < threads; ++t) pool.emplace_back(work, t);
    for (bool last = false; !last;) {
      last = running == 0;  // what they put before is there by now
      while (auto points = results.take(last ? std::chrono::milliseconds(0) : kProgressPeriod)) {
        if (control.batch_done) control.batch_done(std::move(*points));
        tell_progress();
      }
      tell_progress();
    }
  }
  pool.clear();
  for (const std::exception_ptr& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
}

}  // namespace servomill::sim
