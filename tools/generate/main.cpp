// SPDX-License-Identifier: GPL-3.0-or-later
// meshlode_generate OUTDIR                writes the scenes of data/
// meshlode_generate OUTDIR --aggregates   writes trees, grass, soups and other aggregates
// meshlode_generate OUTDIR --painted      writes a tree of bark and leaves, for measurements of what is painted
// meshlode_generate OUTDIR --triangles N  writes a terrain of about N triangles (16M, 500K, 42), for benchmarks
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

#include "base/amounts.h"
#include "base/file.h"
#include "lab/samples/samples.h"

namespace {

using namespace meshlode;

int write(const std::filesystem::path& folder, const lab::SampleFile& file) {
  const std::filesystem::path path = folder / file.name;
  if (const Status written = write_file_atomically(path, file.bytes); !written) {
    std::fprintf(stderr, "meshlode_generate: %s\n", written.error().message().c_str());
    return static_cast<int>(written.error().code);
  }
  std::printf("%s  %zu bytes\n", path.string().c_str(), file.bytes.size());
  return 0;
}

int run(const char* out_dir, const char* triangles_text, std::string_view option) {
  constexpr std::uint64_t kFewest = 2, kMost = 100'000'000;
  const std::optional<std::uint64_t> triangles = triangles_text == nullptr ? std::nullopt : parse_count(triangles_text);
  if (triangles_text != nullptr && (!triangles || *triangles < kFewest || *triangles > kMost)) {
    std::fputs("meshlode_generate: --triangles wants a number from 2 to 100M, such as 16M, 500K or 42\n", stderr);
    return static_cast<int>(ErrorCode::kUsage);
  }
  std::error_code failure;
  std::filesystem::create_directories(out_dir, failure);
  if (failure) {
    std::fprintf(stderr, "meshlode_generate: %s: %s\n", out_dir, failure.message().c_str());
    return static_cast<int>(ErrorCode::kIo);
  }
  if (triangles) return write(out_dir, lab::make_terrain_file(*triangles));
  if (option == "--painted") return write(out_dir, lab::make_painted_tree_file());
  if (option == "--layers") {
    for (const std::string& kind : lab::layered_kinds()) {
      for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        if (const int code = write(out_dir, lab::make_layered_file(kind, seed)); code != 0) return code;
      }
    }
    return 0;
  }
  if (option == "--aggregates") {
    for (const std::string& name : lab::aggregate_names()) {
      if (const int code = write(out_dir, lab::make_aggregate_file(name)); code != 0) return code;
    }
    return 0;
  }
  for (const std::string& name : lab::sample_names()) {
    if (const int code = write(out_dir, lab::make_sample_file(name)); code != 0) return code;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const bool has_triangles = argc == 4 && std::string_view(argv[2]) == "--triangles";
  const std::string_view option = argc == 3 ? argv[2] : "";
  const bool is_known =
      argc == 2 || has_triangles || option == "--aggregates" || option == "--painted" || option == "--layers";
  if (!is_known || argv[1][0] == '-') {
    std::fputs("usage: meshlode_generate OUTDIR [--triangles NUMBER | --aggregates | --layers | --painted]\n", stderr);
    return static_cast<int>(ErrorCode::kUsage);
  }
  return run(argv[1], has_triangles ? argv[3] : nullptr, option);
}
