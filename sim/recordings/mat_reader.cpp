#include "sim/recordings/mat_reader.h"

#include <fmt/format.h>
#include <matio.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/progress.h"
#include "sim/recordings/delimited_text.h"
#include "sim/system/counted.h"

namespace servomill::sim::recordings {
namespace {

struct MatCloser {
  void operator()(mat_t* file) const { Mat_Close(file); }
};
struct VariableFreer {
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
using Variable = std::unique_ptr<matvar_t, VariableFreer>;

// The library prints nothing of its own.
void ignore_log(int, char*) {}

template <class Number>
std::vector<double> converted(const matvar_t& variable, std::size_t count) {
  const auto* data = static_cast<const Number*>(variable.data);
  std::vector<double> out(count);
  for (std::size_t i = 0; i < count; ++i) out[i] = static_cast<double>(data[i]);
  return out;
}

std::vector<double> numbers(const matvar_t& variable, std::size_t count) {
  switch (variable.class_type) {
    case MAT_C_SINGLE:
      return converted<float>(variable, count);
    case MAT_C_INT8:
      return converted<std::int8_t>(variable, count);
    case MAT_C_UINT8:
      return converted<std::uint8_t>(variable, count);
    case MAT_C_INT16:
      return converted<std::int16_t>(variable, count);
    case MAT_C_UINT16:
      return converted<std::uint16_t>(variable, count);
    case MAT_C_INT32:
      return converted<std::int32_t>(variable, count);
    case MAT_C_UINT32:
      return converted<std::uint32_t>(variable, count);
    case MAT_C_INT64:
      return converted<std::int64_t>(variable, count);
    case MAT_C_UINT64:
      return converted<std::uint64_t>(variable, count);
    default:
      return converted<double>(variable, count);
  }
}

bool is_numeric(const matvar_t& variable) {
  return variable.class_type >= MAT_C_DOUBLE && variable.class_type <= MAT_C_UINT64 &&
         variable.isComplex == 0 && variable.rank == 2;
}

std::string kind_of(const matvar_t& variable) {
  switch (variable.class_type) {
    case MAT_C_CELL:
      return "a cell array";
    case MAT_C_STRUCT:
      return "a structure";
    case MAT_C_OBJECT:
    case MAT_C_OPAQUE:
      return "an object of MATLAB";
    case MAT_C_CHAR:
      return "a text";
    case MAT_C_SPARSE:
      return "a sparse matrix";
    case MAT_C_FUNCTION:
      return "a function";
    default:
      return variable.isComplex != 0 ? "complex" : fmt::format("of {} dimensions", variable.rank);
  }
}

constexpr double kMaxPerByte = 1032.0;  // values; the greatest ratio of the compression (deflate)
constexpr std::size_t kHeader = 128, kTag = 8;  // bytes

// Number of four bytes, in the order of the file's mark.
std::uint32_t word_at(std::string_view bytes, std::size_t at, bool is_little) {
  std::uint32_t out = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::uint32_t byte = static_cast<unsigned char>(bytes[at + (is_little ? 3 - i : i)]);
    out = (out << 8) | byte;
  }
  return out;
}

// The arrays of a file follow each other, each behind a tag of its type and length.
void refuse_cut_file(std::string_view bytes, const std::string& path) {
  const bool is_little = bytes.substr(kHeader - 2, 2) == "IM";
  for (std::size_t at = kHeader; at < bytes.size();) {
    const std::size_t left = bytes.size() - at;
    if (left < kTag || word_at(bytes, at + 4, is_little) > left - kTag) {
      throw InputError(
          {path}, fmt::format("is truncated: the array at byte {} is longer than the file", at));
    }
    at += kTag + word_at(bytes, at + 4, is_little);
  }
}

// A table of numbers: columns of equal length.
struct Array {
  std::string name;
  std::size_t rows = 0;
  std::vector<std::vector<double>> columns;
};

class MatFile {
 public:
  MatFile(const std::string& path, std::size_t bytes)
      : path_(path), bytes_(static_cast<double>(bytes)) {
    Mat_LogInitFunc("servomill", ignore_log);
    file_.reset(Mat_Open(path.c_str(), MAT_ACC_RDONLY));
    if (file_ == nullptr) fail("cannot be read: its header is damaged");
  }

