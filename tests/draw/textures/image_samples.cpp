// SPDX-License-Identifier: GPL-3.0-or-later
#include "image_samples.h"

#include <cstdio>
#include <cstdlib>

#include <jpeglib.h>
#include <png.h>
#include <webp/encode.h>

namespace meshlode::test {

PaletteEntry palette_entry(std::uint32_t i) {
  return {static_cast<std::uint8_t>(i * 5), static_cast<std::uint8_t>(255 - i), static_cast<std::uint8_t>(i * 31),
          static_cast<std::uint8_t>(i * 3 + 1)};
}

std::vector<std::uint8_t> make_png(std::uint32_t width, std::uint32_t height, const PngKind& kind,
                                   const std::vector<std::uint8_t>& rows) {
  std::vector<std::uint8_t> out;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);  // errors abort
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &out,
      [](png_structp p, png_bytep bytes, png_size_t count) {
        auto* to = static_cast<std::vector<std::uint8_t>*>(png_get_io_ptr(p));
        to->insert(to->end(), bytes, bytes + count);
      },
      nullptr);
  png_set_IHDR(png, info, width, height, kind.bit_depth, kind.color_type,
               kind.is_interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  std::vector<png_color> palette;
  std::vector<png_byte> alpha;
  if (kind.color_type == PNG_COLOR_TYPE_PALETTE) {
    for (std::uint32_t i = 0; i < (1u << kind.bit_depth); ++i) {
      const PaletteEntry e = palette_entry(i);
      palette.push_back({e.r, e.g, e.b});
      alpha.push_back(e.a);
    }
    png_set_PLTE(png, info, palette.data(), static_cast<int>(palette.size()));
  }
  if (kind.has_transparency) {
    png_color_16 key{};  // of grey and RGB: all zero is transparent
    png_set_tRNS(png, info, alpha.data(), static_cast<int>(alpha.size()), &key);
  }
  png_write_info(png, info);
  const std::size_t stride = rows.size() / height;
  std::vector<png_bytep> pointers;
  std::vector<std::uint8_t> copy = rows;
  for (std::uint32_t y = 0; y < height; ++y) pointers.push_back(copy.data() + y * stride);
  png_write_image(png, pointers.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return out;
}

std::vector<std::uint8_t> make_jpeg(std::uint32_t width, std::uint32_t height, int components, bool is_progressive,
                                    const std::vector<std::uint8_t>& pixels) {
  jpeg_compress_struct info{};
  jpeg_error_mgr errors{};
  info.err = jpeg_std_error(&errors);  // errors end the program
  jpeg_CreateCompress(&info, JPEG_LIB_VERSION, sizeof info);
  unsigned char* bytes = nullptr;
  unsigned long count = 0;
  jpeg_mem_dest(&info, &bytes, &count);
  info.image_width = width;
  info.image_height = height;
  info.input_components = components;
  info.in_color_space = components == 1 ? JCS_GRAYSCALE : components == 3 ? JCS_RGB : JCS_CMYK;
  jpeg_set_defaults(&info);
  jpeg_set_quality(&info, 100, TRUE);
  if (is_progressive) jpeg_simple_progression(&info);
  jpeg_start_compress(&info, TRUE);
  std::vector<std::uint8_t> row;
  const std::size_t stride = std::size_t{width} * static_cast<std::size_t>(components);
  while (info.next_scanline < height) {
    const auto first = pixels.begin() + static_cast<std::ptrdiff_t>(info.next_scanline * stride);
    row.assign(first, first + static_cast<std::ptrdiff_t>(stride));
    JSAMPROW pointer = row.data();
    jpeg_write_scanlines(&info, &pointer, 1);
  }
  jpeg_finish_compress(&info);
  jpeg_destroy_compress(&info);
  std::vector<std::uint8_t> out(bytes, bytes + count);
  std::free(bytes);
  return out;
}

std::vector<std::uint8_t> make_webp(std::uint32_t width, std::uint32_t height, bool is_lossless,
                                    const std::vector<std::uint8_t>& pixels) {
  const int w = static_cast<int>(width), h = static_cast<int>(height);
  std::uint8_t* bytes = nullptr;
  WebPConfig config;
  WebPPicture picture;
  if (WebPConfigInit(&config) == 0 || WebPPictureInit(&picture) == 0) return {};
  config.lossless = is_lossless ? 1 : 0;
  config.quality = 95.0F;
  config.exact = 1;  // colours behind alpha 0 too
  picture.use_argb = config.lossless;
  picture.width = w;
  picture.height = h;
  WebPMemoryWriter writer;
  WebPMemoryWriterInit(&writer);
  picture.writer = WebPMemoryWrite;
  picture.custom_ptr = &writer;
  std::vector<std::uint8_t> out;
  if (WebPPictureImportRGBA(&picture, pixels.data(), 4 * w) != 0 && WebPEncode(&config, &picture) != 0) {
    bytes = writer.mem;
    out.assign(bytes, bytes + writer.size);
  }
  WebPPictureFree(&picture);
  WebPMemoryWriterClear(&writer);
  return out;
}

}  // namespace meshlode::test
