// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/batch/cache/store.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <mutex>
#include <string>
#include <string_view>
#include <system_error>
#include <tuple>
#include <utility>

#include "base/output_files.h"
#include "base/try.h"

namespace meshlode::app {

namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, kEntryKindCount> kFolders{"asset", "record", "mesh", "last"};
constexpr const char* kTagName = "CACHEDIR.TAG";
/// What archivers look for (bford.info/cachedir), and what says that the folder is ours.
constexpr std::string_view kTagText =
    "Signature: 8a477f597d28d172789f06886806bc55\n# A cache of meshlode. It may be removed at any time.\n";

/// Behind the bytes of an entry.
struct Trailer {
  std::array<char, 8> magic{'M', 'L', 'C', 'A', 'C', 'H', 'E', '1'};
  std::uint32_t kind = 0, reserved = 0;
  std::uint64_t bytes = 0;
  std::uint64_t also_reserved = 0;
  Hash128 key{}, hash{};
  friend bool operator==(const Trailer&, const Trailer&) = default;
};
static_assert(sizeof(Trailer) == 64);

/// Whether a file of this kind and key is what was kept; then `bytes` are those without the trailer.
bool is_sound(EntryKind kind, const Hash128& key, std::span<const std::uint8_t>& bytes) {
  if (kind == EntryKind::kAsset) return hash128(bytes) == key;
  if (bytes.size() < sizeof(Trailer)) return false;
  Trailer trailer;
  std::memcpy(&trailer, bytes.data() + bytes.size() - sizeof(Trailer), sizeof(Trailer));
  bytes = bytes.first(bytes.size() - sizeof(Trailer));
  Trailer expected;
  expected.kind = static_cast<std::uint32_t>(kind);
  expected.bytes = bytes.size();
  expected.key = key;
  expected.hash = trailer.hash;
  return trailer == expected && hash128(bytes) == trailer.hash;
}

/// Of an entry's path. \pre list_entries() found it
Hash128 key_of(const fs::path& path) {
  const std::string digits = path.parent_path().filename().string() + path.filename().string();
  Hash128 key{};
  for (std::size_t i = 0; i < key.size(); ++i) {
    std::from_chars(digits.data() + 2 * i, digits.data() + 2 * i + 2, key[i], 16);
  }
  return key;
}

bool is_hex(std::string_view name, std::size_t digits) {
  return name.size() == digits && name.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

/// Whether a folder holds nothing, or nothing but what a cache that is just being made holds.
/// The tag of another program's cache is none.
bool has_tag(const fs::path& folder) {
  const auto file = MappedFile::open(folder / kTagName);
  return file &&
         std::ranges::equal(file->bytes(), kTagText, {}, {}, [](char c) { return static_cast<std::uint8_t>(c); });
}

bool may_become_store(const fs::path& folder) {
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (name == kTagName && has_tag(folder)) continue;
    if (!(name.starts_with(".meshlode-") && name.ends_with(".tmp"))) return false;
  }
  return !error;
}

struct StoredFile {
  fs::path path;
  std::uint64_t bytes = 0;
  std::int64_t seconds = 0, nanoseconds = 0;  ///< when it was used last

