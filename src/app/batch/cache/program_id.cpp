// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/batch/cache/program_id.h"

#include <link.h>
#include <map>
#include <string>

#include "base/file.h"
#include "base/try.h"

namespace meshlode::app {

Result<Hash128> find_program_id() {
  std::map<std::string, std::string> libraries;  // name -> path; the order of loading is not the program's
  ::dl_iterate_phdr(
      [](struct dl_phdr_info* info, std::size_t, void* data) {
        const std::string path = info->dlpi_name;
        // The executable has no name here, and what the kernel lends (linux-vdso.so.1) has no file.
        if (path.find('/') == std::string::npos) return 0;
        (*static_cast<std::map<std::string, std::string>*>(data))[path.substr(path.rfind('/') + 1)] = path;
        return 0;
      },
      &libraries);
  libraries[""] = "/proc/self/exe";
  Hasher hasher;
  for (const auto& [name, path] : libraries) {
    TRY_LET(file, MappedFile::open(path));
    const std::string line = name + "\n" + to_hex(hash128(file->bytes())) + "\n";
    hasher.update({reinterpret_cast<const std::uint8_t*>(line.data()), line.size()});
  }
  return hasher.digest();
}

}  // namespace meshlode::app
