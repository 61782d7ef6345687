/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * A surface in arrays becomes an asset, is opened, and a cut of it is chosen: C99 alone. */
#include <stdio.h>
#include <stdlib.h>

#include <meshlode/meshlode.h>
#include <meshlode/meshlode_build.h>

#define SIDE 129

static float positions[3 * SIDE * SIDE];
static uint32_t indices[6 * (SIDE - 1) * (SIDE - 1)];

static void fill(void) {
  float* p = positions;
  uint32_t *corner = indices, i, j;
  for (j = 0; j < SIDE; ++j) {
    for (i = 0; i < SIDE; ++i) {
      const float x = (float)i / 64.0f - 1.0f, z = (float)j / 64.0f - 1.0f;
      const uint32_t a = j * SIDE + i, b = a + SIDE;
      *p++ = x;
      *p++ = 0.5f * x * x * z * z;
      *p++ = z;
      if (i + 1 == SIDE || j + 1 == SIDE) continue;
      *corner++ = a;
      *corner++ = b;
      *corner++ = a + 1;
      *corner++ = a + 1;
      *corner++ = b;
      *corner++ = b + 1;
    }
  }
}

static unsigned long triangles_of(const meshlode_asset* asset, const meshlode_draw_item* items, size_t count) {
  uint32_t cluster_count;
  const meshlode_cluster* clusters = meshlode_clusters(asset, &cluster_count);
  unsigned long triangles = 0;
  size_t i;
  for (i = 0; i < count; ++i) triangles += clusters[items[i].cluster].triangles_less_1 + 1ul;
  return triangles;
}

int main(void) {
  static const double distances[] = {2.0, 200.0};
  meshlode_primitive_input primitive = {0};
  meshlode_mesh_input mesh = {0};
  meshlode_scene_input scene = {0};
  meshlode_build_options options;
  meshlode_error error;
  meshlode_asset* asset;
  void* bytes;
  size_t size, count, d;

  fill();
  primitive.positions = positions;
  primitive.vertex_count = SIDE * SIDE;
  primitive.indices = indices;
  primitive.triangle_count = 2 * (SIDE - 1) * (SIDE - 1);
  primitive.material = MESHLODE_NONE;
  mesh.name = "hills";
  mesh.primitives = &primitive;
  mesh.primitive_count = 1;
  scene.meshes = &mesh;
  scene.mesh_count = 1;
  meshlode_build_defaults(&options);
  options.codec = 0; /* pages as they are decoded: they can be mapped */
  if (meshlode_build_to_buffer(&scene, &options, &bytes, &size, &error) != MESHLODE_OK) {
    fprintf(stderr, "%s\n", error.text);
    return (int)error.status;
  }
  if (meshlode_open_buffer(bytes, size, &asset, &error) != MESHLODE_OK) {
    fprintf(stderr, "%s\n", error.text);
    return (int)error.status;
  }
  for (d = 0; d < sizeof distances / sizeof *distances; ++d) {
    meshlode_view view = {{0.0, 0.0, 0.0}, 0, 0.8, 0.0, 0.01, 720, MESHLODE_PROMISE_POSITION};
    meshlode_draw_item* items;
    view.eye[1] = distances[d];
    if (meshlode_select_view(asset, &view, 1.0, NULL, 0, &count, &error) != MESHLODE_TOO_SMALL) return 1;
    items = malloc(count * sizeof *items);
    if (!items || meshlode_select_view(asset, &view, 1.0, items, count, &count, &error) != MESHLODE_OK) return 1;
    printf("from %g away: %lu clusters, %lu triangles\n", distances[d], (unsigned long)count,
           triangles_of(asset, items, count));
    free(items);
  }
  meshlode_close(asset);
  meshlode_build_free(bytes);
  return 0;
}
