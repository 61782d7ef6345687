// SPDX-License-Identifier: GPL-3.0-or-later
// The program of docs/tutorials/streaming-pages.md: what it reads, what it draws, and that the page shows it.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <meshlode/build.h>
#include <meshlode/runtime.h>

#include "arrays.h"
#include "draw/textures/image_readers.h"
#include "support/sanitized.h"

namespace meshlode {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

using Read = std::pair<std::uint64_t, std::uint64_t>;  // offset, bytes

/// What the shim wrote down; empty where anything but pread was used.
std::vector<Read> reads_of(const fs::path& log) {
  std::vector<Read> reads;
  std::ifstream in(log);
  std::string call;
  for (Read read; in >> call >> read.first >> read.second;) {
    EXPECT_EQ(call, "pread");
    reads.push_back(read);
  }
  return reads;
}

/// Of a picture of the program, which libpng has to accept: those that differ from the background.
std::size_t drawn_pixels(const fs::path& path) {
  const std::string bytes = text_of(path);
  std::vector<std::uint32_t> texels;
  const auto header = draw::read_png({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, &texels);
  EXPECT_TRUE(header.ok()) << path;
  EXPECT_EQ(texels.size(), 640U * 480U);
  return static_cast<std::size_t>(
      std::count_if(texels.begin(), texels.end(), [](std::uint32_t t) { return (t & 0xFFFFFFU) != 0x202020U; }));
}

TEST(StreamingPages, ReadsTheHeadAndWantedPagesAlone) {
  if (test::kIsSanitized) GTEST_SKIP() << "the runtime of the sanitizers has to be the first library";
  const fs::path folder = fs::path(testing::TempDir()) / "streaming_pages";
  fs::remove_all(folder);
  fs::create_directories(folder);
  const test::Arrays arrays(lab::make_sphere(160));
  BuildOptions options;
  options.preset = Preset::kFast;
  const auto bytes = test::build_one(arrays.primitive(), options);
  ASSERT_TRUE(bytes.ok()) << bytes.error().message();
  std::ofstream(folder / "sphere.lode", std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes->data()), static_cast<std::streamsize>(bytes->size()));
  const std::string command = "READS_LOG='" + (folder / "log").string() + "' LD_PRELOAD='" MESHLODE_LOG_READS "' '" +
                              MESHLODE_STREAMING_PAGES "' '" + (folder / "sphere.lode").string() + "' '" +
                              (folder / "frame").string() + "' 12 > '" + (folder / "out").string() + "'";
  ASSERT_EQ(std::system(command.c_str()), 0) << command;

  const auto asset = AssetFile::view(*bytes);
  ASSERT_TRUE(asset.ok());
  ASSERT_GT(asset->pages().size(), 8U);
  const std::vector<Read> reads = reads_of(folder / "log");
  ASSERT_GT(reads.size(), 4U);
  const std::uint64_t table = 64 + 64 * std::uint64_t{asset->header().section_count};
  const std::uint64_t head = asset->pages()[0].offset;
  EXPECT_EQ(reads[0], Read(0, 64));
  EXPECT_EQ(reads[1], Read(64, table - 64));
  EXPECT_EQ(reads[2], Read(table, head - table));
  std::set<Read> pages;
  for (const format::PageRecord& page : asset->pages()) pages.insert({page.offset, page.stored_bytes});
  for (std::size_t r = 3; r < reads.size(); ++r) EXPECT_TRUE(pages.contains(reads[r])) << r;

  unsigned clusters = 0, used = 0, pool = 0;
  ASSERT_EQ(
      std::sscanf(text_of(folder / "out").c_str(), "%u clusters, %u bytes in a pool of %u", &clusters, &used, &pool),
      3);
  std::uint64_t decoded = 0;
  for (const format::PageRecord& page : asset->pages()) decoded += page.bytes;
  EXPECT_EQ(pool, decoded / 4);
  EXPECT_LE(used, pool);
  EXPECT_GT(clusters, 0U);
  // Nothing is there for the first frame; the last one shows the sphere.
  EXPECT_EQ(drawn_pixels(folder / "frame000.png"), 0U);
  EXPECT_GT(drawn_pixels(folder / "frame011.png"), 30'000U);
  fs::remove_all(folder);
}

TEST(StreamingPages, SmallAssetsAreDrawnAndNothingIsAnError) {
  // Their coarsest pages are more than a quarter of all.
  const fs::path folder = fs::path(testing::TempDir()) / "streaming_small";
  for (const char* name : {"rock", "crystal"}) {
    fs::remove_all(folder);
    fs::create_directories(folder);
    const fs::path asset = folder / "asset.lode";
    const std::string build = "'" MESHLODE_PROGRAM "' build --quiet --preset fast '" +
                              (fs::path(MESHLODE_SOURCE_DIR) / "data" / name).string() + ".glb' -o '" + asset.string() +
                              "'";
    ASSERT_EQ(std::system(build.c_str()), 0) << build;
    const std::string command =
        "'" MESHLODE_STREAMING_PAGES "' '" + asset.string() + "' '" + (folder / "frame").string() + "' ";
    EXPECT_EQ(std::system((command + "4").c_str()), 0) << name;
    EXPECT_GT(drawn_pixels(folder / "frame003.png"), 3'000U) << name;
    EXPECT_NE(std::system((command + "1 2>/dev/null").c_str()), 0) << "nothing is there for the first frame";
  }
  fs::remove_all(folder);
}

TEST(StreamingPages, ThePageShowsTheProgram) {
  const fs::path root = MESHLODE_SOURCE_DIR;
  const std::string code = text_of(root / "docs/examples/streaming_pages.c");
  const std::string page = text_of(root / "docs/tutorials/streaming-pages.md");
  const std::string begin = "```c\n";
  int blocks = 0;
  for (std::size_t at = page.find(begin); at != std::string::npos; at = page.find(begin, at)) {
    at += begin.size();
    const std::string block = page.substr(at, page.find("```", at) - at);
    EXPECT_NE(code.find(block), std::string::npos) << "not in docs/examples/streaming_pages.c:\n" << block;
    ++blocks;
  }
  EXPECT_EQ(blocks, 2);
  EXPECT_LE(std::count(code.begin(), code.end(), '\n'), 230);
}

}  // namespace
}  // namespace meshlode
