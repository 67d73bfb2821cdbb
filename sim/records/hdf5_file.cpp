#include "sim/records/hdf5_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <hdf5.h>
#include <hdf5_hl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <limits>
#include <mutex>
#include <type_traits>
#include <utility>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/user_file.h"
#include "sim/system/output_name.h"

namespace servomill::sim {
namespace {

static_assert(std::is_same_v<hid_t, std::int64_t>);

constexpr unsigned kCreationOrder = H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED;

// Debian's library is not made for threads: whoever works in it holds this.
class Library {
 public:
  Library() : lock_(mutex()) {}

 private:
  static std::recursive_mutex& mutex() {
    static std::recursive_mutex one;
    return one;
  }
  std::lock_guard<std::recursive_mutex> lock_;
};

// The library prints its errors unless told not to, and when the process ends it closes again what
// it could not close before, which crashes after a failed write.
void prepare_library() {
  H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

herr_t keep_first(unsigned depth, const H5E_error2_t* error, void* out) {
  if (depth == 0 && error->desc != nullptr) *static_cast<std::string*>(out) = error->desc;
  return 0;
}

// Why the last call failed: the system's words if it was the system.
std::string library_reason() {
  std::string text;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_first, &text);
  constexpr std::string_view kMark = "error message = '";
  const std::size_t begin = text.find(kMark);
  if (begin == std::string::npos) return text.empty() ? "unknown reason" : text;
  const std::size_t end = text.find('\'', begin + kMark.size());
  return text.substr(begin + kMark.size(), end - begin - kMark.size());
}

std::string system_reason() { return std::strerror(errno); }

std::string file_name(hid_t object) {
  std::array<char, 4096> name{};
  return H5Fget_name(object, name.data(), name.size()) > 0 ? name.data() : "HDF5 file";
}

// Who writes a file has locked it. To be asked behind a call of the library that failed.
void refuse_if_locked(const std::string& path) {
  if (library_reason() != std::strerror(EWOULDBLOCK)) return;
  throw SystemError(path, "cannot be opened", "another process writes it");
}

// The library would cut the file before it finds it locked.
void refuse_to_cut_locked(const std::string& path) {
  if (writer_of(path) != Writer::alive) return;
  throw SystemError(path, "cannot be made", "another process writes it");
}

// `result` of a call that writes into the file of `object`.
template <typename T>
T written(T result, hid_t object) {
  if (result >= 0) return result;
  const std::string reason = library_reason();
  throw SystemError(file_name(object), "cannot be written", reason);
}

// `result` of a call that touches no file and therefore cannot fail.
Hdf5Handle handle(hid_t id) {
  assert(id >= 0);
  return Hdf5Handle(id);
}

Hdf5Handle text_type() {
  Hdf5Handle type = handle(H5Tcopy(H5T_C_S1));
  H5Tset_size(type.get(), H5T_VARIABLE);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  return type;
}

void write_attribute(hid_t object, const std::string& name, hid_t type, hid_t space,
                     const void* data) {
  if (written(H5Aexists(object, name.c_str()), object) > 0) {
    written(H5Adelete(object, name.c_str()), object);
  }
  const Hdf5Handle attribute(
      written(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), object));
  written(H5Awrite(attribute.get(), type, data), object);
}

int descriptor_of(hid_t file) {
  void* descriptor = nullptr;
  written(H5Fget_vfd_handle(file, H5P_DEFAULT, &descriptor), file);
  return *static_cast<int*>(descriptor);
}

// Size with all that the library has not written yet.
std::uint64_t file_size(hid_t file) {
  hsize_t size = 0;
  written(H5Fget_filesize(file, &size), file);
  return size;
}

// The library writes the superblock, which says where the file ends, after all that lies before
// that end. A process killed in between would leave a file that refuses to be read to its end, so
// we write that number first. (HDF5 File Format Specification, superblock version 0: "End of File
// Address", 8 bytes, least significant first.)
void announce_end(hid_t file) {
  constexpr off_t kVersionOffset = 8;
  constexpr off_t kEndOffset = 40;
  const int descriptor = descriptor_of(file);
  std::uint8_t version = 1;
  if (pread(descriptor, &version, 1, kVersionOffset) != 1 || version != 0) return;
  const std::uint64_t size = file_size(file);
  std::array<std::uint8_t, 8> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = static_cast<std::uint8_t>(size >> (8 * i));
  }
  const bool done = ftruncate(descriptor, static_cast<off_t>(size)) == 0 &&
                    pwrite(descriptor, bytes.data(), bytes.size(), kEndOffset) == 8;
  if (!done) throw SystemError(file_name(file), "cannot be written", system_reason());
}

