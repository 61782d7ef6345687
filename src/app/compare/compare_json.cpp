// SPDX-License-Identifier: GPL-3.0-or-later
// `compare --format json`: the keys here are a promise; docs/schemas/compare.schema.json lists them.
#include <algorithm>
#include <cmath>

#include "app/compare/compare.h"
#include "base/json_writer.h"
#include "format/names.h"

namespace meshlode::app {

namespace {

void write_number(JsonWriter& w, const std::optional<double>& number, Change::Kind kind) {
  if (!number) {
    w.null();
  } else if (kind == Change::Kind::kFloat) {
    w.value(static_cast<float>(*number));
  } else if (kind == Change::Kind::kCount && std::abs(*number) < 0x1p53) {
    w.value(static_cast<std::int64_t>(*number));
  } else {
    w.value(*number);
  }
}

void write_change(JsonWriter& w, const Change& change) {
  w.key(change.name);
  w.begin_object();
  w.key("old");
  write_number(w, change.before, change.kind);
  w.key("new");
  write_number(w, change.after, change.kind);
  w.key("change");
  write_number(w, change.difference(), change.kind);
  w.key("ratio");
  write_number(w, change.ratio(), Change::Kind::kDouble);
  w.end_object();
}

void write_changes(JsonWriter& w, const std::vector<Change>& changes) {
  for (const Change& change : changes) write_change(w, change);
}

void write_side(JsonWriter& w, const char* key, const Side& side) {
  w.key(key);
  w.begin_object();
  w.field("file", side.file);
  w.field("format_version", side.format_version);
  w.field("content_hash", side.content_hash);
  w.field("generator", side.generator);
  w.field("source_file", side.source_file);
  w.field("source_hash", side.source_hash);
  w.end_object();
}

void write_pair(JsonWriter& w, const EntryPair& pair) {
  w.field("name", pair.new_name);
  w.field("old_name", pair.old_name);
  w.field("index", pair.new_index);
  w.field("old_index", pair.old_index);
}

void write_one_sided(JsonWriter& w, const std::string& key, const std::vector<OneSided>& entries) {
  w.key(key);
  w.begin_array();
  for (const OneSided& entry : entries) {
    w.begin_object();
    w.field("name", entry.name);
    w.field("index", entry.index);
    w.end_object();
  }
  w.end_array();
}

void write_list(JsonWriter& w, const std::string& key, const ListChange& list) {
  w.key(key + "_changed");
  w.begin_array();
  for (const ListChange::Entry& entry : list.changed) {
    w.begin_object();
    write_pair(w, entry.entry);
    w.key("what");
    w.begin_array();
    for (const std::string& what : entry.what) w.value(what);
    w.end_array();
    w.end_object();
  }
  w.end_array();
  write_one_sided(w, key + "_added", list.added);
  write_one_sided(w, key + "_removed", list.removed);
}

void write_meshes(JsonWriter& w, const AssetComparison& comparison) {
  w.key("meshes");
  w.begin_array();
  for (const MeshChange& mesh : comparison.meshes) {
    w.begin_object();
    write_pair(w, mesh.mesh);
    w.key("error_tier");
    w.begin_object();
    w.field("old", format::name_of(mesh.tier.before));
    w.field("new", format::name_of(mesh.tier.after));
    w.field("comparable", mesh.tier.is_comparable());
    w.end_object();
    write_changes(w, mesh.changes);
    w.key("by_level");
    w.begin_array();
    for (const LevelChange& level : mesh.levels) {
      w.begin_object();
      w.field("level", level.level);
      write_changes(w, level.changes);
      w.end_object();
    }
    w.end_array();
    w.end_object();
  }
  w.end_array();
  write_one_sided(w, "meshes_added", comparison.meshes_added);
  write_one_sided(w, "meshes_removed", comparison.meshes_removed);
}

void write_flip(JsonWriter& w, const std::optional<FlipFigures>& flip) {
  w.key("flip");
  if (!flip) return w.null();
  w.begin_object();
  w.field("mean", flip->mean);
  w.field("weighted_median", flip->weighted_median);
  w.field("max", flip->max);
  w.end_object();
}

void write_picture(JsonWriter& w, const PictureChange& picture) {
  w.begin_object();
  w.field("camera", picture.camera);
  w.field("width", picture.width);
  w.field("height", picture.height);
  w.field("pixel_error", picture.pixel_error);
  write_changes(w, picture.changes);
  w.key("psnr");
  if (picture.difference.psnr) {
    w.value(*picture.difference.psnr);
  } else {
    w.null();
  }
  w.field("differing_pixels", picture.difference.differing_pixels);
  w.field("differing_share", picture.difference.differing_share());
  w.field("max_difference", picture.difference.max_difference);
  write_flip(w, picture.flip);
  w.key("files");
  if (picture.files) {
    w.begin_object();
    w.field("old", picture.files->before);
    w.field("new", picture.files->after);
    w.field("flip", picture.files->flip);
    w.end_object();
  } else {
    w.null();
  }
  w.end_object();
}

void write_pictures(JsonWriter& w, const std::vector<PictureChange>& pictures) {
  w.key("pictures");
  w.begin_array();
  for (const PictureChange& picture : pictures) write_picture(w, picture);
  w.end_array();
  write_flip(w, worst_flip(pictures));
}

void write_broken(JsonWriter& w, const std::vector<BrokenCondition>& broken) {
  w.key("failed");
  w.begin_array();
  for (const BrokenCondition& one : broken) {
    w.begin_object();
    w.field("condition", one.condition);
    w.field("where", one.where);
    w.field("name", one.name);
    w.key("value");
    w.raw(one.value);
    w.field("others", one.others);
    w.end_object();
  }
  w.end_array();
}

}  // namespace

std::optional<FlipFigures> worst_flip(const std::vector<PictureChange>& pictures) {
  if (pictures.empty()) return std::nullopt;
  FlipFigures worst;
  for (const PictureChange& picture : pictures) {
    worst.mean = std::max(worst.mean, picture.flip.mean);
    worst.weighted_median = std::max(worst.weighted_median, picture.flip.weighted_median);
    worst.max = std::max(worst.max, picture.flip.max);
  }
  return worst;
}

std::string golden_json(const GoldenComparison& comparison, const std::vector<BrokenCondition>& broken) {
  JsonWriter w;
  w.begin_object();
  w.field("file", comparison.file);
  w.field("updated", comparison.is_updated);
  write_pictures(w, comparison.pictures);
  w.key("missing");
  w.begin_array();
  for (const MissingPicture& missing : comparison.missing) {
    w.begin_object();
    w.field("camera", missing.camera);
    w.field("reason", missing.reason);
    w.end_object();
  }
  w.end_array();
  write_broken(w, broken);
  w.end_object();
  return w.text();
}

std::string comparison_json(const AssetComparison& comparison, const std::vector<BrokenCondition>& broken) {
  JsonWriter w;
  w.begin_object();
  write_side(w, "old", comparison.before);
  write_side(w, "new", comparison.after);
  w.field("content_equal", comparison.is_content_equal);
  w.field("source_equal", comparison.is_source_equal);
  write_changes(w, comparison.sizes);
  w.key("totals");
  w.begin_object();
  write_changes(w, comparison.totals);
  w.end_object();
  w.key("dropped");
  w.begin_object();
  write_changes(w, comparison.dropped);
  w.end_object();
  w.key("settings");
  w.begin_array();
  for (const SettingChange& setting : comparison.settings) {
    w.begin_object();
    w.field("key", setting.key);
    w.key("old");
    w.raw(setting.before);
    w.key("new");
    w.raw(setting.after);
    w.end_object();
  }
  w.end_array();
  write_meshes(w, comparison);
  write_list(w, "materials", comparison.materials);
  write_list(w, "images", comparison.images);
  w.key("sections");
  w.begin_array();
  for (const SectionChange& section : comparison.sections) {
    w.begin_object();
    w.field("name", section.name);
    write_changes(w, section.changes);
    w.end_object();
  }
  w.end_array();
  w.key("picture");
  if (comparison.pictures.empty()) {
    w.null();
  } else {
    write_picture(w, comparison.pictures.front());
  }
  write_pictures(w, comparison.pictures);
  write_broken(w, broken);
  w.end_object();
  return w.text();
}

}  // namespace meshlode::app
