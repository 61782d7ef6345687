// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/batch/jobs/glob.h"

#include <algorithm>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

#include "base/try.h"

namespace meshlode::app {

namespace {

namespace fs = std::filesystem;

/// What follows a set that starts with '[' where it holds `c`, or where it does not. Nothing: the bracket is not
/// closed.
struct SetMatch {
  std::size_t end = 0;
  bool is_in = false;
};
std::optional<SetMatch> match_set(std::string_view pattern, std::size_t at, char c) {
  std::size_t i = at + 1;
  const bool is_negated = i < pattern.size() && (pattern[i] == '!' || pattern[i] == '^');
  if (is_negated) ++i;
  const std::size_t first = i;
  bool is_in = false;
  for (; i < pattern.size() && (pattern[i] != ']' || i == first); ++i) {
    const auto low = static_cast<unsigned char>(pattern[i]);
    auto high = low;
    if (i + 2 < pattern.size() && pattern[i + 1] == '-' && pattern[i + 2] != ']') {
      high = static_cast<unsigned char>(pattern[i + 2]);
      i += 2;
    }
    const auto byte = static_cast<unsigned char>(c);
    is_in = is_in || (low <= byte && byte <= high);
  }
  if (i >= pattern.size()) return std::nullopt;
  return SetMatch{i + 1, is_in != is_negated};
}

/// The end of the one-byte pattern at `at` where it matches c.
std::optional<std::size_t> match_one(std::string_view pattern, std::size_t at, char c) {
  if (pattern[at] == '?') return at + 1;
  if (pattern[at] == '[') {
    if (const auto set = match_set(pattern, at, c)) return set->is_in ? std::optional(set->end) : std::nullopt;
  }
  return pattern[at] == c ? std::optional(at + 1) : std::nullopt;
}

class Walk {
 public:
  Walk(std::vector<std::string> parts, std::set<fs::path>& found) : parts_(std::move(parts)), found_(found) {}

  Status visit(const fs::path& folder, std::size_t part) {
    if (!seen_.insert({folder, part}).second) return Ok{};
    if (parts_[part] == "**") {
      if (Status done = visit(folder, part + 1); !done) return done;
    }
    std::error_code error;
    const fs::path listed = folder.empty() ? fs::path(".") : folder;
    for (fs::directory_iterator it(listed, error), end; !error && it != end; it.increment(error)) {
      if (Status done = visit_entry(folder / it->path().filename(), part); !done) return done;
    }
    if (error && error != std::errc::no_such_file_or_directory && error != std::errc::not_a_directory) {
      return Error{ErrorCode::kIo, listed.string(), error.message()};
    }
    return Ok{};
  }

 private:
  Status visit_entry(const fs::path& path, std::size_t part) {
    std::error_code ignored;
    const std::string name = path.filename().string();
    if (parts_[part] == "**") {
      const bool is_hidden = name.starts_with('.');
      if (is_hidden || fs::is_symlink(path, ignored) || !fs::is_directory(path, ignored)) return Ok{};
      return visit(path, part);
    }
    if (!matches_name(parts_[part], name)) return Ok{};
    if (part + 1 < parts_.size()) return fs::is_directory(path, ignored) ? visit(path, part + 1) : Status(Ok{});
    if (fs::is_regular_file(path, ignored)) found_.insert(path);
    return Ok{};
  }

  std::vector<std::string> parts_;
  std::set<fs::path>& found_;
  std::set<std::pair<fs::path, std::size_t>> seen_;
};

}  // namespace

bool has_wildcards(std::string_view text) {
  return text.find_first_of("*?[") != std::string_view::npos;
}

bool matches_name(std::string_view pattern, std::string_view name) {
  if (name.starts_with('.') && !pattern.starts_with('.')) return false;
  // After a mismatch only the last star needs to take one byte more: what it took before could not have ended sooner.
  std::size_t p = 0, n = 0, star = std::string_view::npos, star_name = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = ++p;
      star_name = n;
      continue;
    }
    const auto next = p < pattern.size() ? match_one(pattern, p, name[n]) : std::nullopt;
    if (next) {
      p = *next;
      ++n;
    } else if (star != std::string_view::npos) {
      p = star;
      n = ++star_name;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

Result<GlobMatches> find_matches(const std::string& pattern) {
  GlobMatches out;
  std::vector<std::string> parts;
  for (const fs::path& part : fs::path(pattern)) {
    const std::string text = part.string();
    if (parts.empty() && !has_wildcards(text)) {
      out.base /= part;
    } else if (!text.empty() && !(text == "**" && !parts.empty() && parts.back() == "**")) {
      parts.push_back(text);
    }
  }
  if (parts.empty()) return out;
  if (parts.back() == "**") parts.emplace_back("*");
  std::set<fs::path> found;
  TRY(Walk(std::move(parts), found).visit(out.base, 0));
  out.files.assign(found.begin(), found.end());
  std::sort(out.files.begin(), out.files.end(),
            [](const fs::path& a, const fs::path& b) { return a.native() < b.native(); });
  return out;
}

}  // namespace meshlode::app
