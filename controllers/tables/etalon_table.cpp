#include "controllers/tables/etalon_table.h"

#include <fmt/format.h>

#include <optional>

#include "controllers/tables/error_parameter.h"
#include "controllers/tables/table_text.h"

namespace servomill::controllers {
namespace {

class Reader {
 public:
  explicit Reader(const TableText& file) : file_(file) {}

  ErrorColumns read() {
    for (const std::string_view text : lines_of(file_.text)) {
      ++line_;
      const std::string_view line = trimmed(text.substr(0, text.find("//")));
      if (!line.empty()) read(line);
    }
    if (in_grid_) refuse(file_.name, line_, "the file ends within Gridpoints");
    finish_block();
    if (out_.components.empty() && out_.locations.empty()) {
      refuse(file_.name, 0, "contains no geometric error");
    }
    return std::move(out_);
  }

 private:
  void read(std::string_view line) {
    if (in_grid_) {
      read_pair(line);
    } else if (line.front() == '[') {
      begin_block(line);
    } else {
      read_key(line);
    }
  }

  void begin_block(std::string_view line) {
    finish_block();
    if (line.back() != ']') refuse(file_.name, line_, "']' is missing");
    const std::string_view name = line.substr(1, line.size() - 2);
    parameter_ = error_parameter_of(name);
    if (!parameter_) refuse(file_.name, line_, fmt::format("[{}] is not a geometric error", name));
    block_ = name;
    block_line_ = line_;
    is_filled_ = false;
  }

  void finish_block() const {
    if (!parameter_ || is_filled_) return;
    refuse(file_.name, block_line_, fmt::format("[{}] has no value", block_));
  }

  void read_key(std::string_view line) {
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos) {
      refuse(file_.name, line_, fmt::format("'{}' is not an assignment", line));
    }
    const std::string_view key = trimmed(line.substr(0, equals));
    const std::string_view value = trimmed(line.substr(equals + 1));
    if (!parameter_) refuse(file_.name, line_, fmt::format("{} is outside any block", key));
    if (is_filled_) refuse(file_.name, line_, "the block already has a value");
    is_filled_ = true;
    if (key == "VALUE" && parameter_->is_location) {
      add_location(out_, file_.name, *parameter_, {number_at(value, file_.name, line_), line_});
    } else if (key == "Gridpoints" && !parameter_->is_location && value == "{") {
      in_grid_ = true;
      column_ = {.file = file_.name, .name = parameter_->iso_name(), .base_axis = parameter_->axis};
    } else {
      refuse(file_.name, line_,
             fmt::format("'{}' is not supported in [{}]; must be {}", key, block_,
                         parameter_->is_location ? "VALUE = number" : "Gridpoints = {"));
    }
  }

  void read_pair(std::string_view line) {
    if (line == "}") {
      in_grid_ = false;
      add_component(out_, std::move(column_), block_line_);
      return;
    }
    const auto words = words_of(line);
    if (words.size() != 2) {
      refuse(file_.name, line_, fmt::format("{} values; a grid point requires two", words.size()));
    }
    const double value = number_at(words[1], file_.name, line_) * parameter_->unit();
    const double position =
        number_at(words[0], file_.name, line_) * coordinate_unit(parameter_->axis);
    column_.points.push_back({position, value, value, line_});
  }

  const TableText& file_;
  ErrorColumns out_;
  std::optional<ErrorParameter> parameter_;
  std::string block_;
  ErrorColumn column_;
  int line_ = 0, block_line_ = 0;
  bool in_grid_ = false, is_filled_ = false;
};

}  // namespace

ErrorColumns read_etalon_table(const TableText& file) { return Reader(file).read(); }

}  // namespace servomill::controllers
