// SPDX-License-Identifier: MIT
// A promise is chosen by putting its errors where the position's were: the rule, the hierarchy and all that is made of
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

Status Asset::choose(format::Promise promise) {
  if (!has_promise(promise)) {
    const std::string name(format::name_of(promise));
    return Error{ErrorCode::kUnsupported, "promise",
                 "the asset stores no errors for " + name + "; build it with --promise " + name};
  }
  meshes_ = stored_meshes_;
  groups_ = stored_groups_;
  nodes_ = stored_nodes_;
  chosen_ = promise;
  if (promise == format::Promise::kPosition) return Ok{};

  const bool is_texels = promise == format::Promise::kTexels;
  chosen_meshes_.assign(stored_meshes_.begin(), stored_meshes_.end());
  for (std::size_t m = 0; m < chosen_meshes_.size(); ++m) {
    chosen_meshes_[m].level0_deviation = is_texels ? promises_[m].level0_texels : promises_[m].level0_appearance;
  }
  chosen_groups_.assign(stored_groups_.begin(), stored_groups_.end());
  for (std::size_t g = 0; g < chosen_groups_.size(); ++g) {
    chosen_groups_[g].error = is_texels ? promise_errors_[g].texel_error : promise_errors_[g].appearance_error;
  }
  chosen_nodes_.assign(stored_nodes_.begin(), stored_nodes_.end());
  for (std::size_t n = chosen_nodes_.size(); n-- > 0;) {  // children stand behind their node
    format::NodeRecord& node = chosen_nodes_[n];
    if (node.child_count == 0) {
      node.error = chosen_groups_[node.first].error;
      continue;
    }
    float error = 0.0F;
    for (std::uint32_t c = node.first; c < node.first + node.child_count; ++c) {
      error = std::max(error, chosen_nodes_[c].error);
    }
    node.error = coarser_error(error);
  }
  meshes_ = chosen_meshes_;
  groups_ = chosen_groups_;
  nodes_ = chosen_nodes_;
  return Ok{};
}

}  // namespace meshlode::run
