// SPDX-License-Identifier: GPL-3.0-or-later
// Buffers: each has memory of its own, since there are few and they are large.
#include <algorithm>
#include <cstring>

#include "base/try.h"
#include "draw/gpu/vulkan/types.h"

namespace meshlode::draw {

std::uint64_t Buffer::address() const {
  return impl_->address;
}
std::uint64_t Buffer::bytes() const {
  return impl_->bytes;
}
std::uint8_t* Buffer::mapped() const {
  return impl_->mapped;
}

Result<Buffer> Device::make_buffer(std::uint64_t bytes, Memory kind) {
  DeviceImpl& d = *impl_;
  Buffer out;
  out.impl_ = std::make_shared<BufferImpl>();
  BufferImpl& b = *out.impl_;
  if (d.staging) b.owner = impl_;
  b.device = d.device;
  b.destroy = d.f.vkDestroyBuffer;
  b.release = d.f.vkFreeMemory;
  b.bytes = (std::max<std::uint64_t>(bytes, 16) + 15) / 16 * 16;
  VkBufferCreateInfo create = tagged<VkBufferCreateInfo>(VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO);
  create.size = b.bytes;
  create.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT |
                 VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT |
                 VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT;
  const std::string size = std::to_string(b.bytes) + " bytes";
  if (d.f.vkCreateBuffer(d.device, &create, nullptr, &b.buffer) != VK_SUCCESS) {
    b.buffer = VK_NULL_HANDLE;
    return unsupported("no buffer of " + size);
  }
  VkMemoryRequirements needs{};
  d.f.vkGetBufferMemoryRequirements(d.device, b.buffer, &needs);
  const VkMemoryPropertyFlags wanted = kind == Memory::kDevice
                                           ? VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT
                                           : VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  // Reading back from uncached memory is slow: of the mapped types a cached one is preferred.
  std::uint32_t type = VK_MAX_MEMORY_TYPES;
  for (std::uint32_t i = 0; i < d.memory.memoryTypeCount; ++i) {
    const VkMemoryPropertyFlags flags = d.memory.memoryTypes[i].propertyFlags;
    if ((needs.memoryTypeBits >> i & 1u) == 0 || (flags & wanted) != wanted) continue;
    const bool is_cached = (flags & VK_MEMORY_PROPERTY_HOST_CACHED_BIT) != 0;
    if (type == VK_MAX_MEMORY_TYPES || (kind == Memory::kHost && is_cached)) type = i;
  }
  if (type == VK_MAX_MEMORY_TYPES) return unsupported("no memory type for " + size);
  VkMemoryAllocateFlagsInfo flags = tagged<VkMemoryAllocateFlagsInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO);
  flags.flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT;
  VkMemoryAllocateInfo allocate = tagged<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
  allocate.pNext = &flags;
  allocate.allocationSize = needs.size;
  allocate.memoryTypeIndex = type;
  if (d.f.vkAllocateMemory(d.device, &allocate, nullptr, &b.memory) != VK_SUCCESS) {
    b.memory = VK_NULL_HANDLE;
    return unsupported("the device has no room for " + size);
  }
  if (d.f.vkBindBufferMemory(d.device, b.buffer, b.memory, 0) != VK_SUCCESS) return unsupported("no memory bound");
  if (kind == Memory::kHost) {
    void* mapped = nullptr;
    if (d.f.vkMapMemory(d.device, b.memory, 0, VK_WHOLE_SIZE, 0, &mapped) != VK_SUCCESS) {
      return unsupported("memory could not be mapped");
    }
    b.mapped = static_cast<std::uint8_t*>(mapped);
  }
  VkBufferDeviceAddressInfo address = tagged<VkBufferDeviceAddressInfo>(VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO);
  address.buffer = b.buffer;
  b.address = d.f.vkGetBufferDeviceAddress(d.device, &address);
  return out;
}

Status Device::upload(const Buffer& buffer, std::span<const std::uint8_t> bytes, std::uint64_t offset) {
  if (offset > buffer.bytes() || bytes.size() > buffer.bytes() - offset)
    return unsupported("upload past a buffer's end");
  for (std::uint64_t done = 0; done < bytes.size();) {
    const std::uint64_t count = std::min<std::uint64_t>(kStagingBytes, bytes.size() - done);
    std::memcpy(impl_->staging.mapped(), bytes.data() + done, count);
    TRY_LET(commands, Commands::begin(*this));
    commands->copy(impl_->staging, 0, buffer, offset + done, count);
    commands->barrier();
    TRY(commands->run());
    done += count;
  }
  return Ok{};
}

Status Device::download(const Buffer& buffer, std::span<std::uint8_t> bytes, std::uint64_t offset) {
  if (offset > buffer.bytes() || bytes.size() > buffer.bytes() - offset) return unsupported("read past a buffer's end");
  for (std::uint64_t done = 0; done < bytes.size();) {
    const std::uint64_t count = std::min<std::uint64_t>(kStagingBytes, bytes.size() - done);
    TRY_LET(commands, Commands::begin(*this));
    commands->copy(buffer, offset + done, impl_->staging, 0, count);
    commands->barrier();
    TRY(commands->run());
    std::memcpy(bytes.data() + done, impl_->staging.mapped(), count);
    done += count;
  }
  return Ok{};
}

}  // namespace meshlode::draw
