#include "sim/input_files.h"

#include "sim/read_file.h"

namespace servomill::sim {
namespace {

constexpr std::size_t kMostBytes = 200'000'000;  // of texts
constexpr std::size_t kMostDocuments = 100;

}  // namespace

InputFiles::InputFiles()
    : texts_(kMostBytes, [](const std::string& text) { return text.size(); }),
      documents_(kMostDocuments) {}

std::shared_ptr<const std::string> InputFiles::text(const std::string& path, const Place& at,
                                                    std::string_view what) {
  MemoKey key;
  key.add(path);
  return texts_.get(key, [&] { return read_file(path, at, what); });
}

std::shared_ptr<const Document> InputFiles::document(const std::string& path) {
  MemoKey key;
  key.add(path);
  return documents_.get(key, [&] { return Document::from_file(path); });
}

std::shared_ptr<const Document> InputFiles::document(const std::string& path,
                                                     const std::string& text) {
  MemoKey key;
  key.add(path);
  key.add(text);
  return documents_.get(key, [&] { return Document::from_text(text, path); });
}

}  // namespace servomill::sim
