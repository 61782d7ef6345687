// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/gltf/accessor.h"

#include <algorithm>
#include <cstring>

#include "base/try.h"

namespace meshlode::scene {

namespace {

template <class T>
T load(const std::uint8_t* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));  // accessors may be misaligned; the host is little-endian as glTF is
  return value;
}

std::uint32_t load_index(const std::uint8_t* bytes, std::uint32_t type) {
  switch (type) {
    case kGltfUnsignedByte: return *bytes;
    case kGltfUnsignedShort: return load<std::uint16_t>(bytes);
    default: return load<std::uint32_t>(bytes);
  }
}

}  // namespace

std::uint32_t component_count_of(const tinygltf::Accessor& accessor) {
  return static_cast<std::uint32_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type)));
}

std::uint64_t sparse_count_of(const tinygltf::Accessor& accessor) {
  return accessor.sparse.isSparse ? static_cast<std::uint64_t>(accessor.sparse.count) : 0;
}

double read_component(const std::uint8_t* bytes, std::uint32_t component_type, bool normalized) {
  switch (component_type) {
    case kGltfByte: {
      const double c = load<std::int8_t>(bytes);
      return normalized ? std::max(c / 127.0, -1.0) : c;
    }
    case kGltfUnsignedByte: {
      const double c = *bytes;
      return normalized ? c / 255.0 : c;
    }
    case kGltfShort: {
      const double c = load<std::int16_t>(bytes);
      return normalized ? std::max(c / 32767.0, -1.0) : c;
    }
    case kGltfUnsignedShort: {
      const double c = load<std::uint16_t>(bytes);
      return normalized ? c / 65535.0 : c;
    }
    case kGltfUnsignedInt: return load<std::uint32_t>(bytes);
    case kGltfFloat: return static_cast<double>(load<float>(bytes));
    default: return 0.0;
  }
}

Result<AccessorReader> AccessorReader::open(const GltfAsset& asset, std::size_t index) {
  const tinygltf::Accessor& accessor = asset.model.accessors[index];
  const std::string path = "/accessors/" + std::to_string(index);
  AccessorReader reader = over({}, accessor.count, static_cast<std::uint32_t>(accessor.componentType),
                               component_count_of(accessor), accessor.normalized);
  if (accessor.bufferView >= 0 && accessor.count > 0) {
    TRY_LET(bytes, asset.view_bytes(accessor.bufferView, path + "/bufferView"));
    reader.base_ = bytes->data() + accessor.byteOffset;
    const std::size_t stride = asset.model.bufferViews[accessor.bufferView].byteStride;
    if (stride != 0) reader.stride_ = stride;
  }
  const auto& sparse = accessor.sparse;
  if (!sparse.isSparse || sparse.count == 0) return reader;
  TRY_LET(indices, asset.view_bytes(sparse.indices.bufferView, path + "/sparse"));
  TRY_LET(values, asset.view_bytes(sparse.values.bufferView, path + "/sparse"));
  reader.sparse_indices_ = indices->data() + sparse.indices.byteOffset;
  reader.sparse_values_ = values->data() + sparse.values.byteOffset;
  reader.sparse_count_ = sparse.count;
  reader.sparse_index_type_ = static_cast<std::uint32_t>(sparse.indices.componentType);
  const std::uint32_t step = component_size(reader.sparse_index_type_);
  std::uint64_t next = 0;
  for (std::uint64_t i = 0; i < reader.sparse_count_; ++i) {
    const std::uint32_t at = load_index(reader.sparse_indices_ + i * step, reader.sparse_index_type_);
    if (at < next || at >= accessor.count) {
      return asset.invalid(path + "/sparse/indices", "index " + std::to_string(at) + " at " + std::to_string(i) +
                                                         " is out of range or does not increase");
    }
    next = std::uint64_t{at} + 1;
  }
  return reader;
}

AccessorReader AccessorReader::over(std::span<const std::uint8_t> bytes, std::uint64_t count,
                                    std::uint32_t component_type, std::uint32_t component_count, bool normalized) {
  AccessorReader reader;
  reader.count_ = count;
  reader.component_type_ = component_type;
  reader.normalized_ = normalized;
  reader.component_size_ = component_size(component_type);
  reader.component_count_ = component_count;
  reader.base_ = bytes.data();
  reader.stride_ = std::uint64_t{reader.component_size_} * component_count;
  return reader;
}

const std::uint8_t* AccessorReader::bytes_of(std::uint64_t i) const {
  if (sparse_count_ > 0) {
    const std::uint32_t step = component_size(sparse_index_type_);
    std::uint64_t low = 0;
    std::uint64_t high = sparse_count_;
    while (low < high) {
      const std::uint64_t middle = (low + high) / 2;
      if (load_index(sparse_indices_ + middle * step, sparse_index_type_) < i) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    if (low < sparse_count_ && load_index(sparse_indices_ + low * step, sparse_index_type_) == i) {
      return sparse_values_ + low * component_size_ * component_count_;
    }
  }
  return base_ == nullptr ? nullptr : base_ + i * stride_;
}

std::array<double, 4> AccessorReader::element(std::uint64_t i, bool normalized) const {
  std::array<double, 4> out{};
  const std::uint8_t* bytes = bytes_of(i);
  if (bytes == nullptr) return out;
  const std::uint32_t count = std::min<std::uint32_t>(component_count_, 4);
  for (std::uint32_t c = 0; c < count; ++c) {
    out[c] = read_component(bytes + c * component_size_, component_type_, normalized);
  }
  return out;
}

std::uint32_t AccessorReader::index(std::uint64_t i) const {
  const std::uint8_t* bytes = bytes_of(i);
  return bytes == nullptr ? 0 : load_index(bytes, component_type_);
}

}  // namespace meshlode::scene
