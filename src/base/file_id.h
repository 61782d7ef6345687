// SPDX-License-Identifier: MIT
// Which file a path leads to.
#pragma once

#include <compare>
#include <cstdint>

namespace meshlode {

/// Which file it is, whatever it is called: the same for every link to it. Of this machine and moment only.
struct FileId {
  std::uint64_t device = 0, inode = 0;
  friend auto operator<=>(const FileId&, const FileId&) = default;
};

}  // namespace meshlode
