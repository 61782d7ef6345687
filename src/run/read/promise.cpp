// SPDX-License-Identifier: MIT
// An asset by another promise has its errors where the position's were: the rule, the hierarchy and all that is made of
// them (a GPU's buffers too) stay as they are.
#include <algorithm>

#include "format/names.h"
#include "run/read/asset.h"
#include "run/read/nesting.h"

namespace meshlode::run {

bool Asset::has_promise(format::Promise promise) const {
  if (promise == format::Promise::kPosition) return true;
  // Without a mesh there is nothing that a promise could say.
  if (promises_.empty()) return false;
  const std::uint32_t needed =
      promise == format::Promise::kTexels ? format::kPromisesTexels : format::kPromisesAppearance;
  return (promises_[0].promises & needed) != 0;
}

Result<Asset> Asset::with_promise(format::Promise promise) const {
  if (!has_promise(promise)) {
    const std::string name(format::name_of(promise));
    return Error{ErrorCode::kUnsupported, "promise",
                 "the asset stores no errors for " + name + "; build it with --promise " + name};
  }
  Asset out = *this;
  out.promise_ = promise;
  out.meshes_ = stored_.meshes;
  out.groups_ = stored_.groups;
  out.nodes_ = stored_.nodes;
  out.errors_ = nullptr;
  if (promise == format::Promise::kPosition) return out;

  const bool is_texels = promise == format::Promise::kTexels;
  const auto errors = std::make_shared<PromiseErrors>();
  errors->meshes.assign(stored_.meshes.begin(), stored_.meshes.end());
  for (std::size_t m = 0; m < errors->meshes.size(); ++m) {
    errors->meshes[m].level0_deviation = is_texels ? promises_[m].level0_texels : promises_[m].level0_appearance;
  }
  errors->groups.assign(stored_.groups.begin(), stored_.groups.end());
  for (std::size_t g = 0; g < errors->groups.size(); ++g) {
    errors->groups[g].error = is_texels ? promise_errors_[g].texel_error : promise_errors_[g].appearance_error;
  }
  errors->nodes.assign(stored_.nodes.begin(), stored_.nodes.end());
  for (std::size_t n = errors->nodes.size(); n-- > 0;) {  // children stand behind their node
    format::NodeRecord& node = errors->nodes[n];
    if (node.child_count == 0) {
      node.error = errors->groups[node.first].error;
      continue;
    }
    float error = 0.0F;
    for (std::uint32_t c = node.first; c < node.first + node.child_count; ++c) {
      error = std::max(error, errors->nodes[c].error);
    }
    node.error = coarser_error(error);
  }
  out.meshes_ = errors->meshes;
  out.groups_ = errors->groups;
  out.nodes_ = errors->nodes;
  out.errors_ = errors;
  return out;
}

}  // namespace meshlode::run
