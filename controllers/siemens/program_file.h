/// A Siemens program in a file: its text, the places of its labels and control structures, and the
/// subprograms that follow it in the same file.
///
/// An archive holds several programs, each behind its name: %_N_SHAFT_MPF, %_N_POCKET_SPF
/// (Fundamentals, "Structure of an NC program"). The first one runs.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "plant/vocabulary/input_error.h"

namespace servomill::controllers::siemens {

/// Position in the text at the start of a block.
struct BlockMark {
  std::size_t offset = 0;
  int line = 0;  // number of the line before
  bool operator==(const BlockMark&) const = default;
};

/// A line behind its skip level and its block number.
struct Line {
  std::string_view text;
  int number = 0;
  bool is_optional = false;  // behind '/'
  BlockMark mark;            // of its start
  std::size_t column = 0;    // of `text` in the line, from 0
};

/// A label, or a block number.
struct Label {
  std::string name;
  BlockMark mark;  // of its line
};

class ProgramFile {
 public:
  ProgramFile(std::string text, std::string file);
  ProgramFile(const ProgramFile&) = delete;
  ProgramFile& operator=(const ProgramFile&) = delete;

  std::optional<Line> next();
  BlockMark mark() const { return at_; }
  void go_to(const BlockMark& mark) { at_ = mark; }
  void begin() { at_ = begin_; }
  const std::string& file() const { return file_; }
  int line() const { return at_.line; }
  /// The name in the first line of an archive, or that of the file, in capitals.
  const std::string& name() const { return name_; }

  /// The block behind the part of a structure: of IF that behind ELSE or ENDIF, of ENDWHILE that
  /// with WHILE. nullptr: the structure is not complete.
  const BlockMark* partner(const BlockMark& mark) const;
  /// The next label of that name behind or before a position; nullptr: there is none.
  const Label* label_behind(const std::string& name, const BlockMark& from);
  const Label* label_before(const std::string& name, const BlockMark& from);
  /// Faults found without running the program: structures without their end.
  const std::vector<Fault>& faults() const { return faults_; }
  bool changes_tools_by_M6() const { return has_M6_; }

  /// The program of that name in the same file; nullptr: there is none.
  ProgramFile* subprogram(const std::string& name) const;
  /// Names that stand where a program is called: those of subprograms, cycles and functions.
  std::set<std::string> called_names();

 private:
  struct Open {
    std::string word;
    BlockMark begin, behind;
    Place place;
  };

  ProgramFile(std::shared_ptr<const std::string> text, std::string file, BlockMark begin,
              std::size_t end, std::string name);
  void split();
  void index();
  void index_structure(const Line& line, const std::string& word, std::vector<Open>& open);
  void close(const Line& line, const std::string& word, std::vector<Open>& open);
  void index_label(const Line& line);
  const std::vector<Label>& labels_of(const std::string& name);
  void read_block_numbers();

  std::shared_ptr<const std::string> text_;
  std::string file_, name_;
  BlockMark begin_, at_;
  std::size_t end_ = 0;
  std::map<std::size_t, BlockMark> partners_;
  std::map<std::string, std::vector<Label>> labels_;
  bool has_block_numbers_ = false, has_M6_ = false;
  std::vector<Fault> faults_;
  std::vector<std::unique_ptr<ProgramFile>> others_;
};

/// "%_N_SHAFT_MPF", "SHAFT.SPF" and "/_N_WKS_DIR/SHAFT" are SHAFT.
std::string program_name(std::string_view text);

}  // namespace servomill::controllers::siemens
