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
#include <vulkan/vulkan.h>

#include <meshlode/meshlode.h>

#include "place.h"
#include "write_png.h"

#ifndef SHADERS /* where select.comp.spv, draw.vert.spv and draw.frag.spv lie */
#define SHADERS "."
#endif

enum { GROUP_SIZE = 64 };
enum { PAGES, INSTANCES, GROUPS, CLUSTERS, MESHES, ITEMS, DRAW, BUFFERS, READBACK = BUFFERS };

/* The structs of vulkan/tables.glsl. */
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

static VkPhysicalDevice gpu;
static VkPhysicalDeviceProperties properties;
static VkDevice device;
static VkQueue queue;
static uint32_t family;
static VkCommandBuffer commands;
static VkBuffer buffers[BUFFERS + 1];
static void* mapped[BUFFERS + 1];
static VkDescriptorSet set;
static VkPipelineLayout layout;
static VkPipeline select_pipeline, draw_pipeline;
static VkImage color, depth;
static VkImageView color_view, depth_view;

static void check(VkResult result, const char* what) {
  if (result != VK_SUCCESS) stop("Vulkan", what);
}

/* 1. A device with a queue that draws and computes. */
static void open_device(void) {
  VkApplicationInfo application = {VK_STRUCTURE_TYPE_APPLICATION_INFO};
  VkInstanceCreateInfo instance_info = {VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
  VkPhysicalDeviceVulkan13Features features = {VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
  VkDeviceQueueCreateInfo queue_info = {VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
  VkDeviceCreateInfo device_info = {VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
  VkCommandPoolCreateInfo pool_info = {VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
  VkCommandBufferAllocateInfo command_info = {VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
  const float priority = 1.0f;
  VkInstance instance;
  VkPhysicalDevice devices[16];
  VkQueueFamilyProperties families[32];
  VkCommandPool pool;
  uint32_t count = 16, family_count = 32, i;
  application.apiVersion = VK_API_VERSION_1_3;
  instance_info.pApplicationInfo = &application;
  check(vkCreateInstance(&instance_info, NULL, &instance), "no instance");
  if (vkEnumeratePhysicalDevices(instance, &count, devices) < 0 || count == 0) stop("Vulkan", "no device");
  for (i = 0; i < count && !gpu; ++i) {
    vkGetPhysicalDeviceProperties(devices[i], &properties);
    if (properties.apiVersion >= VK_API_VERSION_1_3) gpu = devices[i];
  }
  if (!gpu) stop("Vulkan", "no device of version 1.3");
  vkGetPhysicalDeviceQueueFamilyProperties(gpu, &family_count, families);
  for (family = 0; family < family_count; ++family)
    if ((families[family].queueFlags & VK_QUEUE_GRAPHICS_BIT) && (families[family].queueFlags & VK_QUEUE_COMPUTE_BIT))
      break;
  if (family == family_count) stop("Vulkan", "no queue that draws and computes");
  features.dynamicRendering = features.synchronization2 = features.maintenance4 = VK_TRUE; /* as every 1.3 device has */
  queue_info.queueFamilyIndex = family;
  queue_info.queueCount = 1;
  queue_info.pQueuePriorities = &priority;
  device_info.pNext = &features;
  device_info.queueCreateInfoCount = 1;
  device_info.pQueueCreateInfos = &queue_info;
  check(vkCreateDevice(gpu, &device_info, NULL, &device), "no device");
  vkGetDeviceQueue(device, family, 0, &queue);
  pool_info.queueFamilyIndex = family;
  check(vkCreateCommandPool(device, &pool_info, NULL, &pool), "no command pool");
  command_info.commandPool = pool;
  command_info.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  command_info.commandBufferCount = 1;
  check(vkAllocateCommandBuffers(device, &command_info, &commands), "no command buffer");
}

/* 2. Memory. All buffers are visible to the host: an engine copies to the device's own. */
static VkDeviceMemory take_memory(VkMemoryRequirements needs, VkMemoryPropertyFlags flags) {
  VkPhysicalDeviceMemoryProperties kinds;
  VkMemoryAllocateInfo info = {VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
  VkDeviceMemory memory;
  uint32_t i;
  vkGetPhysicalDeviceMemoryProperties(gpu, &kinds);
  for (i = 0; i < kinds.memoryTypeCount; ++i)
    if ((needs.memoryTypeBits >> i & 1u) && (kinds.memoryTypes[i].propertyFlags & flags) == flags) break;
  if (i == kinds.memoryTypeCount) stop("Vulkan", "no such memory");
  info.allocationSize = needs.size;
  info.memoryTypeIndex = i;
  check(vkAllocateMemory(device, &info, NULL, &memory), "no memory");
  return memory;
}
static void make_buffer(int which, size_t bytes, VkBufferUsageFlags usage) {
  VkBufferCreateInfo info = {VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
  VkMemoryRequirements needs;
  VkDeviceMemory memory;
  if (bytes > properties.limits.maxStorageBufferRange) stop("asset", "more than a storage buffer holds");
  info.size = bytes ? bytes : 16;
  info.usage = usage;
  check(vkCreateBuffer(device, &info, NULL, &buffers[which]), "no buffer");
  vkGetBufferMemoryRequirements(device, buffers[which], &needs);
  memory = take_memory(needs, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
  check(vkBindBufferMemory(device, buffers[which], memory, 0), "no buffer");
  check(vkMapMemory(device, memory, 0, VK_WHOLE_SIZE, 0, &mapped[which]), "a buffer is not mapped");
}
static VkImageView make_image(VkFormat format, VkImageUsageFlags usage, VkImageAspectFlags aspect, VkImage* image) {
  VkImageCreateInfo info = {VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
  VkImageViewCreateInfo view_info = {VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
  VkMemoryRequirements needs;
  VkImageView view;
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = format;
  info.extent.width = WIDTH;
  info.extent.height = HEIGHT;
  info.extent.depth = info.mipLevels = info.arrayLayers = 1;
  info.samples = VK_SAMPLE_COUNT_1_BIT;
  info.usage = usage;
  check(vkCreateImage(device, &info, NULL, image), "no image");
  vkGetImageMemoryRequirements(device, *image, &needs);
  check(vkBindImageMemory(device, *image, take_memory(needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT), 0), "no image");
  view_info.image = *image;
  view_info.viewType = VK_IMAGE_VIEW_TYPE_2D;
  view_info.format = format;
  view_info.subresourceRange.aspectMask = aspect;
  view_info.subresourceRange.levelCount = view_info.subresourceRange.layerCount = 1;
  check(vkCreateImageView(device, &view_info, NULL, &view), "no image view");
  return view;
}

/* 3. The selection rule's view of an instance: docs/reference/selection.md says why each number is rounded as it is. */
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

/* 4. Tables and pages, once, with the transforms of place.h. */
static void fill_buffers(const meshlode_view* camera, const double axes[3][3], double pixel_error) {
  const VkBufferUsageFlags storage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
  uint32_t node_count, i, p, *words, *first_word = take(page_count, sizeof *first_word);
  const meshlode_node* nodes = meshlode_nodes(asset, &node_count);
  size_t bytes = 0, item_count = 0;
  gpu_instance* placed;
  gpu_group* bounds;
  gpu_cluster* found;
  gpu_mesh* described;
  const VkDrawIndirectCommand draw = {3 * MESHLODE_MAX_CLUSTER_TRIANGLES, 0, 0,
                                      0}; /* the shader counts its instances */
  for (p = 0; p < page_count; ++p) {
    first_word[p] = (uint32_t)(bytes / 4);
    bytes += pages[p].bytes;
  }
  make_buffer(PAGES, bytes, storage);
  words = mapped[PAGES];
  for (p = 0; p < page_count; ++p)
    if (meshlode_load_page(asset, p, words + first_word[p], pages[p].bytes, &error)) stop("page", error.text);
  make_buffer(INSTANCES, instance_count * sizeof *placed, storage);
  placed = mapped[INSTANCES];
  for (i = 0; i < instance_count; ++i) {
    const meshlode_mesh* mesh = &meshes[instances[i].mesh];
    memset(&placed[i], 0, sizeof placed[i]);
    if ((instances[i].flags & MESHLODE_INSTANCE_SINGULAR) || mesh->cluster_count == 0) continue; /* not drawn */
    placed[i].place = place_instance(&instances[i], mesh, camera->eye, axes, -1.0, 0.0);
    placed[i].mesh = instances[i].mesh;
    placed[i].view = metric_view(&instances[i], mesh, &nodes[mesh->first_node], camera, pixel_error);
    placed[i].first_cluster = mesh->first_cluster;
    placed[i].cluster_count = mesh->cluster_count;
    item_count += mesh->cluster_count;
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
  make_buffer(MESHES, mesh_count * sizeof *described, storage);
  described = mapped[MESHES];
  for (i = 0; i < mesh_count; ++i) described[i] = describe_mesh(&meshes[i]);
  make_buffer(ITEMS, item_count * sizeof(gpu_item), storage); /* no cut is larger */
  make_buffer(DRAW, sizeof draw, storage | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT);
  memcpy(mapped[DRAW], &draw, sizeof draw);
  make_buffer(READBACK, 4 * WIDTH * HEIGHT, VK_BUFFER_USAGE_TRANSFER_DST_BIT);
  free(first_word);
}

/* 5. One descriptor set of seven buffers for both pipelines. */
static void make_set(void) {
  VkDescriptorSetLayoutBinding bindings[BUFFERS];
  VkDescriptorSetLayoutCreateInfo set_info = {VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
  VkPipelineLayoutCreateInfo layout_info = {VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  const VkDescriptorPoolSize size = {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, BUFFERS};
  VkDescriptorPoolCreateInfo pool_info = {VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  VkDescriptorSetAllocateInfo allocate = {VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  VkDescriptorSetLayout set_layout;
  VkDescriptorPool pool;
  uint32_t i;
  memset(bindings, 0, sizeof bindings);
  for (i = 0; i < BUFFERS; ++i) {
    bindings[i].binding = i;
    bindings[i].descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    bindings[i].descriptorCount = 1;
    bindings[i].stageFlags = VK_SHADER_STAGE_COMPUTE_BIT | VK_SHADER_STAGE_VERTEX_BIT;
  }
  set_info.bindingCount = BUFFERS;
  set_info.pBindings = bindings;
  check(vkCreateDescriptorSetLayout(device, &set_info, NULL, &set_layout), "no set layout");
  layout_info.setLayoutCount = 1;
  layout_info.pSetLayouts = &set_layout;
  check(vkCreatePipelineLayout(device, &layout_info, NULL, &layout), "no pipeline layout");
  pool_info.maxSets = pool_info.poolSizeCount = 1;
  pool_info.pPoolSizes = &size;
  check(vkCreateDescriptorPool(device, &pool_info, NULL, &pool), "no descriptor pool");
  allocate.descriptorPool = pool;
  allocate.descriptorSetCount = 1;
  allocate.pSetLayouts = &set_layout;
  check(vkAllocateDescriptorSets(device, &allocate, &set), "no descriptor set");
  for (i = 0; i < BUFFERS; ++i) {
    VkDescriptorBufferInfo buffer = {0};
    VkWriteDescriptorSet write = {VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
    buffer.buffer = buffers[i];
    buffer.range = VK_WHOLE_SIZE;
    write.dstSet = set;
    write.dstBinding = i;
    write.descriptorCount = 1;
    write.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    write.pBufferInfo = &buffer;
    vkUpdateDescriptorSets(device, 1, &write, 0, NULL);
  }
}
static VkPipelineShaderStageCreateInfo load_stage(const char* path, VkShaderStageFlagBits stage) {
  VkPipelineShaderStageCreateInfo out = {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
  VkShaderModuleCreateInfo info = {VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
  uint32_t* code = take(1 << 18, 4);
  FILE* in = fopen(path, "rb");
  if (!in || (info.codeSize = fread(code, 1, 1 << 20, in)) == 0) stop(path, "cannot be read");
  fclose(in);
  info.pCode = code;
  check(vkCreateShaderModule(device, &info, NULL, &out.module), path);
  free(code);
  out.stage = stage;
  out.pName = "main";
  return out;
}
static void make_pipelines(void) {
  const VkFormat format = VK_FORMAT_R8G8B8A8_UNORM;
  const VkViewport viewport = {0.0f, 0.0f, WIDTH, HEIGHT, 0.0f, 1.0f};
  const VkRect2D scissor = {{0, 0}, {WIDTH, HEIGHT}};
  VkComputePipelineCreateInfo compute = {VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
  VkPipelineShaderStageCreateInfo stages[2];
  VkPipelineVertexInputStateCreateInfo no_vertices = {VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
  VkPipelineInputAssemblyStateCreateInfo assembly = {VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
  VkPipelineViewportStateCreateInfo view = {VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
  VkPipelineRasterizationStateCreateInfo raster = {VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
  VkPipelineMultisampleStateCreateInfo samples = {VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
  VkPipelineDepthStencilStateCreateInfo nearest = {VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
  VkPipelineColorBlendAttachmentState all = {0};
  VkPipelineColorBlendStateCreateInfo blend = {VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
  VkPipelineRenderingCreateInfo rendering = {VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO};
  VkGraphicsPipelineCreateInfo info = {VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO};
  compute.stage = load_stage(SHADERS "/select.comp.spv", VK_SHADER_STAGE_COMPUTE_BIT);
  compute.layout = layout;
  check(vkCreateComputePipelines(device, VK_NULL_HANDLE, 1, &compute, NULL, &select_pipeline), "no compute pipeline");
  stages[0] = load_stage(SHADERS "/draw.vert.spv", VK_SHADER_STAGE_VERTEX_BIT);
  stages[1] = load_stage(SHADERS "/draw.frag.spv", VK_SHADER_STAGE_FRAGMENT_BIT);
  assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  view.viewportCount = view.scissorCount = 1;
  view.pViewports = &viewport;
  view.pScissors = &scissor;
  raster.lineWidth = 1.0f;
  samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
  nearest.depthTestEnable = nearest.depthWriteEnable = VK_TRUE;
  nearest.depthCompareOp = VK_COMPARE_OP_LESS;
  all.colorWriteMask = 15;
  blend.attachmentCount = 1;
  blend.pAttachments = &all;
  rendering.colorAttachmentCount = 1;
  rendering.pColorAttachmentFormats = &format;
  rendering.depthAttachmentFormat = VK_FORMAT_D32_SFLOAT;
  info.pNext = &rendering;
  info.stageCount = 2;
  info.pStages = stages;
  info.pVertexInputState = &no_vertices;
  info.pInputAssemblyState = &assembly;
  info.pViewportState = &view;
  info.pRasterizationState = &raster;
  info.pMultisampleState = &samples;
  info.pDepthStencilState = &nearest;
  info.pColorBlendState = &blend;
  info.layout = layout;
  check(vkCreateGraphicsPipelines(device, VK_NULL_HANDLE, 1, &info, NULL, &draw_pipeline), "no pipeline");
}

/* 6. A frame: select, draw, copy. */
static void wait_for(VkPipelineStageFlags2 from, VkAccessFlags2 written, VkPipelineStageFlags2 to,
                     VkAccessFlags2 read) {
  VkMemoryBarrier2 barrier = {VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
  VkDependencyInfo info = {VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  barrier.srcStageMask = from;
  barrier.srcAccessMask = written;
  barrier.dstStageMask = to;
  barrier.dstAccessMask = read;
  info.memoryBarrierCount = 1;
  info.pMemoryBarriers = &barrier;
  vkCmdPipelineBarrier2(commands, &info);
}
static void change_layout(VkImage image, VkImageAspectFlags aspect, VkImageLayout before, VkImageLayout after) {
  VkImageMemoryBarrier2 barrier = {VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
  VkDependencyInfo info = {VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  barrier.srcStageMask = barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  barrier.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
  barrier.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
  barrier.oldLayout = before;
  barrier.newLayout = after;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image;
  barrier.subresourceRange.aspectMask = aspect;
  barrier.subresourceRange.levelCount = barrier.subresourceRange.layerCount = 1;
  info.imageMemoryBarrierCount = 1;
  info.pImageMemoryBarriers = &barrier;
  vkCmdPipelineBarrier2(commands, &info);
}
static void draw_frame(void) {
  VkCommandBufferBeginInfo begin = {VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  VkRenderingAttachmentInfo color_info = {VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
  VkRenderingAttachmentInfo depth_info = {VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
  VkRenderingInfo rendering = {VK_STRUCTURE_TYPE_RENDERING_INFO};
  VkBufferImageCopy copy = {0};
  VkSubmitInfo submit = {VK_STRUCTURE_TYPE_SUBMIT_INFO};
  uint32_t most = 0, i;
  int k;
  for (i = 0; i < mesh_count; ++i) most = meshes[i].cluster_count > most ? meshes[i].cluster_count : most;
  if (instance_count > properties.limits.maxComputeWorkGroupCount[1])
    stop("asset", "too many instances for one dispatch");
  check(vkBeginCommandBuffer(commands, &begin), "no commands");
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout, 0, 1, &set, 0, NULL);
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, select_pipeline);
  vkCmdDispatch(commands, (most + GROUP_SIZE - 1) / GROUP_SIZE, instance_count, 1);
  wait_for(VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_WRITE_BIT,
           VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT | VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_2_HOST_BIT,
           VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT | VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_HOST_READ_BIT);
  change_layout(color, VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL);
  change_layout(depth, VK_IMAGE_ASPECT_DEPTH_BIT, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL);
  color_info.imageView = color_view;
  depth_info.imageView = depth_view;
  color_info.imageLayout = depth_info.imageLayout = VK_IMAGE_LAYOUT_GENERAL;
  color_info.loadOp = depth_info.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
  color_info.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  for (k = 0; k < 4; ++k) color_info.clearValue.color.float32[k] = k < 3 ? 32 / 255.0f : 1.0f;
  depth_info.clearValue.depthStencil.depth = 1.0f;
  rendering.renderArea.extent.width = WIDTH;
  rendering.renderArea.extent.height = HEIGHT;
  rendering.layerCount = rendering.colorAttachmentCount = 1;
  rendering.pColorAttachments = &color_info;
  rendering.pDepthAttachment = &depth_info;
  vkCmdBeginRendering(commands, &rendering);
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout, 0, 1, &set, 0, NULL);
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, draw_pipeline);
  vkCmdDrawIndirect(commands, buffers[DRAW], 0, 1, 0);
  vkCmdEndRendering(commands);
  change_layout(color, VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
  copy.imageSubresource.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT;
  copy.imageSubresource.layerCount = 1;
  copy.imageExtent.width = WIDTH;
  copy.imageExtent.height = HEIGHT;
  copy.imageExtent.depth = 1;
  vkCmdCopyImageToBuffer(commands, color, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, buffers[READBACK], 1, &copy);
  wait_for(VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_2_HOST_BIT,
           VK_ACCESS_2_HOST_READ_BIT);
  check(vkEndCommandBuffer(commands), "no commands");
  submit.commandBufferCount = 1;
  submit.pCommandBuffers = &commands;
  check(vkQueueSubmit(queue, 1, &submit, VK_NULL_HANDLE), "the device does not take the frame");
  check(vkQueueWaitIdle(queue), "the device is lost");
}
static double save_picture(const char* path) {
  static unsigned char picture[HEIGHT * WIDTH][3];
  const unsigned char* rgba = mapped[READBACK];
  size_t i, count = 0;
  for (i = 0; i < WIDTH * HEIGHT; ++i) {
    memcpy(picture[i], rgba + 4 * i, 3);
    count += picture[i][0] != 32 || picture[i][1] != 32 || picture[i][2] != 32;
  }
  if (write_png(path, &picture[0][0], WIDTH, HEIGHT)) stop(path, "cannot be written, or is no PNG");
  return 100.0 * (double)count / (WIDTH * HEIGHT);
}

/* 7. Is it the CPU's cut? */
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
  meshlode_view view = {{0.0, 0.0, 0.0}, 0, FOVY, 0.0, NEAR, HEIGHT};
  double target[3], axes[3][3], pixel_error, covered;
  size_t i, count, triangles = 0;
  if (argc != 10) stop("usage", "vulkan ASSET PICTURE.png PIXEL_ERROR EYE_X EYE_Y EYE_Z TARGET_X TARGET_Y TARGET_Z");
  if (!((pixel_error = atof(argv[3])) > 0.0)) stop(argv[3], "above 0 is wanted");
  if (meshlode_open_file(argv[1], &asset, &error)) stop(argv[1], error.text);
  meshes = meshlode_meshes(asset, &mesh_count);
  instances = meshlode_instances(asset, &instance_count);
  groups = meshlode_groups(asset, &group_count);
  clusters = meshlode_clusters(asset, &cluster_count);
  pages = meshlode_pages(asset, &page_count);
  if (cluster_count == 0 || instance_count == 0) stop(argv[1], "nothing to draw");
  look(argv + 4, view.eye, target, axes);

  open_device();
  fill_buffers(&view, (const double(*)[3])axes, pixel_error);
  make_set();
  make_pipelines();
  color_view =
      make_image(VK_FORMAT_R8G8B8A8_UNORM, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
                 VK_IMAGE_ASPECT_COLOR_BIT, &color);
  depth_view =
      make_image(VK_FORMAT_D32_SFLOAT, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, VK_IMAGE_ASPECT_DEPTH_BIT, &depth);
  draw_frame();
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
