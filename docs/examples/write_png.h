/* SPDX-License-Identifier: MIT */
/* A PNG of 8-bit RGB, by one loop: a zlib stream of stored blocks, a row each, so that nothing has to be compressed. */
#ifndef EXAMPLES_WRITE_PNG_H
#define EXAMPLES_WRITE_PNG_H

#include <stdint.h>
#include <stdio.h>
#include <string.h>

#define PNG_SIGNATURE "\x89PNG\r\n\x1a\n"

typedef struct png_file {
  FILE* out;
  uint32_t crc;
  int failed;
} png_file;

static void png_put(png_file* png, const void* data, size_t bytes) {
  const unsigned char* b = data;
  size_t i;
  int k;
  for (i = 0; i < bytes; ++i)
    for (png->crc ^= b[i], k = 0; k < 8; ++k) png->crc = png->crc >> 1 ^ (png->crc & 1u ? 0xEDB88320u : 0u);
  if (fwrite(data, 1, bytes, png->out) != bytes) png->failed = 1;
}
static void png_put_number(png_file* png, uint32_t n) {
  const unsigned char b[4] = {(unsigned char)(n >> 24), (unsigned char)(n >> 16), (unsigned char)(n >> 8),
                              (unsigned char)n};
  png_put(png, b, 4);
}
static void png_begin(png_file* png, uint32_t bytes, const char* name) {
  png_put_number(png, bytes);
  png->crc = ~0u;
  png_put(png, name, 4);
}
static void png_end(png_file* png) {
  png_put_number(png, ~png->crc);
}

/* Nothing, an empty file or a PNG: whatever else is there, such as the asset that was read, stays. */
static int png_may_replace(const char* path) {
  FILE* in = fopen(path, "rb");
  char first[8];
  size_t bytes;
  if (!in) return 1;
  bytes = fread(first, 1, sizeof first, in);
  fclose(in);
  return bytes == 0 || (bytes == sizeof first && !memcmp(first, PNG_SIGNATURE, sizeof first));
}

/* Rows from the top. width <= 21,000, height <= 65,000. 0: written; else `path` is not to be used. */
static int write_png(const char* path, const unsigned char* rgb, uint32_t width, uint32_t height) {
  const uint32_t row = 1 + 3 * width; /* with its filter, which is none */
  uint32_t y, i, low = 1, high = 0;   /* Adler-32 */
  png_file png = {NULL, 0, 0};
  if (!png_may_replace(path)) return 1;
  if (!(png.out = fopen(path, "wb"))) return 1;
  png_put(&png, PNG_SIGNATURE, 8);
  png_begin(&png, 13, "IHDR");
  png_put_number(&png, width);
  png_put_number(&png, height);
  png_put(&png, "\x08\x02\0\0\0", 5); /* 8 bits, RGB */
  png_end(&png);
  png_begin(&png, 2 + height * (5 + row) + 4, "IDAT");
  png_put(&png, "\x78\x01", 2);
  for (y = 0; y < height; ++y, rgb += 3 * width) {
    const unsigned char header[6] = {(unsigned char)(y + 1 == height), (unsigned char)(row & 255),
                                     (unsigned char)(row >> 8),        (unsigned char)(~row & 255),
                                     (unsigned char)(~row >> 8 & 255), 0};
    png_put(&png, header, 6);
    png_put(&png, rgb, 3 * width);
    high = (high + low) % 65521; /* of the filter */
    for (i = 0; i < 3 * width; ++i) {
      low = (low + rgb[i]) % 65521;
      high = (high + low) % 65521;
    }
  }
  png_put_number(&png, high << 16 | low);
  png_end(&png);
  png_begin(&png, 0, "IEND");
  png_end(&png);
  return fclose(png.out) != 0 || png.failed;
}

#endif
