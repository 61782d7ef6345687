// SPDX-License-Identifier: GPL-3.0-or-later
// Bounds of buffers, buffer views, accessors and sparse parts (glTF 2.0, sections 3.6.1 and 3.6.2). Every length is
// compared by subtraction, so that no sum can overflow: all numbers are below 2^48 and strides at most 2^12.
#include "scene/import/gltf/check_base.h"
#include "scene/import/gltf/gltf.h"

namespace meshlode::scene {

namespace {

constexpr std::uint64_t kByteLimit = std::uint64_t{1} << 48U;
constexpr std::uint64_t kMaxStride = 4096;
constexpr std::uint64_t kIntMax = 0x7FFFFFFFu;  // tinygltf keeps sparse counts and offsets in an int

struct TypeShape {
  std::string_view name;
  std::uint32_t columns, rows;
};
constexpr TypeShape kShapes[] = {{"SCALAR", 1, 1}, {"VEC2", 1, 2}, {"VEC3", 1, 3}, {"VEC4", 1, 4},
                                 {"MAT2", 2, 2},   {"MAT3", 3, 3}, {"MAT4", 4, 4}};

/// Bytes of an element.
struct ElementSize {
  std::uint64_t step = 0;  ///< to the next one, where nothing else is said
  std::uint64_t used = 0;  ///< those that hold numbers: without the padding behind the last column
};

/// Columns of matrices start at multiples of 4 bytes (glTF 2.0, section 3.6.2.4).
ElementSize element_size(const TypeShape& shape, std::uint32_t component_bytes) {
  const std::uint64_t column = std::uint64_t{shape.rows} * component_bytes;
  if (shape.columns == 1) return {column, column};
  const std::uint64_t padded = (column + 3) / 4 * 4;
  return {shape.columns * padded, (shape.columns - 1) * padded + column};
}

class AccessorChecker : public JsonChecker {
 public:
  AccessorChecker(const Json& root, const std::string& file) : JsonChecker(file), root_(root) {}

  void run() {
    if (!objects(root_, "", "buffers") || !objects(root_, "", "bufferViews") || !objects(root_, "", "accessors"))
      return;
    const auto& buffers = root_.items("buffers");
    for (std::size_t i = 0; i < buffers.size() && ok(); ++i) {
      const std::string path = "/buffers/" + std::to_string(i);
      required_index(buffers[i], path, "byteLength", kByteLimit);
      optional_string(buffers[i], path, "uri");
    }
    const auto& views = root_.items("bufferViews");
    for (std::size_t i = 0; i < views.size() && ok(); ++i) check_view(views[i], "/bufferViews/" + std::to_string(i));
    const auto& accessors = root_.items("accessors");
    for (std::size_t i = 0; i < accessors.size() && ok(); ++i) {
      check_accessor(accessors[i], "/accessors/" + std::to_string(i));
    }
  }

 private:
  bool check_view(const Json& view, const std::string& path) {
    if (!required_index(view, path, "buffer", root_.items("buffers").size()) ||
        !optional_index(view, path, "byteOffset", kByteLimit) ||
        !required_index(view, path, "byteLength", kByteLimit) ||
        !optional_index(view, path, "byteStride", kMaxStride + 1)) {  // 252 and multiples of 4 only, by the letter
      return false;
    }
    const std::uint64_t size = index_or(root_.items("buffers")[index_or(view, "buffer", 0)], "byteLength", 0);
    const std::uint64_t offset = index_or(view, "byteOffset", 0);
    const std::uint64_t length = index_or(view, "byteLength", 0);
    if (offset > size || length > size - offset) {
      return fail(path, "bytes " + std::to_string(offset) + " to " + std::to_string(offset + length) +
                            " lie outside its buffer of " + std::to_string(size) + " bytes");
    }
    return true;
  }

  /// What is in order, but more than is kept.
  bool fits_int(const std::string& path, std::uint64_t value) {
    return value <= kIntMax ||
           fail(path, std::to_string(value) + " is not supported, only up to " + std::to_string(kIntMax),
                ErrorCode::kUnsupported);
  }

  /// `count` elements of `size` bytes every `stride` bytes from `offset` lie inside the view.
  bool check_range(const std::string& path, std::uint64_t view_index, std::uint64_t offset, std::uint64_t count,
                   std::uint64_t size, std::uint64_t stride) {
    const std::uint64_t length = index_or(root_.items("bufferViews")[view_index], "byteLength", 0);
    if (count == 0) return offset <= length || fail(path, "its offset lies outside its buffer view");
    // count < 2^48 and stride <= 2^12: no overflow.
    const std::uint64_t needed = (count - 1) * stride + size;
    if (offset > length || needed > length - offset) {
      return fail(path, std::to_string(count) + " elements need " + std::to_string(needed) + " bytes from offset " +
                            std::to_string(offset) + ", its buffer view has " + std::to_string(length));
    }
    return true;
  }

