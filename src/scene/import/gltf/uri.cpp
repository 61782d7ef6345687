// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/gltf/uri.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <system_error>

namespace meshlode::scene {

namespace {

Error invalid(std::string detail) {
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

bool is_below(const std::filesystem::path& folder, const std::filesystem::path& file) {
  auto f = folder.begin();
  auto p = file.begin();
  for (; f != folder.end(); ++f, ++p) {
    if (f->empty()) continue;  // a trailing slash
    if (p == file.end() || *p != *f) return false;
  }
  return p != file.end();
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
  if (text.size() % 4 == 1) return invalid("base64 of an impossible length");
  std::vector<std::uint8_t> out;
  out.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  unsigned bit_count = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::int8_t digit = kBase64[static_cast<unsigned char>(text[i])];
    if (digit < 0) return invalid("a character that is not base64, at " + std::to_string(i));
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
      if (high < 0 || low < 0) return invalid("a broken percent escape in a URI");
      c = static_cast<char>(high * 16 + low);
      i += 2;
    }
    if (c == '\0') return invalid("a NUL byte in a URI");
    out.push_back(c);
  }
  return out;
}

Result<DataUri> decode_data_uri(std::string_view uri) {
  const std::size_t comma = uri.find(',');
  if (comma == std::string_view::npos) return invalid("a data URI without a comma");
  std::string_view header = uri.substr(5, comma - 5);
  const std::string_view body = uri.substr(comma + 1);
  DataUri out;
  out.mime_type = std::string(header.substr(0, header.find(';')));
  constexpr std::string_view kBase64Suffix = ";base64";
  if (header.size() >= kBase64Suffix.size() && header.substr(header.size() - kBase64Suffix.size()) == kBase64Suffix) {
    auto bytes = base64_decode(body);
    if (!bytes) return bytes.error();
    out.bytes = std::move(*bytes);
    return out;
  }
  // Percent-encoded bytes may be anything, NUL too.
  for (std::size_t i = 0; i < body.size(); ++i) {
    if (body[i] != '%') {
      out.bytes.push_back(static_cast<std::uint8_t>(body[i]));
      continue;
    }
    const int high = i + 2 < body.size() ? hex_digit(body[i + 1]) : -1;
    const int low = i + 2 < body.size() ? hex_digit(body[i + 2]) : -1;
    if (high < 0 || low < 0) return invalid("a broken percent escape in a data URI");
    out.bytes.push_back(static_cast<std::uint8_t>(high * 16 + low));
    i += 2;
  }
  return out;
}

Result<std::filesystem::path> resolve_uri(const std::filesystem::path& folder, std::string_view uri) {
  if (has_scheme(uri)) {
    return Error{ErrorCode::kUnsupported, "",
                 "only data URIs and relative paths are read, not \"" + std::string(uri.substr(0, 60)) + "\""};
  }
  auto decoded = percent_decode(uri);
  if (!decoded) return decoded.error();
  if (decoded->empty()) return invalid("an empty URI");
  return resolve_below(folder, *decoded);
}

Result<std::filesystem::path> resolve_below(const std::filesystem::path& folder, const std::string& path) {
  namespace fs = std::filesystem;
  if (path.find('\0') != std::string::npos) return invalid("a NUL byte in a path");
  const fs::path relative(path);
  if (relative.is_absolute()) return invalid("an absolute path: \"" + path + "\"");
  // First by its letters, so that nothing outside is even looked at; then as it is on the disk, links followed.
  const fs::path tidy = relative.lexically_normal();
  if (tidy.begin() != tidy.end() && *tidy.begin() == "..") {
    return invalid("a path that leaves the scene's folder: \"" + path + "\"");
  }
  std::error_code error;
  const fs::path root = fs::canonical(folder.empty() ? fs::path(".") : folder, error);
  if (error) return Error{ErrorCode::kIo, "", "the scene's folder cannot be resolved: " + error.message()};
  const fs::path file = fs::canonical(root / tidy, error);
  if (error) return Error{ErrorCode::kIo, "", "cannot open \"" + path + "\": " + error.message()};
  if (!is_below(root, file)) {
    return invalid("a link that leaves the scene's folder: \"" + path + "\"");
  }
  return file;
}

}  // namespace meshlode::scene
