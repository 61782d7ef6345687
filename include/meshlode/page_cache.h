/* SPDX-License-Identifier: MIT */
/** \file
 * A pool of page slots, to copy or to use: which page is in which slot, what is loaded next, and who makes room. C99, a
 * header alone; nothing in meshlode needs it.
 *
 * After each selection (meshlode_select_resident) give it the priorities. Then, as often as reads are
 * wanted, meshlode_page_cache_begin names a page to load and the slot for it; when its bytes are there,
 * meshlode_page_cache_end makes it resident. `resident` is what the next selection takes.
 *
 * A slot needs the bytes of the asset's largest page: a large group has a page larger than the rest.
 *
 * A page makes room only for one of higher priority. Of several of the same priority the one goes that was not wanted
 * for the longest time.
 *
 * Threads. No call reads, waits or takes memory; each is short. Calls on one cache are for one thread at a time: where
 * others load, they and the renderer hold the same lock around each call. From meshlode_page_cache_begin on, the slot
 * is the loader's, and a page that was in it is no longer resident: begin only when no frame is drawn from it any more.
 */
#ifndef MESHLODE_PAGE_CACHE_H
#define MESHLODE_PAGE_CACHE_H

#include <meshlode/meshlode.h>

#ifdef __cplusplus
extern "C" {
#endif

/** A pool. Read its members, and change none. */
typedef struct meshlode_page_cache {
  uint32_t page_count;    /**< of the asset */
  uint32_t slot_count;    /**< of the pool */
  uint32_t* slot_of_page; /**< MESHLODE_NONE: in no slot */
  uint32_t* page_of_slot; /**< MESHLODE_NONE: free; of one that is being loaded, the page that it will hold */
  uint32_t* resident;     /**< page p: bit p % 32 of word p / 32 */
  uint32_t* wanted_at;    /**< per page, the last update that wanted it */
  float* priorities;      /**< per page, of the last update */
  uint32_t update_count;  /**< updates so far */
} meshlode_page_cache;

/** Words of memory that a cache needs, beside a float per page and the slots themselves. */
static inline size_t meshlode_page_cache_words(uint32_t page_count, uint32_t slot_count) {
  const size_t pages = page_count;
  return 2 * pages + slot_count + (pages + 31) / 32;
}

/** Memory of the caller, which the cache uses as long as it is used: `words`, meshlode_page_cache_words of them, and a
 * float per page. */
static inline void meshlode_page_cache_init(meshlode_page_cache* cache, uint32_t page_count, uint32_t slot_count,
                                            uint32_t* words, float* priorities) {
  uint32_t i;
  cache->page_count = page_count;
  cache->slot_count = slot_count;
  cache->slot_of_page = words;
  cache->page_of_slot = words + page_count;
  cache->wanted_at = cache->page_of_slot + slot_count;
  cache->resident = cache->wanted_at + page_count;
  cache->priorities = priorities;
  cache->update_count = 0;
  for (i = 0; i < slot_count; ++i) cache->page_of_slot[i] = MESHLODE_NONE;
  for (i = 0; i < page_count; ++i) {
    cache->slot_of_page[i] = MESHLODE_NONE;
    cache->wanted_at[i] = 0;
    cache->priorities[i] = 0.0f;
    cache->resident[i / 32] = 0;
  }
}

/** 1 if the page is in its slot, and not on its way. */
static inline int meshlode_page_cache_has(const meshlode_page_cache* cache, uint32_t page) {
  return (cache->resident[page / 32] >> page % 32 & 1u) != 0u;
}

/** After a selection: meshlode_page_priorities, or the largest of several views'. What was requested before and is not
 * on its way is forgotten. */
static inline void meshlode_page_cache_update(meshlode_page_cache* cache, const float* priorities) {
  uint32_t p;
  ++cache->update_count;
  for (p = 0; p < cache->page_count; ++p) {
    cache->priorities[p] = priorities[p];
    if (priorities[p] > 0.0f) cache->wanted_at[p] = cache->update_count;
  }
}

/** The next page to load: the wanted one of highest priority that is in no slot, of the same priority the one of
 * smallest id. `*slot` is free, or was that of a page of lower priority. \return 1; 0 if nothing is wanted, or has a
 * slot to go to */
static inline int meshlode_page_cache_begin(meshlode_page_cache* cache, uint32_t* page, uint32_t* slot) {
  uint32_t p, s, next = MESHLODE_NONE, victim = MESHLODE_NONE;
  for (p = 0; p < cache->page_count; ++p) {
    if (cache->slot_of_page[p] != MESHLODE_NONE || !(cache->priorities[p] > 0.0f)) continue;
    if (next == MESHLODE_NONE || cache->priorities[p] > cache->priorities[next]) next = p;
  }
  if (next == MESHLODE_NONE) return 0;
  for (s = 0; s < cache->slot_count; ++s) {
    const uint32_t held = cache->page_of_slot[s], best = victim == MESHLODE_NONE ? victim : cache->page_of_slot[victim];
    if (held == MESHLODE_NONE) {
      victim = s;
      break;
    }
    if (!meshlode_page_cache_has(cache, held) || !(cache->priorities[held] < cache->priorities[next])) continue;
    if (victim == MESHLODE_NONE || cache->priorities[held] < cache->priorities[best] ||
        (cache->priorities[held] == cache->priorities[best] && cache->wanted_at[held] < cache->wanted_at[best])) {
      victim = s;
    }
  }
  if (victim == MESHLODE_NONE) return 0;
  if (cache->page_of_slot[victim] != MESHLODE_NONE) {
    const uint32_t old = cache->page_of_slot[victim];
    cache->resident[old / 32] &= ~(1u << old % 32);
    cache->slot_of_page[old] = MESHLODE_NONE;
  }
  cache->page_of_slot[victim] = next;
  cache->slot_of_page[next] = victim;
  *page = next;
  *slot = victim;
  return 1;
}

/** The load of a page ended. With `is_loaded` the page is resident from here on; else its slot is free, and the page
 * is not asked for again before the next update. */
static inline void meshlode_page_cache_end(meshlode_page_cache* cache, uint32_t page, int is_loaded) {
  if (is_loaded) {
    cache->resident[page / 32] |= 1u << page % 32;
  } else {
    cache->page_of_slot[cache->slot_of_page[page]] = MESHLODE_NONE;
    cache->slot_of_page[page] = MESHLODE_NONE;
    cache->priorities[page] = 0.0f;
  }
}

#ifdef __cplusplus
}
#endif

#endif /**< MESHLODE_PAGE_CACHE_H */
