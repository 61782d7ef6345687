// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "app/batch/depend/dependencies.h"
#include "app/batch/depend/depfile.h"
#include "batch_folder.h"

namespace meshlode::app {
namespace {

TEST(Dependencies, AreTheSceneAndAllThatItNames) {
  const BatchFolder folder;
  const auto scene = folder.write_scene("a", 1);
  std::filesystem::remove(folder.path("a.png"));
  const auto files = find_dependencies(scene);
  ASSERT_TRUE(files) << files.error().message();
  ASSERT_EQ(files->size(), 3U);
  EXPECT_EQ((*files)[0].path, scene);
  EXPECT_EQ((*files)[1].kind, FileKind::kBuffer);
  const std::string bin = BatchFolder::text_of(folder.path("a.bin"));
  EXPECT_EQ((*files)[1].hash, hash128({reinterpret_cast<const std::uint8_t*>(bin.data()), bin.size()}));
  EXPECT_EQ((*files)[2].kind, FileKind::kImage);
  EXPECT_FALSE((*files)[2].stamp);
}

TEST(Dependencies, NoticeEveryWayInWhichAFileIsAnotherOne) {
  const BatchFolder folder;
  const auto scene = folder.write_scene("a", 1);
  const auto files = find_dependencies(scene);
  ASSERT_TRUE(files);
  EXPECT_TRUE(are_unchanged(*files));
  const std::string bin = BatchFolder::text_of(folder.path("a.bin"));
  const auto written_at = std::filesystem::last_write_time(folder.path("a.bin"));
  folder.write("a.bin", std::string(bin.size(), 'x'));  // the same length, and soon the same time
  std::filesystem::last_write_time(folder.path("a.bin"), written_at);
  EXPECT_FALSE(are_unchanged(*files));
  const auto again = find_dependencies(scene);
  ASSERT_TRUE(again);
  EXPECT_TRUE(are_unchanged(*again));
  std::filesystem::remove(folder.path("a.png"));
  EXPECT_FALSE(are_unchanged(*again));
}

TEST(Dependencies, CoverWhatWasReadOrSayThatTheyDoNot) {
  const BatchFolder folder;
  const auto files = find_dependencies(folder.write_scene("a", 1));
  ASSERT_TRUE(files);
  const auto id_of = [&](const char* name) { return find_file_id(folder.path(name)).value(); };
  EXPECT_TRUE(cover(*files, std::vector{id_of("a.gltf"), id_of("a.bin"), id_of("a.png")}));
  folder.write("b.mtl", "");
  EXPECT_FALSE(cover(*files, std::vector{id_of("a.gltf"), id_of("b.mtl")}));
}

TEST(Depfile, HasARuleForEachOutputAndEmptyOnesForWhatMayGo) {
  EXPECT_EQ(
      *depfile_text({{"out/a.lode", {"in/a.gltf", "in/a.bin", "in/my pic#1$.png"}}, {"out/b.lode", {"in/b.glb"}}}),
      "out/a.lode: in/a.gltf \\\n  in/a.bin \\\n  in/my\\ pic\\#1$$.png\n"
      "out/b.lode: in/b.glb\n"
      "in/a.bin:\n"
      "in/my\\ pic\\#1$$.png:\n");
}

TEST(Depfile, RefusesANameWithALineBreak) {
  for (const std::vector<DepfileRule>& rules : {std::vector<DepfileRule>{{"out/a\n.lode", {"in/a.gltf"}}},
                                                std::vector<DepfileRule>{{"a.lode", {"a.gltf", "x\ry.png"}}}}) {
    const auto text = depfile_text(rules);
    ASSERT_FALSE(text);
    EXPECT_EQ(text.error().code, ErrorCode::kUsage);
  }
}

}  // namespace
}  // namespace meshlode::app
