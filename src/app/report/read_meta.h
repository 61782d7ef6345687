// SPDX-License-Identifier: GPL-3.0-or-later
// The asset's JSON sections, taken apart for statistics. They come from a file: nothing in them is trusted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace meshlode::app {

struct MetaInfo {
  struct Decision {
    std::string what, reason;
    bool is_kept = true;
  };
  struct LeftOut {
    std::string what, why;
  };
  /// A mesh of the asset that has pieces of another.
  struct Part {
    std::uint64_t mesh = 0, of = 0;
  };
  /// What the source had in the place of an image that --textures converted.
  struct SourceImage {
    std::uint64_t blob = 0, bytes = 0;
    std::uint32_t width = 0, height = 0;
    std::string mime_type;
  };
  bool is_valid = false;  ///< false: not JSON, or not an object; everything below is then as here
  std::string generator, source_file, source_hash;
  std::string settings = "{}";             ///< JSON object
  std::vector<std::string> setting_lines;  ///< of `settings`, for text: the whole's, then those of meshes
  std::string preset, codec;               ///< of the settings; empty where it is not said
  std::string plan = "[]";                 ///< JSON array
  std::string left_out = "[]";             ///< JSON array
  std::vector<Decision> decisions;         ///< of `plan`, for text
  std::vector<LeftOut> left_outs;          ///< of `left_out`, for text
  std::vector<Part> parts;                 ///< as many as can be read
  std::vector<SourceImage> source_images;  ///< the same
  std::uint32_t cluster_triangles = 0;     ///< of the settings; 0 where it is not said
  bool repair = false;                     ///< of the settings: the source was repaired
  bool linear_colors = false;              ///< the same: colour levels were taken as linear
  std::string scene;                       ///< of the settings: the scene that was asked for; empty: the default
};
[[nodiscard]] MetaInfo read_meta(std::string_view meta_json);

/// Of each mesh the one of the source that it is, or is a part of: by its index, which the two have in common.
[[nodiscard]] std::vector<std::size_t> origins_of_meshes(const MetaInfo& meta, std::size_t mesh_count);

struct TextureInfo {
  std::string name;
  std::int64_t image = -1;  ///< of the document, by the rule of base/gltf_textures.h; -1: none
  std::int64_t sampler = -1;
};
[[nodiscard]] std::vector<TextureInfo> read_textures(std::string_view scene_json);

}  // namespace meshlode::app
