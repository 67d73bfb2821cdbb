#include "sim/records/output_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <hdf5.h>
#include <unistd.h>

#include <cassert>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string_view>
#include <utility>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/user_file.h"
#include "sim/records/hdf5_group.h"
#include "sim/records/hdf5_library.h"
#include "sim/system/output_name.h"
#include "sim/system/system_error.h"

namespace servomill::sim::records {
namespace {

std::string system_reason() { return std::strerror(errno); }

// True if the library itself locks the file: the environment makes it, whatever the access list
// says, or the file system lets nobody else do so.
bool library_locks(const std::string& path) {
  const char* const said = std::getenv("HDF5_USE_FILE_LOCKING");
  const std::string_view use = said != nullptr ? said : "";
  if (use == "FALSE" || use == "0") return false;
  return use == "TRUE" || use == "1" || use == "BEST_EFFORT" || system::locks_bind_writers(path);
}

// The library releases its lock before the file has its name.
system::WriteLock locked(const std::string& path, system::WriteLock::File file) {
  return library_locks(path) ? system::WriteLock() : system::WriteLock(path, file);
}

// The library would cut the file before it finds it locked.
void refuse_to_cut_locked(const std::string& path) {
  if (system::writer_of(path) != system::Writer::alive) return;
  throw system::SystemError(path, "cannot be created", "another process writes it");
}

Hdf5Handle access_of_writer(const std::string& path) {
  Hdf5Handle access = hdf5_handle(H5Pcreate(H5P_FILE_ACCESS));
  // closing the file closes what was taken from it
  H5Pset_fclose_degree(access.get(), H5F_CLOSE_STRONG);
  H5Pset_file_locking(access.get(), library_locks(path), true);
  return access;
}

}  // namespace

OutputFile::OutputFile(std::string path, bool force) : path_(std::move(path)), force_(force) {
  path_ = system::output_target(path_, system::existing_of(force_));
  partial_path_ = path_ + ".partial";
  if (!force_) system::refuse_partial(partial_path_);
  const Hdf5Lock lock;
  prepare_hdf5();
  const Hdf5Handle creation = group_creation(H5P_FILE_CREATE);
  // the oldest format has no "open" mark that would make the file of a killed run unreadable
  const Hdf5Handle access = access_of_writer(partial_path_);
  using enum system::WriteLock::File;
  if (force_) refuse_to_cut_locked(partial_path_);
  lock_ = locked(partial_path_, force_ ? replaced : created);
  // a lock of our own has created the file
  const bool is_new = !force_ && library_locks(partial_path_);
  const unsigned flag = is_new ? H5F_ACC_EXCL : H5F_ACC_TRUNC;
  file_ = std::make_unique<Hdf5Handle>(
      H5Fcreate(partial_path_.c_str(), flag, creation.get(), access.get()));
  if (file_->get() < 0)
    throw system::SystemError(partial_path_, "cannot be created", hdf5_reason());
}

OutputFile::OutputFile(std::string path, bool force, system::WriteLock lock,
                       std::unique_ptr<Hdf5Handle> file)
    : path_(std::move(path)),
      partial_path_(path_ + ".partial"),
      force_(force),
      lock_(std::move(lock)),
      file_(std::move(file)) {}

OutputFile OutputFile::resumed(std::string path, bool force) {
  system::WriteLock own = locked(path + ".partial", system::WriteLock::File::resumed);
  return opened(std::move(path), force, std::move(own));
}

OutputFile OutputFile::opened(std::string path, bool force, system::WriteLock own) {
  const Hdf5Lock lock;
  prepare_hdf5();
  const std::string partial = path + ".partial";
  auto file = std::make_unique<Hdf5Handle>(
      H5Fopen(partial.c_str(), H5F_ACC_RDWR, access_of_writer(partial).get()));
  if (file->get() < 0) {
    refuse_if_locked(partial);
    throw InputError({partial}, fmt::format("cannot be opened: {}", hdf5_reason()));
  }
  return {std::move(path), force, std::move(own), std::move(file)};
}

OutputFile OutputFile::reopened(std::string path) {
  system::WriteLock own = locked(path, system::WriteLock::File::resumed);
  const std::string partial = path + ".partial";
  // a link does not replace what another run has left or still writes
  if (::link(path.c_str(), partial.c_str()) != 0) {
    if (errno == EEXIST) {
      throw InputError({partial}, "also exists, from another run; use --force to overwrite");
    }
    throw system::SystemError(path, "cannot be renamed", system_reason());
  }
  if (::unlink(path.c_str()) != 0) {
    const std::string reason = system_reason();
    ::unlink(partial.c_str());
    throw system::SystemError(path, "cannot be renamed", reason);
  }
  return opened(std::move(path), false, std::move(own));
}

OutputFile::OutputFile(OutputFile&&) noexcept = default;
OutputFile::~OutputFile() = default;

void OutputFile::remove_unless_committed() {
  temporary_ =
      std::make_unique<system::TemporaryFile>(system::TemporaryFile::existing(partial_path_));
}

Hdf5Group OutputFile::root() {
  const Hdf5Lock lock;
  return Hdf5Group(Hdf5Handle(written(H5Gopen2(file_->get(), "/", H5P_DEFAULT), file_->get())));
}

void OutputFile::commit() {
  const system::WriteLock until_named = std::move(lock_);
  const Hdf5Lock lock;
  assert(file_->get() >= 0);
  written(H5Fflush(file_->get(), H5F_SCOPE_GLOBAL), file_->get());
  const herr_t closed = H5Fclose(file_->get());
  if (closed < 0) throw system::SystemError(partial_path_, "cannot be written", hdf5_reason());
  *file_ = Hdf5Handle();

  // the data must be on the disk before the name says that they are
  const int descriptor = open(partial_path_.c_str(), O_RDONLY | O_CLOEXEC);
  const bool synced = descriptor >= 0 && fsync(descriptor) == 0;
  if (!synced) throw system::SystemError(partial_path_, "cannot be written", system_reason());
  close(descriptor);
  system::give_name(partial_path_, path_, system::existing_of(force_));
}

}  // namespace servomill::sim::records