hid_t stored_type(Storage storage) {
  switch (storage) {
    case Storage::float64:
      return H5T_IEEE_F64LE;
    case Storage::float32:
      return H5T_IEEE_F32LE;
    case Storage::int32:
      return H5T_STD_I32LE;
  }
  return -1;
}

// The same run gives the same file: no times in it.
Hdf5Handle dataset_creation() {
  Hdf5Handle list = handle(H5Pcreate(H5P_DATASET_CREATE));
  H5Pset_obj_track_times(list.get(), false);
  return list;
}

Hdf5Handle group_creation(hid_t kind) {
  Hdf5Handle list = handle(H5Pcreate(kind));
  H5Pset_link_creation_order(list.get(), kCreationOrder);
  H5Pset_obj_track_times(list.get(), false);
  return list;
}

}  // namespace

Hdf5Handle::Hdf5Handle(Hdf5Handle&& other) noexcept : id_(std::exchange(other.id_, -1)) {}

Hdf5Handle& Hdf5Handle::operator=(Hdf5Handle&& other) noexcept {
  if (this != &other) {
    reset();
    id_ = std::exchange(other.id_, -1);
  }
  return *this;
}

void Hdf5Handle::reset() {
  const Library library;
  // a file that was closed has closed what was open in it
  if (id_ >= 0 && H5Iis_valid(id_) > 0) H5Idec_ref(id_);
  id_ = -1;
}

void Hdf5Object::attribute(const std::string& name, std::string_view text) {
  const Library library;
  assert(text.find('\0') == std::string_view::npos);
  const std::string terminated(text);
  const char* pointer = terminated.c_str();
  const Hdf5Handle space = handle(H5Screate(H5S_SCALAR));
  write_attribute(id_.get(), name, text_type().get(), space.get(), &pointer);
}

void Hdf5Object::attribute(const std::string& name, double value) {
  const Library library;
  const Hdf5Handle space = handle(H5Screate(H5S_SCALAR));
  write_attribute(id_.get(), name, H5T_NATIVE_DOUBLE, space.get(), &value);
}

void Hdf5Object::attribute(const std::string& name, std::int64_t value) {
  const Library library;
  const Hdf5Handle space = handle(H5Screate(H5S_SCALAR));
  write_attribute(id_.get(), name, H5T_NATIVE_INT64, space.get(), &value);
}

void Hdf5Object::attribute(const std::string& name, std::span<const double> values) {
  const Library library;
  const hsize_t size = values.size();
  const Hdf5Handle space = handle(H5Screate_simple(1, &size, nullptr));
  write_attribute(id_.get(), name, H5T_NATIVE_DOUBLE, space.get(), values.data());
}

void Hdf5Object::flush_file() {
  const Library library;
  const Hdf5Handle file(written(H5Iget_file_id(id_.get()), id_.get()));
  announce_end(file.get());
  written(H5Fflush(file.get(), H5F_SCOPE_GLOBAL), file.get());
}

void Hdf5Object::reserve(std::size_t bytes) {
  const Library library;
  const Hdf5Handle file(written(H5Iget_file_id(id_.get()), id_.get()));
  const auto size = static_cast<off_t>(file_size(file.get()));
  const int status =
      fallocate(descriptor_of(file.get()), FALLOC_FL_KEEP_SIZE, size, static_cast<off_t>(bytes));
  if (status == 0 || errno == EOPNOTSUPP || errno == ENOSYS) return;
  throw SystemError(file_name(id_.get()), "cannot be written", system_reason());
}

Hdf5Dataset::Hdf5Dataset(Hdf5Handle id, std::size_t columns, bool has_columns)
    : Hdf5Object(std::move(id)), columns_(columns), has_columns_(has_columns) {}

void Hdf5Dataset::make_scale(const std::string& name) {
  const Library library;
  written(H5DSset_scale(id_.get(), name.c_str()), id_.get());
}

