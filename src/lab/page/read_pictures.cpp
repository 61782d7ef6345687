// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/page/read_pictures.h"

#include <algorithm>
#include <array>
#include <set>
#include <string>

#include "base/file.h"
#include "base/printable.h"
#include "base/try.h"

namespace meshlode::lab::page {

namespace {

constexpr std::size_t kMostPictureBytes = std::size_t{64} << 20;

/// A path that stays below the folder that it is in.
bool is_inside(const std::filesystem::path& path) {
  if (path.empty() || path.is_absolute() || path.has_root_name()) return false;
  return std::none_of(path.begin(), path.end(), [](const std::filesystem::path& part) { return part == ".."; });
}

Status read_picture(ReportData& data, const std::filesystem::path& folder, const std::string& path) {
  static constexpr std::array<std::uint8_t, 8> kPng = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  const std::string where = "picture " + printable(path);
  if (!is_inside(path)) return Error{ErrorCode::kInvalid, where, "leads out of the report's folder"};
  TRY_LET(file, MappedFile::open(folder / path));
  const std::span<const std::uint8_t> bytes = file->bytes();
  if (bytes.size() > kMostPictureBytes) return Error{ErrorCode::kInvalid, where, "more than 64 MiB"};
  if (bytes.size() < kPng.size() || !std::equal(kPng.begin(), kPng.end(), bytes.begin())) {
    return Error{ErrorCode::kInvalid, where, "no PNG"};
  }
  data.pictures[path].assign(bytes.begin(), bytes.end());
  return Ok{};
}

}  // namespace

Status read_pictures(ReportData& data, const std::filesystem::path& folder) {
  std::set<std::string> paths;
  for (const View& view : data.views) paths.insert(view.picture);
  for (const Point& point : data.points) {
    for (const CutPicture& picture : point.pictures) {
      paths.insert(picture.picture);
      paths.insert(picture.heat);
    }
  }
  paths.erase("");
  for (const std::string& path : paths) {
    TRY(read_picture(data, folder, path));
  }
  return Ok{};
}

}  // namespace meshlode::lab::page
