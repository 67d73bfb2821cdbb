/// Reads a document into values of SI units and collects all that is wrong with it.
///
/// ```
/// Reader root(document);
/// Reader drive = root.table("drives").table("Y");
/// double lead = drive.real("lead_mm", kLength, {above(0.0)});       // m
/// double Kv = root.table("nc").real_or("Kv", 60.0, kRate, {above(0.0)});
/// root.finish();                                                    // throws all faults at once
/// ```
/// (This example is also a test: Reader.ReadsTheExampleOfItsHeader.)
///
/// The faults read `machine.toml:14:11: error: drives.Y.lead_mm = -10; must be > 0`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/config/document.h"
#include "sim/config/quantity.h"
#include "sim/config/rule.h"

namespace servomill::sim::config {

struct KeyUse;
class ReadingRecord;

/// A cursor over one table. All cursors over one document share its faults.
///
/// A function named after a type reads a required key; with `_or` the key may be absent. Where a
/// value is wrong a fault is noted and a harmless value returned (0, "", an empty list), so that
/// the reading goes on; `finish()` throws before anyone can use it. Numbers must be finite.
///
/// Quantities: the end of the key names the unit ("lead_mm"), or else the number is in SI ("Kv" in
/// 1/s); a text with a unit of the same dimension is taken as well ("3.6 m/min/mm"). The result is
/// always in SI.
class Reader {
 public:
  /// @param document  must outlive the reader
  explicit Reader(const Document& document);

  double real(std::string_view key, Quantity quantity, Rules rules = {});
  double real_or(std::string_view key, double fallback, Quantity quantity, Rules rules = {});

  std::int64_t integer(std::string_view key, Rules rules = {});
  std::int64_t integer_or(std::string_view key, std::int64_t fallback, Rules rules = {});

  bool boolean(std::string_view key);
  bool boolean_or(std::string_view key, bool fallback);

  std::string text(std::string_view key);
  std::string text_or(std::string_view key, std::string_view fallback);

  /// Place of the text in `names`.
  std::size_t choice(std::string_view key, std::span<const std::string_view> names);
  std::size_t choice_or(std::string_view key, std::size_t fallback,
                        std::span<const std::string_view> names);

  /// A list; a rule holds for each item.
  std::vector<double> reals(std::string_view key, Quantity quantity, Rules rules = {});
  std::vector<double> reals_or(std::string_view key, std::vector<double> fallback,
                               Quantity quantity, Rules rules = {});
  std::vector<std::string> texts(std::string_view key);
  /// A matrix as a list of its rows, of any length.
  std::vector<std::vector<double>> rows(std::string_view key);
  /// Lists in lists, shape[0] of them, each of shape[1] and so on down to numbers; the last index
  /// of the result is the fastest. Empty where the value has another shape, which is a fault.
  std::vector<double> nested(std::string_view key, std::span<const std::size_t> shape);
  std::vector<std::string> texts_or(std::string_view key, std::vector<std::string> fallback);

  /// A table. Where it is missing or no table, the reader returned finds nothing and complains
  /// about nothing further.
  Reader table(std::string_view key);
  /// The same, but an absent table counts as an empty one: keys required in it are missing.
  Reader table_or_empty(std::string_view key);

  /// A list of tables with at least one item.
  std::vector<Reader> tables(std::string_view key);
  std::vector<Reader> tables_or_none(std::string_view key);

  /// True if the key is present. It must still be read: a key that is only looked at counts as
  /// unused.
  bool has(std::string_view key);
  /// True if the key is present and its value has this type (for keys that may be of several).
  bool is(std::string_view key, Value::Type type);

  /// All keys in the order of the document, for tables with free names. They must still be read.
  std::vector<std::string> keys() const;

  /// The value itself, with everything below it counted as read (for `Document::merge`, sweeps);
  /// nullptr if it is absent.
  const Value* raw(std::string_view key);

  /// Notes a fault of a key that is there: "path.key = value; rule".
  void fault(std::string_view key, std::string_view rule);
  /// Notes a fault of this table: "path: message", or the message alone at the root.
  void fault(std::string_view message);
  /// Leaves the unread keys of this table alone in `finish()`: for a table whose faulty key decides
  /// which others it has.
  /// @pre faults() > 0
  void skip_rest();
  /// Number of faults so far, in all of the document.
  std::size_t faults() const;

  /// Place of the value of a key, or of this table if the key is absent.
  Place place(std::string_view key) const;
  /// Dotted key of this table, items of lists as `case[2]`, counted from 0; empty at the root.
  const std::string& path() const { return path_; }

  /// Reports every key that nobody read and ends the reading of the whole document.
  /// @throws InputError with all faults in the order of the document
  void finish();

 private:
  Reader(std::shared_ptr<ReadingRecord> record, const Value* table, std::string path, bool silent);

  bool logs() const;
  void log(std::string_view key, KeyUse use) const;
  const Value* find(std::string_view key);
  const Value* require(std::string_view key, Value::Type type);
  const Value* optional(std::string_view key, Value::Type type);
  void check_type(const Value*& value, std::string_view key, Value::Type type);
  void missing(std::string_view key);
  Place own_place() const;
  std::string name_of(std::string_view key, std::optional<std::size_t> item) const;
  void note(const Value& value, const std::string& name, std::string_view rule);
  double number(const Value& value, std::string_view key, std::optional<std::size_t> item,
                Quantity quantity, Rules rules);
  std::int64_t whole(const Value& value, std::string_view key, Rules rules);
  std::size_t named(const Value& value, std::string_view key,
                    std::span<const std::string_view> names);
  std::vector<double> numbers(const Value& list, std::string_view key, Quantity quantity,
                              Rules rules);
  std::vector<std::string> strings(const Value& list, std::string_view key);
  std::vector<Reader> readers(const Value& list, std::string_view key);
  Reader silent_reader(std::string_view key) const;

  std::shared_ptr<ReadingRecord> record_;
  const Value* table_;
  std::string path_;
  bool silent_;  // stands for a table that was faulty already
};

}  // namespace servomill::sim::config