void Hdf5Dataset::attach_scale(Hdf5Dataset& scale, unsigned dimension) {
  const Library library;
  written(H5DSattach_scale(id_.get(), scale.id_.get(), dimension), id_.get());
}

void Hdf5Dataset::write(std::size_t first, std::span<const double> values) {
  const Library library;
  const hsize_t begin = first, count = values.size();
  const Hdf5Handle in_file(written(H5Dget_space(id_.get()), id_.get()));
  H5Sselect_hyperslab(in_file.get(), H5S_SELECT_SET, &begin, nullptr, &count, nullptr);
  const Hdf5Handle in_memory = handle(H5Screate_simple(1, &count, nullptr));
  written(H5Dwrite(id_.get(), H5T_NATIVE_DOUBLE, in_memory.get(), in_file.get(), H5P_DEFAULT,
                   values.data()),
          id_.get());
}

void Hdf5Dataset::write_text(std::size_t row, std::string_view text) {
  const Library library;
  constexpr std::string_view kCut = "...";
  std::string room(text.substr(0, columns_));
  if (text.size() > columns_) {
    std::size_t end = columns_ - kCut.size();
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;  // UTF-8
    room = std::string(text.substr(0, end)) + std::string(kCut);
  }
  room.resize(columns_, '\0');
  const std::array<hsize_t, 2> begin = {row, 0}, block = {1, columns_};
  const Hdf5Handle in_file(written(H5Dget_space(id_.get()), id_.get()));
  H5Sselect_hyperslab(in_file.get(), H5S_SELECT_SET, begin.data(), nullptr, block.data(), nullptr);
  const Hdf5Handle in_memory = handle(H5Screate_simple(2, block.data(), nullptr));
  written(H5Dwrite(id_.get(), H5T_C_S1, in_memory.get(), in_file.get(), H5P_DEFAULT, room.data()),
          id_.get());
}

void Hdf5Dataset::append(std::size_t rows, std::span<const std::vector<std::uint8_t>> chunks) {
  assert(chunks.size() == columns_);
  const Library library;
  const std::array<hsize_t, 2> size = {rows_ + rows, columns_};
  written(H5Dset_extent(id_.get(), size.data()), id_.get());
  for (std::size_t column = 0; column < columns_; ++column) {
    const std::array<hsize_t, 2> begin = {rows_, column};
    const std::vector<std::uint8_t>& chunk = chunks[column];
    written(H5Dwrite_chunk(id_.get(), H5P_DEFAULT, 0, begin.data(), chunk.size(), chunk.data()),
            id_.get());
  }
  rows_ += rows;
}

Hdf5Group Hdf5Group::group(const std::string& path) {
  const Library library;
  Hdf5Handle here(-1);
  for (std::size_t begin = 0; begin < path.size();) {
    const std::size_t end = std::min(path.find('/', begin), path.size());
    const std::string name = path.substr(begin, end - begin);
    begin = end + 1;
    if (name.empty()) continue;
    const hid_t in = here.get() < 0 ? id_.get() : here.get();
    if (written(H5Lexists(in, name.c_str(), H5P_DEFAULT), in) > 0) {
      here = Hdf5Handle(written(H5Gopen2(in, name.c_str(), H5P_DEFAULT), in));
    } else {
      const Hdf5Handle creation = group_creation(H5P_GROUP_CREATE);
      here = Hdf5Handle(
          written(H5Gcreate2(in, name.c_str(), H5P_DEFAULT, creation.get(), H5P_DEFAULT), in));
    }
  }
  assert(here.get() >= 0);
  return Hdf5Group(std::move(here));
}

Hdf5Group Hdf5Group::group_with_room(const std::string& name, std::size_t children,
                                     std::size_t longest_name) {
  constexpr std::size_t kMost = 65535;  // of either number
  const Library library;
  const Hdf5Handle creation = group_creation(H5P_GROUP_CREATE);
  const auto entries = static_cast<unsigned>(std::min(children, kMost));
  H5Pset_link_phase_change(creation.get(), std::max(entries, 8U), 0);
  H5Pset_est_link_info(creation.get(), entries,
                       static_cast<unsigned>(std::min(longest_name, kMost)));
  return Hdf5Group(Hdf5Handle(written(
      H5Gcreate2(id_.get(), name.c_str(), H5P_DEFAULT, creation.get(), H5P_DEFAULT), id_.get())));
}

