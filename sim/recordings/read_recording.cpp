#include "sim/recordings/read_recording.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <functional>
#include <new>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "plant/vocabulary/input_error.h"
#include "sim/recordings/camonitor_reader.h"
#include "sim/recordings/csv_reader.h"
#include "sim/recordings/hal_reader.h"
#include "sim/recordings/hdf5_reader.h"
#include "sim/recordings/mat_reader.h"
#include "sim/recordings/sinumerik_frequency.h"
#include "sim/recordings/sinumerik_trace.h"
#include "sim/recordings/tncscope_reader.h"
#include "sim/recordings/twincat_reader.h"
#include "sim/system/read_file.h"
#include "sim/system/trial_process.h"

namespace servomill::sim::recordings {
namespace {

// A format: the mark by which its content is recognised, and its reader.
struct Format {
  std::string_view name;
  bool (*is)(std::string_view bytes);
  Recording (*read)(std::string_view bytes, const std::string& path);
};

constexpr std::string_view kHdf5 = "\x89HDF\r\n\x1a\n";

// By the first bytes alone: the library reads the file itself, which may be larger than the memory.
bool is_hdf5_file(const std::string& path) {
  // a pipe would lose these bytes
  if (std::error_code fault; !std::filesystem::is_regular_file(path, fault)) return false;
  std::string head(kHdf5.size(), '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  return file && head == kHdf5;
}

// Damaged files crash or hang the libraries of binary formats: they are tried in another process
// first. The time grows with the file.
void refuse_if_fatal(const std::string& path, const std::function<void()>& read) {
  constexpr double kBytesPerSecond = 10e6;
  constexpr int kMinSeconds = 2;
  std::error_code fault;
  const auto bytes = std::filesystem::file_size(path, fault);
  if (fault) return;
  // The limit grows with the size of the file; a library that takes longer is taken to hang.
  const int seconds = kMinSeconds + static_cast<int>(static_cast<double>(bytes) / kBytesPerSecond);
  const std::string way = system::try_in_process(read, seconds);
  if (!way.empty()) throw InputError({path}, fmt::format("is damaged: reading it {}", way));
}

// A damaged file may promise more values than any memory holds.
Recording read_within_memory(const std::string& path, const std::function<Recording()>& read) {
  try {
    return read();
  } catch (const std::bad_alloc&) {
  } catch (const std::length_error&) {
  }
  throw InputError({path}, "is damaged, or an array in it is larger than the memory");
}

// A text has no NUL; UTF-16 and binary files have.
template <bool (*is)(std::string_view)>
bool is_text(std::string_view bytes) {
  return bytes.find('\0') == std::string_view::npos && is(bytes);
}

// The first that fits reads: marks of binary files come before those of texts.
constexpr std::array kFormats = {
    Format{"MAT v5 of MATLAB", is_mat, read_mat},
    Format{"Sinumerik frequency measurement", is_sinumerik_frequency, parse_sinumerik_frequency},
    Format{"Sinumerik trace", is_sinumerik_trace, parse_sinumerik_trace},
    Format{"TNCscope", is_text<is_tncscope>, parse_tncscope},
    Format{"TNCscope CSV", is_text<is_tncscope_csv>, parse_tncscope_csv},
    Format{"TwinCAT Scope", is_text<is_twincat>, parse_twincat},
    Format{"halscope", is_halscope, parse_halscope},
    Format{"camonitor", is_text<is_camonitor>, parse_camonitor},
    Format{"halsampler", is_text<is_halsampler>, parse_halsampler},
    Format{"CSV", is_text<is_csv>, parse_csv},
};

// Kinds of files that are known by their first bytes and not read.
std::string refused_kind(std::string_view bytes) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 8> kKinds = {{
      {"\xFF\xFE", "a text in UTF-16; save it as UTF-8"},
      {"\xFE\xFF", "a text in UTF-16; save it as UTF-8"},
      {"PK\x03\x04", "a zip archive or a spreadsheet; export it as CSV"},
      {"\x1F\x8B", "compressed (gzip); decompress it"},
      {"MATLAB 7.3", "a MAT file of level 7.3; save it with -v6 or -v7"},
      {"%PDF", "a PDF document"},
      {"\x89PNG", "a picture"},
      {"TDSm", "a TDMS file of LabVIEW; export it as CSV"},
  }};
  for (const auto& [mark, kind] : kKinds) {
    if (bytes.starts_with(mark)) return std::string(kind);
  }
  return "";
}

}  // namespace

std::string format_names() {
  std::string out = "HDF5 of servomill";
  for (const Format& format : kFormats) {
    out += ", ";
    out += format.name;
  }
  return out;
}

Recording read_recording(const std::string& path, const std::string& time_unit) {
  if (is_hdf5_file(path)) {
    refuse_if_fatal(path, [&] { read_hdf5(path); });
    Recording out = read_within_memory(path, [&] { return read_hdf5(path); });
    set_time_unit(out, time_unit);
    return out;
  }
  const std::string bytes = system::read_file(path, {}, "recording");
  if (bytes.empty()) throw InputError({path}, "is empty");
  if (const std::string kind = refused_kind(bytes); !kind.empty()) {
    throw InputError({path}, fmt::format("cannot be read as a recording: it is {}", kind));
  }
  for (const Format& format : kFormats) {
    if (!format.is(bytes)) continue;
    if (format.read == read_mat) refuse_if_fatal(path, [&] { read_mat(bytes, path); });
    Recording out = read_within_memory(path, [&] { return format.read(bytes, path); });
    set_time_unit(out, time_unit);
    return out;
  }
  throw InputError({path},
                   fmt::format("is not a recording of a known format ({})", format_names()));
}

}  // namespace servomill::sim::recordings