  [[nodiscard]] bool was_used_before(const StoredFile& other) const {
    return std::tie(seconds, nanoseconds, path.native()) <
           std::tie(other.seconds, other.nanoseconds, other.path.native());
  }
};

bool is_own_folder(const fs::path& folder) {
  std::error_code error;
  return fs::is_directory(fs::symlink_status(folder, error));
}

/// All entries of one kind. Only what has an entry's name is one, and no link leads to it.
void list_entries(const fs::path& folder, std::vector<StoredFile>& files) {
  std::error_code error;
  if (!is_own_folder(folder)) return;
  for (fs::directory_iterator shard(folder, error), end; !error && shard != end; shard.increment(error)) {
    if (!is_hex(shard->path().filename().native(), 2) || !is_own_folder(shard->path())) continue;
    static_cast<void>(OutputFiles().claim(shard->path() / "swept"));  // removes what killed writers left
    std::error_code inner;
    for (fs::directory_iterator it(shard->path(), inner), last; !inner && it != last; it.increment(inner)) {
      struct stat info {};
      if (!is_hex(it->path().filename().native(), 30) || ::lstat(it->path().c_str(), &info) != 0) continue;
      if (!S_ISREG(info.st_mode)) continue;
      files.push_back(
          {it->path(), static_cast<std::uint64_t>(info.st_size), info.st_mtim.tv_sec, info.st_mtim.tv_nsec});
    }
  }
}

}  // namespace

struct Store::Shared {
  std::mutex mutex;
  std::optional<Error> error;
  std::uint64_t kept_bytes = 0;  ///< since the last trim
};

Store::Store(fs::path folder, const StoreOptions& options)
    : folder_(std::move(folder)), options_(options), shared_(std::make_shared<Shared>()) {}

Result<Store> Store::open(const fs::path& folder, const StoreOptions& options) {
  std::error_code error;
  if (!options.is_read_only) fs::create_directories(folder, error);
  if (error) return Error{ErrorCode::kIo, folder.string(), error.message()};
  if (options.is_read_only && !fs::exists(folder, error)) return Store(folder, options);
  if (!fs::is_directory(folder, error)) return Error{ErrorCode::kUsage, folder.string(), "the cache is not a folder"};
  if (has_tag(folder)) return Store(folder, options);
  // The tag is looked for again: somebody else may have made it, and the first entries with it, in the meantime.
  if (!may_become_store(folder) && !has_tag(folder)) {
    return Error{ErrorCode::kUsage, folder.string(), "holds other files and is not a cache; name a folder of its own"};
  }
  if (options.is_read_only) return Store(folder, options);
  const std::span tag(reinterpret_cast<const std::uint8_t*>(kTagText.data()), kTagText.size());
  TRY(write_file_atomically(folder / kTagName, tag));
  return Store(folder, options);
}

fs::path Store::path_of(EntryKind kind, const Hash128& key) const {
  const std::string name = to_hex(key);
  return folder_ / kFolders[static_cast<std::size_t>(kind)] / name.substr(0, 2) / name.substr(2);
}

bool Store::has(EntryKind kind, const Hash128& key) const {
  std::error_code error;
  return fs::is_regular_file(path_of(kind, key), error);
}

std::optional<Store::Entry> Store::find(EntryKind kind, const Hash128& key) const {
  const fs::path path = path_of(kind, key);
  auto file = MappedFile::open(path);
  if (!file) return std::nullopt;
  auto bytes = file->bytes();
  const bool sound = is_sound(kind, key, bytes);
  if (options_.is_read_only) return sound ? std::optional(Entry{std::move(*file), bytes}) : std::nullopt;
  if (!sound) {
    ::unlink(path.c_str());
    return std::nullopt;
  }
  ::utimensat(AT_FDCWD, path.c_str(), nullptr, 0);  // now; what may not be marked is only forgotten sooner
  return Entry{std::move(*file), bytes};
}

void Store::write(const fs::path& path, std::span<const std::uint8_t> bytes) const {
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  const Status status = error ? Status(Error{ErrorCode::kIo, path.parent_path().string(), error.message()})
                              : write_file_atomically(path, bytes);
  bool is_trim_due = false;
  {
    const std::lock_guard lock(shared_->mutex);
    if (!status && !shared_->error) shared_->error = status.error();
    shared_->kept_bytes += bytes.size();
    // A run that goes on for hours must not wait for its end.
    is_trim_due = options_.limit > 0 && shared_->kept_bytes > options_.limit / 8;
    if (is_trim_due) shared_->kept_bytes = 0;
  }
  if (is_trim_due) trim();
}

