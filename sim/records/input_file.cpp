#include "sim/records/input_file.h"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <utility>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/user_file.h"
#include "sim/records/hdf5_library.h"
#include "sim/records/nexus.h"
#include "sim/records/shared_signals.h"

namespace servomill::sim::records {
namespace {

std::string without_attribute(const std::string& object, const std::string& name) {
  return fmt::format("'{}' has no attribute '{}'", object, name);
}

}  // namespace

InputFile::InputFile(std::string path) : path_(std::move(path)) {
  const Hdf5Lock lock;
  prepare_hdf5();
  const std::string why = why_unreadable(path_);
  if (!why.empty()) fail(fmt::format("cannot be read: {}", why));
  if (H5Fis_hdf5(path_.c_str()) <= 0) fail("is not an HDF5 file");
  file_ = std::make_unique<Hdf5Handle>(H5Fopen(path_.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
  if (file_->get() < 0) {
    refuse_if_locked(path_);
    fail(fmt::format("cannot be read: {}", hdf5_reason()));
  }
}

InputFile::~InputFile() = default;
InputFile::InputFile(InputFile&&) noexcept = default;

void InputFile::fail(const std::string& message) const { throw InputError({path_}, message); }

bool InputFile::has(const std::string& object) const {
  const Hdf5Lock lock;
  for (std::size_t end = 0; end != std::string::npos;) {
    end = object.find('/', end + 1);
    const std::string above = object.substr(0, end);
    if (above == "/" || above.empty()) continue;
    if (H5Lexists(file_->get(), above.c_str(), H5P_DEFAULT) <= 0) return false;
  }
  return true;
}

Hdf5Handle InputFile::open(const std::string& object) const {
  const Hdf5Lock lock;
  if (!has(object)) fail(fmt::format("has no '{}'", object));
  Hdf5Handle id(H5Oopen(file_->get(), object.c_str(), H5P_DEFAULT));
  if (id.get() < 0) fail(fmt::format("'{}' cannot be read: {}", object, hdf5_reason()));
  return id;
}

std::vector<std::string> InputFile::children(const std::string& group, bool groups) const {
  const Hdf5Lock lock;
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
  const Hdf5Lock lock;
  return children(group, true);
}

std::vector<std::string> InputFile::datasets(const std::string& group) const {
  const Hdf5Lock lock;
  return children(group, false);
}

std::vector<std::size_t> InputFile::shape(const std::string& dataset) const {
  const Hdf5Lock lock;
  const Hdf5Handle id = open(dataset);
  if (H5Iget_type(id.get()) != H5I_DATASET) fail(fmt::format("'{}' is not a dataset", dataset));
  const Hdf5Handle space(H5Dget_space(id.get()));
  std::vector<hsize_t> size(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space.get())));
  H5Sget_simple_extent_dims(space.get(), size.data(), nullptr);
  return {size.begin(), size.end()};
}

bool InputFile::holds_numbers(const std::string& dataset) const {
  const Hdf5Lock lock;
  const Hdf5Handle id = open(dataset);
  if (H5Iget_type(id.get()) != H5I_DATASET) return false;
  const Hdf5Handle type(H5Dget_type(id.get()));
  const H5T_class_t kind = H5Tget_class(type.get());
  return kind == H5T_FLOAT || kind == H5T_INTEGER;
}

std::vector<double> InputFile::values(const std::string& dataset) const {
  throw_if_interrupted();
  const Hdf5Lock lock;
  std::size_t count = 1;
  for (const std::size_t length : shape(dataset)) count *= length;
  if (!holds_numbers(dataset)) fail(fmt::format("'{}' does not hold numbers", dataset));
  const Hdf5Handle id = open(dataset);
  std::vector<double> out(count);
  if (H5Dread(id.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, out.data()) < 0) {
    fail(fmt::format("'{}' cannot be read: {}", dataset, hdf5_reason()));
  }
  return out;
}

std::vector<double> InputFile::values(const std::string& dataset, std::size_t first,
                                      std::size_t count) const {
  if (shape(dataset).size() != 1) {
    fail(fmt::format("'{}' has the wrong length", dataset));
  }
  return column(dataset, 0, first, count);
}

std::vector<double> InputFile::column(const std::string& dataset, std::size_t column,
                                      std::size_t first, std::size_t count) const {
  const Hdf5Lock lock;
  const auto size = shape(dataset);
  const bool has_columns = size.size() == 2;
  if ((size.size() != 1 && !has_columns) || first + count > size[0] ||
      (has_columns && column >= size[1])) {
    fail(fmt::format("'{}' has the wrong length", dataset));
  }
  const Hdf5Handle id = open(dataset);
  const std::array<hsize_t, 2> begin = {first, column}, block = {count, 1};
  const hsize_t length = count;
  const Hdf5Handle in_file(H5Dget_space(id.get()));
  H5Sselect_hyperslab(in_file.get(), H5S_SELECT_SET, begin.data(), nullptr, block.data(), nullptr);
  const Hdf5Handle in_memory = hdf5_handle(H5Screate_simple(1, &length, nullptr));
  std::vector<double> out(count);
  if (H5Dread(id.get(), H5T_NATIVE_DOUBLE, in_memory.get(), in_file.get(), H5P_DEFAULT,
              out.data()) < 0) {
    fail(fmt::format("'{}' cannot be read: {}", dataset, hdf5_reason()));
  }
  return out;
}

std::vector<std::string> InputFile::texts(const std::string& dataset, std::size_t first,
                                          std::size_t count) const {
  const Hdf5Lock lock;
  const auto size = shape(dataset);
  if (size.size() != 2 || first + count > size[0]) {
    fail(fmt::format("'{}' has the wrong length", dataset));
  }
  const Hdf5Handle id = open(dataset);
  const std::array<hsize_t, 2> begin = {first, 0}, block = {count, size[1]};
  const Hdf5Handle in_file(H5Dget_space(id.get()));
  H5Sselect_hyperslab(in_file.get(), H5S_SELECT_SET, begin.data(), nullptr, block.data(), nullptr);
  const Hdf5Handle in_memory = hdf5_handle(H5Screate_simple(2, block.data(), nullptr));
  std::string all(count * size[1], '\0');
  if (H5Dread(id.get(), H5T_C_S1, in_memory.get(), in_file.get(), H5P_DEFAULT, all.data()) < 0) {
    fail(fmt::format("'{}' cannot be read: {}", dataset, hdf5_reason()));
  }
  std::vector<std::string> out;
  for (std::size_t row = 0; row < count; ++row) {
    const std::string text = all.substr(row * size[1], size[1]);
    out.push_back(text.substr(0, text.find('\0')));
  }
  return out;
}

bool InputFile::has_attribute(const std::string& object, const std::string& name) const {
  const Hdf5Lock lock;
  return H5Aexists(open(object).get(), name.c_str()) > 0;
}

Hdf5Handle InputFile::open_attribute(const std::string& object, const std::string& name) const {
  const Hdf5Lock lock;
  const Hdf5Handle id = open(object);
  Hdf5Handle attribute(H5Aopen(id.get(), name.c_str(), H5P_DEFAULT));
  if (attribute.get() < 0) fail(without_attribute(object, name));
  return attribute;
}

Meaning InputFile::meaning(const std::string& dataset) const {
  std::string units = text(dataset, "units");
  const std::string name = dataset.substr(dataset.rfind('/') + 1);
  std::string long_name = own_long_name(unlabelled(text(dataset, "long_name"), units), name);
  return {std::move(units), std::move(long_name)};
}

StoredText InputFile::long_text(const std::string& dataset) const {
  const auto size = shape(dataset);
  if (size.size() != 1 || holds_numbers(dataset)) fail(fmt::format("'{}' is not a text", dataset));
  const Hdf5Handle id = open(dataset);
  const Hdf5Handle in_file(H5Dget_space(id.get()));
  StoredText out;
  out.reserve(size[0]);
  std::string piece;
  while (out.size() < size[0]) {
    const hsize_t begin = out.size(), count = std::min(StoredText::kPiece, size[0] - out.size());
    piece.resize(count);
    const Hdf5Handle in_memory(H5Screate_simple(1, &count, nullptr));
    H5Sselect_hyperslab(in_file.get(), H5S_SELECT_SET, &begin, nullptr, &count, nullptr);
    if (H5Dread(id.get(), H5T_C_S1, in_memory.get(), in_file.get(), H5P_DEFAULT, piece.data()) <
        0) {
      fail(fmt::format("'{}' cannot be read: {}", dataset, hdf5_reason()));
    }
    out.append(piece);
  }
  return out;
}

StoredText InputFile::stored_text(const std::string& object, const std::string& name) const {
  const std::string dataset = object + "/" + name;
  const Hdf5Lock lock;
  if (!has_attribute(object, name) && has(dataset)) return long_text(dataset);
  return StoredText(text(object, name));
}

std::string InputFile::text(const std::string& object, const std::string& name) const {
  const Hdf5Lock lock;
  const Hdf5Handle id = open(object);
  const Hdf5Handle attribute(H5Aopen(id.get(), name.c_str(), H5P_DEFAULT));
  if (attribute.get() < 0) fail(without_attribute(object, name));
  const Hdf5Handle type(H5Aget_type(attribute.get()));
  if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) <= 0) {
    fail(fmt::format("attribute '{}' of '{}' is not a string", name, object));
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
  const Hdf5Lock lock;
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
  const Hdf5Lock lock;
  const std::vector<double> all = numbers(object, name);
  if (all.size() != 1) {
    fail(fmt::format("attribute '{}' of '{}' has {} numbers instead of one", name, object,
                     all.size()));
  }
  return all.front();
}

}  // namespace servomill::sim::records
