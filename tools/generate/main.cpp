// SPDX-License-Identifier: GPL-3.0-or-later
// meshlode_generate OUTDIR              writes the scenes of data/
// meshlode_generate OUTDIR --terrain N  writes a terrain of about N triangles, for benchmarks
#include <charconv>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string_view>

#include "base/file.h"
#include "scene/samples/samples.h"

namespace {

using namespace meshlode;

int write(const std::filesystem::path& folder, const scene::SampleFile& file) {
  const std::filesystem::path path = folder / file.name;
  if (const Status written = write_file_atomically(path, file.bytes); !written) {
    std::fprintf(stderr, "meshlode_generate: %s\n", written.error().message().c_str());
    return static_cast<int>(written.error().code);
  }
  std::printf("%s  %zu bytes\n", path.string().c_str(), file.bytes.size());
  return 0;
}

int run(const char* out_dir, const char* terrain) {
  std::error_code failure;
  std::filesystem::create_directories(out_dir, failure);
  if (failure) {
    std::fprintf(stderr, "meshlode_generate: %s: %s\n", out_dir, failure.message().c_str());
    return static_cast<int>(ErrorCode::kIo);
  }
  if (terrain != nullptr) {
    std::uint64_t triangles = 0;
    const char* end = terrain + std::strlen(terrain);
    const auto parsed = std::from_chars(terrain, end, triangles);
    if (parsed.ec != std::errc{} || parsed.ptr != end || triangles < 2 || triangles > 100'000'000) {
      std::fputs("meshlode_generate: --terrain wants a number of triangles, 2 to 100000000\n", stderr);
      return static_cast<int>(ErrorCode::kUsage);
    }
    return write(out_dir, scene::make_terrain_file(triangles));
  }
  for (const std::string& name : scene::sample_names()) {
    if (const int code = write(out_dir, scene::make_sample_file(name)); code != 0) return code;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const bool has_terrain = argc == 4 && std::string_view(argv[2]) == "--terrain";
  if ((argc != 2 && !has_terrain) || argv[1][0] == '-') {
    std::fputs("usage: meshlode_generate OUTDIR [--terrain TRIANGLES]\n", stderr);
    return 1;
  }
  return run(argv[1], has_terrain ? argv[3] : nullptr);
}
