// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/preview/plan_report.h"

#include <cmath>
#include <map>
#include <utility>

#include "base/append_format.h"
#include "base/byte_size.h"
#include "base/printable.h"

namespace meshlode::app {

namespace {

constexpr std::size_t kMaxPlanRows = 40;  ///< of meshes and features: a city has thousands; JSON lists all

std::uint64_t whole(double bytes) {
  return static_cast<std::uint64_t>(std::llround(bytes));
}

void add_line(std::string& out, bool kept, const std::string& what, const std::string& reason) {
  append_format(out, "  %-9s %s: %s\n", kept ? "kept" : "left out", printable(what, 120).c_str(),
                printable(reason, 300).c_str());
}

std::string bytes_text(double bytes, bool kept) {
  return whole(bytes) > 0 ? "; about " + byte_size_text(whole(bytes)) + (kept ? "" : " saved") : std::string();
}

/// What several meshes leave out for one reason is said once, after them.
struct SharedLoss {
  std::size_t meshes = 0;
  double bytes = 0.0;
};
using SharedLosses = std::map<std::pair<std::string, std::string>, SharedLoss>;  ///< by attribute and reason

SharedLosses find_shared_losses(const ScenePlan& plan) {
  SharedLosses losses;
  for (const PlannedMesh& mesh : plan.meshes) {
    for (const PlannedAttribute& item : mesh.attributes) {
      if (item.decision.kept) continue;
      SharedLoss& loss = losses[{item.decision.attribute, item.decision.reason}];
      loss.meshes += 1;
      loss.bytes += item.bytes;
    }
  }
  std::erase_if(losses, [](const auto& loss) { return loss.second.meshes == 1; });
  return losses;
}

void add_attribute(std::string& out, const PlannedAttribute& item, const SharedLosses& shared) {
  const builder::PlanDecision& decision = item.decision;
  if (!decision.kept && shared.contains({decision.attribute, decision.reason})) return;
  std::string reason = decision.reason;
  if (!item.precision.empty()) reason += "; " + item.precision;
  reason += bytes_text(item.bytes, decision.kept);
  append_format(out, "    %-9s %s: %s\n", decision.kept ? "kept" : "left out", decision.attribute.c_str(),
                reason.c_str());
}

void add_more_of_plan(std::string& out, std::size_t total, const char* what) {
  if (total > kMaxPlanRows)
    append_format(out, "  … and %zu more %s (plan --format json lists all)\n", total - kMaxPlanRows, what);
}

std::string gpu_text(const std::optional<std::uint64_t>& bytes) {
  return bytes ? byte_size_text(*bytes) + " on a GPU" : "not decoded here";
}

std::string size_text(const std::optional<ImageSize>& size) {
  return size ? std::to_string(size->width) + "x" + std::to_string(size->height) : "size not known";
}

void add_images(std::string& out, const std::vector<PlannedImage>& images) {
  if (images.empty()) return;
  std::uint64_t bytes = 0, gpu = 0, stored_gpu = 0;
  for (const PlannedImage& image : images) {
    bytes += image.bytes;
    gpu += image.gpu_bytes.value_or(0);
    stored_gpu += image.stored_gpu_bytes.value_or(0);
  }
  append_format(out, "images: %s, %s decoded with mip levels on a GPU", byte_size_text(bytes).c_str(),
                byte_size_text(gpu).c_str());
  if (stored_gpu != gpu) {
    append_format(out, ", %s as they will be stored, by their heads: a damaged image stays as it is",
                  byte_size_text(stored_gpu).c_str());
  }
  out += "\n";
  for (std::size_t i = 0; i < images.size() && i < kMaxPlanRows; ++i) {
    const PlannedImage& image = images[i];
    append_format(out, "  %u  %s: %s, %s, %s, %s", image.source_index, printable(image.name, 80).c_str(),
                  printable(image.mime_type, 40).c_str(), size_text(image.size).c_str(),
                  byte_size_text(image.bytes).c_str(), gpu_text(image.gpu_bytes).c_str());
    if (image.stored_gpu_bytes != image.gpu_bytes) {
      append_format(out, "; stored as %s, %s", size_text(image.stored_size).c_str(),
                    gpu_text(image.stored_gpu_bytes).c_str());
    }
    out += "\n";
  }
  add_more_of_plan(out, images.size(), "images");
}

void write_optional(JsonWriter& json, const char* key, const std::optional<std::uint64_t>& number) {
  json.key(key);
  if (number) {
    json.value(*number);
  } else {
    json.null();
  }
}

void write_size(JsonWriter& json, const char* width, const char* height, const std::optional<ImageSize>& size) {
  write_optional(json, width, size ? std::optional<std::uint64_t>(size->width) : std::nullopt);
  write_optional(json, height, size ? std::optional<std::uint64_t>(size->height) : std::nullopt);
}

}  // namespace

std::string describe_plan(const ScenePlan& plan) {
  std::string out = "attributes (bytes are estimates)\n";
  const SharedLosses shared = find_shared_losses(plan);
  std::size_t small = 0;
  for (std::size_t i = 0; i < plan.meshes.size(); ++i) {
    const PlannedMesh& mesh = plan.meshes[i];
    small += mesh.is_whole ? 1 : 0;
    if (i >= kMaxPlanRows) continue;
    append_format(out, "  %s: %s triangles, about %s\n", printable(mesh.label, 120).c_str(),
                  grouped_digits(mesh.triangles).c_str(), byte_size_text(whole(mesh.bytes)).c_str());
    for (const PlannedAttribute& item : mesh.attributes) add_attribute(out, item, shared);
    if (mesh.is_whole)
      append_format(out, "    passed through: one cluster holds all of it, there is nothing to coarsen\n");
    if (mesh.triangles == 0) append_format(out, "    passed through: it has no triangles\n");
  }
  add_more_of_plan(out, plan.meshes.size(), "meshes");
  for (const auto& [what, loss] : shared) {
    append_format(out, "  left out  %s, %zu of %zu meshes: %s%s\n", what.first.c_str(), loss.meshes, plan.meshes.size(),
                  what.second.c_str(), bytes_text(loss.bytes, false).c_str());
  }
  add_images(out, plan.images);
  append_format(out, "features\n");
  for (std::size_t i = 0; i < plan.features.size() && i < kMaxPlanRows; ++i) {
    add_line(out, plan.features[i].kept, plan.features[i].what, plan.features[i].reason);
  }
  add_more_of_plan(out, plan.features.size(), "features");
  if (small > 0) {
    add_line(out, true, std::to_string(small) + " of " + std::to_string(plan.meshes.size()) + " meshes",
             "one cluster each: passed through without levels of detail");
  } else if (plan.features.empty()) {
    append_format(out, "  none beside its triangles\n");
  }
  return out;
}

void write_plan(JsonWriter& json, const ScenePlan& plan) {
  json.key("meshes");
  json.begin_array();
  for (const PlannedMesh& mesh : plan.meshes) {
    json.begin_object();
    json.field("label", mesh.label);
    json.field("source_triangles", mesh.triangles);
    json.field("source_vertices", mesh.vertices);
    json.field("is_one_cluster", mesh.is_whole);
    json.field("grid_log2", mesh.grid.log2);
    json.field("grid_mantissa", mesh.grid.mantissa);
    json.field("estimated_bytes", whole(mesh.bytes));
    json.key("attributes");
    json.begin_array();
    for (const PlannedAttribute& item : mesh.attributes) {
      json.begin_object();
      json.field("name", item.decision.attribute);
      json.field("kept", item.decision.kept);
      json.field("reason", item.decision.reason);
      json.field("precision", item.precision);
      json.field("estimated_bytes", whole(item.bytes));
      json.end_object();
    }
    json.end_array();
    json.end_object();
  }
  json.end_array();
  json.key("images");
  json.begin_array();
  for (const PlannedImage& image : plan.images) {
    json.begin_object();
    json.field("name", image.name);
    json.field("mime_type", image.mime_type);
    json.field("source_index", image.source_index);
    json.field("bytes", image.bytes);
    write_size(json, "width", "height", image.size);
    write_optional(json, "gpu_bytes", image.gpu_bytes);
    write_size(json, "stored_width", "stored_height", image.stored_size);
    write_optional(json, "stored_gpu_bytes", image.stored_gpu_bytes);
    json.end_object();
  }
  json.end_array();
  json.key("features");
  json.begin_array();
  for (const builder::PlanDecision& feature : plan.features) {
    json.begin_object();
    json.field("what", feature.what);
    json.field("kept", feature.kept);
    json.field("reason", feature.reason);
    json.end_object();
  }
  json.end_array();
}

}  // namespace meshlode::app
