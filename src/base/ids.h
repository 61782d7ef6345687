// SPDX-License-Identifier: MIT
// Ids of different spaces are different types: mixing them is this field's commonest silent bug.
#pragma once

#include <compare>
#include <cstdint>

namespace meshlode {

constexpr std::uint32_t kNoId = 0xFFFFFFFFu;  ///< "no such id", of any space; format::kNone has the same bits

template <class Tag>
struct Id {
  std::uint32_t value = kNoId;

  constexpr Id() = default;
  constexpr explicit Id(std::uint32_t v) : value(v) {}
  constexpr explicit Id(std::size_t v) : value(static_cast<std::uint32_t>(v)) {}
  [[nodiscard]] constexpr bool is_valid() const { return value != kNoId; }
  constexpr auto operator<=>(const Id&) const = default;
};

using MeshId = Id<struct MeshTag>;          ///< a glTF mesh, in file order
using InstanceId = Id<struct InstanceTag>;  ///< a node that draws a mesh
using MaterialId = Id<struct MaterialTag>;  ///< a glTF material; the default material has an id of its own
using GroupId = Id<struct GroupTag>;        ///< a group of clusters: global in an asset, per mesh during the build
using ClusterId = Id<struct ClusterTag>;    ///< a cluster: global in an asset, per mesh during the build
using PageId = Id<struct PageTag>;
using NodeId = Id<struct NodeTag>;  ///< a BVH node

}  // namespace meshlode
