// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/sweep/machine.h"

#include <fstream>

#include <sys/utsname.h>
#include <unistd.h>

#include "base/parallel.h"

namespace meshlode::lab {

MachineFacts describe_machine() {
  MachineFacts facts{"unknown processor", "unknown system", static_cast<std::uint32_t>(thread_limit()), 0};
  std::ifstream processors("/proc/cpuinfo");
  for (std::string line; std::getline(processors, line);) {
    const std::size_t colon = line.find(": ");
    if (!line.starts_with("model name") || colon == std::string::npos) continue;
    facts.processor = line.substr(colon + 2);
    break;
  }
  utsname name{};
  if (::uname(&name) == 0) facts.system = std::string(name.sysname) + " " + name.release;
  const long pages = ::sysconf(_SC_PHYS_PAGES), bytes = ::sysconf(_SC_PAGE_SIZE);
  if (pages > 0 && bytes > 0) {
    facts.memory_bytes = static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(bytes);
  }
  return facts;
}

}  // namespace meshlode::lab
