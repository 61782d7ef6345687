/* SPDX-License-Identifier: MIT */
/* An asset of any size drawn by Vulkan 1.3 from a pool of fixed size: the head of the file is read once, pages when a
 * view wants them. The CPU selects from what is resident, and one indirect draw decodes with <meshlode/decode.glsl>.
 * C99.
 *
 *   vulkan_stream ASSET PICTURE.png PIXEL_ERROR EYE_X EYE_Y EYE_Z TARGET_X TARGET_Y TARGET_Z POOL_PAGES
 *
 * Flies from ten times the distance to the eye and draws on until the view is complete or the pool is full. The picture
 * is that of the last frame. Bindings are in vulkan/tables.glsl. */
#define _XOPEN_SOURCE 700
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <meshlode/page_cache.h>

#include "vulkan/tables.h"

enum { FRAMES = 30, LOADS_PER_FRAME = 4 };

static int file;
static unsigned char* head; /* kept as long as the asset */
static meshlode_selector* selector;
static meshlode_page_cache cache;
static meshlode_draw_item* list;
static float* wanted;             /* per page its priority, for the pool */
static unsigned char* has_failed; /* per page */
static uint32_t slot_words;
static size_t capacity, bytes_read;

/* 1. The head: the header says how long the section table is, and that where the pages begin. */
static void read_range(void* to, uint64_t bytes, uint64_t offset) {
  if (pread(file, to, bytes, (off_t)offset) != (ssize_t)bytes) stop("file", "cannot be read");
  bytes_read += bytes;
}
static void open_head(const char* path) {
  struct stat status;
  uint64_t have = 0, needed = 0;
  file = open(path, O_RDONLY);
  if (file < 0 || fstat(file, &status)) stop(path, "cannot be opened");
  while (meshlode_head_bytes(head, have, (uint64_t)status.st_size, &needed, &error) == MESHLODE_TOO_SMALL ||
         (error.status == MESHLODE_OK && have < needed)) {
    if (!(head = realloc(head, needed))) stop("memory", "ran out");
    read_range(head + have, needed - have, have);
    have = needed;
  }
  if (error.status || meshlode_open_head(head, have, (uint64_t)status.st_size, &asset, &error)) stop(path, error.text);
  if (meshlode_create_selector(asset, &selector, &error)) stop(path, error.text);
}

/* 2. The pool has slots of one size, that of the largest page. A cluster gets its address when its page arrives. */
static void make_pool(uint32_t slots) {
  const VkBufferUsageFlags storage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
  gpu_cluster* found;
  uint32_t p, i;
  for (p = 0; p < page_count; ++p) slot_words = pages[p].bytes / 4 > slot_words ? pages[p].bytes / 4 : slot_words;
  if (slots > page_count) slots = page_count;
  if ((uint64_t)slots * slot_words > UINT32_MAX) stop("pool", "too large for 32-bit words");
  meshlode_page_cache_init(&cache, page_count, slots, take(meshlode_page_cache_words(page_count, slots), 4),
                           take(page_count, sizeof(float)));
  wanted = take(page_count, sizeof *wanted);
  has_failed = take(page_count, 1);
  make_buffer(PAGES, (size_t)slots * slot_words * 4, storage);
  make_buffer(GROUPS, 16, storage); /* of the shader that selects: not used here */
  make_buffer(CLUSTERS, cluster_count * sizeof *found, storage);
  found = mapped[CLUSTERS];
  for (p = 0; p < page_count; ++p)
    for (i = pages[p].first_cluster; i < pages[p].first_cluster + pages[p].cluster_count; ++i) {
      const gpu_cluster one = {clusters[i].own_group, clusters[i].coarser_group, 0, i - pages[p].first_cluster};
      found[i] = one;
    }
  capacity = make_tables();
  list = take(capacity, sizeof *list);
}

/* 3. Load the most important pages, each into a slot that is free or of less importance. The device waits for each
 * frame here; an engine with frames in flight frees a slot when the last frame that reads it is done. Returns how many
 * came. */
static int load_pages(void) {
  static unsigned char stored[MESHLODE_MAX_PAGE_BYTES];
  uint32_t page, slot, i;
  int loads = 0;
  while (loads < LOADS_PER_FRAME && meshlode_page_cache_begin(&cache, &page, &slot)) {
    const meshlode_range range = meshlode_page_range(asset, page);
    uint32_t* words = (uint32_t*)mapped[PAGES] + (size_t)slot * slot_words;
    gpu_cluster* found = mapped[CLUSTERS];
    int is_sound;
    read_range(stored, range.bytes, range.offset);
    is_sound = !meshlode_unpack_page(asset, page, stored, range.bytes, words, pages[page].bytes, &error);
    if (!is_sound) fprintf(stderr, "%s; what is coarser is drawn instead\n", error.text);
    for (i = 0; is_sound && i < pages[page].cluster_count; ++i)
      found[pages[page].first_cluster + i].page_word = slot * slot_words;
    meshlode_page_cache_end(&cache, page, is_sound);
    has_failed[page] = !is_sound;
    if (is_sound) ++loads;
  }
  return loads;
}