void Hdf5Group::move(const std::string& from, const std::string& to) {
  const Library library;
  written(H5Lmove(id_.get(), from.c_str(), id_.get(), to.c_str(), H5P_DEFAULT, H5P_DEFAULT),
          id_.get());
}

void Hdf5Group::remove(const std::string& name) {
  const Library library;
  written(H5Ldelete(id_.get(), name.c_str(), H5P_DEFAULT), id_.get());
}

Hdf5Dataset Hdf5Group::extendible(const std::string& name, std::size_t columns, bool has_columns,
                                  std::size_t chunk_rows, Storage storage, int compression,
                                  const Meaning& meaning) {
  const Library library;
  const int rank = has_columns ? 2 : 1;
  const std::array<hsize_t, 2> size = {0, columns};
  const std::array<hsize_t, 2> most = {H5S_UNLIMITED, columns};
  const std::array<hsize_t, 2> chunk = {chunk_rows, 1};
  const Hdf5Handle space = handle(H5Screate_simple(rank, size.data(), most.data()));
  const Hdf5Handle creation = dataset_creation();
  H5Pset_chunk(creation.get(), rank, chunk.data());
  if (compression != kNoCompression) {
    H5Pset_shuffle(creation.get());
    H5Pset_deflate(creation.get(), static_cast<unsigned>(compression));
  }
  // a run killed while it extends a dataset must not leave rows that look like values
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  if (storage != Storage::int32) {
    H5Pset_fill_value(creation.get(), H5T_NATIVE_DOUBLE, &nothing);
  }
  // whole chunks are written at once and need no cache
  const Hdf5Handle access = handle(H5Pcreate(H5P_DATASET_ACCESS));
  H5Pset_chunk_cache(access.get(), 0, 0, H5D_CHUNK_CACHE_W0_DEFAULT);
  Hdf5Handle id(written(H5Dcreate2(id_.get(), name.c_str(), stored_type(storage), space.get(),
                                   H5P_DEFAULT, creation.get(), access.get()),
                        id_.get()));
  Hdf5Dataset dataset(std::move(id), columns, has_columns);
  dataset.attribute("units", meaning.units);
  dataset.attribute("long_name", meaning.long_name);
  return dataset;
}

Hdf5Dataset Hdf5Group::fixed(const std::string& name, std::size_t rows, Storage storage,
                             double fill, const Meaning& meaning) {
  const Library library;
  const hsize_t size = rows;
  const Hdf5Handle space = handle(H5Screate_simple(1, &size, nullptr));
  const Hdf5Handle creation = dataset_creation();
  H5Pset_alloc_time(creation.get(), H5D_ALLOC_TIME_EARLY);
  H5Pset_fill_value(creation.get(), H5T_NATIVE_DOUBLE, &fill);
  Hdf5Handle id(written(H5Dcreate2(id_.get(), name.c_str(), stored_type(storage), space.get(),
                                   H5P_DEFAULT, creation.get(), H5P_DEFAULT),
                        id_.get()));
  Hdf5Dataset dataset(std::move(id), 1, false);
  dataset.attribute("units", meaning.units);
  dataset.attribute("long_name", meaning.long_name);
  return dataset;
}

Hdf5Dataset Hdf5Group::fixed_texts(const std::string& name, std::size_t rows, std::size_t width,
                                   const std::string& long_name) {
  const Library library;
  const std::array<hsize_t, 2> size = {rows, width};
  const Hdf5Handle space = handle(H5Screate_simple(2, size.data(), nullptr));
  const Hdf5Handle creation = dataset_creation();
  H5Pset_alloc_time(creation.get(), H5D_ALLOC_TIME_EARLY);
  H5Pset_fill_time(creation.get(), H5D_FILL_TIME_NEVER);  // holes of a file read as zeros
  Hdf5Handle id(written(H5Dcreate2(id_.get(), name.c_str(), H5T_C_S1, space.get(), H5P_DEFAULT,
                                   creation.get(), H5P_DEFAULT),
                        id_.get()));
  Hdf5Dataset dataset(std::move(id), width, true);
  dataset.attribute("units", "1");
  dataset.attribute("long_name", long_name);
  return dataset;
}

