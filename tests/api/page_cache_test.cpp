// SPDX-License-Identifier: GPL-3.0-or-later
// The pool of page_cache.h under random priorities, with loads that take a while or fail: its tables agree, a page
// makes room for a more important one alone, and what is wanted is there in the end if it fits.
#include <meshlode/page_cache.h>

#include <algorithm>
#include <deque>
#include <vector>

#include <gtest/gtest.h>

#include "support/random.h"

namespace meshlode {
namespace {

class Pool {
 public:
  Pool(std::uint32_t pages, std::uint32_t slots)
      : words_(meshlode_page_cache_words(pages, slots), 0xDEADBEEFU), priorities_(pages) {
    meshlode_page_cache_init(&cache, pages, slots, words_.data(), priorities_.data());
  }
  void expect_agrees() const {
    std::uint32_t held = 0;
    for (std::uint32_t p = 0; p < cache.page_count; ++p) {
      const std::uint32_t slot = cache.slot_of_page[p];
      if (slot == MESHLODE_NONE) {
        ASSERT_EQ(meshlode_page_cache_has(&cache, p), 0) << p;
        continue;
      }
      ++held;
      ASSERT_LT(slot, cache.slot_count);
      ASSERT_EQ(cache.page_of_slot[slot], p);
    }
    const auto free = std::count(cache.page_of_slot, cache.page_of_slot + cache.slot_count, MESHLODE_NONE);
    ASSERT_EQ(held + static_cast<std::uint32_t>(free), cache.slot_count);
  }
  meshlode_page_cache cache{};

 private:
  std::vector<std::uint32_t> words_;
  std::vector<float> priorities_;
};

std::vector<float> random_priorities(test::RandomSource& random, std::uint32_t pages) {
  std::vector<float> priorities(pages, 0.0F);
  for (float& priority : priorities) {
    if (random.chance(0.5)) priority = static_cast<float>(1 + random.below(6));
  }
  priorities[0] = MESHLODE_INFINITE_ERROR;
  return priorities;
}

TEST(PageCache, TablesAgreeAndRoomIsMadeForWhatMattersMore) {
  test::RandomSource random(501);
  for (int n = 0; n < 40; ++n) {
    const std::uint32_t pages = 1 + random.below(100), slots = 1 + random.below(30);
    Pool pool(pages, slots);
    std::deque<std::uint32_t> loading;
    for (int step = 0; step < 300; ++step) {
      if (step % 5 == 0) meshlode_page_cache_update(&pool.cache, random_priorities(random, pages).data());
      const std::vector<std::uint32_t> before(pool.cache.page_of_slot, pool.cache.page_of_slot + slots);
      const std::vector<std::uint32_t> resident(pool.cache.resident, pool.cache.resident + (pages + 31) / 32);
      const std::vector<std::uint32_t> slot_of(pool.cache.slot_of_page, pool.cache.slot_of_page + pages);
      std::uint32_t page = 0, slot = 0;
      if (meshlode_page_cache_begin(&pool.cache, &page, &slot) != 0) {
        const float* priorities = pool.cache.priorities;
        ASSERT_EQ(slot_of[page], MESHLODE_NONE);
        ASSERT_GT(priorities[page], 0.0F);
        for (std::uint32_t p = 0; p < pages; ++p) {
          ASSERT_TRUE(slot_of[p] != MESHLODE_NONE || priorities[p] < priorities[page] ||
                      (priorities[p] == priorities[page] && p >= page));
        }
        if (before[slot] != MESHLODE_NONE) {
          ASSERT_EQ(std::count(before.begin(), before.end(), MESHLODE_NONE), 0);
          ASSERT_LT(priorities[before[slot]], priorities[page]);
          for (const std::uint32_t other : before) {
            const bool is_there = (resident[other / 32] >> other % 32 & 1U) != 0;
            ASSERT_TRUE(!is_there || priorities[other] > priorities[before[slot]] ||
                        (priorities[other] == priorities[before[slot]] &&
                         pool.cache.wanted_at[other] >= pool.cache.wanted_at[before[slot]]));
          }
        }
        ASSERT_EQ(meshlode_page_cache_has(&pool.cache, page), 0) << "on its way, not there";
        loading.push_back(page);
      }
      pool.expect_agrees();
      if (!loading.empty() && random.chance(0.6)) {
        const bool is_loaded = random.chance(0.9);
        meshlode_page_cache_end(&pool.cache, loading.front(), is_loaded ? 1 : 0);
        ASSERT_EQ(meshlode_page_cache_has(&pool.cache, loading.front()), is_loaded ? 1 : 0);
        loading.pop_front();
        pool.expect_agrees();
      }
    }
  }
}

TEST(PageCache, APageThatFailsIsAskedForOnceAnUpdate) {
  Pool pool(18, 6);
  for (int update = 0; update < 3; ++update) {
    const std::vector<float> priorities(18, 1.0F);
    meshlode_page_cache_update(&pool.cache, priorities.data());
    std::uint32_t page = 0, slot = 0, failures = 0, calls = 0;
    while (meshlode_page_cache_begin(&pool.cache, &page, &slot) != 0) {
      failures += page == 0 ? 1 : 0;
      meshlode_page_cache_end(&pool.cache, page, page == 0 ? 0 : 1);
      pool.expect_agrees();
      ASSERT_LE(++calls, 18U);
    }
    EXPECT_EQ(failures, update == 0 ? 1U : 0U);  // then the pool is full of pages that are as important
    EXPECT_EQ(meshlode_page_cache_has(&pool.cache, 1), 1);
  }
}

TEST(PageCache, TheMostImportantPagesAreThereInTheEnd) {
  test::RandomSource random(502);
  for (int n = 0; n < 200; ++n) {
    const std::uint32_t pages = 1 + random.below(80), slots = 1 + random.below(40);
    Pool pool(pages, slots);
    for (int update = 0; update < 4; ++update) {
      const std::vector<float> priorities = random_priorities(random, pages);
      meshlode_page_cache_update(&pool.cache, priorities.data());
      std::uint32_t page = 0, slot = 0, loads = 0;
      while (meshlode_page_cache_begin(&pool.cache, &page, &slot) != 0) {
        meshlode_page_cache_end(&pool.cache, page, 1);
        ASSERT_LE(++loads, pages);
      }
      float least_there = MESHLODE_INFINITE_ERROR, most_missing = 0.0F;
      std::uint32_t there = 0;
      for (std::uint32_t p = 0; p < pages; ++p) {
        if (meshlode_page_cache_has(&pool.cache, p) != 0) {
          ++there;
          least_there = std::min(least_there, priorities[p]);
        } else {
          most_missing = std::max(most_missing, priorities[p]);
        }
      }
      ASSERT_TRUE(most_missing == 0.0F || (there == slots && most_missing <= least_there));
    }
  }
}

}  // namespace
}  // namespace meshlode
