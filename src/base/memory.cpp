// SPDX-License-Identifier: MIT
#include "base/memory.h"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "base/system.h"

namespace meshlode {

namespace {

namespace fs = std::filesystem;
using Amount = std::optional<std::uint64_t>;

/// The number of a file that holds one; nothing for "max", which is no limit, and for files that are not there.
Amount read_number(const fs::path& path) {
  std::ifstream in(path);
  std::uint64_t number = 0;
  return in >> number ? Amount(number) : std::nullopt;
}

/// The number behind `key` in a file of lines "key number …".
Amount read_entry(const fs::path& path, const std::string& key) {
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string name;
    std::uint64_t number = 0;
    if (words >> name >> number && name == key) return number;
  }
  return std::nullopt;
}

struct Names {
  const char *limit, *usage, *cache;
};
constexpr Names kVersion1{"memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"};
constexpr Names kVersion2{"memory.max", "memory.current", "inactive_file"};

/// What a group and all above it leave.
void add_groups(const fs::path& mount, const fs::path& group, const Names& names, std::vector<std::uint64_t>& out) {
  // A process may see its group under the name that it has outside, while only the mount's own files are there.
  for (fs::path at = group.relative_path();; at = at.parent_path()) {
    const fs::path folder = mount / at;
    const Amount limit = read_number(folder / names.limit), usage = read_number(folder / names.usage);
    if (limit && usage) {
      const std::uint64_t cache = read_entry(folder / "memory.stat", names.cache).value_or(0);
      const std::uint64_t used = *usage - std::min(*usage, cache);
      out.push_back(*limit - std::min(*limit, used));
    }
    if (at.empty()) return;
  }
}

}  // namespace

std::optional<std::uint64_t> available_memory(const fs::path& root) {
  std::vector<std::uint64_t> amounts;
  if (const Amount kilobytes = read_entry(root / "proc/meminfo", "MemAvailable:")) amounts.push_back(*kilobytes * 1024);
  std::ifstream groups(root / "proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {  // hierarchy:controllers:path
    const std::size_t first = line.find(':');
    const std::size_t second = first == std::string::npos ? first : line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    const fs::path group = line.substr(second + 1);
    if (controllers == ",,") {
      add_groups(root / "sys/fs/cgroup", group, kVersion2, amounts);
    } else if (controllers.find(",memory,") != std::string::npos) {
      add_groups(root / "sys/fs/cgroup/memory", group, kVersion1, amounts);
    }
  }
  if (const Amount left = root == "/" ? system::memory_left() : std::nullopt) amounts.push_back(*left);
  if (amounts.empty()) return std::nullopt;
  return *std::min_element(amounts.begin(), amounts.end());
}

void give_back_freed_memory() {
  system::give_back_freed_memory();
}

std::uint64_t resident_memory() {
  return system::resident_memory();
}

bool restart_peak_memory() {
  return system::restart_peak_memory();
}

std::uint64_t peak_memory() {
  return system::peak_memory();
}

}  // namespace meshlode
