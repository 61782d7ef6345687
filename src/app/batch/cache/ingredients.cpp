// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/batch/cache/ingredients.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include "builder/aggregate/aggregate_choice.h"
#include "builder/hooks.h"
#include "builder/plan/attributes.h"
#include "builder/plan/plan.h"
#include "builder/preset.h"
#include "format/names.h"

namespace meshlode::app {

namespace {

/// Changes when what is stored under a key means something else.
constexpr std::string_view kFirstLine = "meshlode asset 1\n";

/// One word of a line, whatever is in it.
std::string word_of(std::string_view text) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string out;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte > 0x20 && byte != 0x7F && c != '%') {
      out += c;
    } else {
      out += {'%', kDigits[byte >> 4U], kDigits[byte & 15U]};
    }
  }
  return out;
}

/// The shortest text that reads back as the same double.
std::string text_of(double number) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), number).ptr;
  return {text.data(), end};
}
std::string text_of(std::uint64_t number) {
  return std::to_string(number);
}
std::string text_of(bool flag) {
  return flag ? "yes" : "no";
}

std::string text_of(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ",") + name;
  return text.empty() ? "none" : text;
}

/// Lines "key value" behind the first one. A key has one word, or two where the first is a kind of file.
std::map<std::string, std::string> read_lines(std::string_view text) {
  std::map<std::string, std::string> lines;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    const std::size_t space = line.rfind(' ');
    if (space != std::string_view::npos) lines.emplace(line.substr(0, space), line.substr(space + 1));
  }
  return lines;
}

std::string describe(const std::string& key, const std::string* before, const std::string* now) {
  if (key == "program") return "the program is another";
  const bool is_setting = key.find(' ') == std::string::npos;
  if (is_setting) return key + " is " + (now != nullptr ? *now : "gone") + ", was " + (before ? *before : "not there");
  if (before == nullptr) return key + " is new";
  if (now == nullptr) return key + " is no longer used";
  if (*now == "missing") return key + " is missing";
  return key + (*before == "missing" ? " is there" : " changed");
}

}  // namespace

std::string settings_text(const builder::PipelineOptions& options, const scene::ImportOptions& import) {
  // Every member has a name here, so that one more does not compile before it is written down or left out on purpose.
  const auto& [error_tier, attributes, keep, drop, grid_step, position_error, normal_error, uv_error,
               uv_error_is_texels, uv_error_is_default, aggregate, aggregate_names, lock_borders] =
      static_cast<const builder::MeshOptions&>(options);
  const auto& [preset, codec, strip_effort, partition_seed, repair, linear_colors, promise, keep_topology, keep_layers,
               max_cluster_triangles, max_cluster_vertices, group_clusters, page_kib, page_order, root_bytes,
               page_hints, max_memory, mesh_store, looks, textures, images, hooks, mesh_options] =
      static_cast<const builder::SceneOptions&>(options);
  const auto& [import_repair, scene, files_read, max_decoded, may_lack_images, allow_outside, import_linear] = import;
  static_cast<void>(mesh_options);     // not known before the import: mesh_rules_text()
  static_cast<void>(max_memory);       // whether, not what
  static_cast<void>(mesh_store);       // how soon
  static_cast<void>(looks);            // the program always has it; images are ingredients
  static_cast<void>(images);           // the same
  static_cast<void>(may_lack_images);  // a missing image is an ingredient of its own
  static_cast<void>(allow_outside);    // the same: a file that may not be opened is a missing one
  static_cast<void>(files_read);       // an output
  const std::pair<const char*, std::string> lines[] = {
      {"preset", builder::name_of(preset)},
      {"error-tier", format::name_of(error_tier)},
      {"attributes", builder::name_of(attributes)},
      {"keep", text_of(builder::names_of_attributes(keep))},
      {"drop", text_of(builder::names_of_attributes(drop))},
      {"scene-of-file", scene.empty() ? "default" : "'" + word_of(scene) + "'"},
      {"grid", text_of(grid_step)},
      {"codec", format::name_of(codec)},
      {"strip-effort", builder::name_of(strip_effort)},
      {"partition-seed", text_of(std::uint64_t{partition_seed})},
      {"repair", text_of(repair)},
      {"import-repair", text_of(import_repair)},
      {"linear-colors", text_of(linear_colors)},
      {"import-linear-colors", text_of(import_linear)},
      {"promise", format::name_of(promise)},
      {"keep-topology", text_of(keep_topology)},
      {"lock-borders", text_of(lock_borders)},
      {"keep-layers", text_of(keep_layers)},
      {"cluster-triangles", text_of(std::uint64_t{max_cluster_triangles})},
      {"cluster-vertices", text_of(std::uint64_t{max_cluster_vertices})},
      {"group-clusters", text_of(std::uint64_t{group_clusters})},
      {"page-size", text_of(std::uint64_t{page_kib})},
      {"page-order", builder::name_of(page_order)},
      {"root-bytes", text_of(std::uint64_t{root_bytes})},
      {"page-hints", text_of(page_hints)},
      {"textures", builder::texture_word(textures)},
      // Whether, not what; but images that take more stay as they are.
      {"max-decoded", textures.is_keep() ? "any" : text_of(max_decoded)},
      {"study", hooks != nullptr ? hooks->record : "none"},
      {"position-error", text_of(position_error)},
      {"normal-error", text_of(normal_error)},
      {"uv-error", text_of(uv_error)},
      {"uv-error-is-texels", text_of(uv_error_is_texels)},
      {"uv-error-is-default", text_of(uv_error_is_default)},
      {"aggregate", builder::aggregate_word(options)},
  };
  std::string text;
  for (const auto& [name, value] : lines) text += std::string(name) + " " + value + "\n";
  return text;
}

