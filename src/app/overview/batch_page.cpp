// SPDX-License-Identifier: GPL-3.0-or-later
// The data of the page of a batch; what shows it is page/overview.js.
#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>

#include "app/overview/overview.h"
#include "app/page/page_texts.h"
#include "app/page/text_forms.h"
#include "base/json_writer.h"

namespace meshlode::app {

namespace {

namespace fs = std::filesystem;

/// From the page to a file. Never a scheme, whatever the file is called: it begins with a dot.
std::string link_to(const fs::path& file, const fs::path& folder) {
  std::error_code error;
  const fs::path from = fs::absolute(folder.empty() ? fs::path(".") : folder, error).lexically_normal();
  const fs::path to = fs::absolute(file, error).lexically_normal().lexically_relative(from);
  const std::string path = to.string();
  return uri_of(path.starts_with("../") ? path : "./" + path);
}

void write_findings(JsonWriter& w, const std::vector<OverviewFinding>& findings) {
  w.key("findings");
  w.begin_array();
  for (const OverviewFinding& finding : findings) {
    w.begin_array();
    w.value(finding.severity);
    w.value(finding.id);
    w.value(finding.text);
    w.end_array();
  }
  w.end_array();
}

void write_asset(JsonWriter& w, const OverviewAsset& asset, const fs::path& folder) {
  const JobResult& r = asset.result;
  w.begin_object();
  w.field("input", r.job.input.string());
  w.field("output", r.job.output.string());
  w.field("status", name_of(r.status));
  if (!r.error.empty()) w.field("error", r.error);
  if (!asset.unread.empty()) w.field("unread", asset.unread);
  w.field("bytes", r.has_asset() ? r.facts.bytes : 0);
  if (asset.old_bytes) w.field("old", *asset.old_bytes);
  w.field("seconds", r.seconds);
  w.field("cpu", r.processor_seconds);
  w.field("memory", r.peak_memory);
  w.field("cache", name_of(r.cache));
  if (r.cache == CacheUse::kMiss) w.field("reason", r.reason);
  w.field("triangles", asset.triangles);
  if (asset.pixel_triangles) w.field("at_pixel", *asset.pixel_triangles);
  if (!asset.thumbnail.empty()) w.field("thumbnail", encode_base64(asset.thumbnail));
  if (!asset.thumbnail_note.empty()) w.field("thumbnail_note", asset.thumbnail_note);
  w.field("stuck", asset.stuck_groups);
  w.array_field("streams", asset.streams);
  write_findings(w, asset.findings);
  if (r.has_asset()) {
    w.field("link", link_to(r.job.output, folder));
    std::error_code error;
    const fs::path page = fs::path(r.job.output).replace_extension(".html");
    if (fs::is_regular_file(page, error)) w.field("page", link_to(page, folder));
  }
  w.end_object();
}

/// Without line breaks and indentation: no string of JSON has a line break.
std::string compact(std::string_view json) {
  std::string out;
  out.reserve(json.size());
  for (std::size_t i = 0; i < json.size(); ++i) {
    if (json[i] != '\n') {
      out += json[i];
      continue;
    }
    while (i + 1 < json.size() && json[i + 1] == ' ') ++i;
  }
  return out;
}

}  // namespace

std::string batch_page(const Overview& overview, const std::string& title, const std::string& folder) {
  JsonWriter w;
  w.begin_object();
  w.field("generator", overview.generator);
  w.field("complete", overview.is_complete);
  w.field("against", overview.has_old);
  w.array_field("streams", kOverviewStreams);
  w.key("versions");
  w.begin_object();
  for (const auto& [name, version] : overview.versions) w.field(name, version);
  w.end_object();
  w.key("gone");
  w.begin_array();
  for (const GoneAsset& gone : overview.gone) {
    w.begin_array();
    w.value(gone.output);
    w.value(gone.bytes);
    w.end_array();
  }
  w.end_array();
  w.key("assets");
  w.begin_array();
  for (const OverviewAsset& asset : overview.assets) write_asset(w, asset, folder);
  w.end_array();
  w.end_object();
  const std::array<PageHole, 4> holes{{
      {"@TITLE@", escape_html(title)},
      {"@STYLE@", std::string(overview_style())},
      {"@DATA@", script_json(compact(w.text()))},
      {"@SCRIPT@", std::string(overview_script())},
  }};
  return fill_holes(overview_frame(), holes);
}

}  // namespace meshlode::app
