// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/page/viewer_page.h"

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include <meshlode/meshlode.h>

#include "app/page/page_texts.h"
#include "app/page/text_forms.h"
#include "app/report/info.h"
#include "base/json_writer.h"
#include "base/try.h"
#include "format/names.h"

namespace meshlode::app {

namespace {

struct Piece {
  std::uint64_t begin = 0, end = 0;  ///< of the file
};

/// Everything but page and blob data, and of the pages the chosen ones: what a reader opens, with zeros for the rest.
std::vector<Piece> choose_pieces(const run::Asset& asset, const std::vector<bool>& chosen) {
  std::vector<Piece> pieces;
  const auto add = [&](std::uint64_t begin, std::uint64_t end) {
    if (begin == end) return;
    // The padding between two pieces is zeros, which cost less than an element of their own.
    if (!pieces.empty() && begin - pieces.back().end < format::kSectionAlignment) {
      pieces.back().end = end;
    } else {
      pieces.push_back({begin, end});
    }
  };
  add(0, sizeof(format::FileHeader) + asset.sections().size_bytes());
  for (const format::SectionEntry& section : asset.sections()) {
    const auto id = static_cast<format::SectionId>(section.id);
    if (id == format::SectionId::kBlobData) continue;
    if (id != format::SectionId::kPageData) {
      add(section.offset, section.offset + section.bytes);
      continue;
    }
    for (std::size_t p = 0; p < chosen.size(); ++p) {
      const format::PageRecord& page = asset.pages()[p];
      if (chosen[p]) add(page.offset, page.offset + page.stored_bytes);
    }
  }
  return pieces;
}

void write_bits(JsonWriter& w, const PageBits& bits) {
  w.begin_object();
  w.field("heads", bits.heads);
  w.field("materials", bits.materials);
  w.field("positions", bits.positions);
  w.field("normals", bits.normals);
  w.field("uvs", bits.uvs);
  w.field("colors", bits.colors);
  w.field("topology", bits.topology);
  w.field("padding", bits.padding);
  w.end_object();
}

/// [stored bytes, codec] of each.
void write_stored_pages(JsonWriter& w, const run::Asset& file) {
  w.key("stored_pages");
  w.begin_array();
  for (const format::PageRecord& page : file.pages()) {
    w.begin_array();
    w.value(page.stored_bytes);
    w.value(format::name_of(page.codec));
    w.end_array();
  }
  w.end_array();
}

/// What the page knows that the asset's own tables do not say.
std::string facts_json(const run::Asset& asset, const ViewerInput& input, const std::vector<bool>& chosen) {
  JsonWriter w;
  w.begin_object();
  const run::Asset& file = input.file != nullptr ? *input.file : asset;
  w.field("file_bytes", file.bytes().size());
  w.field("embedded_file_bytes", asset.bytes().size());
  w.key("embedded_pages");  // [first, count] of each run
  w.begin_array();
  std::uint64_t embedded = 0, all = 0;
  for (std::size_t p = 0; p < chosen.size(); ++p) {
    all += asset.pages()[p].stored_bytes;
    if (!chosen[p]) continue;
    embedded += asset.pages()[p].stored_bytes;
    if (p > 0 && chosen[p - 1]) continue;
    std::size_t end = p;
    while (end < chosen.size() && chosen[end]) ++end;
    w.begin_array();
    w.value(p);
    w.value(end - p);
    w.end_array();
  }
  w.end_array();
  w.field("embedded_page_bytes", embedded);
  w.field("page_bytes", all);
  w.key("sections");
  w.begin_array();
  for (const format::SectionEntry& section : file.sections()) {
    w.begin_array();
    w.value(section_name(section.id));
    w.value(section.bytes);
    w.end_array();
  }
  w.end_array();
  if (input.file != nullptr) write_stored_pages(w, file);
  if (input.byte_map) {
    w.key("level_bits");
    w.begin_array();
    for (const PageBits& level : input.byte_map->levels) write_bits(w, level);
    w.end_array();
  }
  w.end_object();
  return script_json(w.text());
}

std::string pieces_html(const run::Asset& asset, const std::vector<bool>& chosen) {
  std::string out;
  for (const Piece& piece : choose_pieces(asset, chosen)) {
    out += "<script type=\"text/plain\" class=\"piece\" data-at=\"" + std::to_string(piece.begin) + "\">";
    out += encode_base64(asset.bytes().subspan(piece.begin, piece.end - piece.begin));
    out += "</script>\n";
  }
  return out;
}

/// Modules become one script: what they give each other is in one scope there.
std::string script_text() {
  std::string out;
  for (const std::string_view module : page_scripts()) {
    std::size_t at = 0;
    while (at < module.size()) {
      const std::size_t end = std::min(module.find('\n', at), module.size());
      std::string_view line = module.substr(at, end - at);
      at = end + 1;
      if (line.starts_with("import ")) continue;
      if (line.starts_with("export ")) line.remove_prefix(7);
      out += line;
      out += '\n';
    }
  }
  return out;
}

}  // namespace

Result<std::vector<bool>> choose_pages(const run::Asset& asset, std::uint64_t max_bytes) {
  std::vector<bool> chosen(asset.pages().size(), true);
  std::uint64_t all = 0;
  for (const format::PageRecord& page : asset.pages()) all += page.stored_bytes;
  if (all <= max_bytes) return chosen;

  meshlode_asset* opened = nullptr;
  meshlode_error error{};
  if (meshlode_open_buffer(asset.bytes().data(), asset.bytes().size(), &opened, &error) != MESHLODE_OK) {
    return Error{ErrorCode::kInvalid, "", error.text};
  }
  const std::unique_ptr<meshlode_asset, void (*)(meshlode_asset*)> closed_at_end(opened, meshlode_close);
  const auto dependencies = [&](std::size_t p) {
    const format::PageRecord& page = asset.pages()[p];
    return asset.page_dependencies().subspan(page.first_dependency, page.dependency_count);
  };
  std::vector<bool> is_needed(asset.pages().size(), false);
  std::vector<std::uint32_t> order(asset.pages().size());
  if (meshlode_streaming_order(opened, MESHLODE_PROMISE_POSITION, order.data(), &error) != MESHLODE_OK) {
    return Error{ErrorCode::kInvalid, "", error.text};
  }
  // Members of a terminal group are drawn where nothing coarser is: their pages are always there, and what those need.
  std::uint64_t used = 0;
  for (std::size_t p = chosen.size(); p-- > 0;) {
    const format::PageRecord& page = asset.pages()[p];
    const auto groups = asset.groups().subspan(page.first_group, page.group_count);
    chosen[p] = is_needed[p] || std::any_of(groups.begin(), groups.end(), [](const format::GroupRecord& group) {
                  return (group.flags & format::kGroupTerminal) != 0;
                });
    if (!chosen[p]) continue;
    used += page.stored_bytes;
    for (const std::uint32_t needed : dependencies(p)) is_needed[needed] = true;
  }
  for (const std::uint32_t p : order) {
    if (chosen[p] || asset.pages()[p].stored_bytes > max_bytes - std::min(max_bytes, used)) continue;
    const auto needs = dependencies(p);
    if (!std::all_of(needs.begin(), needs.end(), [&](std::uint32_t n) { return chosen[n]; })) continue;
    chosen[p] = true;
    used += asset.pages()[p].stored_bytes;
  }
  return chosen;
}

Result<std::string> viewer_page(const run::Asset& asset, const ViewerInput& input) {
  for (std::size_t p = 0; p < asset.pages().size(); ++p) {
    const format::Codec codec = asset.pages()[p].codec;
    if (codec != format::Codec::kNone && codec != format::Codec::kStrips) {
      return Error{ErrorCode::kUnsupported, "page " + std::to_string(p),
                   std::string("is stored with ") + format::name_of(codec) + ", which a page cannot read"};
    }
  }
  TRY_LET(chosen, choose_pages(asset, input.max_page_bytes));
  const std::array<PageHole, 8> holes{{
      {"@TITLE@", escape_html(input.title)},
      {"@LICENCES@", std::string(page_licences())},
      {"@MAIN@", std::string(page_main())},
      {"@STYLE@", std::string(page_style())},
      {"@FACTS@", facts_json(asset, input, *chosen)},
      {"@PIECES@", pieces_html(asset, *chosen)},
      {"@RUNTIME@", encode_base64(input.runtime)},
      {"@SCRIPT@", script_text()},
  }};
  return fill_holes(page_frame(), holes);
}

}  // namespace meshlode::app
