// SPDX-License-Identifier: MIT
// The page table: pages partition groups and clusters, lie one after the other, and depend only on earlier ones.
#include <cmath>
#include <string>

#include "run/read/check_tables.h"
#include "run/read/file_place.h"

namespace meshlode::run {

namespace {

using format::SectionId;

/// The groups of a page are contiguous, of one mesh, name the page, and make up its cluster range.
Status check_page_members(const RawTables& tables, std::size_t p, std::uint64_t& group_end) {
  const format::PageRecord& page = tables.pages[p];
  const auto fail = [&](const char* field, const char* detail) {
    return invalid_record(SectionId::kPages, p, field, detail);
  };
  if (page.first_group != group_end || page.group_count < 1 || page.group_count > tables.groups.size() - group_end) {
    return fail("first_group", "pages do not partition the groups");
  }
  const format::GroupRecord& first = tables.groups[page.first_group];
  std::uint64_t clusters = 0;
  for (std::uint32_t i = 0; i < page.group_count; ++i) {
    const format::GroupRecord& group = tables.groups[page.first_group + i];
    if (group.page != p) {
      return invalid_record(SectionId::kGroups, page.first_group + i, "page", "is not the page that holds it");
    }
    if (group.mesh != first.mesh) return fail("group_count", "a page holds groups of one mesh");
    clusters += group.cluster_count;
  }
  if (page.first_cluster != first.first_cluster || page.cluster_count != clusters) {
    return fail("first_cluster", "does not match the groups");
  }
  group_end += page.group_count;
  return Ok{};
}

Status check_page_bytes(const RawTables& tables, std::size_t p, std::uint64_t& data_end) {
  const format::PageRecord& page = tables.pages[p];
  const auto fail = [&](const char* field, const char* detail) {
    return invalid_record(SectionId::kPages, p, field, detail);
  };
  const std::uint64_t section_end = tables.page_data->offset + tables.page_data->bytes;
  if (page.offset % format::kSectionAlignment != 0) return fail("offset", "is not a multiple of 16");
  if (page.offset < data_end || page.offset - data_end >= format::kSectionAlignment) {
    return fail("offset", "does not follow the page before it");
  }
  if (page.offset > section_end || page.stored_bytes > section_end - page.offset) {
    return fail("stored_bytes", "reaches beyond section PAGE");
  }
  if (page.codec > format::Codec::kStrips) return fail("codec", "is unknown");
  const format::MeshRecord& mesh = tables.meshes[tables.groups[page.first_group].mesh];
  const std::uint64_t least =
      sizeof(format::PageHeader) + 4U + std::uint64_t{page.cluster_count} * 4U * format::head_words(mesh);
  if (page.bytes < least || page.bytes > format::kMaxPageBytes || page.bytes % 4 != 0) {
    return fail("bytes", "must hold the page's clusters, at most 128 KiB, a multiple of 4");
  }
  if (page.codec == format::Codec::kNone ? page.stored_bytes != page.bytes
                                         : page.stored_bytes < 1 || page.stored_bytes >= page.bytes) {
    return fail("stored_bytes", "does not match bytes and codec");
  }
  data_end = page.offset + page.stored_bytes;
  return Ok{};
}

Status check_page_dependencies(const RawTables& tables, std::size_t p, std::uint64_t& dependency_end) {
  const format::PageRecord& page = tables.pages[p];
  if (page.first_dependency != dependency_end ||
      page.dependency_count > tables.page_dependencies.size() - dependency_end) {
    return invalid_record(SectionId::kPages, p, "first_dependency", "pages do not partition the dependencies");
  }
  const std::uint32_t mesh = tables.groups[page.first_group].mesh;
  for (std::uint64_t i = dependency_end; i < dependency_end + page.dependency_count; ++i) {
    const std::uint32_t needed = tables.page_dependencies[i];
    if (needed >= p) return invalid_record(SectionId::kPageDeps, i, "page", "must be an earlier page");
    if (tables.groups[tables.pages[needed].first_group].mesh != mesh) {
      return invalid_record(SectionId::kPageDeps, i, "page", "must be of the same mesh");
    }
    if (i > dependency_end && needed <= tables.page_dependencies[i - 1]) {
      return invalid_record(SectionId::kPageDeps, i, "page", "must be larger than the one before it");
    }
  }
  dependency_end += page.dependency_count;
  return Ok{};
}

}  // namespace

Status check_pages(const RawTables& tables) {
  std::uint64_t group_end = 0;
  std::uint64_t dependency_end = 0;
  std::uint64_t data_end = tables.page_data->offset;
  for (std::size_t p = 0; p < tables.pages.size(); ++p) {
    if (Status status = check_page_members(tables, p, group_end); !status) return status;
    if (Status status = check_page_bytes(tables, p, data_end); !status) return status;
    if (Status status = check_page_dependencies(tables, p, dependency_end); !status) return status;
  }
  const std::size_t count = tables.pages.size();
  if (group_end != tables.groups.size()) {
    return invalid_record(SectionId::kPages, count, "first_group", "groups are left over");
  }
  if (dependency_end != tables.page_dependencies.size()) {
    return invalid_record(SectionId::kPages, count, "first_dependency", "dependencies are left over");
  }
  if (data_end != tables.page_data->offset + tables.page_data->bytes) {
    return invalid_record(SectionId::kPages, count, "offset", "bytes of section PAGE are left over");
  }
  return Ok{};
}

Status check_page_hints(const RawTables& tables) {
  if (!tables.has_page_hints) return Ok{};
  if (tables.page_hints.size() != tables.pages.size()) {
    return Error{ErrorCode::kInvalid, "section PHNT, field record_count", "must be the number of pages"};
  }
  for (std::size_t p = 0; p < tables.page_hints.size(); ++p) {
    const format::PageHintRecord& hint = tables.page_hints[p];
    const auto fail = [&](const char* field, const char* detail) {
      return invalid_record(SectionId::kPageHints, p, field, detail);
    };
    for (const float middle : hint.center) {
      if (!std::isfinite(middle)) return fail("center", "must be finite");
    }
    if (!std::isfinite(hint.radius) || std::signbit(hint.radius)) return fail("radius", "must be finite, at least 0");
    if (!std::isfinite(hint.largest_error) || hint.largest_error < hint.smallest_error ||
        std::signbit(hint.largest_error)) {
      return fail("largest_error", "must be finite, and not below smallest_error");
    }
    if (!(hint.smallest_error >= 0.0F) || std::signbit(hint.smallest_error)) {
      return fail("smallest_error", "must be finite, at least 0");
    }
  }
  return Ok{};
}

}  // namespace meshlode::run
