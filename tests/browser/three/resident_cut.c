/* SPDX-License-Identifier: GPL-3.0-or-later
 * resident_cut ASSET: the native judge of what a page drew. Each line of the standard input is a selection as numbers:
 * eye (3), whether it is orthographic, vertical angle, height of the view, near distance, height in pixels, pixel
 * error, planes of the frustum (24), then a word of 32 pages for each 32 of the asset. Printed is a line
 * "instance:cluster ..." for each. */
#include <meshlode/meshlode.h>

#include <stdio.h>
#include <stdlib.h>

static double next(void) {
  double value;
  if (scanf("%lf", &value) != 1) exit(4);
  return value;
}

int main(int argc, char** argv) {
  meshlode_asset* asset = NULL;
  meshlode_selector* selector = NULL;
  meshlode_error error;
  if (argc != 2 || meshlode_open_file(argv[1], &asset, &error) != MESHLODE_OK) return 2;
  if (meshlode_create_selector(asset, &selector, &error) != MESHLODE_OK) return 3;
  uint32_t page_count, cluster_count, instance_count;
  meshlode_pages(asset, &page_count);
  meshlode_clusters(asset, &cluster_count);
  meshlode_instances(asset, &instance_count);
  const size_t words = (page_count + 31) / 32;
  const size_t capacity = (size_t)cluster_count * instance_count + 1;
  uint32_t* resident = malloc((words + 1) * sizeof *resident);
  meshlode_draw_item* items = malloc(capacity * sizeof *items);
  if (resident == NULL || items == NULL) return 2;
  double first;
  while (scanf("%lf", &first) == 1) {
    meshlode_view view = {{0}, 0, 0, 0, 0, 0, 0};
    meshlode_frustum frustum;
    view.eye[0] = first;
    view.eye[1] = next();
    view.eye[2] = next();
    view.is_orthographic = (int)next();
    view.fovy_radians = next();
    view.ortho_height = next();
    view.near_distance = next();
    view.height_px = (uint32_t)next();
    const double pixel_error = next();
    for (int i = 0; i < 24; ++i) frustum.planes[i / 4][i % 4] = next();
    for (size_t i = 0; i < words; ++i) resident[i] = (uint32_t)next();
    size_t count = 0;
    if (meshlode_select_resident(selector, &view, &frustum, pixel_error, resident, items, capacity, &count, &error) !=
        MESHLODE_OK) {
      fputs(error.text, stderr);
      return 5;
    }
    for (size_t i = 0; i < count; ++i) {
      printf("%s%lu:%lu", i == 0 ? "" : " ", (unsigned long)items[i].instance, (unsigned long)items[i].cluster);
    }
    putchar('\n');
  }
  meshlode_destroy_selector(selector);
  meshlode_close(asset);
  free(items);
  free(resident);
  return 0;
}
