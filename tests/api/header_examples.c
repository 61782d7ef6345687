/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * The examples at the top of meshlode.h and meshlode_build.h, so that they compile as C99; example_test.cpp compares
 * them line by line. */
#include <stdio.h>

#include <meshlode/meshlode_build.h>
#include <meshlode/page_cache.h>

int use_c_runtime(void);
int use_c_build(const float* xyz, size_t n, const uint32_t* corners, size_t m);

int use_c_runtime(void) {
  /* clang-format off */
  meshlode_asset *asset;
  meshlode_error error;
  if (meshlode_open_file("scene.lode", &asset, &error) != MESHLODE_OK) { puts(error.text); return 1; }
  meshlode_close(asset);
  /* clang-format on */
  return 0;
}

int use_c_build(const float* xyz, size_t n, const uint32_t* corners, size_t m) {
  meshlode_error error;
  /* clang-format off */
  meshlode_primitive_input primitive = {0};
  primitive.positions = xyz;
  primitive.vertex_count = n;
  primitive.indices = corners;
  primitive.triangle_count = m;
  primitive.material = MESHLODE_NONE;
  meshlode_mesh_input mesh = {"rock", &primitive, 1};
  meshlode_scene_input scene = {0};
  scene.meshes = &mesh;
  scene.mesh_count = 1;
  if (meshlode_build_to_file(&scene, NULL, "rock.lode", &error) != MESHLODE_OK) puts(error.text);
  /* clang-format on */
  return 0;
}