  Recording read() {
    out_.file = path_;
    out_.format = "MAT v5";
    Stage stage("variables", 0.0);
    while (Variable variable{Mat_VarReadNextInfo(file_.get())}) {
      throw_if_interrupted();
      take(*variable);
      stage.advance();
    }
    const Array* time = nullptr;
    for (const Array& array : arrays_) {
      if (array.columns.size() == 1 && is_time_name(array.name)) time = &array;
    }
    if (time != nullptr) {
      add_timed(*time);
    } else {
      add_numbered();
    }
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { throw InputError({path_}, message); }

  void take(matvar_t& variable) {
    const std::string name = variable.name == nullptr ? "" : variable.name;
    if (name.empty()) {  // what MATLAB keeps for its objects
      out_.notes.push_back("a variable without a name: skipped");
      return;
    }
    if (!is_numeric(variable)) {
      out_.notes.push_back(fmt::format("'{}' is {}: skipped", name, kind_of(variable)));
      return;
    }
    std::size_t rows = variable.dims[0], columns = variable.dims[1];
    if (rows == 1) std::swap(rows, columns);
    if (rows == 0 || columns == 0) {
      out_.notes.push_back(fmt::format("'{}' is empty: skipped", name));
      return;
    }
    // before the library and the copy take memory for all of them
    if (static_cast<double>(rows) * static_cast<double>(columns) > kMaxPerByte * bytes_) {
      fail(fmt::format("variable '{}' has {} x {} values in a file of {} bytes: it is damaged",
                       name, rows, columns, bytes_));
    }
    if (Mat_VarReadDataAll(file_.get(), &variable) != 0 || variable.data == nullptr) {
      fail(fmt::format("variable '{}' cannot be read: the file is truncated or damaged", name));
    }
    const std::vector<double> all = numbers(variable, rows * columns);
    if (rows == 1) {
      out_.notes.push_back(fmt::format("'{}' = {}", name, all[0]));
      return;
    }
    Array array{name, rows, {}};
    for (std::size_t c = 0; c < columns; ++c) {
      const auto first = all.begin() + static_cast<std::ptrdiff_t>(c * rows);
      array.columns.emplace_back(first, first + static_cast<std::ptrdiff_t>(rows));
    }
    arrays_.push_back(std::move(array));
  }

  void add_channels(const Array& array, std::size_t base) {
    for (std::size_t c = 0; c < array.columns.size(); ++c) {
      out_.channels.push_back(
          {array.columns.size() == 1 ? array.name : fmt::format("{}_{}", array.name, c + 1), "",
           array.columns[c], base});
    }
  }

  void add_timed(const Array& time) {
    Base base;
    base.unit_known = false;
    base.values = time.columns[0];
    out_.bases.push_back(std::move(base));
    for (const Array& array : arrays_) {
      if (&array == &time) continue;
      if (array.rows == time.rows) {
        add_channels(array, 0);
      } else {
        out_.notes.push_back(fmt::format("'{}' has {}, the time '{}' has {}: skipped", array.name,
                                         system::counted(array.rows, "value"), time.name,
                                         time.rows));
      }
    }
  }

  // One base for each length.
  void add_numbered() {
    std::map<std::size_t, std::size_t> base_of;
    for (const Array& array : arrays_) {
      const auto [base, is_new] = base_of.try_emplace(array.rows, out_.bases.size());
      if (is_new) out_.bases.push_back(sample_numbers(array.rows));
      add_channels(array, base->second);
    }
  }

  std::string path_;
  double bytes_ = 0.0;  // of the file
  std::unique_ptr<mat_t, MatCloser> file_;
  std::vector<Array> arrays_;
  Recording out_;
};

}  // namespace

bool is_mat(std::string_view bytes) {
  if (bytes.size() < kHeader || !bytes.starts_with("MATLAB 5.0")) return false;
  const std::string_view order = bytes.substr(kHeader - 2, 2);
  return order == "IM" || order == "MI";
}

Recording read_mat(std::string_view bytes, const std::string& path) {
  refuse_cut_file(bytes, path);
  Recording out = MatFile(path, bytes.size()).read();
  check(out);
  return out;
}

}  // namespace servomill::sim::recordings
