// SPDX-License-Identifier: GPL-3.0-or-later
// `compare -O DIR`: pictures of each pair, and index.html.
#pragma once

#include <map>
#include <mutex>
#include <string>

#include <meshlode/result.h>

#include "app/compare/compare_page.h"
#include "bulk.h"
#include "draw_views.h"

namespace meshlode::cli {

class CompareFolder {
 public:
  /// `folder`: empty for none, and then nothing is written and nothing kept.
  explicit CompareFolder(std::string folder) : folder_(std::move(folder)) {}

  /// Writes old, new and difference as PLACE.CAMERA.old.png and so on, unless they are equal, and names them in
  /// `picture`. Errors: those of writing. Safe to call from any thread.
  [[nodiscard]] Status write(const std::string& place, const draw::Image& before, const draw::Image& after,
                             ComparedPicture& picture);
  /// What the page says of a pair: `file` with the verdict that the outcome and its cells have.
  void add(const BulkInput& input, const FileOutcome& outcome, app::ComparedFile file);
  /// The page. \returns the exit code
  [[nodiscard]] int finish(const std::string& title);

 private:
  std::string folder_;
  std::mutex mutex_;
  std::map<std::string, app::ComparedFile> files_;  ///< by place
};

/// "PLACE.CAMERA".
[[nodiscard]] std::string picture_name(const std::string& place, std::uint32_t camera);
/// `path`: "-" for stdout. Errors: kIo, also for a picture that is too large to compress.
[[nodiscard]] Status write_png(const std::string& path, const draw::Image& image);

}  // namespace meshlode::cli
