// SPDX-License-Identifier: GPL-3.0-or-later
// A batch end to end: what is built, what is taken, what is left alone, and that all of it is the same bytes.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "app/batch/batch.h"
#include "app/batch/cache/cache.h"
#include "app/batch/cache/program_id.h"
#include "batch_folder.h"
#include "support/random.h"

namespace meshlode::app {
namespace {

namespace fs = std::filesystem;

class BatchTest : public testing::Test {
 protected:
  /// Builds in/NAME.gltf to OUT/NAME.lode.
  std::vector<JobResult> run(const std::vector<std::string>& names, const std::string& out, BatchOptions options = {},
                             bool with_cache = true) {
    std::optional<Cache> cache;
    if (with_cache) {
      cache.emplace(Store::open(folder_.path("cache"), {.is_read_only = options.is_dry_run}).value(), Hash128{1});
      options.cache = &*cache;
    }
    options.make_folders = true;
    options.pipeline.preset = Preset::kFast;
    std::vector<Job> jobs;
    for (const std::string& name : names) {
      jobs.push_back({folder_.path("in/" + name + ".gltf"), folder_.path(out + "/" + name + ".lode")});
    }
    OutputFiles files;
    return run_batch(jobs, options, files, watcher_);
  }
  static std::string statuses(const std::vector<JobResult>& results) {
    std::string text;
    for (const JobResult& r : results) text += (text.empty() ? "" : " ") + std::string(name_of(r.status));
    return text;
  }
  [[nodiscard]] std::string asset(const std::string& name) const { return BatchFolder::text_of(folder_.path(name)); }

