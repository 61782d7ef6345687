/* SPDX-License-Identifier: MIT */
/* An asset drawn by Vulkan 1.3 without a window: all pages lie in one buffer as they are, a compute shader selects the
 * cut with <meshlode/metric.h>, and one indirect draw decodes its clusters with <meshlode/decode.glsl>. C99.
 *
 *   vulkan ASSET PICTURE.png PIXEL_ERROR EYE_X EYE_Y EYE_Z TARGET_X TARGET_Y TARGET_Z
 *
 * Bindings are in vulkan/tables.glsl. The cut must be that of meshlode_select_view, cluster for cluster. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "vulkan/tables.h"

enum { GROUP_SIZE = 64 };
static VkPipeline select_pipeline;

/* 1. The selection rule's view of an instance: docs/reference/selection.md says why each number is rounded as it is. */
static float float_above(double value) {
  const float nearest = (float)value;
  return (double)nearest < value ? nextafterf(nearest, FLT_MAX) : nearest;
}
static double clamp(double value, double low, double high) {
  return value < high ? fmax(value, low) : high;
}
static gpu_metric_view metric_view(const meshlode_instance* instance, const meshlode_mesh* mesh,
                                   const meshlode_node* root, const meshlode_view* camera, double pixel_error) {
  const double growth = 1.0 + ldexp(1.0, -20), largest = ldexp(1.0, 126), *m = instance->transform, *o = mesh->origin;
  const double pixels = camera->height_px / (2.0 * tan(0.5 * camera->fovy_radians)) / pixel_error;
  const double x = root->center[0], y = root->center[1], z = root->center[2];
  const double reach = sqrt(x * x + y * y + z * z) + root->radius;
  gpu_metric_view view = {{{0}}, 0, 0, 0, 0};
  double moved[3], length, unit = 1.0;
  int i, k, exponent, scale_exponent;
  for (i = 0; i < 3; ++i)
    moved[i] = ((m[4 * i] * o[0] + m[4 * i + 1] * o[1]) + m[4 * i + 2] * o[2]) + (m[4 * i + 3] - camera->eye[i]);
  length = fmax(instance->scale * reach, sqrt(moved[0] * moved[0] + moved[1] * moved[1] + moved[2] * moved[2]));
  if (length > 0.0 && length <= DBL_MAX) { /* a power of two that brings lengths to about 2^30 */
    frexp(length, &exponent);
    frexp(instance->scale, &scale_exponent);
    unit = ldexp(1.0,
                 instance->scale > 0.0 && 100 - scale_exponent < 30 - exponent ? 100 - scale_exponent : 30 - exponent);
  }
  for (i = 0; i < 3; ++i) {
    for (k = 0; k < 3; ++k) view.row[i][k] = (float)(m[4 * i + k] * unit);
    view.row[i][3] = (float)(moved[i] * unit);
  }
  view.scale = float_above(clamp(instance->scale * unit * growth, 0.0, largest));
  view.error_scale = float_above(clamp(instance->scale * pixels * unit * growth, 1.0 / largest, largest));
  view.near_distance = (float)clamp(camera->near_distance * unit, ldexp(1.0, -40), ldexp(1.0, 61));
  return view;
}

/* 2. Tables and pages, once, with the transforms of place.h. */
static void fill_buffers(const meshlode_view* camera, const double axes[3][3], double pixel_error) {
  const VkBufferUsageFlags storage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
  uint32_t node_count, i, p, *words, *first_word = take(page_count, sizeof *first_word);
  const meshlode_node* nodes = meshlode_nodes(asset, &node_count);
  size_t bytes = 0;
  gpu_instance* placed;
  gpu_group* bounds;
  gpu_cluster* found;
  for (p = 0; p < page_count; ++p) {
    first_word[p] = (uint32_t)(bytes / 4);
    bytes += pages[p].bytes;
  }
  make_buffer(PAGES, bytes, storage);
  words = mapped[PAGES];
  for (p = 0; p < page_count; ++p)
    if (meshlode_load_page(asset, p, words + first_word[p], pages[p].bytes, &error)) stop("page", error.text);
  (void)make_tables();
  place_instances(camera->eye, axes);
  placed = mapped[INSTANCES];
  for (i = 0; i < instance_count; ++i) {
    const meshlode_mesh* mesh = &meshes[instances[i].mesh];
    if (is_drawn(i)) placed[i].view = metric_view(&instances[i], mesh, &nodes[mesh->first_node], camera, pixel_error);
  }
  make_buffer(GROUPS, group_count * sizeof *bounds, storage);
  bounds = mapped[GROUPS];
  for (i = 0; i < group_count; ++i) {
    memcpy(bounds[i].center, groups[i].center, sizeof bounds[i].center);
    bounds[i].radius = groups[i].radius;
    bounds[i].error = groups[i].error;
  }
  make_buffer(CLUSTERS, cluster_count * sizeof *found, storage);
  found = mapped[CLUSTERS];
  for (i = 0; i < cluster_count; ++i) {
    const uint32_t page = meshlode_page_of(asset, i);
    const gpu_cluster one = {clusters[i].own_group, clusters[i].coarser_group, first_word[page],
                             i - pages[page].first_cluster};
    found[i] = one;
  }
  free(first_word);
}

