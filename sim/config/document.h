/// A TOML document: read, changed from the command line or by another document, written back.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "sim/config/value.h"

namespace servomill::sim::config {

class KeyLog;

class Document {
 public:
  /// @param path  as the user wrote it; it is also the name in messages
  /// @throws InputError if the file cannot be read or is not TOML
  static Document from_file(const std::string& path);
  static Document from_text(std::string_view text, const std::string& name);

  /// Sets one value as `--set KEY=VALUE` does. KEY is a dotted path; an item of a list is `case[2]`
  /// or `case.2`, counted from 0, or a table called by its `name` or else its `type`:
  /// case.table.strategy.gcode; the only item of a list need not be named:
  /// case.table.strategy.spacing_mm. Names that are not bare are quoted: parameters."#101". Tables
  /// that do not exist are made: whether the document knows them is for its reader to say. VALUE is
  /// a TOML value, or else a text as it stands: `--set name=table`, `--set lead_mm="20 um"`.
  /// @throws InputError at the place "--set KEY=VALUE"
  void set(std::string_view assignment);

  /// Puts `overriding` (a table) over the document, leaf by leaf: what it has wins and keeps its
  /// own place, so that a fault is reported where it was written. Lists are leaves.
  void merge(const Value& overriding);

  const std::string& name() const { return name_; }
  const Value& root() const { return root_; }

  /// The document as changed, as TOML that reads again to the same values; comments are gone.
  std::string to_toml() const;

  /// Records the keys that readers ask this document and its copies for.
  void record_keys(std::shared_ptr<KeyLog> log) { key_log_ = std::move(log); }
  /// nullptr: they are not recorded.
  KeyLog* key_log() const { return key_log_.get(); }

 private:
  Document(std::string name, Value root);

  std::string name_;
  Value root_;
  std::shared_ptr<KeyLog> key_log_;
};

}  // namespace servomill::sim::config
