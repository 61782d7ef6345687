// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/settings/settings.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "base/glob.h"
#include "base/nearest_name.h"
#include "base/printable.h"
#include "base/try.h"
#include "builder/aggregate/aggregate_choice.h"
#include "builder/plan/attributes.h"
#include "builder/plan/plan.h"
#include "builder/preset.h"
#include "format/names.h"
#include "scene/scene.h"

namespace meshlode::app {

namespace {

constexpr const char* kQuality = "Quality";
constexpr const char* kPrecision = "Precision and attributes";
constexpr const char* kInput = "Input";
constexpr const char* kAdvanced = "Advanced";

constexpr std::array<SettingInfo, kSettingCount> kSettings{{
    {Setting::kFor, "for", "", kQuality,
     "options by use: web, the smallest download; engine, small pages that are mapped; archive, the most accurate; "
     "options that are given win",
     "any", false},
    {Setting::kErrorTier, "error-tier", "", kQuality,
     "what the stored errors are: estimated (qem), sampled (measured) or proven (certified); auto: the preset's",
     "auto", true},
    {Setting::kPreset, "preset", "", kQuality,
     "build time against quality: fast estimates errors (qem), best spends more time on clusters and strips", "default",
     false},
    {Setting::kAttributes, "attributes", "", kPrecision, "auto: what the materials use; none: positions only", "auto",
     true},
    {Setting::kKeep, "keep", " NAMES", kPrecision,
     "attributes to store in any case: NORMAL, TEXCOORD_0 to TEXCOORD_3, COLOR_0, comma-separated, or all", "", true},
    {Setting::kDrop, "drop", " NAMES", kPrecision, "attributes never to store, comma-separated", "", true},
    {Setting::kGrid, "grid", " auto|STEP", kPrecision,
     "step of the position grid in mesh units, above 0, for meshes that must fit together; not with --position-error",
     "auto", true},
    {Setting::kPositionError, "position-error", " auto|D", kPrecision,
     "largest distance that a vertex may move, mesh units, above 0", "auto", true},
    {Setting::kNormalError, "normal-error", " DEGREES", kPrecision,
     "largest error of a stored normal in degrees, above 0 and up to 180", "0.1", true},
    {Setting::kUvError, "uv-error", " auto|E|Npx", kPrecision,
     "largest error of a texture coordinate, above 0, in UV units or, as in 0.25px, in texels", "auto", true},
    {Setting::kCodec, "codec", "", "Output", "compression of pages on disk", "strips", false},
    {Setting::kStripEffort, "strip-effort", "", kAdvanced, "time spent on shorter triangle strips; auto: the preset's",
     "auto", false},
    {Setting::kClusterTriangles, "cluster-triangles", " N", kAdvanced, "maximum triangles per cluster, 1 to 256", "128",
     false},
    {Setting::kGroupClusters, "group-clusters", " N", kAdvanced,
     "target number of clusters that are simplified together, 4 to 32", "20", false},
    {Setting::kRepair, "repair", "", kInput,
     "remove invalid, degenerate and duplicate triangles, orient the rest consistently, split non-manifold edges",
     "false", false},
    {Setting::kLinearColors, "linear-colors", "", kInput,
     "read whole-number colours of PLY and STL as linear, not as sRGB", "false", false},
    {Setting::kKeepTopology, "keep-topology", "", kQuality,
     "keep the holes, handles and pieces of a manifold in every cut; needs more triangles", "false", false},
    {Setting::kLockBorders, "lock-borders", "", kQuality,
     "keep every vertex of open borders in every cut, so that tiles built with one --grid fit together; needs more "
     "triangles",
     "false", true},
    {Setting::kAggregate, "aggregate", " masked|never|auto|always|NAMES", kQuality,
     "which meshes are simplified by covered area, as foliage and debris need; masked: meshes and parts of many small "
     "loose pieces with an alpha mask; auto: those without a mask too; always: all small pieces; or meshes and "
     "materials by name, comma-separated",
     "masked", true},
    {Setting::kPromise, "promise", "", kQuality,
     "what the stored errors cover: positions; texels: also texture coordinates; appearance: also normals", "position",
     false},
    {Setting::kKeepLayers, "keep-layers", "", kAdvanced,
     "keep surfaces that lie close above one another in order in coarse cuts; off: gaps are not looked for", "on",
     false},
    {Setting::kPageSize, "page-size", "", "Output",
     "largest page, in KiB; smaller ones load less that is not drawn, in more requests; a larger group has its own",
     "128", false},
    {Setting::kPageOrder, "page-order", "", "Output",
     "order of groups inside a level: level, as they were built; covisible, those together that views need together, "
     "in pages that end where views load least",
     "level", false},
    {Setting::kRootBytes, "root-bytes", " auto|N", "Output",
     "limit of each mesh's first page in bytes, 16384 to 131072; auto: as --page-size", "auto", false},
    {Setting::kPageHints, "page-hints", "", "Output",
     "store a sphere and errors of each page, 32 bytes, for readers that weigh pages before they read groups", "false",
     false},
    {Setting::kTextures, "textures", " keep|resize:N|webp[:Q]", "Output",
     "images: keep, as they are; resize:N, at most N texels along the longer side; webp, colours at quality Q, 1 to "
     "100 (90), all else without loss; or two, as in resize:1024,webp",
     "keep", false},
}};

struct UseWord {
  const char* use;
  Setting setting;
  const char* word;
};
// Measured in docs/guides/choosing-settings.md; pages in docs/log/streaming.md.
constexpr UseWord kUseWords[] = {
    {"web", Setting::kStripEffort, "best"},     {"web", Setting::kNormalError, "0.5"},
    {"web", Setting::kUvError, "0.25px"},       {"engine", Setting::kCodec, "none"},
    {"engine", Setting::kPageSize, "32"},       {"engine", Setting::kPageOrder, "covisible"},
    {"archive", Setting::kPreset, "best"},      {"archive", Setting::kErrorTier, "certified"},
    {"archive", Setting::kNormalError, "0.02"},
};
constexpr std::array<const char*, 4> kUses{"any", "web", "engine", "archive"};

/// A finite number above 0, all of the text.
std::optional<double> parse_positive(std::string_view text) {
  double value = 0.0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || rest != text.data() + text.size() || !(value > 0.0) || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

/// Degrees: no two directions are further apart than 180.
std::optional<double> parse_angle(std::string_view text) {
  const std::optional<double> degrees = parse_positive(text);
  return degrees && *degrees <= 180.0 ? degrees : std::nullopt;
}

std::optional<double> parse_uv_error(std::string_view text) {
  if (text.ends_with("px")) text.remove_suffix(2);
  return parse_positive(text);
}

std::optional<std::uint32_t> parse_count(std::string_view text, std::uint32_t fewest, std::uint32_t most) {
  std::uint32_t value = 0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_number = error == std::errc{} && rest == text.data() + text.size();
  if (!is_number || value < fewest || value > most) return std::nullopt;
  return value;
}

std::optional<std::uint32_t> parse_cluster_triangles(std::string_view text) {
  return parse_count(text, 1, format::kMaxClusterTriangles);
}

std::optional<std::uint32_t> parse_group_clusters(std::string_view text) {
  return parse_count(text, builder::kFewestGroupClusters, builder::kMostGroupClusters);
}

std::optional<std::uint32_t> parse_root_bytes(std::string_view text) {
  return parse_count(text, builder::kFewestRootBytes, format::kMaxPageBytes);
}

std::string wanted(const char* what, std::string_view word) {
  return "expected " + std::string(what) + got_text(word);
}

std::size_t index_of(Setting setting) {
  return static_cast<std::size_t>(setting);
}

/// Words of one place that are looked at together.
struct Saying {
  const SettingWords& words;
  std::string from;         ///< for those who ask where a word came from
  std::string prefix = {};  ///< of its settings in error messages: "--", or a file and the path to them
  ErrorCode code = ErrorCode::kUsage;

  [[nodiscard]] const std::optional<std::string>& word(Setting setting) const { return words[index_of(setting)]; }
  [[nodiscard]] std::string place(Setting setting) const { return prefix + info_of(setting).name; }
};

Saying saying_of(const SettingLayer& layer) {
  return {layer.words, layer.from, layer.code == ErrorCode::kUsage ? "--" : layer.from + ": /", layer.code};
}

Saying saying_of(const SettingLayer& layer, const SettingLayer::MeshRule& rule) {
  return {rule.words, layer.from + ": meshes/" + rule.glob, layer.from + ": /meshes/" + rule.glob + "/", layer.code};
}

/// \pre find_fault() finds none
std::uint32_t attributes_of(const std::string& word) {
  const auto bits = builder::parse_attributes(word);
  return bits ? *bits : 0;
}

std::string join(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ",") + name;
  return text;
}

/// The words of all layers so far.
class Settling {
 public:
  /// The defaults, and over them what the last `for` of these layers means.
  explicit Settling(std::span<const SettingLayer> layers = {}) {
    for (const SettingInfo& info : kSettings) words_[index_of(info.setting)] = {info.usual, kDefaultPlace};
    std::string use;
    for (const SettingLayer& layer : layers) use = layer.words[index_of(Setting::kFor)].value_or(use);
    for (const UseWord& word : kUseWords) {
      if (use == word.use) words_[index_of(word.setting)] = {word.word, "for " + use};
    }
  }

