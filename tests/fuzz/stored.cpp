// SPDX-License-Identifier: GPL-3.0-or-later
// What a batch wrote for itself, or a person beside a scene, as any bytes. The first byte chooses: what the cache knows
// of an asset, a mesh that it keeps (the second byte is a codec, and an asset is written of it), a manifest, of which
// all shards are merged, a meshlode.json, and the two texts that say why an asset is built again.
#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "app/batch/cache/ingredients.h"
#include "app/batch/cache/record.h"
#include "app/batch/shard/merge.h"
#include "app/batch/shard/read_manifest.h"
#include "app/batch/tell/tell.h"
#include "app/settings/settings_file.h"
#include "builder/store/stored_mesh.h"
#include "builder/write/write.h"
#include "format/names.h"
#include "harness.h"

namespace {

using namespace meshlode;
using fuzz::require;
using Bytes = std::span<const std::uint8_t>;

std::string_view text_of(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void read_record(Bytes bytes) {
  const auto record = app::read_record(bytes);
  if (!record) return;
  const auto again = app::record_bytes(*record);
  require(std::equal(again.begin(), again.end(), bytes.begin(), bytes.end()), "a record is written as other bytes");
}

void read_mesh(Bytes bytes) {
  if (bytes.empty()) return;
  const format::Codec codec = format::kWrittenCodecNames[bytes[0] % format::kWrittenCodecNames.size()].value;
  auto mesh = builder::read_stored_mesh(bytes.subspan(1), "mesh 0");
  if (!mesh) return;
  const auto first = builder::stored_mesh_bytes(mesh->encoded, mesh->decisions, "mesh 0");
  const auto again = builder::read_stored_mesh(first, "mesh 0");
  require(again && builder::stored_mesh_bytes(again->encoded, again->decisions, "mesh 0") == first,
          "a mesh is not read as it was written");
  scene::Scene scene;
  scene.materials.resize(2);
  scene.instances.push_back({"one", 0, MeshId(0U), Mat4d(1.0)});
  builder::WriteInput input;
  input.meshes.push_back(std::move(mesh->encoded));
  input.mesh_names = {"mesh"};
  input.scene = &scene;
  input.codec = codec;
  const auto asset = builder::write_asset(std::move(input));
  require(asset || !asset.error().detail.empty(), "a refusal without a reason");
}

std::string written(const app::Manifest& manifest) {
  return app::manifest_json(manifest.results, manifest.program, manifest.settings, manifest.exit_code,
                            manifest.shard ? &*manifest.shard : nullptr);
}

void read_manifest(Bytes bytes) {
  const auto manifest = app::parse_manifest(text_of(bytes));
  if (!manifest) {
    require(!manifest.error().detail.empty(), "a refusal without a reason");
    return;
  }
  // The generator alone is this program's in what is written.
  const std::string first = written(*manifest);
  const auto again = app::parse_manifest(first);
  require(again && written(*again) == first, "a manifest is not read as it was written");
  static_cast<void>(app::junit_xml(manifest->results));
  static_cast<void>(app::summary_text(manifest->results));
  const auto merged = app::merge_shards({{"one", *manifest}});
  require(!merged || (manifest->shard && merged->results.size() == manifest->shard->batch_jobs),
          "a batch has another number of files");
  static_cast<void>(app::merge_shards({{"one", *manifest}, {"two", *manifest}}));
}

void read_settings(Bytes bytes) {
  const auto layer = app::parse_settings(text_of(bytes), "meshlode.json");
  if (!layer) {
    require(!layer.error().detail.empty(), "a refusal without a reason");
    return;
  }
  const std::vector<std::string> names{"", "rock", "tree.001"};
  const auto settled = app::settle({&*layer, 1});
  const auto meshes = app::settle_meshes({&*layer, 1}, names);
  require(!meshes || meshes->empty() || meshes->size() == names.size(), "meshes without settings");
  if (!settled) return;
  auto options = settled->options;
  static_cast<void>(app::set_mesh_options({&*layer, 1}, names, options));
  static_cast<void>(app::mesh_rules_text({&*layer, 1}));
}

void explain(Bytes bytes) {
  if (bytes.size() < 2) return;
  const std::size_t size = std::min<std::size_t>(bytes[0] + 256U * bytes[1], bytes.size() - 2);
  const std::string before(text_of(bytes.subspan(2, size))), now(text_of(bytes.subspan(2 + size)));
  static_cast<void>(app::explain_change(before, now));
  require(app::explain_change(now, now).empty(), "a text differs from itself");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const Bytes rest(data + 1, size - 1);
  switch (data[0] % 5) {
    case 0: read_record(rest); break;
    case 1: read_mesh(rest); break;
    case 2: read_manifest(rest); break;
    case 3: read_settings(rest); break;
    default: explain(rest);
  }
  return 0;
}
