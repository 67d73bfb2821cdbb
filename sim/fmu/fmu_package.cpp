#include "sim/fmu/fmu_package.h"

#include <zip.h>

#include <memory>
#include <stdexcept>

#include "sim/fmu/machine_constants.h"

namespace servomill::sim::fmu {
namespace {

[[noreturn]] void fail(const char* what, zip_error_t& error) {
  const std::string why = std::string(what) + ": " + zip_error_strerror(&error);
  zip_error_fini(&error);
  throw std::runtime_error(why);
}

// An archive in memory.
class Archive {
 public:
  Archive() {
    zip_error_t error;
    zip_error_init(&error);
    source_ = zip_source_buffer_create(nullptr, 0, 0, &error);
    if (source_ == nullptr) fail("cannot begin an archive", error);
    zip_source_keep(source_);  // for bytes()
    archive_ = zip_open_from_source(source_, ZIP_TRUNCATE, &error);
    if (archive_ == nullptr) {
      zip_source_free(source_);
      zip_source_free(source_);
      fail("cannot begin an archive", error);
    }
  }
  Archive(const Archive&) = delete;
  Archive& operator=(const Archive&) = delete;
  ~Archive() {
    if (archive_ != nullptr) zip_discard(archive_);
    zip_source_free(source_);
  }

  /// @param content  must outlive bytes()
  void add(const std::string& name, std::string_view content) {
    zip_source_t* file = zip_source_buffer(archive_, content.data(), content.size(), 0);
    const zip_int64_t n = file == nullptr ? -1 : zip_file_add(archive_, name.c_str(), file, 0);
    if (n < 0) {
      if (file != nullptr) zip_source_free(file);
      throw std::runtime_error(name + ": " + zip_strerror(archive_));
    }
    // the time would make two archives of the same files differ
    constexpr time_t kNoTime = 315576000;  // 1980-01-01 12:00 UTC, where the times of zip begin
    const auto index = static_cast<zip_uint64_t>(n);
    zip_file_set_mtime(archive_, index, kNoTime, 0);
    zip_set_file_compression(archive_, index, ZIP_CM_DEFLATE, 0);
  }

  std::string bytes() {
    if (zip_close(archive_) != 0) throw std::runtime_error(zip_strerror(archive_));
    archive_ = nullptr;
    zip_stat_t stat;
    zip_stat_init(&stat);
    if (zip_source_stat(source_, &stat) != 0 || zip_source_open(source_) != 0) {
      throw std::runtime_error(zip_error_strerror(zip_source_error(source_)));
    }
    std::string all(stat.size, '\0');
    const zip_int64_t read = zip_source_read(source_, all.data(), all.size());
    zip_source_close(source_);
    if (read != static_cast<zip_int64_t>(all.size())) {
      throw std::runtime_error("the archive cannot be read back");
    }
    return all;
  }

 private:
  zip_source_t* source_ = nullptr;
  zip_t* archive_ = nullptr;
};

}  // namespace

std::string fmu_bytes(FmiVersion version, const MachineConstants& machine,
                      std::string_view library) {
  const std::string constants = text_of(machine);
  const std::string description = model_description(version, machine, token_of(constants));
  const char* platform = version == FmiVersion::fmi2 ? "linux64" : "x86_64-linux";
  Archive archive;
  archive.add("modelDescription.xml", description);
  archive.add("resources/" + std::string(kConstantsFile), constants);
  archive.add("binaries/" + std::string(platform) + "/" + std::string(kModelIdentifier) + ".so",
              library);
  return archive.bytes();
}

}  // namespace servomill::sim::fmu
