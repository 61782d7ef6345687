// SPDX-License-Identifier: GPL-3.0-or-later
// libjpeg-turbo, seen by this file alone. Its errors are long jumps: they end in read_header() and read_rows(), whose
// frames hold nothing that would have to be destroyed.
#include <csetjmp>
#include <cstddef>
#include <cstdio>
#include <string>

#include <jpeglib.h>

#include <jerror.h>

#include "base/try.h"
#include "draw/textures/image_readers.h"

namespace meshlode::draw {

namespace {

/// A progressive file may hold any number of scans over the same coefficients; real ones have about ten.
constexpr int kMostScans = 256;

struct Reader {
  jpeg_decompress_struct info{};
  jpeg_error_mgr errors{};
  jpeg_progress_mgr progress{};
  std::jmp_buf jump{};
  char message[JMSG_LENGTH_MAX] = "";

  Reader() = default;
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  ~Reader() { jpeg_destroy_decompress(&info); }
};

Reader& reader_of(j_common_ptr common) {
  return *static_cast<Reader*>(common->client_data);
}

extern "C" {
[[noreturn]] static void meshlode_jpeg_error(j_common_ptr common) {
  Reader& reader = reader_of(common);
  reader.errors.format_message(common, reader.message);
  std::longjmp(reader.jump, 1);
}
/// A file that ends early would be filled up with grey: that is an error. Other warnings are not.
static void meshlode_jpeg_message(j_common_ptr common, int level) {
  if (level >= 0) return;
  ++common->err->num_warnings;
  if (common->err->msg_code == JWRN_JPEG_EOF) meshlode_jpeg_error(common);
}
static void meshlode_jpeg_progress(j_common_ptr common) {
  const Reader& reader = reader_of(common);
  if (reader.info.input_scan_number > kMostScans) {
    common->err->msg_code = JERR_BAD_PROGRESSION;
    meshlode_jpeg_error(common);
  }
}
}

bool read_header(Reader& reader, const std::uint8_t* bytes, unsigned long count) {
  if (setjmp(reader.jump) != 0) return false;
  reader.info.err = jpeg_std_error(&reader.errors);
  reader.errors.error_exit = meshlode_jpeg_error;
  reader.errors.emit_message = meshlode_jpeg_message;
  reader.info.client_data = &reader;
  jpeg_CreateDecompress(&reader.info, JPEG_LIB_VERSION, sizeof(jpeg_decompress_struct));
  reader.info.client_data = &reader;
  reader.progress.progress_monitor = meshlode_jpeg_progress;
  reader.info.progress = &reader.progress;
  jpeg_mem_src(&reader.info, bytes, count);
  jpeg_read_header(&reader.info, TRUE);
  return true;
}

/// \pre `rgba` has 4 · width · height bytes
bool read_rows(Reader& reader, std::uint8_t* rgba) {
  if (setjmp(reader.jump) != 0) return false;
  reader.info.out_color_space = JCS_EXT_RGBA;  // alpha 255
  reader.info.dct_method = JDCT_ISLOW;         // the same bits on every processor
  jpeg_start_decompress(&reader.info);
  const std::size_t row_bytes = std::size_t{4} * reader.info.output_width;
  while (reader.info.output_scanline < reader.info.output_height) {
    JSAMPROW row = rgba + row_bytes * reader.info.output_scanline;
    jpeg_read_scanlines(&reader.info, &row, 1);
  }
  return true;
}

}  // namespace

Result<ImageHeader> read_jpeg(std::span<const std::uint8_t> bytes, std::vector<std::uint32_t>* texels) {
  Reader reader;
  const auto damaged = [&] { return Error{ErrorCode::kInvalid, "image", std::string("JPEG: ") + reader.message}; };
  if (!read_header(reader, bytes.data(), static_cast<unsigned long>(bytes.size()))) return damaged();
  const std::uint64_t width = reader.info.image_width, height = reader.info.image_height;
  TRY(check_image_size(width, height));
  if (reader.info.arith_code != 0 || reader.info.num_components == 4) {
    return Error{ErrorCode::kUnsupported, "image", "JPEG with arithmetic coding or of four colours"};
  }
  // Each 8 × 8 block of the finest component takes a bit at least: what the file cannot hold is not made room for.
  if (width * height > std::uint64_t{512} * bytes.size()) {
    return Error{ErrorCode::kInvalid, "image", "JPEG: too short for its size"};
  }
  ImageHeader header{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), 0};
  // Coefficients of all scans are kept until the last one: 2 bytes each, in blocks of 8 × 8 whose rows and columns are
  // filled up to the largest sampling factor, which is at most 4.
  if (jpeg_has_multiple_scans(&reader.info) != FALSE) {
    const auto filled = [](std::uint64_t side) { return (side + 31) / 32 * 32; };
    header.decoder_bytes = 2 * static_cast<std::uint64_t>(reader.info.num_components) * filled(width) * filled(height);
  }
  if (texels == nullptr) return header;
  texels->resize(std::size_t{header.width} * header.height);
  if (!read_rows(reader, reinterpret_cast<std::uint8_t*>(texels->data()))) return damaged();
  return header;
}

}  // namespace meshlode::draw
