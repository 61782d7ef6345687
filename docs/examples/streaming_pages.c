/* SPDX-License-Identifier: MIT */
/* A fly-by of an asset from a pool of a quarter of its pages: docs/tutorials/streaming-pages.md */
#define _XOPEN_SOURCE 700
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <meshlode/meshlode.h>

#include "write_png.h"

enum { WIDTH = 640, HEIGHT = 480, LOADS_PER_FRAME = 4 };
static const double FOVY = 0.7853981633974483; /* full vertical angle, radians */
static int file;
static unsigned char* head; /* kept as long as the asset */
static meshlode_asset* asset;
static meshlode_error error;
static meshlode_draw_item* list;
static const meshlode_page* pages;
static uint32_t page_count, *resident; /* a bit per page, for the selection */
static void** slots;                   /* per page its decoded bytes; NULL: not resident */
static size_t pool_bytes, used_bytes;
static void stop(const char* what, const char* why) {
  fprintf(stderr, "%s: %s\n", what, why);
  exit(1);
}
static void* take(size_t bytes) {
  void* memory = calloc(bytes + 1, 1);
  return memory ? memory : (stop("memory", "ran out"), memory);
}
static void read_range(void* to, uint64_t bytes, uint64_t offset) {
  if (pread(file, to, bytes, (off_t)offset) != (ssize_t)bytes) stop("file", "cannot be read");
}

/* 1. Open the head: the header says how long the section table is, and that where the pages begin. */
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
}
/* 3. Load what was asked for, most important first. What is less important makes room for it, or it has to wait. */
static int make_room(size_t bytes, float priority, const float* priorities) {
  while (used_bytes + bytes > pool_bytes) {
    uint32_t p, least = page_count;
    for (p = 0; p < page_count; ++p)
      if (slots[p] && priorities[p] < (least < page_count ? priorities[least] : priority)) least = p;
    if (least == page_count && priority < MESHLODE_INFINITE_ERROR) return 0;
    if (least == page_count) { /* without it nothing is drawn: the pool grows */
      pool_bytes = used_bytes + bytes;
      return 1;
    }
    free(slots[least]);
    slots[least] = NULL;
    used_bytes -= pages[least].bytes;
  }
  return 1;
}
static void load_requests(const meshlode_selector* selector) {
  static unsigned char stored[MESHLODE_MAX_PAGE_BYTES];
  size_t count, i;
  const float* priorities = meshlode_page_priorities(selector, &count);
  const meshlode_page_request* requests = meshlode_page_requests(selector, &count);
  for (i = 0; i < count && i < LOADS_PER_FRAME; ++i) {
    const uint32_t p = requests[i].page;
    const meshlode_range range = meshlode_page_range(asset, p);
    if (!make_room(pages[p].bytes, requests[i].priority, priorities)) break;
    read_range(stored, range.bytes, range.offset);
    slots[p] = take(pages[p].bytes);
    if (meshlode_unpack_page(asset, p, stored, range.bytes, slots[p], pages[p].bytes, &error)) stop("page", error.text);
    used_bytes += pages[p].bytes;
  }
}
/* 4. Draw a cluster: its triangles, the nearest point of each pixel wins. */
static unsigned char picture[HEIGHT][WIDTH][3];
static float depth[HEIGHT][WIDTH], positions[3 * MESHLODE_MAX_CLUSTER_VERTICES];
static unsigned char triangles[3 * MESHLODE_MAX_CLUSTER_TRIANGLES];
static double screen[MESHLODE_MAX_CLUSTER_VERTICES][3]; /* x and y in pixels, 1 / distance; 0: behind the eye */
static double twice_area(const double* p, const double* q, double x, double y) {
  return (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0]);
}
static void fill(const double* a, const double* b, const double* c, uint32_t color) {
  const double area = twice_area(a, b, c[0], c[1]);
  const double low_x = fmin(a[0], fmin(b[0], c[0])), high_x = fmax(a[0], fmax(b[0], c[0]));
  const double low_y = fmin(a[1], fmin(b[1], c[1])), high_y = fmax(a[1], fmax(b[1], c[1]));
  int x, y, k;
  if (!(area != 0.0) || !(a[2] > 0.0 && b[2] > 0.0 && c[2] > 0.0)) return; /* a renderer clips instead */
  for (y = (int)fmax(low_y, 0.0); y < HEIGHT && y <= high_y; ++y)
    for (x = (int)fmax(low_x, 0.0); x < WIDTH && x <= high_x; ++x) {
      const double u = twice_area(b, c, x + 0.5, y + 0.5) / area, v = twice_area(c, a, x + 0.5, y + 0.5) / area;
      const float near = (float)(u * a[2] + v * b[2] + (1.0 - u - v) * c[2]);
      if (u < 0.0 || v < 0.0 || u + v > 1.0 || near <= depth[y][x]) continue;
      depth[y][x] = near;
      for (k = 0; k < 3; ++k) picture[y][x][k] = (unsigned char)(96 + color * (37u + 24u * (unsigned)k) % 160);
    }
}
static void draw(meshlode_draw_item item, const double eye[3], const double axes[3][3]) {
  meshlode_cluster_floats cluster = {MESHLODE_MAX_CLUSTER_VERTICES, MESHLODE_MAX_CLUSTER_TRIANGLES, positions};
  const meshlode_page_bytes page = {meshlode_page_of(asset, item.cluster),
                                    slots[meshlode_page_of(asset, item.cluster)]};
  const double scale = HEIGHT / (2.0 * tan(FOVY / 2.0));
  uint32_t count, v;
  const meshlode_instance* instance = meshlode_instances(asset, &count) + item.instance;
  const double *m = instance->transform, *o = meshlode_meshes(asset, &count)[instance->mesh].origin;
  cluster.triangles = triangles;
  if (meshlode_decode_floats(asset, page, item.cluster, &cluster, NULL)) stop("cluster", "does not decode");
  for (v = 0; v < cluster.vertex_count; ++v) {
    double p[3], q[3];
    int k;
    for (k = 0; k < 3; ++k) p[k] = o[k] + (double)positions[3 * v + (uint32_t)k];
    for (k = 0; k < 3; ++k) q[k] = m[4 * k] * p[0] + m[4 * k + 1] * p[1] + m[4 * k + 2] * p[2] + m[4 * k + 3] - eye[k];
    for (k = 0; k < 3; ++k) p[k] = axes[k][0] * q[0] + axes[k][1] * q[1] + axes[k][2] * q[2];
    screen[v][2] = p[2] > 0.0 ? 1.0 / p[2] : 0.0;
    screen[v][0] = WIDTH / 2 + p[0] * screen[v][2] * scale;
    screen[v][1] = HEIGHT / 2 - p[1] * screen[v][2] * scale;
  }
  for (v = 0; v < 3 * cluster.triangle_count; v += 3)
    fill(screen[triangles[v]], screen[triangles[v + 1]], screen[triangles[v + 2]], item.cluster);
}

