// SPDX-License-Identifier: GPL-3.0-or-later
// data/ is what the generator makes: a change of the generator or of the compiler's arithmetic shows here.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numeric>

#include <gtest/gtest.h>

#include "lab/samples/samples.h"

namespace meshlode::lab {
namespace {

using namespace scene;

std::vector<std::uint8_t> read_all(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

TEST(Samples, DataFolderHoldsExactlyWhatTheGeneratorMakes) {
  for (const std::string& name : sample_names()) {
    const SampleFile made = make_sample_file(name);
    const std::vector<std::uint8_t> stored = read_all(std::filesystem::path(MESHLODE_DATA_DIR) / name);
    ASSERT_EQ(made.bytes.size(), stored.size()) << name;
    const auto at = std::mismatch(made.bytes.begin(), made.bytes.end(), stored.begin()).first;
    EXPECT_EQ(at, made.bytes.end()) << name << " differs first at byte " << at - made.bytes.begin();
  }
}

TEST(Samples, DataFolderStaysSmall) {
  std::uintmax_t bytes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(MESHLODE_DATA_DIR)) bytes += entry.file_size();
  EXPECT_LT(bytes, 5'000'000u);
}

TEST(Samples, FilesAreGlbContainersOfTheirLength) {
  for (const std::string& name : sample_names()) {
    const std::vector<std::uint8_t> bytes = make_sample_file(name).bytes;
    ASSERT_GT(bytes.size(), 20u);
    EXPECT_EQ(std::string(bytes.begin(), bytes.begin() + 4), "glTF");
    const std::size_t length = bytes[8] | bytes[9] << 8 | bytes[10] << 16 | bytes[11] << 24;
    EXPECT_EQ(length, bytes.size()) << name;
  }
}

TEST(Samples, TerrainFileHasAboutTheTrianglesAsked) {
  const std::size_t small = make_terrain_file(200).bytes.size(), large = make_terrain_file(20000).bytes.size();
  EXPECT_GT(large, small + 9900 * 32);
}

}  // namespace
}  // namespace meshlode::lab
