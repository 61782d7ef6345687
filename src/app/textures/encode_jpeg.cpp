// SPDX-License-Identifier: GPL-3.0-or-later
// libjpeg-turbo, seen by this file alone in this room. Its errors are long jumps: they end in write_scanlines(), whose
// frame holds nothing that would have to be destroyed.
#include <csetjmp>
#include <cstddef>
#include <cstdio>
#include <cstdlib>

#include <jpeglib.h>

#include "app/textures/encode.h"

namespace meshlode::app {

namespace {

struct JpegWriter {
  jpeg_compress_struct info{};
  jpeg_error_mgr errors{};
  std::jmp_buf jump{};
  unsigned char* bytes = nullptr;
  unsigned long count = 0;

  JpegWriter() = default;
  JpegWriter(const JpegWriter&) = delete;
  JpegWriter& operator=(const JpegWriter&) = delete;
  ~JpegWriter() {
    jpeg_destroy_compress(&info);
    std::free(bytes);
  }
};

extern "C" {
[[noreturn]] static void meshlode_jpeg_failed(j_common_ptr common) {
  std::longjmp(static_cast<JpegWriter*>(common->client_data)->jump, 1);
}
static void meshlode_jpeg_ignored(j_common_ptr /*common*/, int /*level*/) {}
}

bool write_scanlines(JpegWriter& writer, std::uint32_t width, std::uint32_t height, int quality, JSAMPARRAY rows) {
  if (setjmp(writer.jump) != 0) return false;
  writer.info.err = jpeg_std_error(&writer.errors);
  writer.errors.error_exit = meshlode_jpeg_failed;
  writer.errors.emit_message = meshlode_jpeg_ignored;
  writer.info.client_data = &writer;
  jpeg_CreateCompress(&writer.info, JPEG_LIB_VERSION, sizeof(jpeg_compress_struct));
  writer.info.client_data = &writer;
  jpeg_mem_dest(&writer.info, &writer.bytes, &writer.count);
  writer.info.image_width = width;
  writer.info.image_height = height;
  writer.info.input_components = 3;
  writer.info.in_color_space = JCS_RGB;
  jpeg_set_defaults(&writer.info);
  jpeg_set_quality(&writer.info, quality, TRUE);
  writer.info.optimize_coding = TRUE;
  for (int k = 0; k < writer.info.num_components; ++k) {
    writer.info.comp_info[k].h_samp_factor = writer.info.comp_info[k].v_samp_factor = 1;
  }
  jpeg_start_compress(&writer.info, TRUE);
  jpeg_write_scanlines(&writer.info, rows, height);
  while (writer.info.next_scanline < height) {
    jpeg_write_scanlines(&writer.info, rows + writer.info.next_scanline, height - writer.info.next_scanline);
  }
  jpeg_finish_compress(&writer.info);
  return true;
}

}  // namespace

Result<std::vector<std::uint8_t>> encode_jpeg_file(const draw::DecodedImage& image, int quality) {
  std::vector<std::uint8_t> packed(3 * image.texels.size());
  for (std::size_t i = 0; i < packed.size(); ++i) {
    packed[i] = static_cast<std::uint8_t>(image.texels[i / 3] >> 8U * (i % 3));
  }
  std::vector<JSAMPROW> rows(image.height);
  for (std::size_t y = 0; y < rows.size(); ++y) rows[y] = packed.data() + 3 * y * image.width;
  JpegWriter writer;
  if (!write_scanlines(writer, image.width, image.height, quality, rows.data())) {
    return Error{ErrorCode::kBuildFailed, "image", "libjpeg cannot encode it"};
  }
  return std::vector<std::uint8_t>(writer.bytes, writer.bytes + writer.count);
}

}  // namespace meshlode::app