Hdf5Dataset Hdf5Group::dataset(const std::string& name) {
  const Library library;
  Hdf5Handle id(written(H5Dopen2(id_.get(), name.c_str(), H5P_DEFAULT), id_.get()));
  const Hdf5Handle space(written(H5Dget_space(id.get()), id_.get()));
  std::array<hsize_t, 2> size = {0, 1};
  const int rank = H5Sget_simple_extent_ndims(space.get());
  assert(rank == 1 || rank == 2);
  H5Sget_simple_extent_dims(space.get(), size.data(), nullptr);
  return {std::move(id), size[1], rank == 2};
}

Hdf5Dataset Hdf5Group::labels(const std::string& name, std::string_view letters,
                              const std::string& long_name) {
  const Library library;
  const hsize_t size = letters.size();
  const Hdf5Handle space = handle(H5Screate_simple(1, &size, nullptr));
  Hdf5Handle id(written(H5Dcreate2(id_.get(), name.c_str(), H5T_C_S1, space.get(), H5P_DEFAULT,
                                   dataset_creation().get(), H5P_DEFAULT),
                        id_.get()));
  written(H5Dwrite(id.get(), H5T_C_S1, H5S_ALL, H5S_ALL, H5P_DEFAULT, letters.data()), id_.get());
  Hdf5Dataset dataset(std::move(id), 1, false);
  dataset.attribute("units", "1");
  dataset.attribute("long_name", long_name);
  dataset.make_scale(name);
  return dataset;
}

void Hdf5Group::scalar(const std::string& name, double value, const Meaning& meaning) {
  const Library library;
  const Hdf5Handle space = handle(H5Screate(H5S_SCALAR));
  Hdf5Dataset dataset(
      Hdf5Handle(written(H5Dcreate2(id_.get(), name.c_str(), H5T_IEEE_F64LE, space.get(),
                                    H5P_DEFAULT, dataset_creation().get(), H5P_DEFAULT),
                         id_.get())),
      1, false);
  written(H5Dwrite(dataset.id_.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, &value),
          id_.get());
  dataset.attribute("units", meaning.units);
  dataset.attribute("long_name", meaning.long_name);
}

