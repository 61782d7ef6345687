// SPDX-License-Identifier: GPL-3.0-or-later
// libpng, seen by this file alone. Its errors are long jumps: they end in read_header() and read_rows(), whose frames
// hold nothing that would have to be destroyed.
#include <png.h>

#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <string>

#include "base/try.h"
#include "draw/textures/image_readers.h"

namespace meshlode::draw {

namespace {

struct Reader {
  png_structp png = nullptr;
  png_infop info = nullptr;
  const std::uint8_t* at = nullptr;
  std::size_t left = 0;
  png_uint_32 width = 0, height = 0;
  std::size_t stored_row_bytes = 0;  ///< before anything is expanded
  char message[128] = "";

  Reader() = default;
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
};

extern "C" {
static void meshlode_png_error(png_structp png, png_const_charp message) {
  auto* reader = static_cast<Reader*>(png_get_error_ptr(png));
  std::snprintf(reader->message, sizeof reader->message, "%s", message);
  png_longjmp(png, 1);
}
static void meshlode_png_warning(png_structp /*png*/, png_const_charp /*message*/) {}
static void meshlode_png_read(png_structp png, png_bytep out, png_size_t count) {
  auto* reader = static_cast<Reader*>(png_get_io_ptr(png));
  if (count > reader->left) png_error(png, "the file ends early");
  std::memcpy(out, reader->at, count);
  reader->at += count;
  reader->left -= count;
}
}

bool read_header(Reader& reader) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
  png_set_read_fn(reader.png, &reader, meshlode_png_read);
  png_set_user_limits(reader.png, 0x7FFFFFFF, 0x7FFFFFFF);  // check_image_size() says which side is too long
  png_set_chunk_cache_max(reader.png, 64);
  png_set_chunk_malloc_max(reader.png, 8u << 20);
  png_read_info(reader.png, reader.info);
  reader.width = png_get_image_width(reader.png, reader.info);
  reader.height = png_get_image_height(reader.png, reader.info);
  reader.stored_row_bytes = png_get_rowbytes(reader.png, reader.info);
  return true;
}

/// \pre `rows` has a pointer to 4 · width bytes for each row
bool read_rows(Reader& reader, png_bytepp rows) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
  png_set_expand(reader.png);    // palettes, less than 8 bits, transparent colours
  png_set_scale_16(reader.png);  // the nearest of 8 bits
  png_set_gray_to_rgb(reader.png);
  png_set_add_alpha(reader.png, 0xFF, PNG_FILLER_AFTER);
  (void)png_set_interlace_handling(reader.png);
  png_read_update_info(reader.png, reader.info);
  if (png_get_rowbytes(reader.png, reader.info) != std::size_t{4} * reader.width) {
    png_error(reader.png, "rows of another length than four channels have");
  }
  png_read_image(reader.png, rows);
  return true;
}

}  // namespace

Result<ImageHeader> read_png(std::span<const std::uint8_t> bytes, std::vector<std::uint32_t>* texels) {
  Reader reader;
  reader.at = bytes.data();
  reader.left = bytes.size();
  reader.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &reader, meshlode_png_error, meshlode_png_warning);
  if (reader.png != nullptr) reader.info = png_create_info_struct(reader.png);
  if (reader.info == nullptr) return Error{ErrorCode::kUnsupported, "image", "libpng gives no reader"};
  const auto damaged = [&] { return Error{ErrorCode::kInvalid, "image", std::string("PNG: ") + reader.message}; };
  if (!read_header(reader)) return damaged();
  TRY(check_image_size(reader.width, reader.height));
  // Deflate makes at most 1032 bytes of one: what the file cannot hold is not made room for.
  constexpr std::uint64_t kMostInflation = 1032;
  if (std::uint64_t{reader.stored_row_bytes} * reader.height > kMostInflation * bytes.size()) {
    return Error{ErrorCode::kInvalid, "image", "PNG: too short for its size"};
  }
  const ImageHeader header{reader.width, reader.height, 0};  // rows are expanded where they belong
  if (texels == nullptr) return header;
  texels->resize(std::size_t{header.width} * header.height);
  std::vector<png_bytep> rows(header.height);
  for (std::size_t y = 0; y < rows.size(); ++y)
    rows[y] = reinterpret_cast<png_bytep>(texels->data() + y * header.width);
  if (!read_rows(reader, rows.data())) return damaged();
  return header;
}

}  // namespace meshlode::draw
