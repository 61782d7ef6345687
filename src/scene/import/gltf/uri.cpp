// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/gltf/uri.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <iterator>
#include <optional>
#include <system_error>

#include "base/printable.h"
#include "base/try.h"
#include "base/utf8.h"

namespace meshlode::scene {

namespace {

Error invalid_uri(std::string detail) {
  return {ErrorCode::kInvalid, "", std::move(detail)};
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

constexpr std::array<std::int8_t, 256> make_base64_table() {
  std::array<std::int8_t, 256> table{};
  for (auto& entry : table) entry = -1;
  constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::size_t i = 0; i < kAlphabet.size(); ++i) {
    table[static_cast<unsigned char>(kAlphabet[i])] = static_cast<std::int8_t>(i);
  }
  return table;
}
constexpr std::array<std::int8_t, 256> kBase64 = make_base64_table();

/// RFC 3986 section 3.1: letter (letter / digit / + - .)* ':' before any '/'.
bool has_scheme(std::string_view uri) {
  const std::size_t colon = uri.find(':');
  if (colon == std::string_view::npos || colon == 0 || uri.find('/') < colon) return false;
  if (std::isalpha(static_cast<unsigned char>(uri[0])) == 0) return false;
  return std::all_of(uri.begin(), uri.begin() + static_cast<std::ptrdiff_t>(colon), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '+' || c == '-' || c == '.';
  });
}

/// Whether the head of a data URI ends in ";base64", in letters of either case.
bool is_base64(std::string_view header) {
  constexpr std::string_view kSuffix = ";base64";
  return header.size() >= kSuffix.size() &&
         std::equal(kSuffix.begin(), kSuffix.end(), header.end() - static_cast<std::ptrdiff_t>(kSuffix.size()),
                    [](char a, char b) { return a == std::tolower(static_cast<unsigned char>(b)); });
}

/// Percent-encoded bytes, which may be anything, NUL too.
Result<std::vector<std::uint8_t>> percent_decode_bytes(std::string_view body) {
  std::vector<std::uint8_t> out;
  out.reserve(body.size());
  for (std::size_t i = 0; i < body.size(); ++i) {
    if (body[i] != '%') {
      out.push_back(static_cast<std::uint8_t>(body[i]));
      continue;
    }
    const int high = i + 2 < body.size() ? hex_digit(body[i + 1]) : -1;
    const int low = i + 2 < body.size() ? hex_digit(body[i + 2]) : -1;
    if (high < 0 || low < 0) return invalid_uri("a broken percent escape in a data URI");
    out.push_back(static_cast<std::uint8_t>(high * 16 + low));
    i += 2;
  }
  return out;
}

bool is_below(const std::filesystem::path& folder, const std::filesystem::path& file) {
  auto f = folder.begin();
  auto p = file.begin();
  for (; f != folder.end(); ++f, ++p) {
    if (f->empty()) break;  // a trailing slash
    if (p == file.end() || *p != *f) return false;
  }
  return p != file.end();
}

constexpr std::string_view kFileScheme = "file:";

bool is_file_uri(std::string_view uri) {
  return uri.size() >= kFileScheme.size() &&
         std::equal(kFileScheme.begin(), kFileScheme.end(), uri.begin(),
                    [](char a, char b) { return a == std::tolower(static_cast<unsigned char>(b)); });
}

/// A name of the file's for a terminal: what is decoded from it may be any bytes.
std::string shown_name(std::string_view name) {
  return printable(as_utf8(name.substr(0, 200)), std::string::npos);
}

}  // namespace

bool is_data_uri(std::string_view uri) {
  constexpr std::string_view kPrefix = "data:";
  return uri.size() >= kPrefix.size() && std::equal(kPrefix.begin(), kPrefix.end(), uri.begin(), [](char a, char b) {
           return a == std::tolower(static_cast<unsigned char>(b));
         });
}

Result<std::vector<std::uint8_t>> base64_decode(std::string_view text) {
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  if (text.size() % 4 == 1) return invalid_uri("base64 of an impossible length");
  std::vector<std::uint8_t> out;
  out.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  unsigned bit_count = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::int8_t digit = kBase64[static_cast<unsigned char>(text[i])];
    if (digit < 0) return invalid_uri("a character that is not base64, at " + std::to_string(i));
    bits = (bits << 6U) | static_cast<std::uint32_t>(digit);
    bit_count += 6;
    if (bit_count >= 8) {
      bit_count -= 8;
      out.push_back(static_cast<std::uint8_t>(bits >> bit_count));
      bits &= (1U << bit_count) - 1U;
    }
  }
  return out;
}

Result<std::string> percent_decode(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    char c = text[i];
    if (c == '%') {
      const int high = i + 2 < text.size() ? hex_digit(text[i + 1]) : -1;
      const int low = i + 2 < text.size() ? hex_digit(text[i + 2]) : -1;
      if (high < 0 || low < 0) return invalid_uri("a broken percent escape in a URI");
      c = static_cast<char>(high * 16 + low);
      i += 2;
    }
    if (c == '\0') return invalid_uri("a NUL byte in a URI");
    out.push_back(c);
  }
  return out;
}

