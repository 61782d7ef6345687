// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/polygons/obj_materials.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "base/file.h"
#include "base/try.h"
#include "base/utf8.h"
#include "scene/import/gltf/uri.h"
#include "scene/import/image_mime.h"
#include "scene/import/json.h"
#include "scene/import/polygons/mtl_material.h"
#include "scene/import/polygons/read_mtl.h"
#include "scene/import/polygons/text_scan.h"

namespace meshlode::scene {

namespace {

/// False where the image plainly has no alpha: JPEG, and a PNG of a colour type without and no tRNS.
bool may_have_alpha(std::span<const std::uint8_t> bytes) {
  const std::string_view mime = sniff_image_mime(bytes);
  if (mime == "image/jpeg") return false;
  if (mime != "image/png" || bytes.size() < 33) return true;
  if ((bytes[25] & 4U) != 0) return true;
  for (std::size_t at = 8; bytes.size() - at >= 12;) {
    const std::size_t length = std::size_t{bytes[at]} << 24U | std::size_t{bytes[at + 1]} << 16U |
                               std::size_t{bytes[at + 2]} << 8U | bytes[at + 3];
    const std::string_view type(reinterpret_cast<const char*>(bytes.data()) + at + 4, 4);
    if (type == "tRNS") return true;
    if (type == "IDAT" || length > bytes.size() - at - 12) return false;
    at += 12 + length;
  }
  return false;
}

class ObjMaterials {
 public:
  ObjMaterials(const std::filesystem::path& path, const ImportOptions& options, Hasher& hasher, Scene& scene)
      : folder_(path.parent_path()), options_(options), hasher_(hasher), scene_(scene) {}

  Status run(const PolygonFile& file) {
    for (const std::string& line : file.material_libraries) open_library(line);
    for (const MtlMaterial& material : file.materials) add(material.name, material);
    std::set<std::string> unknown;
    for (const std::string& name : file.material_names) {
      const auto found = by_name_.find(name);
      if (found == by_name_.end()) unknown.insert(name);
      add(name, found == by_name_.end() ? MtlMaterial{} : found->second);
    }
    if (!unknown.empty()) {
      leave_out("material " + shown(*unknown.begin()) +
                    (unknown.size() > 1 ? " and " + std::to_string(unknown.size() - 1) + " more" : ""),
                "no mtllib that could be read has it; it is plain white");
    }
    report();
    const auto& used = file.soup.polygon_materials;  // kNoId before any usemtl
    if (used.empty() || std::find(used.begin(), used.end(), kNoId) != used.end()) scene_.materials.emplace_back();
    if (!materials_.empty()) write_document();
    return missing_;
  }

 private:
  void leave_out(std::string what, std::string why) { scene_.left_out.push_back({std::move(what), std::move(why)}); }

  /// What the libraries have and glTF, or its place here, has not.
  void report() {
    constexpr std::string_view kPhong[] = {"ka", "ks", "ns", "ni", "illum", "tf", "sharpness"};
    std::string names;
    std::uint64_t lines = 0;
    for (const auto& [what, count] : skipped_.counts()) {
      const bool is_phong = std::any_of(std::begin(kPhong), std::end(kPhong),
                                        [&name = what](std::string_view known) { return is_word(name, known); });
      if (is_phong) {
        names += " " + what;
        lines += count;
      } else {
        leave_out("MTL " + what, counted(count, "line") + " passed over");
      }
    }
    if (lines != 0) leave_out("MTL" + names, counted(lines, "line") + " of another shading than glTF's");
    if (!invisible_.empty()) {
      leave_out("MTL Tr 1 of " + counted(invisible_.size(), "material"),
                "nobody would see them, so that they are opaque: " + shown(*invisible_.begin()));
    }
    for (const auto& [what, count] : clamped_.counts()) {
      leave_out("MTL " + what, counted(count, "line") + " with a value out of range, which is clamped");
    }
    if (more_lacked_ != 0) {
      leave_out("mtllib …", counted(more_lacked_, "more name") + ": they cannot be opened below the scene's folder");
    }
    for (const auto& [what, why] : lost_maps_) leave_out(what, why);
  }

