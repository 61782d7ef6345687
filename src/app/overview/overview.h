// SPDX-License-Identifier: GPL-3.0-or-later
// What `meshlode report` shows of a batch: its manifest, what the assets themselves say, and an older manifest to
// compare with. Names and messages come from files: each form of it escapes them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "app/batch/shard/read_manifest.h"
#include "app/doctor/diagnosis.h"
#include "run/read/asset.h"

namespace meshlode::app {

/// What the bytes of an asset are spent on. Those of pages are shared out as their decoded bits are; the last has what
/// no other has, so that the sum is the file.
inline constexpr std::array kOverviewStreams{"positions",  "normals", "uvs",    "colors", "topology",
                                             "page heads", "tables",  "images", "other"};

struct OverviewFinding {
  std::string id, severity;  ///< "high", "medium" or "low"; "warning" of the build
  std::string text;
};

struct OverviewAsset {
  JobResult result;
  std::optional<std::uint64_t> old_bytes;  ///< of the older manifest's asset of this output, where it had one
  std::string unread;                      ///< why the asset says nothing here; empty: it does
  std::uint64_t triangles = 0, stuck_groups = 0;
  std::optional<std::uint64_t> pixel_triangles;  ///< of the cut that `render` draws by its defaults
  std::vector<std::uint8_t> thumbnail;           ///< WebP; empty: there is none
  std::string thumbnail_note;                    ///< what the thumbnail lacks, or why there is none
  std::array<std::uint64_t, kOverviewStreams.size()> streams{};
  std::vector<OverviewFinding> findings;  ///< worst first

  /// Where there is an asset, and one to compare it with.
  [[nodiscard]] std::optional<std::int64_t> growth() const;
};

struct GoneAsset {
  std::string output;
  std::uint64_t bytes = 0;
};

struct Overview {
  std::string generator;
  Versions versions;
  bool is_complete = true, has_old = false;
  int exit_code = 0;
  std::vector<OverviewAsset> assets;  ///< in the order of the manifest
  std::vector<GoneAsset> gone;        ///< of the older manifest, which this one has not

  [[nodiscard]] std::size_t count(JobStatus status) const;
  [[nodiscard]] std::size_t count(CacheUse use) const;
  [[nodiscard]] std::size_t count_findings(const std::string& severity) const;
  [[nodiscard]] std::uint64_t bytes() const;
  [[nodiscard]] std::uint64_t triangles() const;
  [[nodiscard]] std::uint64_t pixel_triangles() const;  ///< of those that are known
  [[nodiscard]] std::uint64_t old_bytes() const;
  /// Assets whose bytes changed, the largest change first: growth before shrinkage of the same size.
  [[nodiscard]] std::vector<const OverviewAsset*> changed() const;
};

/// Adds what the caller alone can find: the cut's triangles and the thumbnail to a row, more to an asset's diagnoses.
/// Called from several threads at once.
using LookAtAsset = std::function<void(const run::Asset& asset, OverviewAsset& row, std::vector<Diagnosis>& diagnoses)>;

/// Reads each asset where the manifest says that it is, at most `at_once` at a time; one that is not there, or has
/// other bytes, is `unread`.
[[nodiscard]] Overview make_overview(Manifest manifest, const Manifest* old, const LookAtAsset& look,
                                     std::size_t at_once);

/// A page for a browser, of its own: data as JSON, rows made as they are scrolled to. `folder`: where it will lie, for
/// its links to scenes and assets; relative to the current one.
[[nodiscard]] std::string batch_page(const Overview& overview, const std::string& title, const std::string& folder);
/// For a merge request: counts, the ten largest changes, failures.
[[nodiscard]] std::string overview_markdown(const Overview& overview);
/// SARIF 2.1.0: failures as errors, warnings and findings by their severity.
[[nodiscard]] std::string overview_sarif(const Overview& overview);
/// The same as workflow commands, a line each ("::error file=…::…").
[[nodiscard]] std::string overview_annotations(const Overview& overview);

/// A failure, a warning or a finding as build servers list them.
struct Remark {
  enum class Level : std::uint8_t { kError, kWarning, kNote };
  Level level = Level::kNote;
  std::string id, file, text;
};
/// In the order of the assets: why one failed or was skipped first, of its scene; then what was found.
[[nodiscard]] std::vector<Remark> list_remarks(const Overview& overview);

/// A path as a URI reference: bytes that may not stand there are percent-encoded, and no part of it is a scheme.
[[nodiscard]] std::string uri_of(const std::string& path);

}  // namespace meshlode::app