  bool check_accessor(const Json& accessor, const std::string& path) {
    const std::uint64_t view_count = root_.items("bufferViews").size();
    if (!optional_index(accessor, path, "bufferView", view_count) ||
        !optional_index(accessor, path, "byteOffset", kByteLimit) ||
        !required_index(accessor, path, "componentType", 5127) ||
        !required_index(accessor, path, "count", kByteLimit) || !optional_bool(accessor, path, "normalized") ||
        !optional_object(accessor, path, "sparse")) {
      return false;
    }
    const std::uint32_t component = component_size(index_or(accessor, "componentType", 0));
    if (component == 0) return fail(path + "/componentType", "not one of glTF's component types");
    const Json* type = accessor.find("type");
    const TypeShape* shape = nullptr;
    for (const TypeShape& candidate : kShapes) {
      if (type != nullptr && type->string() == candidate.name) shape = &candidate;
    }
    if (shape == nullptr) return fail(path + "/type", "not one of glTF's types");
    const std::uint64_t count = index_or(accessor, "count", 0);
    const ElementSize size = element_size(*shape, component);
    if (accessor.find("bufferView") != nullptr) {
      const std::uint64_t view = index_or(accessor, "bufferView", 0);
      std::uint64_t stride = index_or(root_.items("bufferViews")[view], "byteStride", 0);
      if (stride == 0) stride = size.step;
      if (stride < size.used) return fail(path, "its buffer view's byteStride is smaller than one element");
      if (!check_range(path, view, index_or(accessor, "byteOffset", 0), count, size.used, stride)) return false;
    }
    if (!fits_int(path + "/count", count)) return false;
    if (const Json* sparse = accessor.find("sparse")) return check_sparse(*sparse, path + "/sparse", count, size);
    return true;
  }

  bool check_sparse(const Json& sparse, const std::string& path, std::uint64_t element_count, ElementSize size) {
    if (!required_index(sparse, path, "count", element_count + 1)) return false;
    const std::uint64_t view_count = root_.items("bufferViews").size();
    for (const std::string_view part : {"indices", "values"}) {
      const std::string here = path + "/" + std::string(part);
      const Json* object = sparse.find(part);
      if (object == nullptr) return fail(here, "missing");
      if (!object->is_object()) return fail(here, "not an object");
      if (!required_index(*object, here, "bufferView", view_count)) return false;
      if (!optional_index(*object, here, "byteOffset", kByteLimit)) return false;
    }
    const Json& indices = *sparse.find("indices");
    if (!required_index(indices, path + "/indices", "componentType", 5126)) return false;
    const std::uint64_t index_type = index_or(indices, "componentType", 0);
    if (index_type != kGltfUnsignedByte && index_type != kGltfUnsignedShort && index_type != kGltfUnsignedInt) {
      return fail(path + "/indices/componentType", "not an unsigned integer type");
    }
    const std::uint64_t count = index_or(sparse, "count", 0);
    const std::uint32_t index_size = component_size(index_type);
    const Json& values = *sparse.find("values");
    return check_range(path + "/indices", index_or(indices, "bufferView", 0), index_or(indices, "byteOffset", 0), count,
                       index_size, index_size) &&
           check_range(path + "/values", index_or(values, "bufferView", 0), index_or(values, "byteOffset", 0), count,
                       size.used, size.step) &&
           fits_int(path + "/indices/byteOffset", index_or(indices, "byteOffset", 0)) &&
           fits_int(path + "/values/byteOffset", index_or(values, "byteOffset", 0));
  }

  const Json& root_;
};

}  // namespace

std::uint32_t component_size(std::uint64_t component_type) {
  switch (component_type) {
    case kGltfByte:
    case kGltfUnsignedByte: return 1;
    case kGltfShort:
    case kGltfUnsignedShort: return 2;
    case kGltfUnsignedInt:
    case kGltfFloat: return 4;
    default: return 0;
  }
}

Status check_gltf_accessors(const Json& root, const std::string& file) {
  AccessorChecker checker(root, file);
  checker.run();
  return checker.status();
}

}  // namespace meshlode::scene
