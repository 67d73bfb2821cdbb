#include "sim/records/hdf5_library.h"

#include <hdf5.h>

#include <array>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <type_traits>
#include <utility>

#include "sim/system/system_error.h"

namespace servomill::sim::records {
namespace {

static_assert(std::is_same_v<hid_t, std::int64_t>);

std::recursive_mutex& library_mutex() {
  static std::recursive_mutex one;
  return one;
}

herr_t keep_first(unsigned depth, const H5E_error2_t* error, void* out) {
  if (depth == 0 && error->desc != nullptr) *static_cast<std::string*>(out) = error->desc;
  return 0;
}

}  // namespace

Hdf5Lock::Hdf5Lock() : lock_(library_mutex()) {}

Hdf5Handle::Hdf5Handle(Hdf5Handle&& other) noexcept : id_(std::exchange(other.id_, -1)) {}

Hdf5Handle& Hdf5Handle::operator=(Hdf5Handle&& other) noexcept {
  if (this != &other) {
    reset();
    id_ = std::exchange(other.id_, -1);
  }
  return *this;
}

void Hdf5Handle::reset() {
  const Hdf5Lock lock;
  // a file that was closed has closed what was open in it
  if (id_ >= 0 && H5Iis_valid(id_) > 0) H5Idec_ref(id_);
  id_ = -1;
}

// The library prints its errors unless it is kept from it, and when the process ends it closes
// again what it could not close before, which crashes after a failed write.
void prepare_hdf5() {
  H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

std::string hdf5_reason() {
  std::string text;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_first, &text);
  constexpr std::string_view kMark = "error message = '";
  const std::size_t begin = text.find(kMark);
  if (begin == std::string::npos) return text.empty() ? "unknown reason" : text;
  const std::size_t end = text.find('\'', begin + kMark.size());
  return text.substr(begin + kMark.size(), end - begin - kMark.size());
}

std::string hdf5_file_name(hid_t object) {
  std::array<char, 4096> name{};
  return H5Fget_name(object, name.data(), name.size()) > 0 ? name.data() : "HDF5 file";
}

std::int64_t written(std::int64_t result, hid_t object) {
  if (result >= 0) return result;
  const std::string reason = hdf5_reason();
  throw system::SystemError(hdf5_file_name(object), "cannot be written", reason);
}

Hdf5Handle hdf5_handle(hid_t id) {
  assert(id >= 0);
  return Hdf5Handle(id);
}

Hdf5Handle group_creation(hid_t kind) {
  Hdf5Handle list = hdf5_handle(H5Pcreate(kind));
  H5Pset_link_creation_order(list.get(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
  H5Pset_obj_track_times(list.get(), false);
  return list;
}

// A process locks the file that it writes.
void refuse_if_locked(const std::string& path) {
  if (hdf5_reason() != std::strerror(EWOULDBLOCK)) return;
  throw system::SystemError(path, "cannot be opened", "another process writes it");
}

}  // namespace servomill::sim::records