  Status add(const Saying& saying) {
    for (const SettingInfo& info : kSettings) {
      const auto& word = saying.word(info.setting);
      if (!word) continue;
      const std::string fault = find_fault(info.setting, *word);
      if (!fault.empty()) return Error{saying.code, saying.place(info.setting), fault};
    }
    if (Status grids = choose_grid_word(saying); !grids) return grids;
    if (Status names = choose_names(saying); !names) return names;
    for (std::size_t i = 0; i < kSettingCount; ++i) {
      if (saying.words[i]) words_[i] = {*saying.words[i], saying.from};
    }
    return Ok{};
  }

  [[nodiscard]] const std::array<SettledWord, kSettingCount>& words() const { return words_; }

 private:
  /// A grid and a position error exclude each other: the later one stays.
  Status choose_grid_word(const Saying& saying) {
    const auto says = [&](Setting setting) { return saying.word(setting) && *saying.word(setting) != "auto"; };
    if (says(Setting::kGrid) && says(Setting::kPositionError)) {
      const std::string other = (saying.code == ErrorCode::kUsage ? "--" : "") + std::string("grid");
      return Error{saying.code, saying.place(Setting::kPositionError), "give this or " + other + ", not both"};
    }
    if (says(Setting::kGrid)) words_[index_of(Setting::kPositionError)] = {"auto", saying.from};
    if (says(Setting::kPositionError)) words_[index_of(Setting::kGrid)] = {"auto", saying.from};
    return Ok{};
  }