std::string mesh_rules_text(std::span<const app::SettingLayer> layers) {
  if (std::all_of(layers.begin(), layers.end(), [](const auto& layer) { return layer.mesh_rules.empty(); })) return {};
  std::string text;
  const auto add = [&](const std::string& place, const app::SettingWords& words) {
    for (const app::SettingInfo& info : app::all_settings()) {
      const auto& word = words[static_cast<std::size_t>(info.setting)];
      if (word) text += place + ":" + info.name + " " + word_of(*word) + "\n";
    }
  };
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const std::string layer = "layer-" + std::to_string(i);
    add(layer, layers[i].words);
    for (const app::SettingLayer::MeshRule& rule : layers[i].mesh_rules)
      add(layer + ":" + word_of(rule.glob), rule.words);
  }
  return text;
}

std::string ingredients_text(const Hash128& program, const std::string& settings, std::span<const Dependency> files) {
  std::string text(kFirstLine);
  text += "program " + to_hex(program) + "\n" + settings;
  for (const Dependency& file : files) {
    text += std::string(name_of(file.kind)) + " " + word_of(file.name) + " ";
    text += (file.stamp ? to_hex(file.hash) : "missing") + "\n";
  }
  return text;
}

Hash128 key_of(const std::string& ingredients) {
  return hash128({reinterpret_cast<const std::uint8_t*>(ingredients.data()), ingredients.size()});
}

std::string explain_change(const std::string& before, const std::string& now) {
  constexpr std::size_t kMost = 3;
  const auto old_lines = read_lines(before), new_lines = read_lines(now);
  std::vector<std::string> changes;
  for (const auto& [key, value] : new_lines) {
    const auto old = old_lines.find(key);
    if (old == old_lines.end()) {
      changes.push_back(describe(key, nullptr, &value));
    } else if (old->second != value) {
      changes.push_back(describe(key, &old->second, &value));
    }
  }
  for (const auto& [key, value] : old_lines) {
    if (!new_lines.contains(key)) changes.push_back(describe(key, &value, nullptr));
  }
  std::string text;
  for (std::size_t i = 0; i < changes.size() && i < kMost; ++i) text += (i == 0 ? "" : "; ") + changes[i];
  if (changes.size() > kMost) text += "; " + std::to_string(changes.size() - kMost) + " more";
  return text;
}

}  // namespace meshlode::app
