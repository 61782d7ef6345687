// SPDX-License-Identifier: GPL-3.0-or-later
// bin/meshlode of the relocatable folder (folder.sh): starts ../libexec/meshlode by the folder's own loader, with the
// folder's own libraries, whatever the host has. The path of a loader is fixed in an executable, so that a folder that
// may lie anywhere needs this step. Linked statically: it needs no shell, no library and no /proc.
#include <sys/auxv.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

namespace {

constexpr int kCannotStart = 127;  // as a shell says it
constexpr const char* kLoader = "ld-linux-x86-64.so.2";

int fail(const char* what, const std::string& path) {
  std::fprintf(stderr, "meshlode: %s: %s: %s\n", what, path.c_str(), std::strerror(errno));
  return kCannotStart;
}

}  // namespace

int main(int, char** argv) {
  // Where this file lies: the kernel's answer, or, without /proc, the path that it was started by. Links are followed:
  // npm starts it by one.
  char self[PATH_MAX];
  const ssize_t length = ::readlink("/proc/self/exe", self, sizeof self - 1);
  if (length > 0) {
    self[length] = '\0';
  } else {
    const auto* started_by = reinterpret_cast<const char*>(::getauxval(AT_EXECFN));
    if (started_by == nullptr || ::realpath(started_by, self) == nullptr)
      return fail("cannot find its own folder", "AT_EXECFN");
  }
  std::string folder = self;
  for (int level = 0; level < 2; ++level) {  // /bin/meshlode
    const std::size_t slash = folder.rfind('/');
    if (slash == std::string::npos) return fail("cannot find its own folder", self);
    folder.resize(slash);
  }
  errno = EINVAL;
  // The loader takes ':' and ';' for the end of a path, and expands '$'.
  if (folder.find_first_of(":;$") != std::string::npos)
    return fail("cannot run from a path with ':', ';' or '$'", folder);

  std::string loader = folder + "/lib/libc/" + kLoader;
  std::string libraries = folder + "/lib:" + folder + "/lib/libc";
  // A driver of a distribution that is newer than the folder wants that one's libc: with it, --gpu works there.
  const char* libc = std::getenv("MESHLODE_LIBC");
  if (libc != nullptr && std::strcmp(libc, "host") == 0) {
    loader = std::string("/lib64/") + kLoader;
    libraries = folder + "/lib";
  } else {
    // Libraries of the host want the host's libc.
    ::unsetenv("LD_PRELOAD");
    ::unsetenv("LD_AUDIT");
  }
  std::string option = "--library-path", program = folder + "/libexec/meshlode";
  std::vector<char*> command{loader.data(), option.data(), libraries.data(), program.data()};
  while (*argv != nullptr && *++argv != nullptr) command.push_back(*argv);
  command.push_back(nullptr);
  ::execv(loader.c_str(), command.data());
  return fail("cannot start", loader);
}
