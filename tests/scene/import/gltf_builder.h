// SPDX-License-Identifier: GPL-3.0-or-later
// Small glTF files written by hand, and a folder of their own for them.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "scene/import/import.h"

namespace meshlode::testing {

/// A fresh folder that goes away with the object.
class TempFolder {
 public:
  TempFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "meshlode-import-XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  ~TempFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    const std::filesystem::path file = path_ / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << bytes;
    return file;
  }

 private:
  std::filesystem::path path_;
};

/// Collects binary data, views and accessors; the rest of the JSON is given as text.
class GltfBuilder {
 public:
  template <class T>
  int view(const std::vector<T>& values, int stride = 0) {
    bin.resize((bin.size() + 3) / 4 * 4);
    const std::size_t offset = bin.size();
    bin.resize(offset + sizeof(T) * values.size());
    if (!values.empty()) std::memcpy(bin.data() + offset, values.data(), sizeof(T) * values.size());
    std::string text = "{\"buffer\":0,\"byteOffset\":" + std::to_string(offset) +
                       ",\"byteLength\":" + std::to_string(sizeof(T) * values.size());
    if (stride != 0) text += ",\"byteStride\":" + std::to_string(stride);
    views.push_back(text + "}");
    return static_cast<int>(views.size()) - 1;
  }
  /// A view in a fallback buffer without data, whose bytes are a stream in buffer 0. `mode` such as "TRIANGLES".
  int meshopt_view(const std::vector<std::uint8_t>& stream, std::size_t count, std::size_t stride,
                   const std::string& mode, const std::string& filter = "NONE") {
    const std::size_t offset = (bin.size() + 3) / 4 * 4;
    bin.resize(offset);
    bin.insert(bin.end(), stream.begin(), stream.end());
    const auto n = [](std::size_t value) { return std::to_string(value); };
    std::string text = "{\"buffer\":1,\"byteOffset\":" + n(fallback_bytes) + ",\"byteLength\":" + n(count * stride);
    if (mode == "ATTRIBUTES") text += ",\"byteStride\":" + n(stride);
    text += ",\"extensions\":{\"" + meshopt_name + "\":{\"buffer\":0,\"byteOffset\":" + n(offset) +
            ",\"byteLength\":" + n(stream.size()) + ",\"byteStride\":" + n(stride) + ",\"count\":" + n(count) +
            ",\"mode\":\"" + mode + "\",\"filter\":\"" + filter + "\"}}}";
    fallback_bytes += (count * stride + 3) / 4 * 4;
    views.push_back(text);
    return static_cast<int>(views.size()) - 1;
  }
  int accessor(int view_index, int component, std::size_t count, const std::string& type,
               const std::string& extra = "") {
    std::string text = "{\"componentType\":" + std::to_string(component) + ",\"count\":" + std::to_string(count) +
                       ",\"type\":\"" + type + "\"";
    if (view_index >= 0) text += ",\"bufferView\":" + std::to_string(view_index);
    accessors.push_back(text + extra + "}");
    return static_cast<int>(accessors.size()) - 1;
  }
  template <class T>
  int array(const std::vector<T>& values, int component, const std::string& type, std::size_t width,
            const std::string& extra = "") {
    return accessor(view(values), component, values.size() / width, type, extra);
  }
  int floats(const std::vector<float>& values, const std::string& type, std::size_t width) {
    return array(values, 5126, type, width);
  }
  /// `buffer` is the text of buffer 0 after its byteLength, such as ",\"uri\":\"b.bin\"".
  [[nodiscard]] std::string json(const std::string& rest, const std::string& buffer) const {
    std::string text = "{\"asset\":{\"version\":\"2.0\"}";
    if (!bin.empty()) {
      text += ",\"buffers\":[{\"byteLength\":" + std::to_string(bin.size()) + buffer + "}";
      if (fallback_bytes > 0) {
        text += ",{\"byteLength\":" + std::to_string(fallback_bytes) + ",\"extensions\":{\"" + meshopt_name +
                "\":{\"fallback\":true}}}";
      }
      text += "]";
    }
    text += list("bufferViews", views) + list("accessors", accessors);
    return text + (rest.empty() ? "" : "," + rest) + "}";
  }
  [[nodiscard]] std::string glb(const std::string& rest) const {
    std::string text = json(rest, "");
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string binary(bin.begin(), bin.end());
    binary.resize((binary.size() + 3) / 4 * 4, '\0');
    const auto u32 = [](std::size_t value) {
      const auto v = static_cast<std::uint32_t>(value);
      return std::string(reinterpret_cast<const char*>(&v), 4);
    };
    return "glTF" + u32(2) + u32(12 + 8 + text.size() + 8 + binary.size()) + u32(text.size()) + "JSON" + text +
           u32(binary.size()) + std::string("BIN\0", 4) + binary;
  }
  [[nodiscard]] Result<scene::Scene> import(const std::string& rest, const scene::ImportOptions& options = {}) const {
    const TempFolder folder;
    return scene::import_scene(folder.write("scene.glb", glb(rest)), options);
  }

  std::vector<std::uint8_t> bin;
  std::vector<std::string> views, accessors;
  std::size_t fallback_bytes = 0;  ///< of buffer 1
  std::string meshopt_name = "EXT_meshopt_compression";

 private:
  static std::string list(const std::string& key, const std::vector<std::string>& items) {
    if (items.empty()) return "";
    std::string text = ",\"" + key + "\":[";
    for (std::size_t i = 0; i < items.size(); ++i) text += (i == 0 ? "" : ",") + items[i];
    return text + "]";
  }
};

/// Four corners of the unit square, two triangles.
inline const std::vector<float> kSquare = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
inline const std::vector<std::uint16_t> kSquareIndices = {0, 1, 2, 0, 2, 3};

/// One mesh with one primitive.
inline std::string mesh_text(const std::string& attributes, const std::string& rest = "") {
  return "\"meshes\":[{\"primitives\":[{\"attributes\":{" + attributes + "}" + rest +
         "}]}],\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}],\"scene\":0";
}

/// The text with a number in every place of '#'.
inline std::string with_number(std::string text, const std::string& number) {
  for (std::size_t at = text.find('#'); at != std::string::npos; at = text.find('#', at + number.size())) {
    text.replace(at, 1, number);
  }
  return text;
}

inline std::string describe(const Result<scene::Scene>& scene) {
  return scene ? "ok" : scene.error().message();
}

}  // namespace meshlode::testing
