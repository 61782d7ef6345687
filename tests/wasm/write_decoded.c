/* SPDX-License-Identifier: GPL-3.0-or-later
 * write_decoded ASSET OUT: what the C API makes of an asset, as one stream of bytes that read_test.mjs makes again from
 * the WebAssembly module: of every cluster the integers and floats, then cuts by each promise that it has. Where the
 * asset or a page is refused the stream ends with the status and the text. Little-endian, as assets are. */
#include <meshlode/meshlode.h>

#include <stdio.h>
#include <stdlib.h>

static FILE* out;

static void put(const void* bytes, size_t size) {
  if (fwrite(bytes, 1, size, out) != size) exit(2);
}
static void put_u32(uint32_t value) {
  put(&value, sizeof value);
}

static void put_integers(const meshlode_asset* asset, meshlode_page_bytes page, uint32_t cluster) {
  static int32_t values[256 * 32];
  static uint8_t triangles[256 * 3];
  static uint32_t materials[256];
  meshlode_cluster_integers decoded = {256 * 32, 256, values, triangles, materials, 0, 0, 0};
  if (meshlode_decode_integers(asset, page, cluster, &decoded, NULL) != MESHLODE_OK) exit(3);
  put_u32(decoded.vertex_count);
  put_u32(decoded.triangle_count);
  put_u32(decoded.channel_count);
  put(values, sizeof(int32_t) * decoded.vertex_count * decoded.channel_count);
  put(triangles, 3 * (size_t)decoded.triangle_count);
  put(materials, sizeof(uint32_t) * decoded.triangle_count);
}

static void put_floats(const meshlode_asset* asset, meshlode_page_bytes page, uint32_t cluster,
                       const meshlode_mesh* mesh) {
  static float positions[256 * 3], normals[256 * 3], uvs[4][256 * 2], colors[256 * 4];
  meshlode_cluster_floats decoded = {0};
  decoded.vertex_capacity = decoded.triangle_capacity = 256;
  decoded.positions = positions;
  decoded.normals = normals;
  for (int set = 0; set < 4; ++set) decoded.uvs[set] = uvs[set];
  decoded.colors = colors;
  if (meshlode_decode_floats(asset, page, cluster, &decoded, NULL) != MESHLODE_OK) exit(3);
  const size_t count = decoded.vertex_count;
  put(positions, sizeof(float) * 3 * count);
  if (mesh->normal_mode == MESHLODE_NORMALS_STORED) put(normals, sizeof(float) * 3 * count);
  for (uint32_t set = 0; set < mesh->uv_set_count; ++set) put(uvs[set], sizeof(float) * 2 * count);
  if (mesh->has_color) put(colors, sizeof(float) * 4 * count);
}

static int put_pages(const meshlode_asset* asset, meshlode_error* error) {
  uint32_t page_count, group_count, cluster_count, mesh_count;
  const meshlode_page* pages = meshlode_pages(asset, &page_count);
  const meshlode_group* groups = meshlode_groups(asset, &group_count);
  const meshlode_cluster* clusters = meshlode_clusters(asset, &cluster_count);
  const meshlode_mesh* meshes = meshlode_meshes(asset, &mesh_count);
  static uint32_t words[MESHLODE_MAX_PAGE_BYTES / 4];
  for (uint32_t p = 0; p < page_count; ++p) {
    if (meshlode_load_page(asset, p, words, sizeof words, error) != MESHLODE_OK) return 0;
    const meshlode_page_bytes page = {p, words};
    for (uint32_t c = pages[p].first_cluster; c < pages[p].first_cluster + pages[p].cluster_count; ++c) {
      put_integers(asset, page, c);
      put_floats(asset, page, c, &meshes[groups[clusters[c].coarser_group].mesh]);
    }
  }
  return 1;
}

static void put_cuts(const meshlode_asset* asset, uint32_t promise) {
  uint32_t mesh_count, instance_count, cluster_count;
  const meshlode_mesh* meshes = meshlode_meshes(asset, &mesh_count);
  meshlode_instances(asset, &instance_count);
  meshlode_clusters(asset, &cluster_count);
  uint32_t* ids = malloc(sizeof(uint32_t) * (cluster_count + 1));
  const size_t capacity = (size_t)cluster_count * (instance_count + 1) + 1;
  meshlode_draw_item* items = malloc(sizeof *items * capacity);
  if (ids == NULL || items == NULL) exit(2);
  for (int step = 0; step < 12; ++step) {
    const double distance = (double)(1 << step) / 8;
    for (uint32_t m = 0; m < mesh_count; ++m) {
      size_t count = 0;
      double stored_error = 0;
      if (meshlode_select_uniform(asset, m, promise, meshes[m].diagonal * distance / 256, ids, cluster_count, &count,
                                  &stored_error, NULL) != MESHLODE_OK) {
        exit(3);
      }
      put_u32((uint32_t)count);
      put(ids, sizeof(uint32_t) * count);
      put(&stored_error, sizeof stored_error);
    }
    const meshlode_view view = {
        {0.25 * distance, 0.5 * distance, distance}, step % 3 == 2, 0.75, distance, 0.0625, 720, promise};
    size_t count = 0;
    if (meshlode_select_view(asset, &view, 1.5, items, capacity, &count, NULL) != MESHLODE_OK) exit(3);
    put_u32((uint32_t)count);
    for (size_t i = 0; i < count; ++i) {
      put_u32(items[i].instance);
      put_u32(items[i].cluster);
    }
  }
  free(items);
  free(ids);
}

int main(int argc, char** argv) {
  if (argc != 3 || (out = fopen(argv[2], "wb")) == NULL) return 2;
  meshlode_asset* asset = NULL;
  meshlode_error error;
  FILE* in = fopen(argv[1], "rb");
  if (in == NULL || fseek(in, 0, SEEK_END) != 0) return 2;
  const long size = ftell(in);
  rewind(in);
  void* bytes = malloc((size_t)size + 1);
  if (bytes == NULL || fread(bytes, 1, (size_t)size, in) != (size_t)size) return 2;
  if (meshlode_open_buffer(bytes, (size_t)size, &asset, &error) == MESHLODE_OK && put_pages(asset, &error)) {
    for (uint32_t promise = MESHLODE_PROMISE_POSITION; promise <= MESHLODE_PROMISE_APPEARANCE; ++promise) {
      meshlode_promise_tables tables;
      if (meshlode_tables_of(asset, promise, &tables, NULL) == MESHLODE_OK) put_cuts(asset, promise);
    }
  } else {
    put_u32((uint32_t)error.status);
    put(error.text, sizeof error.text);
  }
  meshlode_close(asset);
  free(bytes);
  fclose(in);
  return fclose(out) == 0 ? 0 : 2;
}
