// SPDX-License-Identifier: GPL-3.0-or-later
#include "file_kind.h"
#include "base/try.h"

#include <cstring>
#include <span>
#include <string_view>
#include <utility>

#include <meshlode/format.h>

#include "base/file.h"
#include "scene/import/import.h"

namespace meshlode::cli {

namespace {

bool is_asset(std::span<const std::uint8_t> bytes) {
  std::uint32_t magic = 0;
  if (bytes.size() < sizeof(magic)) return false;
  std::memcpy(&magic, bytes.data(), sizeof(magic));
  return magic == format::kMagic;
}

/// As import takes the file; empty: no scene. JSON is glTF only where it may have glTF's one required member.
std::string scene_name(const std::string& path, std::span<const std::uint8_t> bytes) {
  const std::string_view format = scene::find_format_name(path, bytes);
  if (format.empty()) return {};
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (format == "glTF" && text.find("\"asset\"") == std::string_view::npos) return {};
  return (format == "OBJ" || format == "STL" ? "an " : "a ") + std::string(format) + " scene";
}

}  // namespace

SeenFile look_at_file(const std::string& path) {
  const Result<MappedFile> file = MappedFile::open(path);
  if (!file) return {FileForm::kUnreadable};
  const std::span<const std::uint8_t> bytes = file->bytes();
  if (bytes.empty()) return {FileForm::kEmpty};
  if (is_asset(bytes)) return {FileForm::kAsset};
  std::string name = scene_name(path, bytes);
  return name.empty() ? SeenFile{} : SeenFile{FileForm::kScene, std::move(name)};
}

Status check_may_be_asset(const std::string& path) {
  const SeenFile seen = look_at_file(path);
  if (seen.form == FileForm::kEmpty) return Error{ErrorCode::kInvalid, path, "the file is empty"};
  if (seen.form == FileForm::kOther) return Error{ErrorCode::kInvalid, path, "not a .lode asset"};
  if (seen.form != FileForm::kScene) return Ok{};
  return Error{ErrorCode::kInvalid, path,
               "this is " + seen.name +
                   ", not a .lode asset; make one with 'meshlode build', or look at the scene with 'meshlode plan' or "
                   "'meshlode doctor'"};
}

Status check_is_manifest(const std::string& path, const std::string& writer) {
  const SeenFile seen = look_at_file(path);
  std::string name = seen.name;
  if (seen.form == FileForm::kEmpty) return Error{ErrorCode::kInvalid, path, "the file is empty"};
  if (seen.form == FileForm::kAsset) name = "a .lode asset";
  if (name.empty()) return Ok{};
  return Error{ErrorCode::kInvalid, path, "this is " + name + ", not a manifest; '" + writer + "' writes one"};
}

Result<run::Asset> open_asset(const std::string& path, std::uint64_t max_decoded) {
  TRY(check_may_be_asset(path));
  return run::Asset::open(path, max_decoded);
}

}  // namespace meshlode::cli
