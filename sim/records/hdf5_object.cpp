#include "sim/records/hdf5_object.h"

#include <fcntl.h>
#include <hdf5.h>
#include <unistd.h>
#include <array>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <vector>

#include "sim/system/system_error.h"

namespace servomill::sim::records {
namespace {

std::string system_reason() { return std::strerror(errno); }

Hdf5Handle text_type() {
  Hdf5Handle type = hdf5_handle(H5Tcopy(H5T_C_S1));
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
  if (!done) throw system::SystemError(hdf5_file_name(file), "cannot be written", system_reason());
}

}  // namespace

void Hdf5Object::attribute(const std::string& name, std::string_view text) {
  const Hdf5Lock lock;
  assert(text.find('\0') == std::string_view::npos);
  const std::string terminated(text);
  const char* pointer = terminated.c_str();
  const Hdf5Handle space = hdf5_handle(H5Screate(H5S_SCALAR));
  write_attribute(id_.get(), name, text_type().get(), space.get(), &pointer);
}

void Hdf5Object::attribute(const std::string& name, double value) {
  const Hdf5Lock lock;
  const Hdf5Handle space = hdf5_handle(H5Screate(H5S_SCALAR));
  write_attribute(id_.get(), name, H5T_NATIVE_DOUBLE, space.get(), &value);
}

void Hdf5Object::attribute(const std::string& name, std::int64_t value) {
  const Hdf5Lock lock;
  const Hdf5Handle space = hdf5_handle(H5Screate(H5S_SCALAR));
  write_attribute(id_.get(), name, H5T_NATIVE_INT64, space.get(), &value);
}

void Hdf5Object::attribute(const std::string& name, std::span<const double> values) {
  const Hdf5Lock lock;
  const hsize_t size = values.size();
  const Hdf5Handle space = hdf5_handle(H5Screate_simple(1, &size, nullptr));
  write_attribute(id_.get(), name, H5T_NATIVE_DOUBLE, space.get(), values.data());
}

void Hdf5Object::attribute(const std::string& name, std::span<const std::int32_t> values) {
  const Hdf5Lock lock;
  const hsize_t size = values.size();
  const Hdf5Handle space = hdf5_handle(H5Screate_simple(1, &size, nullptr));
  write_attribute(id_.get(), name, H5T_NATIVE_INT32, space.get(), values.data());
}

void Hdf5Object::attribute(const std::string& name, std::span<const std::string> texts) {
  const Hdf5Lock lock;
  std::vector<const char*> pointers;
  for (const std::string& text : texts) pointers.push_back(text.c_str());
  const hsize_t size = pointers.size();
  const Hdf5Handle space = hdf5_handle(H5Screate_simple(1, &size, nullptr));
  write_attribute(id_.get(), name, text_type().get(), space.get(), pointers.data());
}

bool Hdf5Object::has_attribute(const std::string& name) const {
  const Hdf5Lock lock;
  return written(H5Aexists(id_.get(), name.c_str()), id_.get()) > 0;
}

std::string Hdf5Object::text(const std::string& name) const {
  const Hdf5Lock lock;
  const Hdf5Handle attribute(written(H5Aopen(id_.get(), name.c_str(), H5P_DEFAULT), id_.get()));
  char* pointer = nullptr;
  written(H5Aread(attribute.get(), text_type().get(), &pointer), id_.get());
  std::string out = pointer == nullptr ? "" : pointer;
  H5free_memory(pointer);
  return out;
}

void Hdf5Object::flush_file() {
  const Hdf5Lock lock;
  const Hdf5Handle file(written(H5Iget_file_id(id_.get()), id_.get()));
  announce_end(file.get());
  written(H5Fflush(file.get(), H5F_SCOPE_GLOBAL), file.get());
}

void Hdf5Object::reserve(std::size_t bytes) {
  const Hdf5Lock lock;
  const Hdf5Handle file(written(H5Iget_file_id(id_.get()), id_.get()));
  const auto size = static_cast<off_t>(file_size(file.get()));
  const int status =
      fallocate(descriptor_of(file.get()), FALLOC_FL_KEEP_SIZE, size, static_cast<off_t>(bytes));
  if (status == 0 || errno == EOPNOTSUPP || errno == ENOSYS) return;
  throw system::SystemError(hdf5_file_name(id_.get()), "cannot be written", system_reason());
}

}  // namespace servomill::sim::records