  /// A file that geometry does not need. `error`: of open().
  void lack(const std::string& what, const Error& error) {
    const std::string why = "it " + reason_not_opened(error);
    if (!options_.may_lack_images && missing_) missing_ = Error{ErrorCode::kIo, what, why};
    leave_out(what, why);
  }

  Result<MappedFile> open(const std::string& name, std::filesystem::path& path) {
    TRY_LET(resolved, resolve_named(folder_, name, options_.allow_outside));
    path = *resolved;
    auto file = MappedFile::open(path);
    if (!file) return file;
    if (options_.files_read != nullptr) options_.files_read->push_back(file->id());
    return file;
  }

  /// Each name is tried once.
  const Status& read_library(const std::string& name) {
    const auto [known, is_new] = reads_.try_emplace(name, Ok{});
    if (is_new) known->second = open_and_read(name);
    return known->second;
  }

  Status open_and_read(const std::string& name) {
    std::filesystem::path path;
    TRY_LET(file, open(name, path));
    if (!read_.insert(path).second) return Ok{};
    hasher_.update(file->bytes());
    MtlFile library = read_mtl(file->bytes());
    for (MtlMaterial& material : library.materials) {
      std::string key = material.name;
      by_name_.try_emplace(std::move(key), std::move(material));  // the first of a name counts
    }
    for (const auto& [what, count] : library.skipped.counts()) skipped_.add(what, count);
    for (const auto& [what, count] : library.clamped.counts()) clamped_.add(what, count);
    return Ok{};
  }

  /// One name with blanks, or several.
  void open_library(const std::string& line) {
    if (read_library(std::string(unquoted(line)))) return;
    constexpr std::size_t kShown = 8;
    std::string_view rest = line;
    for (std::string_view name = take_name(rest); !name.empty(); name = take_name(rest)) {
      const Status& read = read_library(std::string(name));
      if (read || !lacked_.emplace(name).second) continue;
      if (lacked_.size() <= kShown) {
        lack("mtllib " + shown(name), read.error());
      } else {
        ++more_lacked_;
      }
    }
  }

  /// The image of a map; kNoId where there is none, or it cannot be opened, which is said once.
  std::uint32_t image_of(const MtlMap& map) {
    if (map.file.empty()) return kNoId;
    if (const auto known = image_by_name_.find(map.file); known != image_by_name_.end()) return known->second;
    std::uint32_t& image = image_by_name_[map.file];
    image = kNoId;
    std::filesystem::path path;
    const auto file = open(map.file, path);
    if (!file) {
      lack(map.keyword + " " + shown(map.file), file.error());
      return kNoId;
    }
    const auto [known, is_new] = image_by_path_.try_emplace(path, static_cast<std::uint32_t>(images_.size()));
    image = known->second;
    if (is_new) add_image(path, file->bytes());
    return image;
  }

  void add_image(const std::filesystem::path& path, std::span<const std::uint8_t> bytes) {
    hasher_.update(bytes);
    SceneBlob blob;
    blob.name = as_utf8(path.filename().string());
    blob.mime_type = std::string(sniff_image_mime(bytes));
    blob.source_index = static_cast<std::uint32_t>(images_.size());
    blob.bytes.assign(bytes.begin(), bytes.end());
    Json json = Json::make_object();
    json.set("name", Json::make_string(blob.name));
    if (!blob.mime_type.empty()) json.set("mimeType", Json::make_string(blob.mime_type));
    json.set("blob", Json::make_index(scene_.blobs.size()));
    images_.push_back(std::move(json));
    scene_.blobs.push_back(std::move(blob));
  }

  void lose(const MtlMap& map, const char* why) { lost_maps_.emplace(map.keyword + " " + shown(map.file), why); }

