#include "sim/input/input_files.h"

#include <utility>

#include "plant/vocabulary/checksum.h"
#include "sim/system/read_file.h"

namespace servomill::sim::input {
namespace {

constexpr std::size_t kMaxDocuments = 100;

}  // namespace

InputFiles::InputFiles(std::size_t most_bytes)
    : texts_(most_bytes, [](const std::string& text) { return text.size(); }),
      programs_(most_bytes, [](const StoredText& text) { return text.size(); }),
      documents_(kMaxDocuments) {}

void InputFiles::provide(const std::string& path, std::string text) {
  const std::scoped_lock lock(mutex_);
  checksums_.emplace(path, crc64(text));
  provided_.emplace(path, std::make_shared<const std::string>(std::move(text)));
}

std::shared_ptr<const std::string> InputFiles::text(const std::string& path, const Place& at,
                                                    std::string_view what) {
  if (const auto found = provided_.find(path); found != provided_.end()) return found->second;
  system::MemoKey key;
  key.add(path);
  return texts_.get(key, [&] {
    const bool is_document = what == "scenario" || what == "machine";
    std::string text =
        system::read_file(path, at, what, is_document ? kMaxBytesOfDocument : kMaxBytesOfFile);
    refuse_changed(path, crc64(text));
    return text;
  });
}

std::shared_ptr<const StoredText> InputFiles::program(const std::string& path, const Place& at,
                                                      std::string_view what) {
  system::MemoKey key;
  key.add(path);
  return programs_.get(key, [&] {
    StoredText text = system::stored_file(path, at, what);
    refuse_changed(path, crc64_in_pieces(text));
    return text;
  });
}

void InputFiles::refuse_changed(const std::string& path, std::uint64_t checksum) {
  const std::scoped_lock lock(mutex_);
  if (checksums_.emplace(path, checksum).first->second != checksum) {
    throw InputError({path}, "has changed since it was first read");
  }
}

std::uint64_t InputFiles::checksum(const std::string& path, const Place& at,
                                   std::string_view what) {
  {
    const std::scoped_lock lock(mutex_);
    if (const auto read = checksums_.find(path); read != checksums_.end()) return read->second;
  }
  text(path, at, what);
  const std::scoped_lock lock(mutex_);
  return checksums_.at(path);
}

std::shared_ptr<const config::Document> InputFiles::document(const std::string& path) {
  return document(path, *text(path, {}, "scenario"));
}

std::shared_ptr<const config::Document> InputFiles::document(const std::string& path,
                                                             const std::string& text) {
  system::MemoKey key;
  key.add(path);
  key.add(text);
  return documents_.get(key, [&] { return config::Document::from_text(text, path); });
}

}  // namespace servomill::sim::input
