// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/settings/settings_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <system_error>
#include <utility>

#include "base/nearest_name.h"
#include "base/try.h"
#include "scene/import/json.h"

namespace meshlode::app {

namespace {

namespace fs = std::filesystem;
using scene::Json;
using scene::JsonMember;

// What a file may cost, whoever wrote it: every mesh is held against every rule.
constexpr std::size_t kMaxBytes = std::size_t{1} << 20U;
constexpr std::size_t kMaxRules = 1000;
constexpr std::size_t kMaxGlobBytes = 256;

/// Options of build that say nothing about an asset: where it goes, and what the machine may spend on it.
constexpr std::array<std::string_view, 11> kOptionsOfTheCall{
    "output", "output-folder", "max-memory",    "max-decoded",     "jobs", "report", "format",
    "quiet",  "explain",       "settings-root", "no-settings-file"};

bool is_of_the_call(std::string_view key) {
  return std::find(kOptionsOfTheCall.begin(), kOptionsOfTheCall.end(), key) != kOptionsOfTheCall.end();
}

std::string number_text(double number) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), number).ptr;
  return {text.data(), end};
}

const char* kind_of(Setting setting) {
  if (is_flag(setting)) return "give true or false";
  if (is_list(setting)) return "give a text or an array of texts";
  return takes_number(setting) ? "give a number or a text" : "give a text";
}

class FileReader {
 public:
  explicit FileReader(const std::string& from) { layer_ = {from, ErrorCode::kInvalid, {}, {}}; }

  Result<SettingLayer> read(std::string_view text) {
    if (text.size() > kMaxBytes) return Error{ErrorCode::kInvalid, layer_.from, "a file of settings has at most 1MiB"};
    if (text.empty()) return Error{ErrorCode::kInvalid, layer_.from, "the file is empty"};
    const Result<Json> root = scene::parse_json(text);
    if (!root) return Error{ErrorCode::kInvalid, layer_.from, root.error().detail};
    if (!root->is_object()) return Error{ErrorCode::kInvalid, layer_.from, "is not an object of settings"};
    for (const JsonMember& member : *root->object()) {
      TRY(read_member(member));
    }
    TRY(settle({&layer_, 1}));
    return std::move(layer_);
  }

 private:
  [[nodiscard]] Error wrong(const std::string& path, std::string detail) const {
    return {ErrorCode::kInvalid, layer_.from + ": /" + path, std::move(detail)};
  }

  Status read_member(const JsonMember& member) {
    if (member.key == "$schema") return Ok{};
    if (member.key == "meshes") return read_rules(member.value);
    const auto setting = setting_of(member.key);
    if (!setting) return refuse_key(member.key, "", false);
    return read_word(*setting, member.value, member.key, layer_.words);
  }

  Status read_rules(const Json& meshes) {
    if (!meshes.is_object()) return wrong("meshes", "is not an object of names or globs");
    if (meshes.object()->size() > kMaxRules) {
      return wrong("meshes", "has more than " + std::to_string(kMaxRules) + " entries");
    }
    for (const JsonMember& rule : *meshes.object()) {
      const std::string path = "meshes/" + rule.key.substr(0, kMaxGlobBytes);
      if (rule.key.size() > kMaxGlobBytes) return wrong(path, "is longer than 256 bytes");
      if (!rule.value.is_object()) return wrong(path, "is not an object of settings");
      SettingLayer::MeshRule& out = layer_.mesh_rules.emplace_back();
      out.glob = rule.key;
      for (const JsonMember& member : *rule.value.object()) {
        const auto setting = setting_of(member.key);
        if (setting && !info_of(*setting).is_of_mesh) {
          return wrong(path + "/" + member.key, "is a setting of the whole scene");
        }
        if (!setting) return refuse_key(member.key, path + "/", true);
        if (Status s = read_word(*setting, member.value, path + "/" + member.key, out.words); !s) return s;
      }
    }
    return Ok{};
  }

  [[nodiscard]] Status read_word(Setting setting, const Json& value, const std::string& path,
                                 SettingWords& words) const {
    std::optional<std::string> word = word_of_value(setting, value);
    if (!word) return wrong(path, kind_of(setting));
    words[static_cast<std::size_t>(setting)] = std::move(*word);
    return Ok{};
  }

  [[nodiscard]] Error refuse_key(const std::string& key, const std::string& path, bool is_of_mesh) const {
    const std::string shown = key.substr(0, 64);
    if (is_of_the_call(key)) {
      return wrong(path + shown, "is given on the command line alone");
    }
    std::vector<std::string> known;
    for (const SettingInfo& info : all_settings()) {
      if (!is_of_mesh || info.is_of_mesh) known.emplace_back(info.name);
    }
    if (!is_of_mesh) known.emplace_back("meshes");
    return wrong(path + shown, "no setting has this name" + nearest_hint(key, known));
  }

  SettingLayer layer_;
};

/// The folders whose files count, outermost first.
std::vector<fs::path> folders_of(const fs::path& scene, const fs::path& root) {
  const fs::path own = scene.parent_path();
  const fs::path inside =
      root.empty() ? fs::path() : own.lexically_normal().lexically_relative(root.lexically_normal());
  if (inside.empty() || *inside.begin() == "..") return {own};
  std::vector<fs::path> folders{root};
  for (const fs::path& part : inside) {
    if (part != ".") folders.push_back(folders.back() / part);
  }
  return folders;
}

}  // namespace

std::optional<std::string> word_of_value(Setting setting, const Json& value) {
  if (is_flag(setting)) {
    if (!value.is_bool()) return std::nullopt;
    return std::get<bool>(value.value) ? "true" : "false";
  }
  if (value.is_string()) return std::string(*value.string());
  if (is_list(setting)) {
    if (!value.is_array()) return std::nullopt;
    std::string words;
    for (const Json& name : *value.array()) {
      if (!name.is_string()) return std::nullopt;
      words += (words.empty() ? "" : ",") + std::string(*name.string());
    }
    return words;
  }
  const auto number = value.number();
  if (!number || !takes_number(setting)) return std::nullopt;
  return number_text(*number);
}

Result<SettingLayer> parse_settings(std::string_view text, const std::string& from) {
  return FileReader(from).read(text);
}

Result<std::vector<SettingLayer>> read_settings_files(const fs::path& scene, const fs::path& root,
                                                      std::vector<FileId>& files_read) {
  std::vector<SettingLayer> layers;
  for (const fs::path& folder : folders_of(scene, root)) {
    const fs::path path = folder / kSettingsFileName;
    std::error_code ec;
    if (fs::symlink_status(path, ec).type() == fs::file_type::not_found) continue;
    TRY_LET(file, MappedFile::open(path));
    files_read.push_back(file->id());
    const std::span<const std::uint8_t> bytes = file->bytes();
    TRY_LET(layer, parse_settings({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, path.string()));
    layers.push_back(std::move(*layer));
  }
  return layers;
}

}  // namespace meshlode::app
