// SPDX-License-Identifier: GPL-3.0-or-later
// Pages that another thread reads, however slowly: no frame waits for one, each draws what is there, and the last ones
// what a viewer of the whole file draws.
#include <meshlode/meshlode.h>
#include <meshlode/page_cache.h>

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "arrays.h"

namespace meshlode {
namespace {

/// A disk on which a read is under way until finish() is called.
class SlowDisk {
 public:
  /// By the thread that loads.
  void read() {
    std::unique_lock lock(mutex_);
    is_reading_ = true;
    changed_.notify_all();
    changed_.wait(lock, [&] { return !is_reading_ || is_over_; });
  }
  /// Whether a read is under way, or comes to be before the loader has nothing to do.
  [[nodiscard]] bool wait_for_read() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return is_reading_ || is_idle_; });
    return is_reading_;
  }
  void finish() {
    const std::lock_guard lock(mutex_);
    is_reading_ = false;
    changed_.notify_all();
  }
  /// The loader has nothing left to do.
  void rest() {
    const std::lock_guard lock(mutex_);
    is_idle_ = true;
    changed_.notify_all();
  }
  /// No read takes any time from now on.
  void end() {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool is_reading_ = false, is_idle_ = false, is_over_ = false;
};

TEST(SlowReads, NoFrameWaitsForOne) {
  BuildOptions options;
  options.preset = Preset::kFast;
  options.page_size = 16;
  const test::Arrays arrays(lab::make_sphere(64));
  const auto bytes = test::build_one(arrays.primitive(), options);
  ASSERT_TRUE(bytes.ok()) << bytes.error().message();
  meshlode_error error{};
  meshlode_asset* asset = nullptr;
  ASSERT_EQ(meshlode_open_buffer(bytes->data(), bytes->size(), &asset, &error), MESHLODE_OK) << error.text;
  meshlode_selector* selector = nullptr;
  ASSERT_EQ(meshlode_create_selector(asset, &selector, &error), MESHLODE_OK) << error.text;
  std::uint32_t page_count = 0, cluster_count = 0;
  const meshlode_page* const pages = meshlode_pages(asset, &page_count);
  (void)meshlode_clusters(asset, &cluster_count);
  ASSERT_GT(page_count, 8U);

  meshlode_view view{};
  view.eye[2] = 4.0;
  view.fovy_radians = 0.8;
  view.near_distance = 1e-3;
  view.height_px = 1080;
  const double pixel_error = 0.5;
  std::vector<meshlode_draw_item> items(cluster_count), whole(cluster_count);
  std::size_t count = 0, whole_count = 0;
  ASSERT_EQ(meshlode_select_view(asset, &view, pixel_error, whole.data(), whole.size(), &whole_count, &error),
            MESHLODE_OK)
      << error.text;

  std::vector<std::uint32_t> words(meshlode_page_cache_words(page_count, page_count));
  std::vector<float> priorities(page_count);
  meshlode_page_cache cache{};
  meshlode_page_cache_init(&cache, page_count, page_count, words.data(), priorities.data());
  std::vector<std::vector<std::uint32_t>> slots(page_count);
  std::mutex mutex;
  SlowDisk disk;
  const auto load = [&] {
    for (std::uint32_t page = 0, slot = 0;;) {
      {
        const std::lock_guard lock(mutex);
        if (meshlode_page_cache_begin(&cache, &page, &slot) == 0) break;
      }
      disk.read();
      const meshlode_range range = meshlode_page_range(asset, page);
      slots[slot].resize((pages[page].bytes + 3) / 4);
      const bool is_loaded = meshlode_unpack_page(asset, page, bytes->data() + range.offset, range.bytes,
                                                  slots[slot].data(), pages[page].bytes, nullptr) == MESHLODE_OK;
      EXPECT_TRUE(is_loaded);
      const std::lock_guard lock(mutex);
      meshlode_page_cache_end(&cache, page, is_loaded ? 1 : 0);
    }
    disk.rest();
  };

  std::uint32_t frames = 0, reads = 0, coarser = 0;
  const auto draw = [&] {
    const std::lock_guard lock(mutex);
    ASSERT_EQ(meshlode_select_resident(selector, &view, nullptr, pixel_error, cache.resident, items.data(),
                                       items.size(), &count, &error),
              MESHLODE_OK)
        << error.text;
    for (std::size_t i = 0; i < count; ++i)
      ASSERT_NE(meshlode_page_cache_has(&cache, meshlode_page_of(asset, items[i].cluster)), 0);
    std::size_t pages_known = 0;
    meshlode_page_cache_update(&cache, meshlode_page_priorities(selector, &pages_known));
    ++frames;
  };
  draw();
  EXPECT_EQ(count, 0U);
  std::thread loader(load);  // something is wanted by now
  for (; !testing::Test::HasFatalFailure() && disk.wait_for_read(); ++reads) {
    // The read is still under way when these frames are done, however long it takes.
    for (int k = 0; k < 3; ++k) draw();
    EXPECT_EQ(count > 0, reads > 0) << "the coarsest page is the first";
    coarser += count < whole_count ? 1U : 0U;
    disk.finish();
  }
  draw();
  EXPECT_GT(reads, 4U);
  EXPECT_EQ(coarser, reads);
  EXPECT_EQ(frames, 3 * reads + 2);
  EXPECT_EQ(count, whole_count);
  for (std::size_t i = 0; i < std::min(count, whole_count); ++i) EXPECT_EQ(items[i].cluster, whole[i].cluster);

  disk.end();
  loader.join();
  meshlode_destroy_selector(selector);
  meshlode_close(asset);
}

}  // namespace
}  // namespace meshlode
