// SPDX-License-Identifier: MIT
// What an asset promises besides positions: as many records as it describes, and numbers that can be compared.
#include <cmath>

#include "run/read/check_tables.h"
#include "run/read/file_place.h"

namespace meshlode::run {

namespace {

using format::SectionId;

bool is_length(float value) {
  return std::isfinite(value) && value >= 0.0F && !std::signbit(value);
}

Status check_mesh(const RawTables& tables, std::size_t m) {
  const format::PromiseMeshRecord& record = tables.promises[m];
  const auto fail = [&](const char* field, const char* detail) {
    return invalid_record(SectionId::kPromises, m, field, detail);
  };
  const std::uint32_t all = format::kPromisesTexels | format::kPromisesAppearance;
  if ((record.promises & format::kPromisesTexels) == 0 || (record.promises & ~all) != 0) {
    return fail("promises", "must have bit 0 and no bit but 0 and 1");
  }
  if (record.promises != tables.promises[0].promises) return fail("promises", "must be the same in all meshes");
  if (!is_length(record.normal_object)) return fail("normal_object", "must be finite and not negative");
  for (std::uint32_t set = 0; set < format::kMaxUvSets; ++set) {
    const float* const object = record.uv_object[set];
    if (!is_length(object[0]) || !is_length(object[1])) return fail("uv_object", "must be finite and not negative");
    if ((object[0] == 0.0F) != (object[1] == 0.0F)) return fail("uv_object", "must be 0 along both axes or none");
    if (set >= tables.meshes[m].uv_set_count && object[0] != 0.0F) {
      return fail("uv_object", "must be 0 for a set that is not stored");
    }
  }
  const bool has_appearance = (record.promises & format::kPromisesAppearance) != 0;
  if (!has_appearance && record.normal_object != 0.0F) return fail("normal_object", "must be 0 without bit 1");
  if (!is_length(record.level0_texels) || record.level0_texels < tables.meshes[m].level0_deviation) {
    return fail("level0_texels", "must be finite and not below the mesh's level0_deviation");
  }
  const bool is_above = is_length(record.level0_appearance) && record.level0_appearance >= record.level0_texels;
  if (has_appearance ? !is_above : record.level0_appearance != 0.0F) {
    return fail("level0_appearance", "must be finite and not below level0_texels, or 0 without bit 1");
  }
  return Ok{};
}

Status check_group(const RawTables& tables, std::size_t g) {
  const format::PromiseGroupRecord& record = tables.promise_errors[g];
  const format::GroupRecord& group = tables.groups[g];
  const auto fail = [&](const char* field, const char* detail) {
    return invalid_record(SectionId::kPromiseErrors, g, field, detail);
  };
  const bool is_terminal = (group.flags & format::kGroupTerminal) != 0;
  const auto is_error = [&](float error, float least) {
    return is_length(error) && error >= least && is_terminal == (error == format::kInfiniteError);
  };
  if (!is_error(record.texel_error, group.error)) {
    return fail("texel_error", "must be finite, not below the group's error, and infinite where that is");
  }
  if ((tables.promises[group.mesh].promises & format::kPromisesAppearance) == 0) {
    if (record.appearance_error != 0.0F) return fail("appearance_error", "must be 0 where it is not promised");
  } else if (!is_error(record.appearance_error, record.texel_error)) {
    return fail("appearance_error", "must be finite, not below texel_error, and infinite where that is");
  }
  return Ok{};
}

}  // namespace

Status check_promises(const RawTables& tables) {
  if (!tables.has_promises) return Ok{};
  // Where only one of the two sections is there, the other one's table is empty.
  if (tables.promises.size() != tables.meshes.size()) {
    return Error{ErrorCode::kInvalid, "section PRMS, field record_count", "must be the number of meshes"};
  }
  if (tables.promise_errors.size() != tables.groups.size()) {
    return Error{ErrorCode::kInvalid, "section PRMG, field record_count", "must be the number of groups"};
  }
  for (std::size_t m = 0; m < tables.promises.size(); ++m) {
    if (Status status = check_mesh(tables, m); !status) return status;
  }
  for (std::size_t g = 0; g < tables.promise_errors.size(); ++g) {
    if (Status status = check_group(tables, g); !status) return status;
  }
  return Ok{};
}

}  // namespace meshlode::run
