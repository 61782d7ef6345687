// SPDX-License-Identifier: GPL-3.0-or-later
// <meshlode/build.h>: checks what a caller passes, runs the pipeline in as many threads as asked for, and turns what a
// third party throws into an Error.
#include <meshlode/build.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <optional>
#include <string>
#include <utility>

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "base/guarded.h"
#include "base/output_files.h"
#include "base/try.h"
#include "builder/api/scene_input.h"
#include "builder/builder.h"
#include "builder/preset.h"
#include "format/names.h"
#include "scene/import/import.h"
#include "scene/repair/repair.h"

namespace meshlode {
namespace {

bool is_zero_or_more(double value) {
  return value >= 0.0 && std::isfinite(value);
}

/// Enumerators come from a caller, who may have cast them from anything.
Status check_choices(const BuildOptions& options) {
  const auto usage = [](const char* field) { return Error{ErrorCode::kUsage, field, "is not one of its enumerators"}; };
  if (options.error_tier && *options.error_tier > format::ErrorTier::kCertified)
    return usage("BuildOptions::error_tier");
  if (options.preset > Preset::kBest) return usage("BuildOptions::preset");
  if (options.strip_effort > StripEffort::kBest) return usage("BuildOptions::strip_effort");
  if (options.page_order > PageOrder::kCovisible) return usage("BuildOptions::page_order");
  if (options.attributes > AttributeChoice::kAll) return usage("BuildOptions::attributes");
  if (options.uv_error_unit > UvErrorUnit::kTexels) return usage("BuildOptions::uv_error_unit");
  if (options.promise > format::Promise::kAppearance) return usage("BuildOptions::promise");
  if (!format::is_written(options.codec)) return usage("BuildOptions::codec");
  return Ok{};
}

Status check_numbers(const BuildOptions& options) {
  const auto usage = [](const char* field, const char* detail) { return Error{ErrorCode::kUsage, field, detail}; };
  if (!is_zero_or_more(options.grid_step)) return usage("BuildOptions::grid_step", "is not a number >= 0");
  if (!is_zero_or_more(options.position_error)) return usage("BuildOptions::position_error", "is not a number >= 0");
  if (options.grid_step > 0.0 && options.position_error > 0.0) {
    return usage("BuildOptions::position_error", "not together with grid_step");
  }
  if (!is_zero_or_more(options.normal_error) || options.normal_error == 0.0 || options.normal_error > 180.0) {
    return usage("BuildOptions::normal_error", "is not a number above 0 and up to 180");
  }
  if (!is_zero_or_more(options.uv_error)) return usage("BuildOptions::uv_error", "is not a number >= 0");
  for (const auto& [field, bits] :
       {std::pair("BuildOptions::keep", options.keep), {"BuildOptions::drop", options.drop}}) {
    if ((bits & ~kAllAttributes) != 0) return usage(field, "has bits that are no attribute's");
  }
  if ((options.keep & options.drop) != 0) return usage("BuildOptions::drop", "has an attribute of keep");
  if (options.cluster_triangles < 1 || options.cluster_triangles > format::kMaxClusterTriangles) {
    return usage("BuildOptions::cluster_triangles", "is not 1 to 256");
  }
  if (options.group_clusters < builder::kFewestGroupClusters || options.group_clusters > builder::kMostGroupClusters) {
    return usage("BuildOptions::group_clusters", "is not 4 to 32");
  }
  if (!builder::is_page_size(options.page_size)) {
    return usage("BuildOptions::page_size", "is not 16, 32, 64 or 128");
  }
  if (!builder::is_root_size(options.root_bytes)) {
    return usage("BuildOptions::root_bytes", "is not 0, or 16384 to 131072");
  }
  if (options.thread_count > 4096) return usage("BuildOptions::thread_count", "is above 4096");
  return Ok{};
}

Result<builder::PipelineOptions> make_pipeline_options(const BuildOptions& options) {
  TRY(check_choices(options));
  TRY(check_numbers(options));
  builder::PipelineOptions pipeline;
  pipeline.preset = options.preset;
  pipeline.error_tier = options.error_tier.value_or(builder::settings_of(options.preset).error_tier);
  pipeline.attributes = options.attributes;
  pipeline.keep = options.keep;
  pipeline.drop = options.drop;
  pipeline.grid_step = options.grid_step;
  pipeline.position_error = options.position_error;
  pipeline.normal_error = options.normal_error;
  if (options.uv_error > 0.0) {
    pipeline.uv_error = options.uv_error;
    pipeline.uv_error_is_texels = options.uv_error_unit == UvErrorUnit::kTexels;
    pipeline.uv_error_is_default = false;
  }
  pipeline.codec = options.codec;
  pipeline.strip_effort = options.strip_effort;
  pipeline.max_cluster_triangles = options.cluster_triangles;
  pipeline.group_clusters = options.group_clusters;
  pipeline.page_kib = options.page_size;
  pipeline.page_order = options.page_order;
  pipeline.root_bytes = options.root_bytes;
  pipeline.page_hints = options.page_hints;
  pipeline.repair = options.repair;
  pipeline.linear_colors = options.linear_colors;
  pipeline.keep_topology = options.keep_topology;
  pipeline.lock_borders = options.lock_borders;
  pipeline.keep_layers = options.keep_layers;
  pipeline.aggregate = options.aggregate;
  pipeline.aggregate_names = options.aggregate_names;
  pipeline.promise = options.promise;
  pipeline.max_memory = options.max_memory_bytes;
  return pipeline;
}

/// The caller's callbacks. They may throw anything: that ends the build, and is what it failed of.
class Callbacks {
 public:
  explicit Callbacks(const BuildOptions& options) : options_(options) {}