int main(int argc, char** argv) {
  uint32_t p, count, frame, frames = argc == 4 ? (uint32_t)atoi(argv[3]) : 0;
  size_t items = 0, capacity, i;
  char name[4096];
  meshlode_selector* selector;
  const meshlode_mesh* mesh;
  if (frames == 0) stop("usage", "streaming_pages ASSET PREFIX FRAMES");
  open_head(argv[1]);
  (void)meshlode_instances(asset, &count);
  (void)meshlode_clusters(asset, &p);
  list = take((capacity = (size_t)count * p) * sizeof *list); /* no cut is larger */
  mesh = meshlode_meshes(asset, &count);
  pages = meshlode_pages(asset, &page_count);
  slots = take(page_count * sizeof *slots);
  resident = take((page_count / 32 + 1) * sizeof *resident);
  for (p = 0; p < page_count; ++p) pool_bytes += pages[p].bytes;
  pool_bytes /= 4;
  if (!count || meshlode_create_selector(asset, &selector, &error)) stop(argv[1], "nothing to draw");
  for (frame = 0; frame < frames; ++frame) {
    /* 2. Select of what is there, from a path around the first mesh that comes closer. */
    const double a = 3.14159 * frame / frames, r = mesh->diagonal * (0.6 + 4.0 * (frames - 1 - frame) / frames);
    const double axes[3][3] = {{cos(a), 0, -sin(a)}, {0, 1, 0}, {-sin(a), 0, -cos(a)}}; /* right, up, forward */
    meshlode_view view = {{0.0, 0.0, 0.0}, 0, FOVY, 0.0, 1e-3, HEIGHT, MESHLODE_PROMISE_POSITION};
    meshlode_frustum frustum;
    double at[3];
    for (i = 0; i < 3; ++i) {
      const double middle = 0.5 * mesh->grid_mantissa * ((double)mesh->bounds_min[i] + mesh->bounds_max[i]);
      view.eye[i] = (at[i] = mesh->origin[i] + ldexp(middle, mesh->grid_log2)) - r * axes[2][i];
    }
    if (meshlode_make_frustum(&view, at, axes[1], (double)WIDTH / HEIGHT, &frustum, &error)) stop("view", error.text);
    memset(resident, 0, (page_count / 32 + 1) * sizeof *resident);
    for (p = 0; p < page_count; ++p) resident[p / 32] |= (slots[p] ? 1u : 0u) << p % 32;
    if (meshlode_select_resident(selector, &view, &frustum, 1.0, resident, list, capacity, &items, &error))
      stop("view", error.text);
    memset(picture, 32, sizeof picture);
    memset(depth, 0, sizeof depth);
    for (i = 0; i < items; ++i) draw(list[i], view.eye, axes);
    if (snprintf(name, sizeof name, "%s%03u.png", argv[2], frame) >= (int)sizeof name) stop(argv[2], "is too long");
    if (write_png(name, &picture[0][0][0], WIDTH, HEIGHT)) stop(name, "cannot be written, or is no PNG"); /* 5. */
    load_requests(selector); /* for the frames to come */
  }
  if (!items) stop(argv[1], "the last frame shows nothing");
  printf("%u clusters, %u bytes in a pool of %u\n", (unsigned)items, (unsigned)used_bytes, (unsigned)pool_bytes);
  meshlode_destroy_selector(selector);
  meshlode_close(asset);
  return close(file);
}