  /// A name that is kept and dropped: the later one stays.
  Status choose_names(const Saying& saying) {
    const auto& kept = saying.word(Setting::kKeep);
    const auto& dropped = saying.word(Setting::kDrop);
    const std::uint32_t both = attributes_of(kept.value_or("")) & attributes_of(dropped.value_or(""));
    if (both != 0) {
      return Error{saying.code, saying.place(Setting::kDrop),
                   builder::names_of_attributes(both)[0] + " is kept by name too"};
    }
    if (saying.word(Setting::kAttributes)) {
      for (const Setting setting : {Setting::kKeep, Setting::kDrop}) words_[index_of(setting)] = {"", saying.from};
    }
    if (kept) remove_names(Setting::kDrop, attributes_of(*kept), saying.from);
    if (dropped) remove_names(Setting::kKeep, attributes_of(*dropped), saying.from);
    return Ok{};
  }

  void remove_names(Setting setting, std::uint32_t bits, const std::string& from) {
    SettledWord& word = words_[index_of(setting)];
    const std::uint32_t before = attributes_of(word.word);
    if ((before & bits) != 0) word = {join(builder::names_of_attributes(before & ~bits)), from};
  }

  std::array<SettledWord, kSettingCount> words_;
};

/// \pre every word is one: find_fault()
builder::PipelineOptions options_of(const std::array<SettledWord, kSettingCount>& words) {
  const auto word = [&](Setting setting) -> const std::string& { return words[index_of(setting)].word; };
  builder::PipelineOptions options;
  options.preset = value_in(builder::kPresetNames, word(Setting::kPreset)).value_or(options.preset);
  options.error_tier = value_in(format::kErrorTierNames, word(Setting::kErrorTier))
                           .value_or(builder::settings_of(options.preset).error_tier);
  options.codec = value_in(format::kWrittenCodecNames, word(Setting::kCodec)).value_or(options.codec);
  options.strip_effort =
      value_in(builder::kStripEffortNames, word(Setting::kStripEffort)).value_or(options.strip_effort);
  options.attributes =
      value_in(builder::kAttributeChoiceNames, word(Setting::kAttributes)).value_or(options.attributes);
  options.keep = attributes_of(word(Setting::kKeep));
  options.drop = attributes_of(word(Setting::kDrop));
  options.grid_step = parse_positive(word(Setting::kGrid)).value_or(0.0);
  options.position_error = parse_positive(word(Setting::kPositionError)).value_or(0.0);
  options.normal_error = parse_positive(word(Setting::kNormalError)).value_or(options.normal_error);
  if (const auto uv_error = parse_uv_error(word(Setting::kUvError))) {
    options.uv_error = *uv_error;
    options.uv_error_is_texels = word(Setting::kUvError).ends_with("px");
    options.uv_error_is_default = false;
  }
  options.max_cluster_triangles =
      parse_cluster_triangles(word(Setting::kClusterTriangles)).value_or(options.max_cluster_triangles);
  options.group_clusters = parse_group_clusters(word(Setting::kGroupClusters)).value_or(options.group_clusters);
  options.page_kib = parse_count(word(Setting::kPageSize), 16, 128).value_or(options.page_kib);
  options.page_order = value_in(builder::kPageOrderNames, word(Setting::kPageOrder)).value_or(options.page_order);
  options.root_bytes = parse_root_bytes(word(Setting::kRootBytes)).value_or(options.root_bytes);
  options.page_hints = word(Setting::kPageHints) == "true";
  options.repair = word(Setting::kRepair) == "true";
  options.linear_colors = word(Setting::kLinearColors) == "true";
  options.keep_topology = word(Setting::kKeepTopology) == "true";
  options.lock_borders = word(Setting::kLockBorders) == "true";
  options.aggregate =
      value_in(builder::kAggregateChoiceNames, word(Setting::kAggregate)).value_or(AggregateChoice::kNamed);
  if (options.aggregate == AggregateChoice::kNamed) options.aggregate_names = word(Setting::kAggregate);
  options.promise = value_in(format::kPromiseNames, word(Setting::kPromise)).value_or(options.promise);
  options.keep_layers = word(Setting::kKeepLayers) == "on";
  options.textures = builder::parse_texture_choice(word(Setting::kTextures)).value_or(options.textures);
  return options;
}

}  // namespace

std::span<const SettingInfo, kSettingCount> all_settings() {
  return kSettings;
}

std::optional<Setting> setting_of(std::string_view name) {
  for (const SettingInfo& info : all_settings()) {
    if (name == info.name) return info.setting;
  }
  return std::nullopt;
}

bool is_list(Setting setting) {
  return setting == Setting::kKeep || setting == Setting::kDrop;
}

bool takes_number(Setting setting) {
  return choices_of(setting).empty() || setting == Setting::kPageSize;
}

const SettingInfo& info_of(Setting setting) {
  return kSettings[index_of(setting)];
}

bool is_flag(Setting setting) {
  return setting == Setting::kRepair || setting == Setting::kLinearColors || setting == Setting::kKeepTopology ||
         setting == Setting::kLockBorders || setting == Setting::kPageHints;
}

std::vector<std::string> choices_of(Setting setting) {
  switch (setting) {
    case Setting::kFor: return {kUses.begin(), kUses.end()};
    case Setting::kErrorTier: {
      std::vector<std::string> names = all_names(format::kErrorTierNames);
      names.insert(names.begin(), "auto");
      return names;
    }
    case Setting::kPreset: return all_names(builder::kPresetNames);
    case Setting::kAttributes: return all_names(builder::kAttributeChoiceNames);
    case Setting::kCodec: return all_names(format::kWrittenCodecNames);
    case Setting::kStripEffort: return all_names(builder::kStripEffortNames);
    case Setting::kRepair:
    case Setting::kLinearColors:
    case Setting::kKeepTopology:
    case Setting::kLockBorders:
    case Setting::kPageHints: return {"false", "true"};
    case Setting::kPromise: return all_names(format::kPromiseNames);
    case Setting::kKeepLayers: return {"on", "off"};
    case Setting::kPageSize: return {"16", "32", "64", "128"};
    case Setting::kPageOrder: return all_names(builder::kPageOrderNames);
    default: return {};
  }
}

std::string find_fault(Setting setting, std::string_view word) {
  const std::vector<std::string> choices = choices_of(setting);
  if (!choices.empty()) {
    if (std::find(choices.begin(), choices.end(), word) != choices.end()) return {};
    const bool was_written = setting == Setting::kCodec && value_in(format::kCodecNames, word);
    return was_written ? format::not_written(word) : unknown_choice(word, choices);
  }
  switch (setting) {
    case Setting::kKeep:
    case Setting::kDrop: {
      const auto bits = builder::parse_attributes(word);
      return bits ? "" : bits.error().detail;
    }
    case Setting::kGrid:
      return word == "auto" || parse_positive(word) ? "" : wanted("auto or a step above 0 in mesh units", word);
    case Setting::kPositionError:
      return word == "auto" || parse_positive(word) ? "" : wanted("auto or a distance above 0 in mesh units", word);

    case Setting::kAggregate:
      return !word.empty() ? "" : "give masked, never, auto, always, or names of meshes and materials, comma-separated";
    case Setting::kClusterTriangles:
      return parse_cluster_triangles(word) ? "" : wanted("a whole number of triangles from 1 to 256", word);
    case Setting::kGroupClusters:
      return parse_group_clusters(word) ? "" : wanted("a whole number of clusters from 4 to 32", word);
    case Setting::kNormalError: return parse_angle(word) ? "" : wanted("an angle above 0 and up to 180 degrees", word);
    case Setting::kTextures:
      return builder::parse_texture_choice(word)
                 ? ""
                 : wanted("keep, resize:N (1 to 16384), webp, webp:Q (1 to 100) or resize:N,webp:Q", word);
    case Setting::kRootBytes:
      return word == "auto" || parse_root_bytes(word) ? "" : wanted("auto or 16384 to 131072 bytes", word);
    case Setting::kUvError:
      return word == "auto" || parse_uv_error(word)
                 ? ""
                 : wanted("auto, a number above 0 in UV units, or texels as 0.25px", word);
    default: return {};
  }
}

std::string describe_use(const Settled& settled) {
  const std::string& use = settled[Setting::kFor].word;
  if (use == info_of(Setting::kFor).usual) return {};
  std::string text;
  for (const SettingInfo& info : kSettings) {
    const SettledWord& word = settled[info.setting];
    if (word.from == "for " + use) text += (text.empty() ? ": " : ", ") + std::string(info.name) + " " + word.word;
  }
  return "for " + use + (text.empty() ? ": every setting is given" : text);
}

Result<Settled> settle(std::span<const SettingLayer> layers) {
  Settling settling(layers);
  for (const SettingLayer& layer : layers) {
    TRY(settling.add(saying_of(layer)));
    for (const SettingLayer::MeshRule& rule : layer.mesh_rules) {
      Settling alone;
      TRY(alone.add(saying_of(layer, rule)));
    }
  }
  return Settled{options_of(settling.words()), settling.words()};
}

std::vector<std::string> names_of_meshes(const scene::Scene& scene) {
  std::vector<std::string> names;
  for (const scene::SourceMesh& mesh : scene.meshes) names.push_back(mesh.name);
  return names;
}

Result<std::vector<SettledMesh>> settle_meshes(std::span<const SettingLayer> layers,
                                               std::span<const std::string> mesh_names) {
  TRY_LET(whole, settle(layers));
  const bool has_rules =
      std::any_of(layers.begin(), layers.end(), [](const SettingLayer& layer) { return !layer.mesh_rules.empty(); });
  bool is_any = false;
  std::vector<SettledMesh> out;
  for (std::size_t i = 0; has_rules && i < mesh_names.size(); ++i) {
    Settling settling(layers);
    for (const SettingLayer& layer : layers) {
      TRY(settling.add(saying_of(layer)));
      for (const SettingLayer::MeshRule& rule : layer.mesh_rules) {
        if (!is_match(rule.glob, mesh_names[i])) continue;
        is_any = true;
        TRY(settling.add(saying_of(layer, rule)));
      }
    }
    SettledMesh& mesh = out.emplace_back();
    mesh.options = options_of(settling.words());
    for (const SettingInfo& info : kSettings) {
      const SettledWord& word = settling.words()[index_of(info.setting)];
      if (word.word != (*whole)[info.setting].word) mesh.own.emplace_back(info.setting, word);
    }
  }
  if (!is_any) out.clear();
  return out;
}

Status set_mesh_options(std::span<const SettingLayer> layers, std::span<const std::string> mesh_names,
                        builder::PipelineOptions& options) {
  TRY_LET(meshes, settle_meshes(layers, mesh_names));
  options.mesh_options.clear();
  for (const SettledMesh& mesh : *meshes) options.mesh_options.push_back(mesh.options);
  return Ok{};
}

}  // namespace meshlode::app