  BatchFolder folder_;
  BatchWatcher watcher_;
};

TEST_F(BatchTest, ASecondRunDoesNothingAndAChangeRebuildsItsDependantsAlone) {
  for (const std::uint32_t i : {1, 2, 3}) folder_.write_scene("in/" + std::to_string(i), i);
  EXPECT_EQ(statuses(run({"1", "2", "3"}, "out")), "built built built");
  const auto written_at = fs::last_write_time(folder_.path("out/1.lode"));
  EXPECT_EQ(statuses(run({"1", "2", "3"}, "out")), "unchanged unchanged unchanged");
  EXPECT_EQ(fs::last_write_time(folder_.path("out/1.lode")), written_at);

  folder_.write("in/2.png", "a picture of 3");  // one byte of one texture
  const auto results = run({"1", "2", "3"}, "out");
  EXPECT_EQ(statuses(results), "unchanged built unchanged");
  EXPECT_EQ(results[1].reason, "image 2.png changed");
  folder_.write("in/2.png", "a picture of 2");
  EXPECT_EQ(statuses(run({"1", "2", "3"}, "out")), "unchanged cached unchanged");

  BatchOptions other;
  other.pipeline.codec = format::Codec::kNone;
  const auto with_codec = run({"1", "2"}, "out", other);
  EXPECT_EQ(statuses(with_codec), "built built");
  EXPECT_EQ(with_codec[0].reason, "codec is none, was strips");
  EXPECT_EQ(statuses(run({"1", "2", "3"}, "out")), "cached cached unchanged");
}

TEST_F(BatchTest, AnAssetThatIsRefusedStaysAndFailsItsJobHoweverItCame) {
  for (const std::uint32_t i : {1, 2}) folder_.write_scene("in/" + std::to_string(i), i);
  std::vector<fs::path> seen;
  BatchOptions picky;
  picky.check_asset = [&](const fs::path& asset) -> Status {
    EXPECT_TRUE(fs::exists(asset)) << asset;
    seen.push_back(asset);
    if (asset.filename() == "1.lode") return Error{ErrorCode::kCheckFailed, asset.string(), "too much"};
    return Ok{};
  };
  const auto built = run({"1", "2"}, "out", picky);
  EXPECT_EQ(statuses(built), "failed built");
  EXPECT_EQ(built[0].exit_code, static_cast<int>(ErrorCode::kCheckFailed));
  EXPECT_EQ(worst_exit_code(built), static_cast<int>(ErrorCode::kCheckFailed));
  EXPECT_NE(built[0].error.find("too much"), std::string::npos);
  EXPECT_EQ(statuses(run({"1", "2"}, "out", picky)), "failed unchanged");
  EXPECT_EQ(statuses(run({"1", "2"}, "other", picky)), "failed cached");
  EXPECT_EQ(seen.size(), 6U);
  EXPECT_EQ(statuses(run({"1", "2"}, "out")), "unchanged unchanged");
  picky.fail_fast = true;
  EXPECT_EQ(statuses(run({"1", "2"}, "out", picky)), "failed skipped");
  picky.is_dry_run = true;
  EXPECT_EQ(statuses(run({"1", "2"}, "out", picky)), "unchanged unchanged");
  EXPECT_EQ(seen.size(), 7U);
  // What was not made is not looked at.
  picky.is_dry_run = false;
  folder_.write("in/3.gltf", "broken");
  EXPECT_EQ(statuses(run({"3"}, "out", picky)), "failed");
  EXPECT_EQ(seen.size(), 7U);
}

TEST_F(BatchTest, WhatIsTakenIsWhatWouldBeBuilt) {
  folder_.write_scene("in/1", 1);
  const auto built = run({"1"}, "first");
  const auto taken = run({"1"}, "second");
  EXPECT_EQ(statuses(run({"1"}, "third", {}, false)), "built");
  EXPECT_EQ(statuses(taken), "cached");
  EXPECT_EQ(asset("first/1.lode"), asset("second/1.lode"));
  EXPECT_EQ(asset("first/1.lode"), asset("third/1.lode"));
  EXPECT_EQ(built[0].facts.triangles, 72U);
  EXPECT_EQ(taken[0].facts.triangles, 72U);
  EXPECT_EQ(taken[0].asset_hash, built[0].asset_hash);
}

// Twenty dozen edits of random files and settings, with returns to what was there before: always what a clean build
// writes.
TEST_F(BatchTest, TwoHundredRandomEditsGiveTheBytesOfCleanBuilds) {
  test::Random random(7);
  std::map<std::string, int> seen;
  for (const std::uint32_t i : {1, 2}) folder_.write_scene("in/" + std::to_string(i), i, 3);
  BatchOptions options;
  for (int edit = 0; edit < 200; ++edit) {
    const std::string name = random.below(2) == 0 ? "1" : "2";
    const auto variant = static_cast<std::uint32_t>(random.below(3));
    switch (random.below(6)) {
      case 0: folder_.write_scene("in/" + name, variant, 3); break;
      case 1: folder_.write("in/" + name + ".png", std::string(variant + 1, 'p')); break;
      case 2: fs::remove(folder_.path("in/" + name + ".png")); break;
      case 3: options.pipeline.normal_error = 0.1 * (1.0 + variant); break;
      case 4: options.pipeline.codec = variant == 0 ? format::Codec::kNone : format::Codec::kStrips; break;
      default: fs::remove(folder_.path("out/" + name + ".lode"));
    }
    options.import.may_lack_images = true;
    for (const JobResult& r : run({"1", "2"}, "out", options)) {
      ASSERT_EQ(r.error, "") << "edit " << edit;
      ++seen[name_of(r.status)];
    }
    run({"1", "2"}, "clean", options, false);
    for (const char* file : {"/1.lode", "/2.lode"}) {
      ASSERT_EQ(asset(std::string("out") + file), asset(std::string("clean") + file)) << "edit " << edit;
    }
  }
  for (const char* status : {"built", "cached", "unchanged"}) EXPECT_GT(seen[status], 20) << status;
}

// Below the file: another texture leaves the mesh as it was, another option does not.
TEST_F(BatchTest, AMeshThatIsTheSameIsNotBuiltAgain) {
  folder_.write_scene("in/1", 1, 24);
  EXPECT_EQ(run({"1"}, "out")[0].meshes_from_cache, 0U);
  folder_.write("in/1.png", "another picture");
  const auto painted = run({"1"}, "out");
  EXPECT_EQ(statuses(painted), "built");
  EXPECT_EQ(painted[0].meshes_from_cache, 1U);
  BatchOptions packed;
  packed.pipeline.codec = format::Codec::kNone;  // of the same mesh
  EXPECT_EQ(run({"1"}, "packed", packed)[0].meshes_from_cache, 1U);
  BatchOptions finer;
  finer.pipeline.position_error = 1e-4;
  EXPECT_EQ(run({"1"}, "finer", finer)[0].meshes_from_cache, 0U);
  run({"1"}, "clean/out", {}, false);
  run({"1"}, "clean/packed", packed, false);
  run({"1"}, "clean/finer", finer, false);
  for (const char* name : {"out/1.lode", "packed/1.lode", "finer/1.lode"}) {
    EXPECT_EQ(asset(name), asset(std::string("clean/") + name)) << name;
  }
}

TEST_F(BatchTest, ADryRunWritesNothingAndSaysWhatTheRunThenDoes) {
  folder_.write_scene("in/1", 1);
  BatchOptions dry;
  dry.is_dry_run = true;
  const auto before = run({"1"}, "out", dry);
  EXPECT_EQ(statuses(before), "would_build");
  EXPECT_EQ(before[0].reason, "not built before");
  EXPECT_FALSE(fs::exists(folder_.path("cache")));
  EXPECT_FALSE(fs::exists(folder_.path("out")));
  run({"1"}, "out");
  EXPECT_EQ(statuses(run({"1"}, "out", dry)), "unchanged");
  fs::remove(folder_.path("out/1.lode"));
  EXPECT_EQ(statuses(run({"1"}, "out", dry)), "would_copy");
  folder_.write("in/1.png", "x");
  EXPECT_EQ(run({"1"}, "out", dry)[0].reason, "image 1.png changed");
  fs::remove(folder_.path("in/1.bin"));
  EXPECT_EQ(statuses(run({"1"}, "out", dry)), "failed");
}

TEST_F(BatchTest, AnEntryThatWasSpoiltIsBuiltAnew) {
  folder_.write_scene("in/1", 1);
  run({"1"}, "out");
  const std::string sound = asset("out/1.lode");
  for (const char* kind : {"cache/asset", "cache/record"}) {
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path(kind))) {
      if (entry.is_regular_file()) fs::resize_file(entry.path(), fs::file_size(entry.path()) / 2);
    }
    fs::remove(folder_.path("out/1.lode"));
    EXPECT_EQ(statuses(run({"1"}, "out")), "built") << kind;
    EXPECT_EQ(asset("out/1.lode"), sound);
  }
}

