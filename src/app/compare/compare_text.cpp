// SPDX-License-Identifier: GPL-3.0-or-later
// `compare` for people: what differs, in one table; what is equal is not listed.
#include <cmath>

#include "app/compare/compare.h"
#include "base/append_format.h"
#include "base/printable.h"
#include "format/names.h"

namespace meshlode::app {

namespace {

constexpr std::size_t kMaxDifferences = 40;  ///< of each list: a city has thousands; JSON lists all

std::string number_text(const std::optional<double>& number, Change::Kind kind) {
  if (!number) return "-";
  if (kind == Change::Kind::kCount && std::abs(*number) < 0x1p53) {
    return (*number < 0.0 ? "-" : "") + grouped_digits(static_cast<std::uint64_t>(std::abs(*number)));
  }
  // Figures of what was built are finite: the format writes infinity for those that nobody took.
  if (*number >= static_cast<double>(format::kInfiniteError)) return "not measured";
  std::string text;
  append_format(text, "%.6g", *number);
  return text;
}

/// One line, or none where both sides are equal. \returns whether there is one
bool add_row(std::string& out, const std::string& name, const Change& change) {
  if (change.is_equal()) return false;
  const auto difference = change.difference();
  std::string signed_text = number_text(difference, change.kind);
  if (difference && *difference > 0.0) signed_text = "+" + signed_text;
  append_format(out, "  %-29s %13s %13s %12s", name.c_str(), number_text(change.before, change.kind).c_str(),
                number_text(change.after, change.kind).c_str(), signed_text.c_str());
  if (const auto ratio = change.ratio()) {
    append_format(out, " %7.4f\n", *ratio);
  } else {
    append_format(out, " %7s\n", "-");
  }
  return true;
}

/// The rows that differ below a heading; nothing where none does.
void add_rows(std::string& out, const std::string& heading, const std::string& rows) {
  if (!rows.empty()) out += heading + "\n" + rows;
}

std::string rows_of(const std::string& prefix, const std::vector<Change>& changes) {
  std::string rows;
  for (const Change& change : changes) add_row(rows, prefix + change.name, change);
  return rows;
}

void add_more_differences(std::string& out, std::size_t total, const char* what) {
  if (total > kMaxDifferences)
    append_format(out, "  … and %zu more %s (--format json lists all)\n", total - kMaxDifferences, what);
}

std::string pair_text(const EntryPair& pair) {
  const std::string name = std::to_string(pair.new_index) + "  " + printable(pair.new_name);
  return pair.old_name == pair.new_name ? name : name + ", formerly " + printable(pair.old_name);
}

void add_one_sided(std::string& rows, const char* word, const std::vector<OneSided>& entries) {
  for (std::size_t i = 0; i < entries.size() && i < kMaxDifferences; ++i) {
    append_format(rows, "  %s: %u  %s\n", word, entries[i].index, printable(entries[i].name).c_str());
  }
  add_more_differences(rows, entries.size(), word);
}

void add_settings(std::string& out, const std::vector<SettingChange>& settings) {
  std::string rows;
  for (std::size_t i = 0; i < settings.size() && i < kMaxDifferences; ++i) {
    append_format(rows, "  %-29s %s -> %s\n", printable(settings[i].key, 32).c_str(),
                  printable(settings[i].before, 160).c_str(), printable(settings[i].after, 160).c_str());
  }
  add_more_differences(rows, settings.size(), "settings");
  add_rows(out, "\nsettings", rows);
}

void add_meshes(std::string& out, const AssetComparison& comparison) {
  std::size_t shown = 0;
  for (const MeshChange& mesh : comparison.meshes) {
    std::string rows = rows_of("", mesh.changes);
    for (const LevelChange& level : mesh.levels) {
      rows += rows_of("level " + std::to_string(level.level) + " ", level.changes);
    }
    if (!rows.empty() && shown++ < kMaxDifferences) add_rows(out, "\nmesh " + pair_text(mesh.mesh), rows);
  }
  add_more_differences(out, shown, "meshes that differ");
  std::string rows;
  std::size_t renamed = 0;
  for (const MeshChange& mesh : comparison.meshes) {
    if (mesh.mesh.old_name == mesh.mesh.new_name) continue;
    if (renamed++ < kMaxDifferences) rows += "  renamed: " + pair_text(mesh.mesh) + "\n";
  }
  add_more_differences(rows, renamed, "renamed");
  add_one_sided(rows, "added", comparison.meshes_added);
  add_one_sided(rows, "removed", comparison.meshes_removed);
  add_rows(out, "\nmeshes", rows);
}

void add_list(std::string& out, const char* heading, const ListChange& list) {
  std::string rows;
  for (std::size_t i = 0; i < list.changed.size() && i < kMaxDifferences; ++i) {
    const ListChange::Entry& entry = list.changed[i];
    std::string what;
    for (const std::string& member : entry.what) what += (what.empty() ? "" : ", ") + printable(member, 40);
    rows += "  changed: " + pair_text(entry.entry) + ": " + printable(what, 200) + "\n";
  }
  add_more_differences(rows, list.changed.size(), "changed");
  add_one_sided(rows, "added", list.added);
  add_one_sided(rows, "removed", list.removed);
  add_rows(out, heading, rows);
}

void add_picture(std::string& out, const PictureChange& picture, bool is_one_of_many) {
  const std::string camera = is_one_of_many ? " of camera " + std::to_string(picture.camera) + "," : "";
  append_format(out, "\npicture%s %ux%u at a pixel error of %g\n", camera.c_str(), picture.width, picture.height,
                picture.pixel_error);
  out += rows_of("", picture.changes);
  const PictureDifference& difference = picture.difference;
  if (!difference.psnr) {
    out += "  equal in every pixel\n";
    return;
  }
  append_format(out, "  PSNR %.2f dB; %s of %s pixels differ (%.3f%%), a channel by %u of 255 at most\n",
                *difference.psnr, grouped_digits(difference.differing_pixels).c_str(),
                grouped_digits(difference.pixels).c_str(), 100.0 * difference.differing_share(),
                difference.max_difference);
  append_format(out, "  FLIP mean %.4f, weighted median %.4f, max %.4f\n", picture.flip.mean,
                picture.flip.weighted_median, picture.flip.max);
}

/// "content     equal" or both texts.
void add_text_row(std::string& out, const char* name, const std::string& before, const std::string& after,
                  bool is_equal) {
  append_format(out, "%-10s", name);
  if (is_equal) {
    append_format(out, "equal: %s\n", printable(after, 120).c_str());
  } else {
    append_format(out, "%s -> %s\n", printable(before, 120).c_str(), printable(after, 120).c_str());
  }
}

}  // namespace

std::string tiers_text(const AssetComparison& comparison) {
  std::size_t count = 0;
  const MeshChange* first = nullptr;
  for (const MeshChange& mesh : comparison.meshes) {
    if (mesh.tier.is_comparable()) continue;
    if (first == nullptr) first = &mesh;
    ++count;
  }
  if (first == nullptr) return {};
  std::string text;
  append_format(text, "not comparable in %zu of %zu meshes: their error tiers differ (%s -> %s)", count,
                comparison.meshes.size(), format::name_of(first->tier.before), format::name_of(first->tier.after));
  return text;
}

std::string comparison_text(const AssetComparison& comparison) {
  const Side& before = comparison.before;
  const Side& after = comparison.after;
  std::string out;
  append_format(out, "old       %s\nnew       %s\n", printable(before.file, 200).c_str(),
                printable(after.file, 200).c_str());
  add_text_row(out, "content", before.content_hash, after.content_hash, comparison.is_content_equal);
  add_text_row(out, "source", before.source_file + " " + before.source_hash,
               after.source_file + " " + after.source_hash, comparison.is_source_equal);
  if (before.generator != after.generator) add_text_row(out, "program", before.generator, after.generator, false);

  if (const std::string tiers = tiers_text(comparison); !tiers.empty()) {
    append_format(out, "%-10s%s\n", "errors", tiers.c_str());
  }

  std::string rows =
      rows_of("", comparison.sizes) + rows_of("", comparison.totals) + rows_of("dropped ", comparison.dropped);
  for (const SectionChange& section : comparison.sections) rows += rows_of(section.name + " ", section.changes);
  std::string body;
  std::string head;
  append_format(head, "\n  %-29s %13s %13s %12s %7s", "", "old", "new", "change", "ratio");
  add_rows(body, head, rows);
  add_settings(body, comparison.settings);
  add_meshes(body, comparison);
  add_list(body, "\nmaterials", comparison.materials);
  add_list(body, "\nimages", comparison.images);
  if (body.empty()) {
    body = "\nno number differs, nor a name, a setting, a material or an image";
    body += comparison.is_content_equal ? "\n" : ": what differs is not in these tables (vertices, groups, promises)\n";
  }
  out += body;
  return out + pictures_text(comparison.pictures);
}

std::string pictures_text(const std::vector<PictureChange>& pictures) {
  std::string out;
  for (const PictureChange& picture : pictures) add_picture(out, picture, pictures.size() > 1);
  return out;
}

}  // namespace meshlode::app
