// SPDX-License-Identifier: GPL-3.0-or-later
// libpng, seen by this file alone in this room. Its errors are long jumps: they end in write_rows(), whose frame holds
// nothing that would have to be destroyed.
#include <png.h>

#include <csetjmp>
#include <cstddef>
#include <new>

#include "app/textures/encode.h"

namespace meshlode::app {

namespace {

struct PngWriter {
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::vector<std::uint8_t>* out = nullptr;

  PngWriter() = default;
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;
  ~PngWriter() { png_destroy_write_struct(&png, &info); }
};

bool append(std::vector<std::uint8_t>& out, const std::uint8_t* bytes, std::size_t count) {
  try {
    out.insert(out.end(), bytes, bytes + count);
    return true;
  } catch (const std::bad_alloc&) {
    return false;  // an exception must not pass through libpng
  }
}

extern "C" {
static void meshlode_png_failed(png_structp png, png_const_charp /*message*/) {
  png_longjmp(png, 1);
}
static void meshlode_png_ignored(png_structp /*png*/, png_const_charp /*message*/) {}
static void meshlode_png_append(png_structp png, png_bytep bytes, png_size_t count) {
  if (!append(*static_cast<PngWriter*>(png_get_io_ptr(png))->out, bytes, count)) png_error(png, "out of memory");
}
static void meshlode_png_flush(png_structp /*png*/) {}
}

/// Channels that tell the texels apart.
struct PngChannels {
  bool has_color = false, has_alpha = false;
  [[nodiscard]] int type() const {
    return has_color ? (has_alpha ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB)
                     : (has_alpha ? PNG_COLOR_TYPE_GRAY_ALPHA : PNG_COLOR_TYPE_GRAY);
  }
  [[nodiscard]] std::size_t count() const { return (has_color ? 3U : 1U) + (has_alpha ? 1U : 0U); }
};

PngChannels channels_of(const draw::DecodedImage& image) {
  PngChannels channels;
  for (const std::uint32_t texel : image.texels) {
    channels.has_alpha = channels.has_alpha || texel >> 24U != 255U;
    channels.has_color =
        channels.has_color || (texel & 255U) != (texel >> 8U & 255U) || (texel & 255U) != (texel >> 16U & 255U);
  }
  return channels;
}

bool write_rows(PngWriter& writer, std::uint32_t width, std::uint32_t height, int type, png_bytepp rows) {
  if (setjmp(png_jmpbuf(writer.png)) != 0) return false;
  png_set_write_fn(writer.png, &writer, meshlode_png_append, meshlode_png_flush);
  png_set_user_limits(writer.png, 0x7FFFFFFF, 0x7FFFFFFF);
  png_set_compression_level(writer.png, 9);
  png_set_IHDR(writer.png, writer.info, width, height, 8, type, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_set_rows(writer.png, writer.info, rows);
  png_write_png(writer.png, writer.info, PNG_TRANSFORM_IDENTITY, nullptr);
  return true;
}

}  // namespace

Result<std::vector<std::uint8_t>> encode_png_file(const draw::DecodedImage& image) {
  const PngChannels channels = channels_of(image);
  const std::size_t count = channels.count();
  std::vector<std::uint8_t> packed(count * image.texels.size());
  for (std::size_t i = 0; i < image.texels.size(); ++i) {
    for (std::size_t k = 0; k < count; ++k) {
      const bool is_alpha = channels.has_alpha && k + 1 == count;
      packed[count * i + k] = static_cast<std::uint8_t>(image.texels[i] >> (is_alpha ? 24U : 8U * k));
    }
  }
  std::vector<png_bytep> rows(image.height);
  for (std::size_t y = 0; y < rows.size(); ++y) rows[y] = packed.data() + count * y * image.width;
  std::vector<std::uint8_t> out;
  PngWriter writer;
  writer.out = &out;
  writer.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &writer, meshlode_png_failed, meshlode_png_ignored);
  if (writer.png != nullptr) writer.info = png_create_info_struct(writer.png);
  if (writer.info == nullptr || !write_rows(writer, image.width, image.height, channels.type(), rows.data())) {
    return Error{ErrorCode::kBuildFailed, "image", "libpng cannot encode it"};
  }
  return out;
}

}  // namespace meshlode::app
