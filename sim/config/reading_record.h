/// Record of the reading of one document: the errors found so far, and for each table the keys that
/// were asked for and read, from which the keys that nobody read follow at the end.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "sim/config/document.h"

namespace servomill::sim::config {

class ReadingRecord {
 public:
  /// @param document  outlives the record
  explicit ReadingRecord(const Document& document) : document_(document) {}
  ReadingRecord(const ReadingRecord&) = delete;
  ReadingRecord& operator=(const ReadingRecord&) = delete;
  /// @pre finish() was called, or an exception is on its way
  ~ReadingRecord();

  const Document& document() const { return document_; }
  /// An empty table of the document, for those that are absent.
  const Value& nothing() const { return nothing_; }

  /// A table that is read from now on.
  /// @param path  dotted key of the table
  void open(const Value& table, const std::string& path) { tables_[&table].path = path; }
  /// A name that the table may have.
  void know(const Value& table, std::string_view key);
  /// A key that is there and was read.
  void read(const Value& table, std::string_view key) { tables_[&table].read.emplace(key); }
  /// The unread keys of this table are no errors.
  void skip_rest(const Value& table) { tables_[&table].rest_is_skipped = true; }

  void fault(Place place, std::string message);
  /// "name = value; rule"
  void fault(const Value& value, const std::string& name, std::string_view rule);
  std::size_t faults() const { return faults_.size(); }

  /// Reports every key that nobody read.
  /// @throws InputError with all errors, file by file
  void finish();

 private:
  struct Table {
    std::string path;
    std::vector<std::string> known;  // names asked for, in the order of asking
    std::set<std::string, std::less<>> read;
    bool rest_is_skipped = false;
  };

  void report_unread(const Value& table);
  std::vector<Fault> faults_by_file();

  const Document& document_;
  Value nothing_;
  std::vector<Fault> faults_;
  std::map<const Value*, Table> tables_;
  bool finished_ = false;
};

}  // namespace servomill::sim::config