/* 3. The shader of the selection, and its dispatch. */
static void make_select_pipeline(void) {
  VkComputePipelineCreateInfo compute = {VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
  compute.stage = load_stage(SHADERS "/select.comp.spv", VK_SHADER_STAGE_COMPUTE_BIT);
  compute.layout = layout;
  check(vkCreateComputePipelines(device, VK_NULL_HANDLE, 1, &compute, NULL, &select_pipeline), "no compute pipeline");
}
static void select_clusters(void) {
  uint32_t most = 0, i;
  for (i = 0; i < mesh_count; ++i) most = meshes[i].cluster_count > most ? meshes[i].cluster_count : most;
  if (instance_count > properties.limits.maxComputeWorkGroupCount[1])
    stop("asset", "too many instances for one dispatch");
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout, 0, 1, &set, 0, NULL);
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, select_pipeline);
  vkCmdDispatch(commands, (most + GROUP_SIZE - 1) / GROUP_SIZE, instance_count, 1);
  wait_for(VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_WRITE_BIT,
           VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT | VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_2_HOST_BIT,
           VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT | VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_HOST_READ_BIT);
}

/* 4. Is it the CPU's cut? */
static int compare_items(const void* a, const void* b) {
  const gpu_item *x = a, *y = b;
  if (x->instance != y->instance) return x->instance < y->instance ? -1 : 1;
  return x->cluster < y->cluster ? -1 : x->cluster > y->cluster;
}
static void check_cut(const meshlode_view* view, double pixel_error, size_t count) {
  gpu_item* items = mapped[ITEMS];
  meshlode_draw_item* expected = take(count, sizeof *expected);
  size_t i, expected_count = 0;
  if (meshlode_select_view(asset, view, pixel_error, expected, count, &expected_count, &error)) stop("cut", error.text);
  qsort(items, count, sizeof *items, compare_items);
  for (i = 0; i < count; ++i)
    if (items[i].instance != expected[i].instance || items[i].cluster != expected[i].cluster) break;
  if (i != count || expected_count != count) stop("cut", "the GPU selects other clusters than the CPU");
  free(expected);
}

int main(int argc, char** argv) {
  meshlode_view view = {{0.0, 0.0, 0.0}, 0, FOVY, 0.0, NEAR, HEIGHT, MESHLODE_PROMISE_POSITION};
  double target[3], axes[3][3], pixel_error, covered;
  size_t i, count, triangles = 0;
  if (argc != 10) stop("usage", "vulkan ASSET PICTURE.png PIXEL_ERROR EYE_X EYE_Y EYE_Z TARGET_X TARGET_Y TARGET_Z");
  if (!((pixel_error = atof(argv[3])) > 0.0)) stop(argv[3], "above 0 is wanted");
  if (meshlode_open_file(argv[1], &asset, &error)) stop(argv[1], error.text);
  read_tables(argv[1]);
  look(argv + 4, view.eye, target, axes);

  open_device();
  fill_buffers(&view, (const double(*)[3])axes, pixel_error);
  make_set();
  make_select_pipeline();
  make_draw_pipeline();
  make_images();
  begin_frame();
  select_clusters();
  end_frame();
  count = ((const VkDrawIndirectCommand*)mapped[DRAW])->instanceCount;
  check_cut(&view, pixel_error, count);
  covered = save_picture(argv[2]);
  for (i = 0; i < count; ++i) triangles += clusters[((const gpu_item*)mapped[ITEMS])[i].cluster].triangles_less_1 + 1u;
  printf("%s: %u triangles in %u clusters, %.2f%% of the picture covered\n", properties.deviceName, (unsigned)triangles,
         (unsigned)count, covered);
  /* The process ends here: a program that goes on destroys what it made, one by one. */
  meshlode_close(asset);
  return 0;
}