Result<DataUri> decode_data_uri(std::string_view uri) {
  const std::size_t comma = uri.find(',');
  if (comma == std::string_view::npos) return invalid_uri("a data URI without a comma");
  std::string_view header = uri.substr(5, comma - 5);
  std::string_view body = uri.substr(comma + 1);
  DataUri out;
  out.mime_type = std::string(header.substr(0, header.find(';')));
  if (!is_base64(header)) {
    TRY_LET(bytes, percent_decode_bytes(body));
    out.bytes = std::move(*bytes);
    return out;
  }
  // "=" and "+" may be escaped, and whoever wraps lines puts breaks between the characters.
  std::string plain;
  if (body.find_first_of("% \t\r\n") != std::string_view::npos) {
    TRY_LET(unescaped, percent_decode_bytes(body));
    std::copy_if(unescaped->begin(), unescaped->end(), std::back_inserter(plain),
                 [](std::uint8_t c) { return c != ' ' && c != '\t' && c != '\r' && c != '\n'; });
    body = plain;
  }
  TRY_LET(bytes, base64_decode(body));
  out.bytes = std::move(*bytes);
  return out;
}

std::vector<std::string> paths_of_uri(std::string_view uri) {
  std::vector<std::string> out;
  const auto add = [&](std::string path) {
    if (!path.empty() && std::find(out.begin(), out.end(), path) == out.end()) out.push_back(std::move(path));
  };
  std::string_view text = uri;
  if (has_scheme(uri)) {
    if (!is_file_uri(uri)) return out;
    text.remove_prefix(kFileScheme.size());
    if (text.starts_with("//")) text.remove_prefix(std::min(text.find('/', 2), text.size()));  // file://host/path
    if (!text.starts_with('/')) return out;
  }
  if (auto decoded = percent_decode(text)) add(std::move(*decoded));
  add(std::string(text));
  for (std::size_t i = 0, count = out.size(); i < count; ++i) {
    std::string path = out[i];
    std::replace(path.begin(), path.end(), '\\', '/');
    add(std::move(path));
  }
  return out;
}

Result<std::filesystem::path> resolve_uri(const std::filesystem::path& folder, std::string_view uri,
                                          std::span<const std::filesystem::path> allowed) {
  const std::vector<std::string> paths = paths_of_uri(uri);
  const Error not_read{ErrorCode::kUnsupported, "",
                       "only data URIs and paths are read, not \"" + shown_name(uri) + "\""};
  if (paths.empty() && !uri.empty()) return not_read;
  if (paths.empty()) return invalid_uri("an empty URI");
  std::optional<Error> first;
  for (const std::string& path : paths) {
    auto found = resolve_below(folder, path, allowed);
    if (found) return found;
    if (!first) first = found.error();
  }
  const bool is_outside = first->code == ErrorCode::kInvalid;  // worth more than how its letters are written
  if (auto decoded = percent_decode(uri); !decoded && !is_outside) return decoded.error();
  return is_file_uri(uri) && is_outside ? not_read : *first;
}

Result<std::filesystem::path> resolve_below(const std::filesystem::path& folder, const std::string& path,
                                            std::span<const std::filesystem::path> allowed) {
  namespace fs = std::filesystem;
  if (path.find('\0') != std::string::npos) return invalid_uri("a NUL byte in a path");
  const fs::path tidy = fs::path(path).lexically_normal();
  std::error_code error;
  const fs::path root = fs::canonical(folder.empty() ? fs::path(".") : folder, error);
  if (error) return Error{ErrorCode::kIo, "", "the scene's folder cannot be resolved: " + error.message()};
  // First by its letters, so that nothing outside is even looked at; then as it is on the disk, links followed.
  const fs::path where = (root / tidy).lexically_normal();  // an absolute path stands for itself
  const bool leaves = tidy.is_absolute() || (tidy.begin() != tidy.end() && *tidy.begin() == "..");
  std::vector<fs::path> roots{root};
  bool is_allowed = !leaves;
  for (const fs::path& each : allowed) {
    const fs::path real = fs::canonical(each, error);
    if (error) continue;  // a folder that is not there allows nothing
    const fs::path named = fs::absolute(each, error).lexically_normal();
    is_allowed = is_allowed || is_below(named, where) || is_below(real, where);
    roots.push_back(real);
  }
  if (!is_allowed && tidy.is_absolute())
    return invalid_uri("an absolute path, in no folder of --allow-outside: \"" + shown_name(path) + "\"");
  if (!is_allowed)
    return invalid_uri("a path that leaves the scene's folder, into none of --allow-outside: \"" + shown_name(path) +
                       "\"");
  const fs::path file = fs::canonical(where, error);
  if (error) return Error{ErrorCode::kIo, "", "cannot open \"" + shown_name(path) + "\": " + error.message()};
  if (std::none_of(roots.begin(), roots.end(), [&](const fs::path& each) { return is_below(each, file); })) {
    return invalid_uri("a link that leaves the scene's folder, into none of --allow-outside: \"" + shown_name(path) +
                       "\"");
  }
  return file;
}

std::string reason_not_opened(const Error& error) {
  if (error.code == ErrorCode::kIo) return "cannot be opened: there is no such file, or it cannot be read";
  if (error.code == ErrorCode::kUnsupported) return "cannot be opened: only data URIs and paths are read";
  return "cannot be opened: " + error.detail.substr(0, error.detail.find(": \""));  // the name is said already
}

}  // namespace meshlode::scene
