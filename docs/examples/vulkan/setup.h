/* SPDX-License-Identifier: MIT */
/* What the two programs on Vulkan 1.3 do alike: device, buffers, images, the pipeline that decodes, the end of a frame.
 */
#ifndef EXAMPLES_VULKAN_SETUP_H
#define EXAMPLES_VULKAN_SETUP_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <vulkan/vulkan.h>

#include "../place.h"
#include "../write_png.h"

#ifndef SHADERS /* where the SPIR-V of this folder lies */
#define SHADERS "."
#endif

enum { PAGES, INSTANCES, GROUPS, CLUSTERS, MESHES, ITEMS, DRAW, BUFFERS, READBACK = BUFFERS };

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
static VkPipeline draw_pipeline;
static VkImage color, depth;
static VkImageView color_view, depth_view;

static void check(VkResult result, const char* what) {
  if (result != VK_SUCCESS) stop("Vulkan", what);
}

/* A device with a queue that draws and computes. */
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
  pool_info.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT; /* a frame begins it anew */
  check(vkCreateCommandPool(device, &pool_info, NULL, &pool), "no command pool");
  command_info.commandPool = pool;
  command_info.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  command_info.commandBufferCount = 1;
  check(vkAllocateCommandBuffers(device, &command_info, &commands), "no command buffer");
}

/* Memory. All buffers are visible to the host: an engine copies to the device's own. */
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

static void make_images(void) {
  color_view =
      make_image(VK_FORMAT_R8G8B8A8_UNORM, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
                 VK_IMAGE_ASPECT_COLOR_BIT, &color);
  depth_view =
      make_image(VK_FORMAT_D32_SFLOAT, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, VK_IMAGE_ASPECT_DEPTH_BIT, &depth);
}

/* One descriptor set of seven buffers for both pipelines. */
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
static void make_draw_pipeline(void) {
  const VkFormat format = VK_FORMAT_R8G8B8A8_UNORM;
  const VkViewport viewport = {0.0f, 0.0f, WIDTH, HEIGHT, 0.0f, 1.0f};
  const VkRect2D scissor = {{0, 0}, {WIDTH, HEIGHT}};
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

/* A frame. */
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
static void begin_frame(void) {
  VkCommandBufferBeginInfo begin = {VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  check(vkBeginCommandBuffer(commands, &begin), "no commands");
}
/* Draws what ITEMS holds and DRAW counts, copies the picture, and waits. */
static void end_frame(void) {
  VkRenderingAttachmentInfo color_info = {VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
  VkRenderingAttachmentInfo depth_info = {VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
  VkRenderingInfo rendering = {VK_STRUCTURE_TYPE_RENDERING_INFO};
  VkBufferImageCopy copy = {0};
  VkSubmitInfo submit = {VK_STRUCTURE_TYPE_SUBMIT_INFO};
  int k;
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

#endif