/* 4. A frame: select of what is resident, draw, load. */
static size_t draw_frame(const meshlode_view* view, const double target[3], const double axes[3][3], double pixel_error,
                         int* loads) {
  meshlode_frustum frustum;
  gpu_item* items = mapped[ITEMS];
  const float* priorities;
  size_t count = 0, i;
  if (meshlode_make_frustum(view, target, axes[1], (double)WIDTH / HEIGHT, &frustum, &error) ||
      meshlode_select_resident(selector, view, &frustum, pixel_error, cache.resident, list, capacity, &count, &error))
    stop("view", error.text);
  for (i = 0; i < count; ++i) {
    items[i].instance = list[i].instance;
    items[i].cluster = list[i].cluster;
  }
  ((VkDrawIndirectCommand*)mapped[DRAW])->instanceCount = (uint32_t)count;
  place_instances(view->eye, axes);
  begin_frame();
  end_frame();
  /* A page that failed is not tried again: each attempt evicts a sound page of a full pool. */
  priorities = meshlode_page_priorities(selector, &i);
  for (i = 0; i < page_count; ++i) wanted[i] = has_failed[i] ? 0.0f : priorities[i];
  meshlode_page_cache_update(&cache, wanted);
  *loads = load_pages();
  return count;
}

/* With all that the view wants, the cut is that of the whole asset. */
static void check_cut(const meshlode_view* view, const double target[3], const double axes[3][3], double pixel_error,
                      size_t count) {
  meshlode_frustum frustum;
  meshlode_draw_item* expected = take(capacity, sizeof *expected);
  size_t expected_count = 0;
  if (meshlode_make_frustum(view, target, axes[1], (double)WIDTH / HEIGHT, &frustum, &error) ||
      meshlode_select_frustum(asset, view, &frustum, pixel_error, expected, capacity, &expected_count, &error))
    stop("cut", error.text);
  if (expected_count != count || memcmp(expected, list, count * sizeof *list) != 0)
    stop("cut", "is not that of the whole asset");
  free(expected);
}

int main(int argc, char** argv) {
  meshlode_view view = {{0.0, 0.0, 0.0}, 0, FOVY, 0.0, NEAR, HEIGHT, MESHLODE_PROMISE_POSITION};
  double eye[3], target[3], axes[3][3], pixel_error, covered;
  size_t i, count = 0, missing = 0, triangles = 0;
  uint32_t frame, slots;
  int k, loads = 1;
  if (argc != 11)
    stop("usage",
         "vulkan_stream ASSET PICTURE.png PIXEL_ERROR EYE_X EYE_Y EYE_Z TARGET_X TARGET_Y TARGET_Z POOL_PAGES");
  if (!((pixel_error = atof(argv[3])) > 0.0)) stop(argv[3], "above 0 is wanted");
  if ((slots = (uint32_t)strtoul(argv[10], NULL, 10)) == 0) stop(argv[10], "above 0 is wanted");
  open_head(argv[1]);
  read_tables(argv[1]);
  look(argv + 4, eye, target, axes);
  open_device();
  make_pool(slots);
  make_set();
  make_draw_pipeline();
  make_images();
  /* The last place is drawn until nothing comes any more: a page that a full pool has no room for is not asked for
   * again. */
  for (frame = 0; frame < FRAMES || loads > 0; ++frame) {
    const double far = frame < FRAMES ? 1.0 + 9.0 * (FRAMES - 1 - frame) / (FRAMES - 1) : 1.0;
    for (k = 0; k < 3; ++k) view.eye[k] = target[k] + far * (eye[k] - target[k]);
    count = draw_frame(&view, target, (const double(*)[3])axes, pixel_error, &loads);
  }
  (void)meshlode_page_requests(selector, &missing);
  if (missing == 0) check_cut(&view, target, (const double(*)[3])axes, pixel_error, count);
  covered = save_picture(argv[2]);
  for (i = 0; i < count; ++i) triangles += clusters[list[i].cluster].triangles_less_1 + 1u;
  printf("%s: %u triangles in %u clusters, %.2f%% of the picture covered\n", properties.deviceName, (unsigned)triangles,
         (unsigned)count, covered);
  printf("%u frames, %lu bytes read, %u slots, %u pages missing\n", (unsigned)frame, (unsigned long)bytes_read,
         (unsigned)cache.slot_count, (unsigned)missing);
  /* The process ends here: a program that goes on destroys what it made, one by one. */
  meshlode_destroy_selector(selector);
  meshlode_close(asset);
  return close(file);
}
