// SPDX-License-Identifier: GPL-3.0-or-later
// replay PATH...: feeds each file, and each file of each folder in the order of their names, to the harness it is
// linked with. With --mutate N each file is followed by N seeded mutants, a short fuzzing for compilers without
// libFuzzer; with
// --truncate files of at most 4 KiB are followed by each of their truncations.
#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "harness.h"
#include "support/random.h"

namespace {

using Bytes = std::vector<std::uint8_t>;

std::vector<std::filesystem::path> list_files(const std::filesystem::path& path) {
  if (!std::filesystem::is_directory(path)) return {path};
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(path)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

Bytes mutate(Bytes bytes, meshlode::test::Random& random) {
  const std::uint64_t changes = 1 + random.below(4);
  for (std::uint64_t i = 0; i < changes && !bytes.empty(); ++i) {
    const std::size_t at = random.below(bytes.size());
    switch (random.below(6)) {
      case 0: bytes[at] = static_cast<std::uint8_t>(random.next()); break;
      case 1: bytes[at] ^= static_cast<std::uint8_t>(1U << random.below(8)); break;
      case 2: bytes[at] = random.below(2) == 0 ? 0xFF : 0x00; break;
      case 3: bytes.resize(at); break;
      case 4: bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at), 1 + random.below(8), bytes[at]); break;
      default: {
        const std::size_t from = random.below(bytes.size());
        const std::size_t count = std::min(bytes.size() - std::max(from, at), 1 + random.below(16));
        std::memmove(bytes.data() + at, bytes.data() + from, count);
        break;
      }
    }
  }
  return bytes;
}

/// Exactly as long as the bytes, so that the address sanitizer sees a read behind their end.
void feed(const Bytes& bytes) {
  const Bytes exact(bytes.begin(), bytes.end());
  LLVMFuzzerTestOneInput(exact.data(), exact.size());
}

}  // namespace

int main(int argc, char** argv) {
  std::uint64_t mutants = 0;
  bool truncates = false;
  std::size_t count = 0;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--mutate") == 0 && i + 1 < argc) {
      mutants = std::strtoull(argv[++i], nullptr, 10);
      continue;
    }
    if (std::strcmp(argv[i], "--truncate") == 0) {
      truncates = true;
      continue;
    }
    for (const auto& path : list_files(argv[i])) {
      std::ifstream in(path, std::ios::binary);
      const Bytes bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
      if (!in) {
        std::fprintf(stderr, "cannot read %s\n", path.string().c_str());
        return 2;
      }
      feed(bytes);
      for (std::size_t size = 0; truncates && bytes.size() <= 4096 && size < bytes.size(); ++size) {
        feed(Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)));
      }
      meshlode::test::Random random(31 + count);
      for (std::uint64_t m = 0; m < mutants; ++m) feed(mutate(bytes, random));
      ++count;
    }
  }
  std::printf("%zu files, %llu mutants of each: nothing found\n", count, static_cast<unsigned long long>(mutants));
  return count > 0 ? 0 : 2;  // an empty corpus would pass without having looked at anything
}
