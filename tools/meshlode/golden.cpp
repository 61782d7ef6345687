// SPDX-License-Identifier: GPL-3.0-or-later
#include "golden.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <system_error>
#include <utility>

#include "app/compare/compare.h"
#include "base/append_format.h"
#include "base/file.h"
#include "base/try.h"
#include "compare_pairs.h"
#include "draw/textures/image.h"
#include "outputs.h"

namespace meshlode::cli {

namespace {

namespace fs = std::filesystem;

std::string golden_path(const GoldenCommand& command, const std::string& place, std::size_t camera) {
  const std::string name = picture_name(place, static_cast<std::uint32_t>(camera)) + ".png";
  return (fs::path(command.golden.folder) / name).string();
}

/// PLACE.CAMERA.png: other files that lie there are nobody's.
bool is_picture_name(const fs::path& path) {
  const fs::path stem = path.stem();
  const std::string camera = stem.extension().string();
  return path.extension() == ".png" && camera.size() > 1 && camera[1] != '0' &&
         camera.find_first_not_of("0123456789", 1) == std::string::npos;
}

Result<draw::Image> read_golden(const std::string& path, const draw::Image& wanted) {
  std::error_code error;
  if (!fs::exists(path, error)) {
    return Error{ErrorCode::kCheckFailed, path, "there is no such golden picture; --update writes it"};
  }
  TRY_LET(file, MappedFile::open(path));
  keep_file(path);
  const auto named = [&](Error e) {
    e.where = path + (e.where.empty() ? "" : ": ") + e.where;
    return e;
  };
  const auto header = draw::read_image_header(file->bytes());
  if (!header) return named(header.error());
  if (header->width != wanted.width || header->height != wanted.height) {
    std::string text;
    append_format(text, "is %ux%u, and the picture to compare is %ux%u; --update writes it anew", header->width,
                  header->height, wanted.width, wanted.height);
    return Error{ErrorCode::kCheckFailed, path, text};
  }
  const auto decoded = draw::decode_image(file->bytes());
  if (!decoded) return named(decoded.error());
  const auto rgba = decoded->rgba();
  return draw::Image{decoded->width, decoded->height, {rgba.begin(), rgba.end()}};
}

}  // namespace

FileOutcome compare_with_golden(const BulkInput& input, const GoldenCommand& command, CompareFolder& folder) {
  FileOutcome out;
  app::ComparedFile page;
  const auto done = [&] {
    folder.add(input, out, std::move(page));
    return std::move(out);
  };
  const auto fail = [&](Error error) {
    out.fail(std::move(error));
    return done();
  };
  if (input.path.empty()) {
    page.verdict = "gone";
    out.cells = {"-", "gone"};
    if (!command.golden.is_updated) out.fail({ErrorCode::kCheckFailed, input.source, "has no asset"});
    return done();
  }
  const Result<run::Asset> asset = open_sound(input.path, command.views.max_decoded, input.asset_hash);
  if (!asset) return fail(asset.error());
  page.after = asset->bytes().size();
  const auto cameras = make_cameras(command.views, *asset);
  if (!cameras) return fail(cameras.error());
  std::vector<std::string> warnings;
  const auto views = draw_views(*asset, *cameras, command.views, warnings);
  for (const std::string& warning : warnings) out.notes += "warning: " + warning + "\n";
  if (!views) {
    Error error = views.error();
    error.where = input.path + (error.where.empty() ? "" : ": ") + error.where;
    return fail(std::move(error));
  }
  app::GoldenComparison comparison{input.path, command.golden.is_updated, {}, {}};
  for (std::size_t i = 0; i < views->size(); ++i) {
    const draw::Image& image = (*views)[i].image;
    const std::string path = golden_path(command, input.place, i + 1);
    if (command.golden.is_updated) {
      if (const Status written = write_png(path, image); !written) return fail(written.error());
      continue;
    }
    const auto golden = read_golden(path, image);
    if (!golden) {
      comparison.missing.push_back({static_cast<std::uint32_t>(i + 1), golden.error().message()});
      out.fail(golden.error());
      continue;
    }
    ComparedPicture picture = compare_images(*golden, image);
    picture.change.camera = static_cast<std::uint32_t>(i + 1);
    picture.change.pixel_error = command.views.common.pixel_error;
    if (const Status written = folder.write(input.place, *golden, image, picture); !written) {
      return fail(written.error());
    }
    comparison.pictures.push_back(std::move(picture.change));
  }
  std::vector<app::BrokenCondition> broken;
  if (!comparison.pictures.empty()) {
    auto judged = app::judge_budget(command.budget, app::golden_json(comparison));
    if (!judged) return fail(judged.error());
    broken = std::move(*judged);
  }
  for (const app::BrokenCondition& one : broken) {
    out.late_errors.push_back({ErrorCode::kCheckFailed, input.path, one.message()});
    out.exit_code = std::max(out.exit_code, static_cast<int>(ErrorCode::kCheckFailed));
  }
  const auto flip = app::worst_flip(comparison.pictures);
  const bool is_whole = comparison.missing.empty();
  const bool is_equal = is_whole && std::ranges::all_of(comparison.pictures, [](const app::PictureChange& picture) {
                          return picture.difference.differing_pixels == 0;
                        });
  page.verdict = command.golden.is_updated ? "updated" : !is_whole ? "missing" : is_equal ? "equal" : "changed";
  page.pictures = comparison.pictures;
  page.text = app::pictures_text(comparison.pictures);
  std::string mean = "-";
  if (flip) {
    mean.clear();
    append_format(mean, "%.4f", flip->mean);
  }
  out.cells = {mean, page.verdict};
  if (command.output.json()) {
    out.text = app::golden_json(comparison, broken);
  } else if (!command.output.quiet) {
    out.text = command.golden.is_updated
                   ? input.path + ": " + std::to_string(views->size()) + " golden picture(s) written\n"
               : page.text.empty() ? ""
                                   : input.path + page.text;
  }
  return done();
}

Status add_orphans(const GoldenCommand& command, std::vector<BulkInput>& files) {
  std::set<fs::path> known;
  const std::size_t cameras = std::max<std::size_t>(1, command.views.cameras.size());
  for (const BulkInput& input : files) {
    for (std::size_t i = 1; i <= cameras; ++i) known.insert(golden_path(command, input.place, i));
  }
  std::error_code error;
  std::set<fs::path> orphans;
  auto entry = fs::recursive_directory_iterator(command.golden.folder, error);
  for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
    const fs::path& path = entry->path();
    if (is_picture_name(path) && !known.contains(path)) orphans.insert(path);
  }
  if (error && !command.golden.is_updated) return Error{ErrorCode::kIo, command.golden.folder, error.message()};
  for (const fs::path& path : orphans) {
    BulkInput input{"", path.string()};
    input.place = path.lexically_relative(command.golden.folder).string();
    files.push_back(std::move(input));
  }
  return Ok{};
}

}  // namespace meshlode::cli
