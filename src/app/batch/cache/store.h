// SPDX-License-Identifier: GPL-3.0-or-later
// A folder of entries under 128-bit keys, shared by whoever can write there: batches, shards, machines.
//
// An entry is one file, `<kind>/<2 hexadecimal digits>/<30 more>`. It appears whole or not at all (base/output_files.h:
// a locked temporary file, synced, renamed), is never changed, and is hashed again whenever it is taken, so that a
// broken one is removed and counts as not there. Whoever loses a race finds the other's entry or none. Assets are
// stored as they are under the hash of their bytes; other kinds end in a trailer that names kind, key and hash.
//
// The hash is XXH3, which nobody is kept from forging: who may write into a cache is trusted by all who take from it.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <meshlode/result.h>

#include "base/file.h"
#include "base/hash.h"

namespace meshlode::app {

enum class EntryKind : std::uint32_t {
  kAsset,   ///< the bytes of a .lode file; the key is their hash128
  kRecord,  ///< which asset comes of which ingredients (cache/record.h)
  kMesh,    ///< one built mesh (build/mesh_store.h)
  kLast,    ///< the ingredients of what an output held last, to say what changed
};
constexpr std::size_t kEntryKindCount = 4;

[[nodiscard]] const char* name_of(EntryKind kind);

struct EntryCount {
  std::uint64_t entries = 0, bytes = 0;
};

struct StoreOptions {
  std::uint64_t limit = 0;    ///< bytes of all entries together after trim(); 0: none
  bool is_read_only = false;  ///< nothing is written, not even when an entry was last used
};

/// Safe to call from any thread.
class Store {
 public:
  /// Makes the folder where it is missing. Errors: kUsage it holds other things and is no cache; kIo it cannot be made.
  /// A store that is read-only and missing is empty.
  [[nodiscard]] static Result<Store> open(const std::filesystem::path& folder, const StoreOptions& options);

  struct Entry {
    MappedFile file;
    std::span<const std::uint8_t> bytes;  ///< without the trailer
  };
  /// The entry, proved to be what was kept, and marked as used now.
  [[nodiscard]] std::optional<Entry> find(EntryKind kind, const Hash128& key) const;
  /// Whether there is a file for it; find() may say otherwise.
  [[nodiscard]] bool has(EntryKind kind, const Hash128& key) const;

  /// Stores bytes under a key that they are always the same for. What cannot be stored is not: see first_error().
  void keep(EntryKind kind, const Hash128& key, std::vector<std::uint8_t> bytes) const;
  void keep_asset(const Hash128& hash, std::span<const std::uint8_t> asset) const;

  /// Removes the entries that were used longest ago until the rest keeps the limit, and what killed writers left. One
  /// process at a time; others leave it to that one.
  void trim() const;

  /// The same to another limit, of which 0 leaves nothing; what was removed. Errors: kIo, also where another process is
  /// at it. \pre not read-only
  [[nodiscard]] Result<EntryCount> trim_to(std::uint64_t limit) const;

  /// What there is, by kind.
  [[nodiscard]] std::array<EntryCount, kEntryKindCount> count() const;

  struct Check {
    EntryCount checked, broken;
  };
  /// Proves every entry, and removes those that are not what was kept. Does not mark them as used.
  [[nodiscard]] Check check() const;

  /// Why something could not be kept, of the first time.
  [[nodiscard]] std::optional<Error> first_error() const;

 private:
  Store(std::filesystem::path folder, const StoreOptions& options);
  [[nodiscard]] std::filesystem::path path_of(EntryKind kind, const Hash128& key) const;
  void write(const std::filesystem::path& path, std::span<const std::uint8_t> bytes) const;

  struct Shared;  ///< what several threads change
  std::filesystem::path folder_;
  StoreOptions options_;
  std::shared_ptr<Shared> shared_;
};

}  // namespace meshlode::app