  /// False: the build is to stop.
  [[nodiscard]] bool report(const builder::ProgressEvent& event) {
    return call([&] {
      if (options_.on_progress) {
        reached_ = std::max(reached_, event.fraction);
        options_.on_progress({reached_, event.mesh, event.mesh_count, event.level, event.triangles, event.mesh_name});
      }
      return !options_.should_cancel || !options_.should_cancel();
    });
  }
  [[nodiscard]] bool may_begin() {
    return call([&] { return !options_.should_cancel || !options_.should_cancel(); });
  }
  /// Why the build was stopped.
  [[nodiscard]] Error reason() const { return {ErrorCode::kBuildFailed, "", thrown_.value_or("cancelled")}; }
  [[nodiscard]] bool has_thrown() const { return thrown_.has_value(); }

 private:
  template <class Body>
  bool call(const Body& body) {
    try {
      return body();
    } catch (const std::bad_alloc&) {
      thrown_ = "out of memory";
    } catch (const std::exception& failure) {
      thrown_ = failure.what();
    } catch (...) {
      thrown_ = "an exception of an unknown type";
    }
    return false;
  }

  const BuildOptions& options_;
  double reached_ = 0.0;
  std::optional<std::string> thrown_;
};

Result<std::vector<std::uint8_t>> run_pipeline(scene::Scene&& scene, const BuildOptions& options) {
  TRY_LET(pipeline, make_pipeline_options(options));
  Callbacks callbacks(options);
  if (!callbacks.may_begin()) return callbacks.reason();
  const builder::ProgressCallback progress = [&](const builder::ProgressEvent& event) {
    return callbacks.report(event);
  };
  builder::PipelineReport report;
  const auto build = [&] { return builder::build_lode(std::move(scene), *pipeline, progress, report); };
  const auto build_in_threads = [&] {
    // More than oneTBB has would only make it warn on stderr.
    const std::size_t available = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    tbb::task_arena arena(static_cast<int>(std::min<std::size_t>(options.thread_count, available)));
    return arena.execute(build);
  };
  auto bytes = options.thread_count == 0 ? build() : build_in_threads();
  if (callbacks.has_thrown()) return callbacks.reason();
  return bytes;
}

Status write_result(Result<std::vector<std::uint8_t>> bytes, OutputFiles& files, const std::filesystem::path& output) {
  if (!bytes) return bytes.error();
  return files.write(output, *bytes);
}

}  // namespace

Result<std::vector<std::uint8_t>> build_asset(const SceneInput& scene, const BuildOptions& options) {
  return guarded({}, [&]() -> Result<std::vector<std::uint8_t>> {
    TRY_LET(made, builder::make_scene(scene, options.repair));
    if (options.repair) scene::repair_scene(*made);
    return run_pipeline(std::move(*made), options);
  });
}

Status build_asset_file(const SceneInput& scene, const std::filesystem::path& output, const BuildOptions& options) {
  return guarded({}, [&]() -> Status {
    OutputFiles files;
    if (Status status = files.claim(output); !status) return status;
    return write_result(build_asset(scene, options), files, output);
  });
}

Status build_file(const std::filesystem::path& input, const std::filesystem::path& output,
                  const BuildOptions& options) {
  return guarded({}, [&]() -> Status {
    scene::ImportOptions import_options;
    import_options.repair = options.repair;
    import_options.linear_colors = options.linear_colors;
    import_options.allow_outside = options.allow_outside;
    import_options.max_decoded = options.max_decoded_bytes;
    std::vector<FileId> files_read;
    import_options.files_read = &files_read;
    TRY_LET(scene, scene::import_scene(input, import_options));
    OutputFiles files;
    files.keep(files_read);
    if (Status status = files.claim(output); !status) return status;
    return write_result(run_pipeline(std::move(*scene), options), files, output);
  });
}

}  // namespace meshlode
