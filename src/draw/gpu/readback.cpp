// SPDX-License-Identifier: GPL-3.0-or-later
// What comes back of a frame: its cut, its pixels, its colours; and the frame drawn again with items in order.
#include <algorithm>
#include <array>
#include <cstring>

#include "base/try.h"
#include "draw/gpu/push.h"
#include "draw/gpu/renderer.h"
#include "draw/gpu/shaders.h"

namespace meshlode::draw {

Result<GpuCounters> Renderer::read_counters() {
  GpuCounters out{};
  const std::span<std::uint8_t> bytes(reinterpret_cast<std::uint8_t*>(&out), sizeof out);
  TRY(device_.download(counters_block_, bytes));
  return out;
}

Result<std::vector<GpuVisible>> Renderer::read_visible() {
  TRY_LET(counters, read_counters());
  std::vector<GpuVisible> out(std::min(counters->stages[STAGE_SLOTS].count, frame_.slot_capacity));
  const std::span<std::uint8_t> bytes(reinterpret_cast<std::uint8_t*>(out.data()), out.size() * sizeof(GpuVisible));
  TRY(device_.download(visible_, bytes));
  return out;
}

Result<std::vector<Renderer::Item>> Renderer::read_items() {
  TRY_LET(counters, read_counters());
  TRY_LET(visible, read_visible());
  const std::uint32_t front = std::min(counters->stages[STAGE_SOFTWARE].count, frame_.item_capacity);
  const std::uint32_t back = std::min(counters->stages[STAGE_HARDWARE].count, frame_.item_capacity - front);
  std::vector<GpuItem> items(std::size_t{front} + back);
  const std::span<std::uint8_t> bytes(reinterpret_cast<std::uint8_t*>(items.data()), items.size() * sizeof(GpuItem));
  TRY(device_.download(items_, bytes.first(front * sizeof(GpuItem))));
  TRY(device_.download(items_, bytes.subspan(front * sizeof(GpuItem)),
                       (frame_.item_capacity - back) * sizeof(GpuItem)));
  std::vector<Item> out;
  for (std::uint32_t i = 0; i < items.size(); ++i) {
    const auto& [marked_slot, cluster, view] = items[i];
    const std::uint32_t slot = marked_slot & ITEM_SLOT;
    if (slot >= visible->size()) return Error{ErrorCode::kCheckFailed, "items", "a slot that no instance has"};
    if (view != 0) return Error{ErrorCode::kCheckFailed, "items", "a view that the frame does not have"};
    const std::uint32_t place = i < front ? i : frame_.item_capacity - back + (i - front);
    out.push_back({{InstanceId((*visible)[slot].instance), ClusterId(cluster)}, marked_slot, place});
  }
  std::sort(out.begin(), out.end(), [](const Item& a, const Item& b) { return a.key < b.key; });
  return out;
}

Result<std::vector<run::ClusterInstance>> Renderer::read_cut() {
  TRY_LET(items, read_items());
  std::vector<run::ClusterInstance> out;
  for (const Item& item : *items) out.push_back(item.key);
  return out;
}

Status Renderer::redraw_in_order() {
  TRY_LET(before, read_counters());
  const std::uint32_t front = std::min(before->stages[STAGE_SOFTWARE].count, frame_.item_capacity);
  const std::uint32_t back = std::min(before->stages[STAGE_HARDWARE].count, frame_.item_capacity - front);
  const std::uint32_t count = front + back;
  // Both ends of the list become one, in order.
  TRY_LET(list, Commands::begin(device_));
  if (back > 0) {
    const std::uint64_t bytes = back * sizeof(GpuItem);
    TRY_LET(rest, device_.make_buffer(bytes, Memory::kDevice));  // the two places may overlap
    list->copy(items_, (frame_.item_capacity - back) * sizeof(GpuItem), *rest, 0, bytes);
    list->barrier();
    list->copy(*rest, 0, items_, front * sizeof(GpuItem), bytes);
    list->barrier();
  }
  for (std::uint32_t run = 1; run < count; run *= 2) {
    for (std::uint32_t distance = run; distance > 0; distance /= 2) {
      const Push push{frame_block_.address(), 0, run, count, distance};
      list->dispatch(sort_, bytes_of(push), (count + kGroupSize - 1) / kGroupSize);
      list->barrier();
    }
  }
  TRY(list->run());
  GpuCounters counters = counters_;
  counters.stages[STAGE_SOFTWARE] = {count, std::min(count, kGroupRow), (count + kGroupRow - 1) / kGroupRow, 1};
  counters.stages[STAGE_HARDWARE] = counters.stages[STAGE_SOFTWARE];  // the far ones' pass looks at all items too
  counters.stages[STAGE_HARDWARE].count = 0;
  counters.stages[STAGE_SLOTS] = before->stages[STAGE_SLOTS];
  std::memcpy(upload_.mapped(), &frame_, sizeof frame_);
  std::memcpy(upload_.mapped() + sizeof frame_, &counters, sizeof counters);
  TRY(lists_[1].run());
  return Ok{};
}

Result<VisibilityBuffer> Renderer::read_pixels() {
  std::vector<std::uint64_t> values(std::size_t{frame_.width} * frame_.height);
  const std::span<std::uint8_t> bytes(reinterpret_cast<std::uint8_t*>(values.data()), values.size() * 8);
  TRY(device_.download(pixels_, bytes));
  VisibilityBuffer out = make_visibility_buffer(frame_.width, frame_.height);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i] == 0) continue;
    const std::uint32_t key = ~static_cast<std::uint32_t>(values[i]);
    out.depth[i] = static_cast<std::uint32_t>(values[i] >> 32);
    out.item[i] = key >> 8;
    out.triangle[i] = key & 0xFFu;
  }
  return out;
}

Result<VisibilityBuffer> Renderer::read_pixels_of_cut() {
  TRY_LET(items, read_items());
  std::vector<std::uint32_t> index(frame_.item_capacity, VisibilityBuffer::kNothing);
  for (std::size_t i = 0; i < items->size(); ++i) index[(*items)[i].place] = static_cast<std::uint32_t>(i);
  TRY_LET(out, read_pixels());
  for (std::uint32_t& item : out->item) {
    if (item == VisibilityBuffer::kNothing) continue;
    if (item >= index.size() || index[item] == VisibilityBuffer::kNothing) {
      return Error{ErrorCode::kCheckFailed, "pixels", "an item that no list has"};
    }
    item = index[item];
  }
  return out;
}

Result<Renderer::Resolved> Renderer::resolve(std::uint32_t view, std::uint32_t level_count) {
  const std::array<std::uint32_t, 4> constants = {0, 0, 0, view};
  const bool is_textured = scene_.surfaces && (view == VIEW_SHADED || view == VIEW_NORMALS);
  TRY_LET(pipeline,
          device_.make_compute(find_shader(is_textured ? "resolve_textures.comp" : "resolve.comp"), constants));
  TRY_LET(list, Commands::begin(device_));
  const Push push{frame_block_.address(), 0, 0, 0, level_count};
  list->stamp("begin");
  list->dispatch(*pipeline, bytes_of(push), (frame_.width * frame_.height + kGroupSize - 1) / kGroupSize);
  list->barrier();
  list->stamp("resolve");
  TRY_LET(times, list->run());
  Resolved out;
  out.milliseconds = times->empty() ? 0.0 : times->front().milliseconds;
  out.image.width = frame_.width;
  out.image.height = frame_.height;
  out.image.rgba.resize(std::size_t{frame_.width} * frame_.height * 4);
  TRY(device_.download(colors_, out.image.rgba));
  return out;
}

}  // namespace meshlode::draw