/// So that an interrupt between the asset's name and the end of its job can say what is there.
TEST_F(BatchTest, BeforeAnAssetIsWrittenItsResultIsTold) {
  folder_.write_scene("in/1", 1);
  std::vector<JobResult> told;
  watcher_.on_write = [&](const JobResult& result) {
    EXPECT_FALSE(fs::exists(result.job.output));
    told.push_back(result);
  };
  const auto expect_told = [&](const JobResult& result) {
    ASSERT_EQ(told.size(), 1U);
    EXPECT_EQ(told[0].status, result.status);
    EXPECT_EQ(told[0].facts.bytes, fs::file_size(result.job.output));
    EXPECT_EQ(told[0].asset_hash, result.asset_hash);
    EXPECT_EQ(told[0].exit_code, 0);
    told.clear();
  };
  const auto built = run({"1"}, "out");
  EXPECT_EQ(statuses(built), "built");
  expect_told(built[0]);
  const auto cached = run({"1"}, "other");
  EXPECT_EQ(statuses(cached), "cached");
  expect_told(cached[0]);
  run({"1"}, "other");
  EXPECT_TRUE(told.empty());
}

TEST_F(BatchTest, OneFailureStopsTheOthersOnlyWhereAsked) {
  folder_.write_scene("in/1", 1);
  folder_.write("in/2.gltf", "broken");
  folder_.write_scene("in/3", 3);
  const auto all = run({"1", "2", "3"}, "out");
  EXPECT_EQ(statuses(all), "built failed built");
  EXPECT_EQ(worst_exit_code(all), 3);
  BatchOptions fast;
  fast.fail_fast = true;
  EXPECT_EQ(statuses(run({"1", "2", "3"}, "out", fast)), "unchanged failed skipped");
}