void Hdf5Group::table(const std::string& name, std::size_t columns, std::span<const double> values,
                      const Meaning& meaning, const std::string& row_scale,
                      const std::string& column_scale) {
  const Library library;
  assert(columns > 0 && values.size() % columns == 0);
  const std::array<hsize_t, 2> size = {values.size() / columns, columns};
  const Hdf5Handle space = handle(H5Screate_simple(2, size.data(), nullptr));
  Hdf5Dataset dataset(
      Hdf5Handle(written(H5Dcreate2(id_.get(), name.c_str(), H5T_IEEE_F64LE, space.get(),
                                    H5P_DEFAULT, dataset_creation().get(), H5P_DEFAULT),
                         id_.get())),
      columns, true);
  written(
      H5Dwrite(dataset.id_.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
      id_.get());
  dataset.attribute("units", meaning.units);
  dataset.attribute("long_name", meaning.long_name);
  unsigned dimension = 0;
  for (const std::string& scale : {row_scale, column_scale}) {
    Hdf5Dataset of(Hdf5Handle(written(H5Dopen2(id_.get(), scale.c_str(), H5P_DEFAULT), id_.get())),
                   1, false);
    dataset.attach_scale(of, dimension++);
  }
}

void Hdf5Group::list(const std::string& name, std::span<const double> values,
                     const Meaning& meaning, const std::string& scale) {
  const Library library;
  const hsize_t size = values.size();
  const Hdf5Handle space = handle(H5Screate_simple(1, &size, nullptr));
  Hdf5Dataset dataset(
      Hdf5Handle(written(H5Dcreate2(id_.get(), name.c_str(), H5T_IEEE_F64LE, space.get(),
                                    H5P_DEFAULT, dataset_creation().get(), H5P_DEFAULT),
                         id_.get())),
      1, false);
  written(
      H5Dwrite(dataset.id_.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
      id_.get());
  dataset.attribute("units", meaning.units);
  dataset.attribute("long_name", meaning.long_name);
  if (scale.empty()) {
    dataset.make_scale(name);
    return;
  }
  Hdf5Dataset of(Hdf5Handle(written(H5Dopen2(id_.get(), scale.c_str(), H5P_DEFAULT), id_.get())), 1,
                 false);
  dataset.attach_scale(of, 0);
}

OutputFile::OutputFile(std::string path, bool force) : path_(std::move(path)), force_(force) {
  path_ = output_target(path_, existing_of(force_));
  partial_path_ = path_ + ".partial";
  if (!force_) refuse_partial(partial_path_);
  const Library library;
  prepare_library();
  const Hdf5Handle creation = group_creation(H5P_FILE_CREATE);
  const Hdf5Handle access = handle(H5Pcreate(H5P_FILE_ACCESS));
  // closing the file closes what was taken from it; the oldest format has no "open" mark that would
  // make the file of a killed run unreadable
  H5Pset_fclose_degree(access.get(), H5F_CLOSE_STRONG);
  if (force_) refuse_to_cut_locked(partial_path_);
  const unsigned flag = force_ ? H5F_ACC_TRUNC : H5F_ACC_EXCL;
  file_ = Hdf5Handle(H5Fcreate(partial_path_.c_str(), flag, creation.get(), access.get()));
  if (file_.get() < 0) throw SystemError(partial_path_, "cannot be made", library_reason());
}

OutputFile::OutputFile(std::string path, bool force, Hdf5Handle file)
    : path_(std::move(path)),
      partial_path_(path_ + ".partial"),
      force_(force),
      file_(std::move(file)) {}

OutputFile OutputFile::resumed(std::string path, bool force) {
  const Library library;
  prepare_library();
  const Hdf5Handle access = handle(H5Pcreate(H5P_FILE_ACCESS));
  H5Pset_fclose_degree(access.get(), H5F_CLOSE_STRONG);
  Hdf5Handle file(H5Fopen((path + ".partial").c_str(), H5F_ACC_RDWR, access.get()));
  if (file.get() < 0) {
    refuse_if_locked(path + ".partial");
    throw InputError({path + ".partial"}, fmt::format("cannot be opened: {}", library_reason()));
  }
  return {std::move(path), force, std::move(file)};
}

OutputFile OutputFile::reopened(std::string path) {
  const std::string partial = path + ".partial";
  // a link does not replace what another run has left or still writes
  if (::link(path.c_str(), partial.c_str()) != 0) {
    if (errno == EEXIST) {
      throw InputError({partial}, "is there as well, of another run; use --force to overwrite");
    }
    throw SystemError(path, "cannot be renamed", system_reason());
  }
  if (::unlink(path.c_str()) != 0) {
    const std::string reason = system_reason();
    ::unlink(partial.c_str());
    throw SystemError(path, "cannot be renamed", reason);
  }
  return resumed(std::move(path), false);
}

OutputFile::OutputFile(OutputFile&&) noexcept = default;
OutputFile::~OutputFile() = default;

void OutputFile::remove_unless_committed() {
  temporary_ = std::make_unique<TemporaryFile>(TemporaryFile::existing(partial_path_));
}

Hdf5Group OutputFile::root() {
  const Library library;
  return Hdf5Group(Hdf5Handle(written(H5Gopen2(file_.get(), "/", H5P_DEFAULT), file_.get())));
}

void OutputFile::commit() {
  const Library library;
  assert(file_.get() >= 0);
  written(H5Fflush(file_.get(), H5F_SCOPE_GLOBAL), file_.get());
  const herr_t closed = H5Fclose(file_.get());
  if (closed < 0) throw SystemError(partial_path_, "cannot be written", library_reason());
  file_ = Hdf5Handle();

  // the data must be on the disk before the name says that they are
  const int descriptor = open(partial_path_.c_str(), O_RDONLY | O_CLOEXEC);
  const bool synced = descriptor >= 0 && fsync(descriptor) == 0;
  if (!synced) throw SystemError(partial_path_, "cannot be written", system_reason());
  close(descriptor);
  give_name(partial_path_, path_, existing_of(force_));
}

InputFile::InputFile(std::string path) : path_(std::move(path)) {
  const Library library;
  prepare_library();
  const std::string why = why_unreadable(path_);
  if (!why.empty()) fail(fmt::format("cannot be read: {}", why));
  if (H5Fis_hdf5(path_.c_str()) <= 0) fail("is not an HDF5 file");
  file_ = Hdf5Handle(H5Fopen(path_.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
  if (file_.get() < 0) {
    refuse_if_locked(path_);
    fail(fmt::format("cannot be read: {}", library_reason()));
  }
}

void InputFile::fail(const std::string& message) const { throw InputError({path_}, message); }

bool InputFile::has(const std::string& object) const {
  const Library library;
  for (std::size_t end = 0; end != std::string::npos;) {
    end = object.find('/', end + 1);
    const std::string above = object.substr(0, end);
    if (above == "/" || above.empty()) continue;
    if (H5Lexists(file_.get(), above.c_str(), H5P_DEFAULT) <= 0) return false;
  }
  return true;
}

Hdf5Handle InputFile::open(const std::string& object) const {
  const Library library;
  if (!has(object)) fail(fmt::format("has no '{}'", object));
  Hdf5Handle id(H5Oopen(file_.get(), object.c_str(), H5P_DEFAULT));
  if (id.get() < 0) fail(fmt::format("'{}' cannot be read: {}", object, library_reason()));
  return id;
}

std::vector<std::string> InputFile::children(const std::string& group, bool groups) const {
  const Library library;
  const Hdf5Handle id = open(group);
  if (H5Iget_type(id.get()) != H5I_GROUP) fail(fmt::format("'{}' is not a group", group));
  H5G_info_t info;
  H5Gget_info(id.get(), &info);
  // files of others may not know the order of making
  const Hdf5Handle creation(H5Gget_create_plist(id.get()));
  unsigned order = 0;
  H5Pget_link_creation_order(creation.get(), &order);
  const H5_index_t index =
      (order & H5P_CRT_ORDER_INDEXED) != 0 ? H5_INDEX_CRT_ORDER : H5_INDEX_NAME;
  std::vector<std::string> names;
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    std::array<char, 1024> name{};
    H5Lget_name_by_idx(id.get(), ".", index, H5_ITER_INC, i, name.data(), name.size(), H5P_DEFAULT);
    const Hdf5Handle child(H5Oopen(id.get(), name.data(), H5P_DEFAULT));
    if (H5Iget_type(child.get()) == (groups ? H5I_GROUP : H5I_DATASET))
      names.push_back(name.data());
  }
  return names;
}

std::vector<std::string> InputFile::groups(const std::string& group) const {
  const Library library;
  return children(group, true);
}

std::vector<std::string> InputFile::datasets(const std::string& group) const {
  const Library library;
  return children(group, false);
}

std::vector<std::size_t> InputFile::shape(const std::string& dataset) const {
  const Library library;
  const Hdf5Handle id = open(dataset);
  if (H5Iget_type(id.get()) != H5I_DATASET) fail(fmt::format("'{}' is not a dataset", dataset));
  const Hdf5Handle space(H5Dget_space(id.get()));
  std::vector<hsize_t> size(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space.get())));
  H5Sget_simple_extent_dims(space.get(), size.data(), nullptr);
  return {size.begin(), size.end()};
}

std::vector<double> InputFile::values(const std::string& dataset) const {
  throw_if_interrupted();
  const Library library;
  std::size_t count = 1;
  for (const std::size_t length : shape(dataset)) count *= length;
  const Hdf5Handle id = open(dataset);
  const Hdf5Handle type(H5Dget_type(id.get()));
  const H5T_class_t kind = H5Tget_class(type.get());
  if (kind != H5T_FLOAT && kind != H5T_INTEGER) {
    fail(fmt::format("'{}' does not hold numbers", dataset));
  }
  std::vector<double> out(count);
  if (H5Dread(id.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, out.data()) < 0) {
    fail(fmt::format("'{}' cannot be read: {}", dataset, library_reason()));
  }
  return out;
}

std::vector<double> InputFile::values(const std::string& dataset, std::size_t first,
                                      std::size_t count) const {
  if (shape(dataset).size() != 1) {
    fail(fmt::format("'{}' has not the length it should have", dataset));
  }
  return column(dataset, 0, first, count);
}

std::vector<double> InputFile::column(const std::string& dataset, std::size_t column,
                                      std::size_t first, std::size_t count) const {
  const Library library;
  const auto size = shape(dataset);
  const bool has_columns = size.size() == 2;
  if ((size.size() != 1 && !has_columns) || first + count > size[0] ||
      (has_columns && column >= size[1])) {
    fail(fmt::format("'{}' has not the length it should have", dataset));
  }
  const Hdf5Handle id = open(dataset);
  const std::array<hsize_t, 2> begin = {first, column}, block = {count, 1};
  const hsize_t length = count;
  const Hdf5Handle in_file(H5Dget_space(id.get()));
  H5Sselect_hyperslab(in_file.get(), H5S_SELECT_SET, begin.data(), nullptr, block.data(), nullptr);
  const Hdf5Handle in_memory = handle(H5Screate_simple(1, &length, nullptr));
  std::vector<double> out(count);
  if (H5Dread(id.get(), H5T_NATIVE_DOUBLE, in_memory.get(), in_file.get(), H5P_DEFAULT,
              out.data()) < 0) {
    fail(fmt::format("'{}' cannot be read: {}", dataset, library_reason()));
  }
  return out;
}

std::vector<std::string> InputFile::texts(const std::string& dataset, std::size_t first,
                                          std::size_t count) const {
  const Library library;
  const auto size = shape(dataset);
  if (size.size() != 2 || first + count > size[0]) {
    fail(fmt::format("'{}' has not the length it should have", dataset));
  }
  const Hdf5Handle id = open(dataset);
  const std::array<hsize_t, 2> begin = {first, 0}, block = {count, size[1]};
  const Hdf5Handle in_file(H5Dget_space(id.get()));
  H5Sselect_hyperslab(in_file.get(), H5S_SELECT_SET, begin.data(), nullptr, block.data(), nullptr);
  const Hdf5Handle in_memory = handle(H5Screate_simple(2, block.data(), nullptr));
  std::string all(count * size[1], '\0');
  if (H5Dread(id.get(), H5T_C_S1, in_memory.get(), in_file.get(), H5P_DEFAULT, all.data()) < 0) {
    fail(fmt::format("'{}' cannot be read: {}", dataset, library_reason()));
  }
  std::vector<std::string> out;
  for (std::size_t row = 0; row < count; ++row) {
    const std::string text = all.substr(row * size[1], size[1]);
    out.push_back(text.substr(0, text.find('\0')));
  }
  return out;
}

bool InputFile::has_attribute(const std::string& object, const std::string& name) const {
  const Library library;
  return H5Aexists(open(object).get(), name.c_str()) > 0;
}

Hdf5Handle InputFile::open_attribute(const std::string& object, const std::string& name) const {
  const Library library;
  const Hdf5Handle id = open(object);
  Hdf5Handle attribute(H5Aopen(id.get(), name.c_str(), H5P_DEFAULT));
  if (attribute.get() < 0) fail(fmt::format("'{}' has no attribute '{}'", object, name));
  return attribute;
}

std::string InputFile::text(const std::string& object, const std::string& name) const {
  const Library library;
  const Hdf5Handle attribute = open_attribute(object, name);
  const Hdf5Handle type(H5Aget_type(attribute.get()));
  if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) <= 0) {
    fail(fmt::format("attribute '{}' of '{}' is not a text", name, object));
  }
  const Hdf5Handle memory(H5Tget_native_type(type.get(), H5T_DIR_DEFAULT));
  char* pointer = nullptr;
  if (H5Aread(attribute.get(), memory.get(), &pointer) < 0) {
    fail(fmt::format("attribute '{}' of '{}' cannot be read", name, object));
  }
  std::string out = pointer == nullptr ? "" : pointer;
  H5free_memory(pointer);
  return out;
}

std::vector<double> InputFile::numbers(const std::string& object, const std::string& name) const {
  const Library library;
  const Hdf5Handle attribute = open_attribute(object, name);
  const Hdf5Handle type(H5Aget_type(attribute.get()));
  const H5T_class_t kind = H5Tget_class(type.get());
  if (kind != H5T_FLOAT && kind != H5T_INTEGER) {
    fail(fmt::format("attribute '{}' of '{}' is not a number", name, object));
  }
  const Hdf5Handle space(H5Aget_space(attribute.get()));
  std::vector<double> out(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space.get())));
  if (H5Aread(attribute.get(), H5T_NATIVE_DOUBLE, out.data()) < 0) {
    fail(fmt::format("attribute '{}' of '{}' cannot be read", name, object));
  }
  return out;
}

double InputFile::number(const std::string& object, const std::string& name) const {
  const Library library;
  const std::vector<double> all = numbers(object, name);
  if (all.size() != 1) {
    fail(fmt::format("attribute '{}' of '{}' has {} numbers instead of one", name, object,
                     all.size()));
  }
  return all.front();
}

}  // namespace servomill::sim
