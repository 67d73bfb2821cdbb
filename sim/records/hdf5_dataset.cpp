#include "sim/records/hdf5_dataset.h"

#include <hdf5.h>
#include <hdf5_hl.h>
#include <array>
#include <cassert>

#include "sim/system/utf8.h"

namespace servomill::sim::records {

Hdf5Dataset::Hdf5Dataset(Hdf5Handle id, std::size_t columns)
    : Hdf5Object(std::move(id)), columns_(columns) {}

void Hdf5Dataset::make_scale(const std::string& name) {
  const Hdf5Lock lock;
  written(H5DSset_scale(id_.get(), name.c_str()), id_.get());
}

void Hdf5Dataset::attach_scale(Hdf5Dataset& scale, unsigned dimension) {
  const Hdf5Lock lock;
  written(H5DSattach_scale(id_.get(), scale.id_.get(), dimension), id_.get());
}

// HDF5 Dimension Scale Specification, section 4.2: the attribute DIMENSION_LIST has references to
// the scales of each dimension.
void Hdf5Dataset::refer_to_scales(std::span<Hdf5Dataset* const> scales) {
  const Hdf5Lock lock;
  std::vector<hobj_ref_t> references(scales.size());
  std::vector<hvl_t> list;
  for (std::size_t i = 0; i < scales.size(); ++i) {
    written(H5Rcreate(&references[i], scales[i]->id_.get(), ".", H5R_OBJECT, -1), id_.get());
    list.push_back({1, &references[i]});
  }
  const hsize_t rank = list.size();
  const Hdf5Handle type = hdf5_handle(H5Tvlen_create(H5T_STD_REF_OBJ));
  const Hdf5Handle space = hdf5_handle(H5Screate_simple(1, &rank, nullptr));
  const Hdf5Handle attribute(written(
      H5Acreate2(id_.get(), "DIMENSION_LIST", type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT),
      id_.get()));
  written(H5Awrite(attribute.get(), type.get(), list.data()), id_.get());
}

// Replaces values of a list, from `first` on.
void Hdf5Dataset::write(std::size_t first, std::size_t count, std::int64_t type,
                        const void* values) {
  const hsize_t begin = first, size = count;
  const Hdf5Handle in_file(written(H5Dget_space(id_.get()), id_.get()));
  H5Sselect_hyperslab(in_file.get(), H5S_SELECT_SET, &begin, nullptr, &size, nullptr);
  const Hdf5Handle in_memory = hdf5_handle(H5Screate_simple(1, &size, nullptr));
  written(H5Dwrite(id_.get(), type, in_memory.get(), in_file.get(), H5P_DEFAULT, values),
          id_.get());
}

void Hdf5Dataset::write(std::size_t first, std::span<const double> values) {
  const Hdf5Lock lock;
  write(first, values.size(), H5T_NATIVE_DOUBLE, values.data());
}

void Hdf5Dataset::write(const StoredText& text) {
  const Hdf5Lock lock;
  std::size_t at = 0;
  text.each_piece([&](std::string_view piece) {
    write(at, piece.size(), H5T_C_S1, piece.data());
    at += piece.size();
  });
}

void Hdf5Dataset::write_text(std::size_t row, std::string_view text) {
  const Hdf5Lock lock;
  constexpr std::string_view kCut = "...";
  std::string room(text.substr(0, columns_));
  if (text.size() > columns_) {
    const std::size_t end = system::utf8_start(text, columns_ - kCut.size());
    room = std::string(text.substr(0, end)) + std::string(kCut);
  }
  room.resize(columns_, '\0');
  const std::array<hsize_t, 2> begin = {row, 0}, block = {1, columns_};
  const Hdf5Handle in_file(written(H5Dget_space(id_.get()), id_.get()));
  H5Sselect_hyperslab(in_file.get(), H5S_SELECT_SET, begin.data(), nullptr, block.data(), nullptr);
  const Hdf5Handle in_memory = hdf5_handle(H5Screate_simple(2, block.data(), nullptr));
  written(H5Dwrite(id_.get(), H5T_C_S1, in_memory.get(), in_file.get(), H5P_DEFAULT, room.data()),
          id_.get());
}

void Hdf5Dataset::append(std::size_t rows, std::span<const std::vector<std::uint8_t>> chunks) {
  assert(chunks.size() == columns_);
  const Hdf5Lock lock;
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

void Hdf5Dataset::read_chunk(std::size_t row, std::size_t column,
                             std::vector<std::uint8_t>& chunk) {
  const Hdf5Lock lock;
  const std::array<hsize_t, 2> begin = {row, column};
  hsize_t size = 0;
  written(H5Dget_chunk_storage_size(id_.get(), begin.data(), &size), id_.get());
  chunk.resize(size);
  std::uint32_t left_out = 0;  // filters
  written(H5Dread_chunk(id_.get(), H5P_DEFAULT, begin.data(), &left_out, chunk.data()), id_.get());
}

}  // namespace servomill::sim::records