TEST_F(BatchTest, AMissingTextureIsAnErrorWhereStrictWhateverTheCacheHas) {
  folder_.write_scene("in/1", 1);
  fs::remove(folder_.path("in/1.png"));
  BatchOptions lenient;
  lenient.import.may_lack_images = true;
  EXPECT_EQ(statuses(run({"1"}, "out", lenient)), "built");
  const auto again = run({"1"}, "out", lenient);
  EXPECT_EQ(statuses(again), "unchanged");
  EXPECT_EQ(again[0].facts.left_out.size(), 1U);
  EXPECT_EQ(statuses(run({"1"}, "out")), "failed");
  folder_.write("in/1.png", "there again");
  EXPECT_EQ(statuses(run({"1"}, "out", lenient)), "built");
}

// An asset that draws nothing is told of, from the cache and where it already lies too, and refused where strict.
TEST_F(BatchTest, ASceneOfWhichNothingIsLeftIsNeverSilent) {
  const std::string points = R"("accessors":[{"componentType":5126,"type":"VEC3","count":3}],)";
  const std::string rest = R"("nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}]})";
  const std::string mesh = R"({"asset":{"version":"2.0"},)" + points + R"("meshes":[{"primitives":[{)";
  folder_.write("in/flat.gltf", mesh + R"("attributes":{"POSITION":0}}]}],)" + rest);
  folder_.write("in/lines.gltf", mesh + R"("mode":3,"attributes":{"POSITION":0}}]}],)" + rest);
  for (const char* status : {"built built", "unchanged unchanged", "cached cached"}) {
    if (status[0] == 'c') fs::remove_all(folder_.path("out"));
    const auto results = run({"flat", "lines"}, "out");
    ASSERT_EQ(statuses(results), status);
    ASSERT_EQ(results[0].warnings.size(), 1U);
    EXPECT_EQ(results[0].warnings[0].text, "nothing to draw: its one triangle has no area");
    ASSERT_EQ(results[1].warnings.size(), 1U);
    EXPECT_EQ(results[1].warnings[0].id, "nothing-to-draw");
  }
  BatchOptions strict;
  strict.is_strict = true;
  fs::remove_all(folder_.path("out"));
  for (const bool with_cache : {true, false}) {
    const auto refused = run({"flat", "lines"}, "out", strict, with_cache);
    EXPECT_EQ(statuses(refused), "failed failed");
    EXPECT_EQ(worst_exit_code(refused), 3);
    EXPECT_NE(refused[1].error.find("--strict: nothing to draw: it has no triangle"), std::string::npos);
    EXPECT_FALSE(fs::exists(folder_.path("out/flat.lode")));
  }
}

// Whoever reads the asset from the cache must not be given what came of files that changed in between.
TEST_F(BatchTest, ASceneThatChangesWhileItIsBuiltIsNotKept) {
  folder_.write_scene("in/1", 1);
  const Cache cache(Store::open(folder_.path("cache"), {}).value(), Hash128{1});
  BatchOptions options;
  options.cache = &cache;
  options.pipeline.preset = Preset::kFast;
  BatchWatcher watcher;
  watcher.on_progress = [&](const builder::ProgressEvent&) {
    folder_.write("in/1.png", "written meanwhile");
    return true;
  };
  OutputFiles files;
  const auto results = run_batch({{folder_.path("in/1.gltf"), folder_.path("1.lode")}}, options, files, watcher);
  EXPECT_EQ(statuses(results), "built");
  EXPECT_FALSE(fs::exists(folder_.path("cache/record")));
}

}  // namespace
}  // namespace meshlode::app
