/* SPDX-License-Identifier: MIT
 *
 * The C example of docs/reference/api.md: opens an asset, streams its pages coarse to fine, and counts what a camera
 * would draw once everything is there. */
#include <stdio.h>
#include <stdlib.h>

#include <meshlode/meshlode.h>

static int fail(const char* what, const meshlode_error* error) {
  fprintf(stderr, "%s: %s\n", what, error->text);
  return (int)error->status;
}

static void free_pages(const meshlode_asset* asset, void** loaded) {
  uint32_t count, i;
  (void)meshlode_pages(asset, &count);
  for (i = 0; loaded && i < count; ++i) free(loaded[i]);
  free(loaded);
}

/* Loads every page in streaming order into memory of its own. NULL where one cannot be loaded. */
static void** load_pages(const meshlode_asset* asset, meshlode_error* error) {
  uint32_t count, i;
  const meshlode_page* pages = meshlode_pages(asset, &count);
  void** loaded = calloc(count ? count : 1, sizeof *loaded);
  uint32_t* order = malloc((count ? count : 1) * sizeof *order);
  int ok = loaded && order && meshlode_streaming_order(asset, MESHLODE_PROMISE_POSITION, order, error) == MESHLODE_OK;
  for (i = 0; ok && i < count; ++i) {
    const uint32_t page = order[i];
    loaded[page] = malloc(pages[page].bytes);
    ok = loaded[page] && meshlode_load_page(asset, page, loaded[page], pages[page].bytes, error) == MESHLODE_OK;
  }
  free(order);
  if (ok) return loaded;
  free_pages(asset, loaded);
  return NULL;
}

int main(int argc, char** argv) {
  meshlode_asset* asset;
  meshlode_error error;
  const meshlode_view view = {{0.0, 1.0, 3.0}, 0, 0.8, 0.0, 0.01, 720, MESHLODE_PROMISE_POSITION};
  meshlode_draw_item* items;
  size_t count, i;
  void** pages;
  double area_x2 = 0.0;
  unsigned long triangles = 0;
  static float positions[3 * MESHLODE_MAX_CLUSTER_VERTICES];
  static uint8_t corners[3 * MESHLODE_MAX_CLUSTER_TRIANGLES];

  if (argc != 2) return 1;
  if (meshlode_open_file(argv[1], &asset, &error) != MESHLODE_OK) return fail(argv[1], &error);
  if (!(pages = load_pages(asset, &error))) return fail("pages", &error);

  /* What the camera needs: ask for the number, then for the items. */
  if (meshlode_select_view(asset, &view, 1.0, NULL, 0, &count, &error) != MESHLODE_TOO_SMALL)
    return fail("view", &error);
  items = malloc(count * sizeof *items);
  if (!items) return 4;
  if (meshlode_select_view(asset, &view, 1.0, items, count, &count, &error)) return fail("view", &error);

  for (i = 0; i < count; ++i) {
    meshlode_page_bytes page;
    meshlode_cluster_floats cluster = {MESHLODE_MAX_CLUSTER_VERTICES, MESHLODE_MAX_CLUSTER_TRIANGLES};
    uint32_t t;
    page.page = meshlode_page_of(asset, items[i].cluster);
    page.bytes = pages[page.page];
    cluster.positions = positions;
    cluster.triangles = corners;
    if (meshlode_decode_floats(asset, page, items[i].cluster, &cluster, &error)) return fail("cluster", &error);
    for (t = 0; t < cluster.triangle_count; ++t) { /* the area seen from above */
      const float *a = positions + 3 * corners[3 * t], *b = positions + 3 * corners[3 * t + 1];
      const float* c = positions + 3 * corners[3 * t + 2];
      area_x2 += (double)(b[2] - a[2]) * (double)(c[0] - a[0]) - (double)(b[0] - a[0]) * (double)(c[2] - a[2]);
    }
    triangles += cluster.triangle_count;
  }
  printf("%lu clusters, %lu triangles, %.4f square units seen from above\n", (unsigned long)count, triangles,
         0.5 * area_x2);
  free_pages(asset, pages);
  free(items);
  meshlode_close(asset);
  return count > 0 ? 0 : 1;
}