  /// map_d can be the alpha of the base colour texture, and of no other.
  bool is_masked(const MtlMaterial& from, std::uint32_t base_color) {
    if (from.alpha.file.empty()) return false;
    const auto same = resolve_named(folder_, from.alpha.file, options_.allow_outside);
    const auto known = same ? image_by_path_.find(*same) : image_by_path_.end();
    if (base_color == kNoId || known == image_by_path_.end() || known->second != base_color) {
      lose(from.alpha, "glTF has the alpha in the base colour texture, and this is another file");
      return false;
    }
    if (!may_have_alpha(scene_.blobs[base_color].bytes)) lose(from.alpha, "the image has no alpha channel");
    return true;
  }

  MtlImages images_of(const MtlMaterial& from) {
    MtlImages images;
    images.base_color = image_of(from.base_color);
    images.masks = is_masked(from, images.base_color);
    if (can_have_roughness_map(from)) {
      images.metallic_roughness = image_of(from.rough);
    } else {
      for (const MtlMap* map : {&from.rough, &from.metal}) {
        if (!map->file.empty()) lose(*map, "glTF has roughness and metalness in one image");
      }
    }
    images.normal = image_of(from.normal);
    images.emissive = image_of(from.emissive);
    return images;
  }

  void add(const std::string& name, const MtlMaterial& from) {
    SceneMaterial material;
    material.name = as_utf8(name);
    material.source_index = static_cast<std::uint32_t>(materials_.size());
    if (!from.dissolve && from.transparency == 1.0) invisible_.insert(name);
    materials_.push_back(make_material(from, images_of(from), material, has_strength_));
    scene_.materials.push_back(std::move(material));
  }

  void write_document() {
    Json document = Json::make_object();
    Json asset = Json::make_object();
    asset.set("version", Json::make_string("2.0"));
    document.set("asset", std::move(asset));
    if (has_strength_) {
      Json used = Json::make_array();
      std::get<Json::Array>(used.value).push_back(Json::make_string("KHR_materials_emissive_strength"));
      document.set("extensionsUsed", std::move(used));
    }
    document.set("materials", Json{std::move(materials_)});
    if (!images_.empty()) {
      Json::Array textures;
      for (std::size_t i = 0; i < images_.size(); ++i) {
        Json texture = Json::make_object();
        texture.set("source", Json::make_index(i));
        textures.push_back(std::move(texture));
      }
      document.set("textures", Json{std::move(textures)});
      document.set("images", Json{std::move(images_)});
    }
    scene_.document = dump_json(document);
  }

  std::filesystem::path folder_;
  const ImportOptions& options_;
  Hasher& hasher_;
  Scene& scene_;
  std::set<std::filesystem::path> read_;
  std::map<std::string, MtlMaterial> by_name_;
  std::map<std::string, std::uint32_t> image_by_name_;
  std::map<std::filesystem::path, std::uint32_t> image_by_path_;
  Json::Array materials_, images_;
  bool has_strength_ = false;
  Tally skipped_, clamped_;
  std::map<std::string, Status> reads_;  ///< libraries that were tried
  std::set<std::string, std::less<>> lacked_;
  std::uint64_t more_lacked_ = 0;  ///< that are not named
  std::set<std::string> invisible_;
  std::map<std::string, std::string> lost_maps_;  ///< with the reason
  Status missing_ = Ok{};                         ///< the first file that may not be missing
};

}  // namespace

std::string with_slashes(std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  return name;
}

Result<std::filesystem::path> resolve_named(const std::filesystem::path& folder, const std::string& name,
                                            std::span<const std::filesystem::path> allow_outside) {
  return resolve_below(folder, with_slashes(name), allow_outside);
}

Status add_obj_materials(const std::filesystem::path& path, const PolygonFile& file, const ImportOptions& options,
                         Hasher& hasher, Scene& scene) {
  return ObjMaterials(path, options, hasher, scene).run(file);
}

}  // namespace meshlode::scene
