/* SPDX-License-Identifier: MIT */
/* What the programs that draw on a GPU do alike: the end at an error, the camera, and where an instance is. */
#ifndef EXAMPLES_PLACE_H
#define EXAMPLES_PLACE_H

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <meshlode/meshlode.h>

enum { WIDTH = 640, HEIGHT = 480 };
static const double FOVY = 0.7853981633974483, NEAR = 1e-3; /* radians; world units */

static void stop(const char* what, const char* why) {
  fprintf(stderr, "%s: %s\n", what, why);
  exit(1);
}
static void* take(size_t count, size_t bytes) {
  void* memory = calloc(count + 1, bytes);
  if (!memory) stop("memory", "ran out");
  return memory;
}

static void normalize(double* v) {
  const double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  int k;
  for (k = 0; k < 3; ++k) v[k] /= length;
}

/* Three numbers each for eye and target, from the command line. axes: right, up, forward; the world's up is (0, 1, 0).
 */
static void look(char** words, double eye[3], double target[3], double axes[3][3]) {
  int i;
  for (i = 0; i < 3; ++i) {
    eye[i] = atof(words[i]);
    target[i] = atof(words[3 + i]);
    axes[2][i] = target[i] - eye[i];
  }
  normalize(axes[2]);
  axes[0][0] = -axes[2][2]; /* right: forward x (0, 1, 0) */
  axes[0][1] = 0.0;
  axes[0][2] = axes[2][0];
  normalize(axes[0]);
  for (i = 0; i < 3; ++i) { /* up: right x forward */
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    axes[1][i] = axes[0][j] * axes[2][k] - axes[0][k] * axes[2][j];
  }
}

/* As both shaders read it, std430. */
typedef struct gpu_place {
  float clip[16];     /* column-major: grid units of the mesh -> clip space */
  float normal[3][4]; /* rows: directions of the mesh -> world, up to a length */
} gpu_place;
typedef struct gpu_mesh {
  uint32_t normal_scale, uv_set_count, has_color, material;
} gpu_mesh;

/* In doubles up to the last step: grid -> mesh -> world -> relative to the eye -> clip space, without a far plane.
 * up: 1 where y of clip space points up (OpenGL), -1 where down (Vulkan). least_depth: of z / w, -1 or 0. */
static gpu_place place_instance(const meshlode_instance* instance, const meshlode_mesh* mesh, const double eye[3],
                                const double axes[3][3], double up, double least_depth) {
  gpu_place out = {{0.0f}, {{0.0f}}};
  const double* m = instance->transform;
  const double step = mesh->grid_mantissa * ldexp(1.0, mesh->grid_log2), focal = 1.0 / tan(FOVY / 2.0);
  double seen[3][4]; /* right, up, forward of a grid point */
  int row, column, k;
  for (row = 0; row < 3; ++row)
    for (column = 0; column < 4; ++column) {
      double sum = 0.0;
      for (k = 0; k < 3; ++k) {
        const double* r = m + 4 * k;
        const double moved = r[0] * mesh->origin[0] + r[1] * mesh->origin[1] + r[2] * mesh->origin[2] + r[3] - eye[k];
        sum += axes[row][k] * (column < 3 ? r[column] * step : moved);
      }
      seen[row][column] = sum;
    }
  for (column = 0; column < 4; ++column) {
    out.clip[4 * column] = (float)(focal * HEIGHT / WIDTH * seen[0][column]);
    out.clip[4 * column + 1] = (float)(up * focal * seen[1][column]);
    out.clip[4 * column + 2] = (float)(seen[2][column] - (column == 3 ? (1.0 - least_depth) * NEAR : 0.0));
    out.clip[4 * column + 3] = (float)seen[2][column];
  }
  for (row = 0; row < 3; ++row) /* cofactors: right for uneven scales, and turned where the instance is mirrored */
    for (column = 0; column < 3; ++column) {
      const double *a = m + 4 * ((row + 1) % 3), *b = m + 4 * ((row + 2) % 3);
      const int i = (column + 1) % 3, j = (column + 2) % 3;
      out.normal[row][column] =
          (float)((a[i] * b[j] - a[j] * b[i]) * (instance->flags & MESHLODE_INSTANCE_MIRRORED ? -1.0 : 1.0));
    }
  return out;
}
static gpu_mesh describe_mesh(const meshlode_mesh* mesh) {
  const gpu_mesh out = {mesh->normal_mode == MESHLODE_NORMALS_STORED ? mesh->normal_scale : 0, mesh->uv_set_count,
                        mesh->has_color, mesh->material};
  return out;
}

#endif
