#include "sim/records/hdf5_group.h"

#include <hdf5.h>
#include <algorithm>
#include <array>
#include <cassert>
#include <limits>

namespace servomill::sim::records {
namespace {

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

// The same run gives the same file: it holds no times.
Hdf5Handle dataset_creation() {
  Hdf5Handle list = hdf5_handle(H5Pcreate(H5P_DATASET_CREATE));
  H5Pset_obj_track_times(list.get(), false);
  return list;
}

Hdf5Handle list_space(std::size_t rows) {
  const hsize_t size = rows;
  return hdf5_handle(H5Screate_simple(1, &size, nullptr));
}

Hdf5Handle table_space(std::size_t rows, std::size_t columns) {
  const std::array<hsize_t, 2> size = {rows, columns};
  return hdf5_handle(H5Screate_simple(2, size.data(), nullptr));
}

// Columns of a table; 1 of a list and of one value.
std::size_t columns_of(hid_t space) {
  std::array<hsize_t, 2> size = {0, 1};
  assert(H5Sget_simple_extent_ndims(space) <= 2);
  H5Sget_simple_extent_dims(space, size.data(), nullptr);
  return size[1];
}

}  // namespace

Hdf5Group Hdf5Group::group(const std::string& path) {
  const Hdf5Lock lock;
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
  constexpr std::size_t kMax = 65535;  // of either number
  const Hdf5Lock lock;
  const Hdf5Handle creation = group_creation(H5P_GROUP_CREATE);
  const auto entries = static_cast<unsigned>(std::min(children, kMax));
  H5Pset_link_phase_change(creation.get(), std::max(entries, 8U), 0);
  H5Pset_est_link_info(creation.get(), entries,
                       static_cast<unsigned>(std::min(longest_name, kMax)));
  return Hdf5Group(Hdf5Handle(written(
      H5Gcreate2(id_.get(), name.c_str(), H5P_DEFAULT, creation.get(), H5P_DEFAULT), id_.get())));
}

void Hdf5Group::move(const std::string& from, const std::string& to) {
  const Hdf5Lock lock;
  written(H5Lmove(id_.get(), from.c_str(), id_.get(), to.c_str(), H5P_DEFAULT, H5P_DEFAULT),
          id_.get());
}

void Hdf5Group::link(const std::string& from, const std::string& name) {
  const Hdf5Lock lock;
  written(
      H5Lcreate_hard(id_.get(), from.c_str(), id_.get(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT),
      id_.get());
}

void Hdf5Group::remove(const std::string& name) {
  const Hdf5Lock lock;
  written(H5Ldelete(id_.get(), name.c_str(), H5P_DEFAULT), id_.get());
}

// Stored form of a dataset and its first values.
struct Hdf5Group::Layout {
  hid_t type;                            // as stored
  Hdf5Handle space;                      // one value, a list or rows of columns
  const void* values = nullptr;          // none: the dataset is filled later
  hid_t value_type = H5T_NATIVE_DOUBLE;  // of these values
  const StoredText* text = nullptr;      // in place of values
  Hdf5Handle creation = dataset_creation();
  hid_t access = H5P_DEFAULT;
};

Hdf5Dataset Hdf5Group::create(const std::string& name, const Layout& layout,
                              const Meaning& meaning) {
  Hdf5Dataset dataset(
      Hdf5Handle(written(H5Dcreate2(id_.get(), name.c_str(), layout.type, layout.space.get(),
                                    H5P_DEFAULT, layout.creation.get(), layout.access),
                         id_.get())),
      columns_of(layout.space.get()));
  if (layout.values != nullptr) {
    written(H5Dwrite(dataset.id_.get(), layout.value_type, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                     layout.values),
            id_.get());
  }
  if (layout.text != nullptr) dataset.write(*layout.text);
  dataset.attribute("units", meaning.units);
  dataset.attribute("long_name", meaning.long_name);
  return dataset;
}

Hdf5Dataset Hdf5Group::extendible(const std::string& name, std::size_t columns, bool has_columns,
                                  std::size_t chunk_rows, Storage storage, int compression,
                                  const Meaning& meaning) {
  const Hdf5Lock lock;
  const int rank = has_columns ? 2 : 1;
  const std::array<hsize_t, 2> size = {0, columns};
  const std::array<hsize_t, 2> most = {H5S_UNLIMITED, columns};
  const std::array<hsize_t, 2> chunk = {chunk_rows, 1};
  Layout layout{.type = stored_type(storage),
                .space = hdf5_handle(H5Screate_simple(rank, size.data(), most.data()))};
  const hid_t creation = layout.creation.get();
  H5Pset_chunk(creation, rank, chunk.data());
  if (compression != kNoCompression) {
    H5Pset_shuffle(creation);
    H5Pset_deflate(creation, static_cast<unsigned>(compression));
  }
  // a run killed while it extends a dataset must not leave rows that look like values
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  if (storage != Storage::int32) H5Pset_fill_value(creation, H5T_NATIVE_DOUBLE, &nothing);
  // whole chunks are written at once and need no cache
  const Hdf5Handle access = hdf5_handle(H5Pcreate(H5P_DATASET_ACCESS));
  H5Pset_chunk_cache(access.get(), 0, 0, H5D_CHUNK_CACHE_W0_DEFAULT);
  layout.access = access.get();
  return create(name, layout, meaning);
}

Hdf5Dataset Hdf5Group::fixed(const std::string& name, std::size_t rows, Storage storage,
                             double fill, const Meaning& meaning) {
  const Hdf5Lock lock;
  const Layout layout{.type = stored_type(storage), .space = list_space(rows)};
  H5Pset_alloc_time(layout.creation.get(), H5D_ALLOC_TIME_EARLY);
  H5Pset_fill_value(layout.creation.get(), H5T_NATIVE_DOUBLE, &fill);
  return create(name, layout, meaning);
}

Hdf5Dataset Hdf5Group::fixed_texts(const std::string& name, std::size_t rows, std::size_t width,
                                   const std::string& long_name) {
  const Hdf5Lock lock;
  const Layout layout{.type = H5T_C_S1, .space = table_space(rows, width)};
  H5Pset_alloc_time(layout.creation.get(), H5D_ALLOC_TIME_EARLY);
  H5Pset_fill_time(layout.creation.get(), H5D_FILL_TIME_NEVER);  // holes of a file read as zeros
  return create(name, layout, {"1", long_name});
}

Hdf5Dataset Hdf5Group::dataset(const std::string& name) {
  const Hdf5Lock lock;
  Hdf5Handle id(written(H5Dopen2(id_.get(), name.c_str(), H5P_DEFAULT), id_.get()));
  const Hdf5Handle space(written(H5Dget_space(id.get()), id_.get()));
  const std::size_t columns = columns_of(space.get());
  return {std::move(id), columns};
}

Hdf5Dataset Hdf5Group::labels(const std::string& name, std::string_view letters,
                              const std::string& long_name) {
  const Hdf5Lock lock;
  Hdf5Dataset dataset = create(name,
                               {.type = H5T_C_S1,
                                .space = list_space(letters.size()),
                                .values = letters.data(),
                                .value_type = H5T_C_S1},
                               {"1", long_name});
  dataset.attribute("_Encoding", "utf-8");  // netCDF's mark of characters that are texts
  dataset.make_scale(name);
  return dataset;
}

// A chunk is a piece, so that each is encoded once.
void Hdf5Group::write_text(const std::string& name, const StoredText& text) {
  constexpr std::size_t kLongest = 1'000'000;  // bytes of an attribute
  constexpr hsize_t kChunk = StoredText::kPiece;
  if (text.size() <= kLongest) return attribute(name, text.all());
  const Hdf5Lock lock;
  Layout layout{.type = H5T_C_S1, .space = list_space(text.size()), .text = &text};
  H5Pset_chunk(layout.creation.get(), 1, &kChunk);
  H5Pset_deflate(layout.creation.get(), 1);
  Hdf5Dataset dataset = create(name, layout, {"1", name});
  dataset.attribute("_Encoding", "utf-8");
  dataset.make_scale(name);
}

void Hdf5Group::scalar(const std::string& name, double value, const Meaning& meaning) {
  const Hdf5Lock lock;
  create(name,
         {.type = H5T_IEEE_F64LE, .space = hdf5_handle(H5Screate(H5S_SCALAR)), .values = &value},
         meaning);
}

void Hdf5Group::table(const std::string& name, std::size_t columns, std::span<const double> values,
                      const Meaning& meaning, const std::string& row_scale,
                      const std::string& column_scale) {
  const Hdf5Lock lock;
  assert(columns > 0 && values.size() % columns == 0);
  Hdf5Dataset made = create(name,
                            {.type = H5T_IEEE_F64LE,
                             .space = table_space(values.size() / columns, columns),
                             .values = values.data()},
                            meaning);
  unsigned dimension = 0;
  for (const std::string& scale : {row_scale, column_scale}) {
    Hdf5Dataset of = dataset(scale);
    made.attach_scale(of, dimension++);
  }
}

void Hdf5Group::list(const std::string& name, std::span<const double> values,
                     const Meaning& meaning, const std::string& scale) {
  list(Storage::float64, name, values, meaning, scale);
}

void Hdf5Group::counts(const std::string& name, std::span<const double> values,
                       const Meaning& meaning, const std::string& scale) {
  list(Storage::int32, name, values, meaning, scale);
}

void Hdf5Group::list(Storage storage, const std::string& name, std::span<const double> values,
                     const Meaning& meaning, const std::string& scale) {
  const Hdf5Lock lock;
  Hdf5Dataset made = create(
      name,
      {.type = stored_type(storage), .space = list_space(values.size()), .values = values.data()},
      meaning);
  if (scale.empty()) {
    made.make_scale(name);
    return;
  }
  Hdf5Dataset of = dataset(scale);
  made.attach_scale(of, 0);
}

}  // namespace servomill::sim::records
