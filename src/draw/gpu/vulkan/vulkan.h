// SPDX-License-Identifier: GPL-3.0-or-later
// The little of Vulkan 1.3 that the verifier needs: a headless device, buffers that shaders reach by their address (so
// there is no descriptor anywhere), compute and draw pipelines, and command lists with timestamps. The loader is opened
// at run time: a machine without Vulkan runs every other command, and gets a clear line from this one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <meshlode/result.h>

namespace meshlode::draw {

struct DeviceInfo {
  std::string name;
  std::string driver;
  std::string missing;  ///< why this device cannot run the verifier; empty where it can
  bool is_software = false;
  bool has_mesh_shaders = false;
  std::uint32_t subgroup_size = 0;
  double timestamp_ns = 1.0;  ///< of one tick
};

/// Every device that the loader shows, in its order. Errors: kUnsupported without a loader or driver.
[[nodiscard]] Result<std::vector<DeviceInfo>> list_devices();

struct DeviceOptions {
  std::string device;     ///< index in list_devices(), or a part of the name; empty: the first that can run
  bool validate = false;  ///< validation layer with synchronization validation, where installed
};

enum class Memory : std::uint8_t {
  kDevice,  ///< fast for the device, not mapped
  kHost,    ///< mapped and coherent
};

class Buffer {
 public:
  [[nodiscard]] std::uint64_t address() const;  ///< what shaders are given
  [[nodiscard]] std::uint64_t bytes() const;
  [[nodiscard]] std::uint8_t* mapped() const;  ///< null for kDevice
  explicit operator bool() const { return impl_ != nullptr; }

 private:
  friend class Device;
  friend class Commands;
  std::shared_ptr<struct BufferImpl> impl_;
};

class Pipeline {
 public:
  explicit operator bool() const { return impl_ != nullptr; }

 private:
  friend class Device;
  friend class Commands;
  std::shared_ptr<struct PipelineImpl> impl_;
};

class Device {
 public:
  /// Errors: kUnsupported, saying what is missing; kUsage for a name that no device has.
  [[nodiscard]] static Result<Device> open(const DeviceOptions& options);
  [[nodiscard]] const DeviceInfo& info() const;
  [[nodiscard]] bool is_validating() const;
  /// What the validation layer said so far; empty is right.
  [[nodiscard]] std::vector<std::string> messages() const;

  /// At least 16 bytes are made. Errors: kUnsupported where the device has no room.
  [[nodiscard]] Result<Buffer> make_buffer(std::uint64_t bytes, Memory memory);
  [[nodiscard]] Status upload(const Buffer& buffer, std::span<const std::uint8_t> bytes, std::uint64_t offset = 0);
  [[nodiscard]] Status download(const Buffer& buffer, std::span<std::uint8_t> bytes, std::uint64_t offset = 0);

  /// `constants` are the specialization constants 0, 1, …
  [[nodiscard]] Result<Pipeline> make_compute(std::span<const std::uint32_t> spirv,
                                              std::span<const std::uint32_t> constants);
  /// No attachments: the fragment shader writes through addresses. `first` is a vertex or a mesh shader.
  [[nodiscard]] Result<Pipeline> make_draw(std::span<const std::uint32_t> first,
                                           std::span<const std::uint32_t> fragment,
                                           std::span<const std::uint32_t> constants, bool is_mesh_shader);

 private:
  friend class Commands;
  std::shared_ptr<struct DeviceImpl> impl_;
};

/// A command list that can be submitted any number of times.
class Commands {
 public:
  [[nodiscard]] static Result<Commands> begin(const Device& device);

  void dispatch(const Pipeline& pipeline, std::span<const std::uint8_t> push, std::uint32_t groups);
  void dispatch_indirect(const Pipeline& pipeline, std::span<const std::uint8_t> push, const Buffer& arguments,
                         std::uint64_t offset);
  /// A draw with VkDrawIndirectCommand, or with mesh task counts for a mesh pipeline, over width × height pixels.
  void draw_indirect(const Pipeline& pipeline, std::span<const std::uint8_t> push, const Buffer& arguments,
                     std::uint64_t offset, std::uint32_t width, std::uint32_t height);
  void fill(const Buffer& buffer, std::uint64_t offset, std::uint64_t bytes, std::uint32_t value);
  void copy(const Buffer& from, std::uint64_t from_offset, const Buffer& to, std::uint64_t to_offset,
            std::uint64_t bytes);
  /// Everything before is finished and visible to everything after.
  void barrier();
  /// A timestamp; the time since the one before is reported under this name.
  void stamp(std::string_view name);

  struct Time {
    std::string name;
    double milliseconds = 0.0;
  };
  /// Ends the list at its first call, runs it and waits. Errors: kUnsupported for a lost device.
  [[nodiscard]] Result<std::vector<Time>> run();

 private:
  std::shared_ptr<struct CommandsImpl> impl_;
};

template <class T>
[[nodiscard]] std::span<const std::uint8_t> bytes_of(const T& value) {
  return {reinterpret_cast<const std::uint8_t*>(&value), sizeof(T)};
}

}  // namespace meshlode::draw
