/* SPDX-License-Identifier: MIT
 *
 * A stranger's engine in C: opens an asset and draws its coarsest cut. */
#include <stdio.h>

#include <meshlode/meshlode.h>

int main(int argc, char** argv) {
  static uint32_t page[MESHLODE_MAX_PAGE_BYTES / 4];
  meshlode_asset* asset;
  meshlode_error error;
  uint32_t cluster;
  size_t count;
  meshlode_page_bytes bytes = {0, page};
  meshlode_cluster_floats floats = {MESHLODE_MAX_CLUSTER_VERTICES, MESHLODE_MAX_CLUSTER_TRIANGLES};
  if (argc != 2) return 1;
  if (meshlode_open_file(argv[1], &asset, &error)) {
    puts(error.text);
    return 1;
  }
  if (meshlode_select_uniform(asset, 0, MESHLODE_PROMISE_POSITION, 0.0, &cluster, 1, &count, NULL, &error)) return 1;
  bytes.page = meshlode_page_of(asset, cluster);
  if (meshlode_load_page(asset, bytes.page, page, sizeof page, &error)) return 1;
  if (meshlode_decode_floats(asset, bytes, cluster, &floats, &error)) return 1;
  printf("%u triangle(s) in C\n", (unsigned)floats.triangle_count);
  meshlode_close(asset);
  return floats.triangle_count == 1 ? 0 : 1;
}
