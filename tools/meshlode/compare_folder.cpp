// SPDX-License-Identifier: GPL-3.0-or-later
#include "compare_folder.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <utility>
#include <vector>

#include "base/try.h"
#include "outputs.h"
#include "streams.h"

namespace meshlode::cli {

std::string picture_name(const std::string& place, std::uint32_t camera) {
  return place + "." + std::to_string(camera);
}

Status write_png(const std::string& path, const draw::Image& image) {
  const std::vector<std::uint8_t> png = draw::encode_png(image);
  if (png.empty()) return Error{ErrorCode::kIo, path, "the picture is too large to compress"};
  return write_output(path, png);
}

Status CompareFolder::write(const std::string& place, const draw::Image& before, const draw::Image& after,
                            ComparedPicture& picture) {
  if (folder_.empty() || picture.change.difference.differing_pixels == 0) return Ok{};
  const std::string name = picture_name(place, picture.change.camera);
  const app::PictureFiles files{name + ".old.png", name + ".new.png", name + ".flip.png"};
  const std::filesystem::path folder = folder_;
  TRY(write_png((folder / files.before).string(), before));
  TRY(write_png((folder / files.after).string(), after));
  TRY(write_png((folder / files.flip).string(), picture.heat));
  picture.change.files = files;
  return Ok{};
}

void CompareFolder::add(const BulkInput& input, const FileOutcome& outcome, app::ComparedFile file) {
  if (folder_.empty()) return;
  file.name = input.place;
  for (const std::vector<Error>* errors : {&outcome.errors, &outcome.late_errors}) {
    for (const Error& error : *errors) file.message += error.message() + "\n";
  }
  if (file.verdict.empty()) file.verdict = "equal";
  if (outcome.exit_code != 0 && file.verdict != "gone") {
    file.verdict = outcome.exit_code == static_cast<int>(ErrorCode::kCheckFailed) ? "FAILED" : "error";
  }
  const std::lock_guard lock(mutex_);
  files_.insert_or_assign(input.place, std::move(file));
}

int CompareFolder::finish(const std::string& title) {
  if (folder_.empty()) return 0;
  std::vector<app::ComparedFile> files;
  for (auto& [place, file] : files_) files.push_back(std::move(file));
  const std::string path = (std::filesystem::path(folder_) / "index.html").string();
  const Status written = write_text(path, app::compare_page(std::move(files), title));
  return written ? 0 : print_error(written.error());
}

}  // namespace meshlode::cli
