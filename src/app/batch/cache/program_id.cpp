// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/batch/cache/program_id.h"

#include <link.h>
#include <sys/auxv.h>
#include <unistd.h>

#include <filesystem>
#include <map>
#include <string>
#include <system_error>

#include "base/file.h"
#include "base/try.h"

namespace meshlode::app {

namespace {

constexpr const char* kSelf = "/proc/self/exe";

/// The executable where it was given to the loader by name: to the kernel the loader is the program, started by no
/// other loader (AT_BASE), and glibc's puts the path of what it loads into AT_EXECFN. Null where the kernel started the
/// executable.
const char* loaded_by_name() {
  return ::getauxval(AT_BASE) == 0 ? reinterpret_cast<const char*>(::getauxval(AT_EXECFN)) : nullptr;
}

}  // namespace

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
  const char* path_by_loader = loaded_by_name();
  libraries[""] = path_by_loader != nullptr ? path_by_loader : kSelf;
  Hasher hasher;
  for (const auto& [name, path] : libraries) {
    TRY_LET(file, MappedFile::open(path));
    const std::string line = name + "\n" + to_hex(hash128(file->bytes())) + "\n";
    hasher.update({reinterpret_cast<const std::uint8_t*>(line.data()), line.size()});
  }
  return hasher.digest();
}

Result<std::filesystem::path> find_launcher() {
  const char* path = loaded_by_name();
  if (path == nullptr) return std::filesystem::path(kSelf);
  // /libexec/meshlode -> /bin/meshlode
  std::error_code ec;
  auto launcher = std::filesystem::absolute(path, ec).parent_path().parent_path() / "bin" / "meshlode";
  if (::access(launcher.c_str(), X_OK) != 0) {
    return Error{ErrorCode::kIo, launcher.string(),
                 "is missing; it starts a program that the loader was given by name"};
  }
  return launcher;
}

}  // namespace meshlode::app