void Store::keep(EntryKind kind, const Hash128& key, std::vector<std::uint8_t> bytes) const {
  if (options_.is_read_only) return;
  Trailer trailer;
  trailer.kind = static_cast<std::uint32_t>(kind);
  trailer.bytes = bytes.size();
  trailer.key = key;
  trailer.hash = hash128(bytes);
  const auto* end = reinterpret_cast<const std::uint8_t*>(&trailer);
  bytes.insert(bytes.end(), end, end + sizeof(Trailer));
  write(path_of(kind, key), bytes);
}

void Store::keep_asset(const Hash128& hash, std::span<const std::uint8_t> asset) const {
  if (options_.is_read_only || find(EntryKind::kAsset, hash)) return;
  write(path_of(EntryKind::kAsset, hash), asset);
}

void Store::trim() const {
  if (!options_.is_read_only && options_.limit != 0) static_cast<void>(trim_to(options_.limit));
}

Result<EntryCount> Store::trim_to(std::uint64_t limit) const {
  const fs::path lock_path = folder_ / "trim.lock";
  const int lock = ::open(lock_path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (lock < 0) return Error{ErrorCode::kIo, lock_path.string(), std::strerror(errno)};
  if (::flock(lock, LOCK_EX | LOCK_NB) != 0) {
    ::close(lock);
    return Error{ErrorCode::kIo, folder_.string(), "another process is trimming this cache"};
  }
  std::vector<StoredFile> files;
  // Beside the tag nobody writes again who would remove what a killed writer left there.
  static_cast<void>(OutputFiles().claim(folder_ / kTagName));
  for (const char* folder : kFolders) list_entries(folder_ / folder, files);
  std::sort(files.begin(), files.end(), [](const StoredFile& a, const StoredFile& b) { return a.was_used_before(b); });
  std::uint64_t total = 0;
  for (const StoredFile& file : files) total += file.bytes;
  EntryCount removed;
  for (const StoredFile& file : files) {
    if (total <= limit) break;
    // A reader that has it open keeps it; one that comes now builds again.
    if (::unlink(file.path.c_str()) != 0) continue;
    total -= file.bytes;
    ++removed.entries;
    removed.bytes += file.bytes;
  }
  ::close(lock);
  return removed;
}

std::array<EntryCount, kEntryKindCount> Store::count() const {
  std::array<EntryCount, kEntryKindCount> counts;
  for (std::size_t kind = 0; kind < kEntryKindCount; ++kind) {
    std::vector<StoredFile> files;
    list_entries(folder_ / kFolders[kind], files);
    counts[kind].entries = files.size();
    for (const StoredFile& file : files) counts[kind].bytes += file.bytes;
  }
  return counts;
}

Store::Check Store::check() const {
  Check check;
  for (std::size_t kind = 0; kind < kEntryKindCount; ++kind) {
    std::vector<StoredFile> files;
    list_entries(folder_ / kFolders[kind], files);
    for (const StoredFile& stored : files) {
      const auto file = MappedFile::open(stored.path);
      std::error_code error;
      if (!file && !fs::exists(stored.path, error)) continue;  // somebody trimmed it
      ++check.checked.entries;
      check.checked.bytes += stored.bytes;
      std::span<const std::uint8_t> bytes = file ? file->bytes() : std::span<const std::uint8_t>();
      if (file && is_sound(static_cast<EntryKind>(kind), key_of(stored.path), bytes)) continue;
      ++check.broken.entries;
      check.broken.bytes += stored.bytes;
      if (!options_.is_read_only) ::unlink(stored.path.c_str());
    }
  }
  return check;
}

const char* name_of(EntryKind kind) {
  return kFolders[static_cast<std::size_t>(kind)];
}

std::optional<Error> Store::first_error() const {
  const std::lock_guard lock(shared_->mutex);
  return shared_->error;
}

}  // namespace meshlode::app
