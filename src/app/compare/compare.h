// SPDX-License-Identifier: GPL-3.0-or-later
// What `meshlode compare OLD NEW` says: two assets side by side, as data, as JSON and as text. The JSON's keys are a
// promise (docs/schemas/compare.schema.json, docs/reference/compare.md).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/budget/judge_budget.h"
#include "app/compare/documents.h"
#include "app/compare/pictures.h"
#include "app/report/info.h"
#include "run/read/asset.h"

namespace meshlode::app {

/// One number of both assets; a side that does not have it has nothing.
struct Change {
  enum class Kind : std::uint8_t { kCount, kFloat, kDouble };
  const char* name = "";  ///< the JSON's key
  std::optional<double> before = std::nullopt, after = std::nullopt;
  Kind kind = Kind::kCount;
  bool is_comparable = true;  ///< both mean the same

  [[nodiscard]] bool is_equal() const { return before == after; }
  /// new - old; nothing where a side is missing, or one alone is infinite, or they are not comparable.
  [[nodiscard]] std::optional<double> difference() const;
  /// new / old, 1 where they are equal; nothing where a side is missing, or the old one is 0 or infinite, or they are
  /// not comparable.
  [[nodiscard]] std::optional<double> ratio() const;
};

struct Side {
  std::string file;  ///< as the caller calls it
  std::string content_hash, generator, source_file, source_hash;
  std::uint32_t format_version = 0;
};

struct LevelChange {
  std::uint32_t level = 0;
  std::vector<Change> changes;
};

/// An entry of both assets; the names differ where it was matched by its index.
struct EntryPair {
  std::string old_name, new_name;
  std::uint32_t old_index = 0, new_index = 0;
};

/// Errors of different tiers are other things: a proven bound, the largest distance found, a guess by quadrics. Which
/// is larger says nothing about which asset is more accurate.
struct TierChange {
  format::ErrorTier before{}, after{};
  [[nodiscard]] bool is_comparable() const { return before == after; }
};

struct MeshChange {
  EntryPair mesh;
  TierChange tier;
  std::vector<Change> changes;
  std::vector<LevelChange> levels;
};

struct SectionChange {
  std::string name;
  std::vector<Change> changes;
};

struct OneSided {
  std::string name;
  std::uint32_t index = 0;
};

/// A list whose entries have no numbers to compare.
struct ListChange {
  struct Entry {
    EntryPair entry;
    std::vector<std::string> what;  ///< the members that differ
  };
  std::vector<Entry> changed;
  std::vector<OneSided> removed, added;
};

/// What FLIP's paper pools a picture of differences into (lab/flip/flip.h), each 0 to 1.
struct FlipFigures {
  double mean = 0.0, weighted_median = 0.0, max = 0.0;
};

/// PNG files below the folder of `compare -O`.
struct PictureFiles {
  std::string before, after, flip;
};

struct PictureChange {
  std::uint32_t camera = 1;  ///< in the order in which they were given
  std::uint32_t width = 0, height = 0;
  double pixel_error = 0.0;
  std::vector<Change> changes;  ///< triangles and clusters of the cuts
  PictureDifference difference;
  FlipFigures flip;
  std::optional<PictureFiles> files;
};

struct AssetComparison {
  Side before, after;
  bool is_content_equal = false, is_source_equal = false;
  std::vector<Change> sizes, totals, dropped;
  std::vector<SettingChange> settings;
  std::vector<MeshChange> meshes;  ///< matched: by name, then by index (match_by_name)
  std::vector<OneSided> meshes_removed, meshes_added;
  ListChange materials, images;
  std::vector<SectionChange> sections;
  std::vector<PictureChange> pictures;  ///< left to the caller: it takes drawing both
};

/// Nothing of an asset's pages is looked at but their sizes.
[[nodiscard]] AssetComparison compare_assets(const run::Asset& before, const run::Asset& after);

/// `broken`: what a budget found in this very document.
[[nodiscard]] std::string comparison_json(const AssetComparison& comparison,
                                          const std::vector<BrokenCondition>& broken = {});
[[nodiscard]] std::string comparison_text(const AssetComparison& comparison);

/// The largest of each; nothing where there is no picture.
[[nodiscard]] std::optional<FlipFigures> worst_flip(const std::vector<PictureChange>& pictures);
[[nodiscard]] std::string pictures_text(const std::vector<PictureChange>& pictures);

/// `compare --golden`: one asset against the pictures that were stored of it.
struct MissingPicture {
  std::uint32_t camera = 0;  ///< in the order of --camera, from 1
  std::string reason;        ///< with the path
};
struct GoldenComparison {
  std::string file;
  bool is_updated = false;  ///< the pictures were written, nothing was compared
  std::vector<PictureChange> pictures;
  std::vector<MissingPicture> missing;  ///< stored pictures that could not be compared
};
/// docs/schemas/golden.schema.json.
[[nodiscard]] std::string golden_json(const GoldenComparison& comparison,
                                      const std::vector<BrokenCondition>& broken = {});
/// "not comparable in 2 of 3 meshes: …"; empty where all are.
[[nodiscard]] std::string tiers_text(const AssetComparison& comparison);

}  // namespace meshlode::app
