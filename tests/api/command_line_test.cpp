// SPDX-License-Identifier: GPL-3.0-or-later
// BuildOptions can say all that `meshlode build` can be told, and means the same by it: the same bytes.
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshlode/build.h>

namespace meshlode {
namespace {

namespace fs = std::filesystem;

struct Saying {
  const char* words;                          ///< of the command line
  std::function<void(BuildOptions&)> fields;  ///< the same
  const char* scene = "city.glb";
};

const Saying kSayings[] = {
    {"", [](BuildOptions&) {}},
    {"--error-tier measured", [](BuildOptions& o) { o.error_tier = format::ErrorTier::kMeasured; }},
    {"--error-tier certified", [](BuildOptions& o) { o.error_tier = format::ErrorTier::kCertified; }},
    {"--preset default", [](BuildOptions& o) { o.preset = Preset::kDefault; }},
    {"--preset fast", [](BuildOptions& o) { o.preset = Preset::kFast; }},
    {"--preset best", [](BuildOptions& o) { o.preset = Preset::kBest; }},
    {"--preset fast --error-tier measured",
     [](BuildOptions& o) { o.preset = Preset::kFast, o.error_tier = format::ErrorTier::kMeasured; }},
    {"--attributes none", [](BuildOptions& o) { o.attributes = AttributeChoice::kNone; }},
    {"--attributes all", [](BuildOptions& o) { o.attributes = AttributeChoice::kAll; }},
    {"--keep NORMAL", [](BuildOptions& o) { o.keep = kAttributeNormal; }},
    // Foliage's masks are textures, which the library does not read: the default differs there.
    {"--drop TEXCOORD_0 --aggregate never",
     [](BuildOptions& o) { o.drop = attribute_texcoord(0), o.aggregate = AggregateChoice::kNever; }, "foliage.glb"},
    {"--grid 0.01", [](BuildOptions& o) { o.grid_step = 0.01; }},
    {"--position-error 0.002", [](BuildOptions& o) { o.position_error = 0.002; }},
    {"--normal-error 0.5", [](BuildOptions& o) { o.normal_error = 0.5; }},
    {"--uv-error 0.001 --aggregate never",
     [](BuildOptions& o) { o.uv_error = 0.001, o.aggregate = AggregateChoice::kNever; }, "foliage.glb"},
    {"--uv-error 0.25px --aggregate never",
     [](BuildOptions& o) {
       o.uv_error = 0.25, o.uv_error_unit = UvErrorUnit::kTexels, o.aggregate = AggregateChoice::kNever;
     },
     "foliage.glb"},
    {"--codec none", [](BuildOptions& o) { o.codec = format::Codec::kNone; }},
    {"--codec none --jobs 2", [](BuildOptions& o) { o.codec = format::Codec::kNone, o.thread_count = 2; }},
    {"--strip-effort fast --codec strips",
     [](BuildOptions& o) { o.strip_effort = StripEffort::kFast, o.codec = format::Codec::kStrips; }},
    {"--cluster-triangles 64", [](BuildOptions& o) { o.cluster_triangles = 64; }},
    {"--keep-topology", [](BuildOptions& o) { o.keep_topology = true; }},
    {"--lock-borders --grid 0.01", [](BuildOptions& o) { o.lock_borders = true, o.grid_step = 0.01; }, "foliage.glb"},
    {"--page-size 16", [](BuildOptions& o) { o.page_size = 16; }},
    {"--page-order covisible", [](BuildOptions& o) { o.page_order = PageOrder::kCovisible; }},
    {"--page-size 16 --root-bytes 65536", [](BuildOptions& o) { o.page_size = 16, o.root_bytes = 65536; }},
    {"--page-hints", [](BuildOptions& o) { o.page_hints = true; }},
    {"--keep-layers off", [](BuildOptions& o) { o.keep_layers = false; }},
    {"--aggregate auto", [](BuildOptions& o) { o.aggregate = AggregateChoice::kAuto; }},
    {"--aggregate always", [](BuildOptions& o) { o.aggregate = AggregateChoice::kAlways; }},
    {"--promise texels --error-tier measured --aggregate never",
     [](BuildOptions& o) {
       o.promise = format::Promise::kTexels, o.error_tier = format::ErrorTier::kMeasured;
       o.aggregate = AggregateChoice::kNever;
     },
     "foliage.glb"},
    {"--group-clusters 12", [](BuildOptions& o) { o.group_clusters = 12; }},
    {"--strict", [](BuildOptions&) {}},  // the library always is
    {"--repair", [](BuildOptions& o) { o.repair = true; }},
    {"--linear-colors", [](BuildOptions& o) { o.linear_colors = true; }},
    {"--allow-outside .", [](BuildOptions& o) { o.allow_outside = {"."}; }},  // no file of data/ names another
    {"--max-memory 64GiB", [](BuildOptions& o) { o.max_memory_bytes = std::uint64_t{64} << 30U; }},
    {"--max-decoded 1MiB", [](BuildOptions& o) { o.max_decoded_bytes = std::uint64_t{1} << 20U; }},
};

std::vector<char> bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string run_program(const std::string& words) {
  const std::string command = std::string("'") + MESHLODE_PROGRAM + "' " + words;
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::string text;
  std::array<char, 4096> part{};
  for (std::size_t n = 1; pipe && n > 0;) {
    n = std::fread(part.data(), 1, part.size(), pipe.get());
    text.append(part.data(), n);
  }
  return text;
}

/// "--codec" and the like, wherever they stand.
std::set<std::string> options_in(const std::string& text) {
  std::set<std::string> options;
  for (std::size_t at = text.find("--"); at != std::string::npos; at = text.find("--", at + 2)) {
    const std::size_t end = text.find_first_not_of("abcdefghijklmnopqrstuvwxyz-", at);
    if (end > at + 2) options.insert(text.substr(at, end - at));
  }
  return options;
}

TEST(ApiCommandLine, WhatBothSayTheSameWayGivesTheSameBytes) {
  const fs::path folder = fs::path(testing::TempDir()) / "meshlode_api_command_line";
  fs::create_directories(folder);
  const fs::path theirs = folder / "program.lode", ours = folder / "library.lode";
  for (const Saying& saying : kSayings) {
    const fs::path scene = fs::path(MESHLODE_SOURCE_DIR) / "data" / saying.scene;
    std::string words = saying.words;
    BuildOptions options;
    if (!words.empty() && words.find("--error-tier") == std::string::npos &&
        words.find("--preset") == std::string::npos) {  // the quick one, where it is not the point
      words += " --error-tier qem";
      options.error_tier = format::ErrorTier::kQem;
    }
    run_program("build '" + scene.string() + "' -o '" + theirs.string() + "' --quiet " + words);
    saying.fields(options);
    const Status built = build_file(scene, ours, options);
    ASSERT_TRUE(built.ok()) << saying.words << ": " << built.error().message();
    const std::vector<char> expected = bytes_of(theirs);
    EXPECT_FALSE(expected.empty()) << saying.words;
    EXPECT_TRUE(expected == bytes_of(ours)) << saying.words;
    fs::remove(theirs);
    fs::remove(ours);
  }
  fs::remove_all(folder);
}

TEST(ApiCommandLine, EveryOptionOfBuildIsSaid) {
  // Files, reports, the terminal, batches, their shares and budgets, and the cache are the program's own, and which
  // scene of a file is built, and words that stand for several options. The library decodes no image: no textures.
  std::set<std::string> said = {
      "--help",    "--output",    "--output-folder", "--report", "--format",           "--quiet",
      "--junit",   "--manifest",  "--depfile",       "--cache",  "--no-cache",         "--cache-limit",
      "--dry-run", "--fail-fast", "--explain",       "--scene",  "--no-settings-file", "--settings-root",
      "--fail-if", "--shard",     "--color",         "--for",    "--textures",         "--shard-costs"};
  for (const Saying& saying : kSayings) said.merge(options_in(saying.words));
  const std::set<std::string> offered = options_in(run_program("build --help"));
  ASSERT_TRUE(offered.contains("--error-tier"));
  for (const std::string& option : offered) EXPECT_TRUE(said.contains(option)) << "BuildOptions lacks " << option;
}

}  // namespace
}  // namespace meshlode
