/* SPDX-License-Identifier: MIT */
/* Tables of an asset in the buffers of tables.glsl. */
#ifndef EXAMPLES_VULKAN_TABLES_H
#define EXAMPLES_VULKAN_TABLES_H

#include <meshlode/meshlode.h>

#include "setup.h"

/* The structs of tables.glsl. */
typedef struct gpu_metric_view { /* MetricView of metric.h */
  float row[3][4], scale, error_scale, near_distance, reserved;
} gpu_metric_view;
typedef struct gpu_instance {
  gpu_place place;
  gpu_metric_view view;
  uint32_t mesh, first_cluster, cluster_count, unused;
} gpu_instance;
typedef struct gpu_group {
  float center[3], radius, error;
  uint32_t unused[3];
} gpu_group;
typedef struct gpu_cluster {
  uint32_t own_group, coarser_group, page_word, index_in_page;
} gpu_cluster;
typedef struct gpu_item {
  uint32_t instance, cluster;
} gpu_item;

static meshlode_asset* asset;
static meshlode_error error;
static const meshlode_mesh* meshes;
static const meshlode_instance* instances;
static const meshlode_group* groups;
static const meshlode_cluster* clusters;
static const meshlode_page* pages;
static uint32_t mesh_count, instance_count, group_count, cluster_count, page_count;

/* The tables of the asset. */
static void read_tables(const char* name) {
  meshes = meshlode_meshes(asset, &mesh_count);
  instances = meshlode_instances(asset, &instance_count);
  groups = meshlode_groups(asset, &group_count);
  clusters = meshlode_clusters(asset, &cluster_count);
  pages = meshlode_pages(asset, &page_count);
  if (cluster_count == 0 || instance_count == 0) stop(name, "nothing to draw");
}
static int is_drawn(uint32_t instance) {
  return !(instances[instance].flags & MESHLODE_INSTANCE_SINGULAR) &&
         meshes[instances[instance].mesh].cluster_count != 0;
}
/* INSTANCES but for their views, MESHES, ITEMS, DRAW. Returns how many items fit: no cut is larger. */
static size_t make_tables(void) {
  const VkBufferUsageFlags storage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
  const VkDrawIndirectCommand draw = {3 * MESHLODE_MAX_CLUSTER_TRIANGLES, 0, 0, 0};
  size_t item_count = 0;
  gpu_instance* placed;
  gpu_mesh* described;
  uint32_t i;
  make_buffer(INSTANCES, instance_count * sizeof *placed, storage);
  placed = mapped[INSTANCES];
  for (i = 0; i < instance_count; ++i) {
    memset(&placed[i], 0, sizeof placed[i]);
    if (!is_drawn(i)) continue;
    placed[i].mesh = instances[i].mesh;
    placed[i].first_cluster = meshes[instances[i].mesh].first_cluster;
    placed[i].cluster_count = meshes[instances[i].mesh].cluster_count;
    item_count += placed[i].cluster_count;
  }
  make_buffer(MESHES, mesh_count * sizeof *described, storage);
  described = mapped[MESHES];
  for (i = 0; i < mesh_count; ++i) described[i] = describe_mesh(&meshes[i]);
  make_buffer(ITEMS, item_count * sizeof(gpu_item), storage);
  make_buffer(DRAW, sizeof draw, storage | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT);
  memcpy(mapped[DRAW], &draw, sizeof draw);
  make_buffer(READBACK, 4 * WIDTH * HEIGHT, VK_BUFFER_USAGE_TRANSFER_DST_BIT);
  return item_count;
}
static void place_instances(const double eye[3], const double axes[3][3]) {
  gpu_instance* placed = mapped[INSTANCES];
  uint32_t i;
  for (i = 0; i < instance_count; ++i)
    if (is_drawn(i)) placed[i].place = place_instance(&instances[i], &meshes[instances[i].mesh], eye, axes, -1.0, 0.0);
}

#endif
