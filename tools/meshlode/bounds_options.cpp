// SPDX-License-Identifier: GPL-3.0-or-later
#include "bounds_options.h"
#include "base/try.h"

#include <cmath>
#include <string>

namespace meshlode::cli {

namespace {

Status check_number(const char* option, const std::optional<double>& value) {
  if (value && (!(*value >= 0.0) || !std::isfinite(*value))) {
    return Error{ErrorCode::kUsage, option, "give a number, 0 or more"};
  }
  return Ok{};
}

/// A mesh without any group to pass says nothing either way.
Status check_measured(const char* option, const run::Asset& asset, std::size_t mesh,
                      float format::GroupRecord::*deviation) {
  const format::MeshRecord& record = asset.meshes()[mesh];
  for (const format::GroupRecord& group : asset.groups().subspan(record.first_group, record.group_count)) {
    if ((group.flags & format::kGroupTerminal) != 0 || group.*deviation < format::kInfiniteError) continue;
    return Error{ErrorCode::kUnsupported, option,
                 "mesh " + std::to_string(mesh) +
                     ": the asset does not store this deviation: " + "it was not measured by the build"};
  }
  return Ok{};
}

}  // namespace

void add_bounds_options(OptionParser& parser, BoundsOptions& options) {
  parser.add_value("--normal-error DEGREES", options.normal_error,
                   "also limit the stored deviation of normals, 0 to 180 (default: no limit)");
  parser.add_value("--uv-error E", options.uv_error,
                   "also limit the stored deviation of texture coordinates, UV units (default: no limit)");
}

Result<run::AttributeBounds> make_bounds(const BoundsOptions& options, const run::Asset& asset) {
  TRY(check_number("--normal-error", options.normal_error));
  if (options.normal_error && *options.normal_error > 180.0) {
    return Error{ErrorCode::kUsage, "--normal-error", "give degrees, 0 to 180"};
  }
  TRY(check_number("--uv-error", options.uv_error));
  run::AttributeBounds bounds;
  if (options.normal_error) bounds.normal_degrees = *options.normal_error;
  if (options.uv_error) bounds.uv = *options.uv_error;
  for (std::size_t m = 0; m < asset.meshes().size(); ++m) {
    const run::AttributeBounds own = run::bounds_for(bounds, asset.meshes()[m]);
    if (options.normal_error && own.normal_degrees == *options.normal_error) {
      TRY_LET(status, check_measured("--normal-error", asset, m, &format::GroupRecord::normal_deviation));
    }
    if (options.uv_error && own.uv == *options.uv_error) {
      if (const Status status = check_measured("--uv-error", asset, m, &format::GroupRecord::uv_deviation); !status) {
        return status.error();
      }
    }
  }
  return bounds;
}

}  // namespace meshlode::cli
