// SPDX-License-Identifier: GPL-3.0-or-later
// read_asset FOLDER -- ASSET...: what base, format and run make of assets, as hashes, and what base/system.h does in an
// empty folder. The output is the same on every system and with every standard library; portability_test.sh compares
// it.
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "base/file.h"
#include "base/hash.h"
#include "base/memory.h"
#include "base/output_files.h"
#include "base/system.h"
#include "run/decode/decode.h"
#include "run/read/asset.h"
#include "run/select/select.h"
#include "run/unpack/content_hash.h"
#include "run/unpack/unpack.h"

namespace meshlode {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;

int failures = 0;

void expect(bool holds, const char* what) {
  std::printf("%s: %s\n", holds ? "holds" : "FAILED", what);
  if (!holds) ++failures;
}

template <class T>
void hash_values(Hasher& hasher, const std::vector<T>& values) {
  const std::uint64_t count = values.size();
  hasher.update({reinterpret_cast<const std::uint8_t*>(&count), sizeof count});
  hasher.update({reinterpret_cast<const std::uint8_t*>(values.data()), values.size() * sizeof(T)});
}

/// Integers and floats of every cluster, page by page.
Status hash_clusters(const run::Asset& asset, Hasher& integers, Hasher& floats) {
  run::DecodedCluster cluster;
  run::ClusterAttributes attributes;
  for (std::size_t p = 0; p < asset.pages().size(); ++p) {
    const auto page = run::load_page(asset, PageId{p});
    if (!page) return page.error();
    const format::PageRecord& record = asset.pages()[p];
    for (const format::GroupRecord& group : asset.groups().subspan(record.first_group, record.group_count)) {
      for (std::uint32_t i = 0; i < group.cluster_count; ++i) {
        run::decode_cluster(asset, *page, ClusterId{group.first_cluster + i}, cluster);
        run::decode_attributes(asset.meshes()[group.mesh], cluster, attributes);
        hash_values(integers, cluster.channels);
        hash_values(integers, cluster.triangles);
        hash_values(integers, cluster.triangle_material);
        hash_values(floats, attributes.positions);
        hash_values(floats, attributes.normals);
        for (const auto& uvs : attributes.uvs) hash_values(floats, uvs);
        hash_values(floats, attributes.colors);
      }
    }
  }
  return Ok{};
}

/// Cuts from near to far, perspective and not, and uniform ones.
std::string hash_cuts(const run::Asset& asset, std::size_t& drawn) {
  Hasher hasher;
  for (int step = 0; step < 12; ++step) {
    run::Camera camera;
    const double distance = static_cast<double>(std::int64_t{1} << step) / 8.0;
    camera.eye = {0.3 * distance, 0.4 * distance, distance};
    camera.is_orthographic = step % 3 == 2;
    camera.ortho_height = distance;
    const auto items = run::select_bvh(asset, camera, 1.5);
    drawn += items.size();
    for (const run::ClusterInstance& item : items)
      hash_values(hasher, std::vector<std::uint32_t>{item.instance.value, item.cluster.value});
    for (std::size_t m = 0; m < asset.meshes().size(); ++m) {
      const auto cut = run::select_uniform(asset, MeshId{m}, distance / 256.0);
      for (const ClusterId id : cut.clusters) hash_values(hasher, std::vector<std::uint32_t>{id.value});
    }
  }
  return to_hex(hasher.digest());
}

void read_asset(const fs::path& path) {
  std::printf("%s\n", path.filename().string().c_str());
  const auto asset = run::Asset::open(path);
  if (!asset) {
    std::printf("  refused: %s\n", asset.error().detail.c_str());
    return;
  }
  Hash128 stated{};
  std::memcpy(stated.data(), asset->header().content_hash, stated.size());
  std::size_t drawn = 0;
  const std::string cuts = hash_cuts(*asset, drawn);
  std::printf("  content %s\n  cuts %s, %zu clusters drawn\n", to_hex(stated).c_str(), cuts.c_str(), drawn);
  const auto computed = run::hash_asset_content(*asset);
  Hasher integers, floats;
  const Status status = computed ? hash_clusters(*asset, integers, floats) : Status(computed.error());
  if (!status) {
    std::printf("  refused: %s\n", status.error().detail.c_str());
    return;
  }
  std::printf("  integers %s\n  floats %s\n", to_hex(integers.digest()).c_str(), to_hex(floats.digest()).c_str());
  expect(*computed == stated, "the content is that of the hash");
}

bool has_bytes(const fs::path& path, const Bytes& bytes) {
  const auto file = MappedFile::open(path);
  return file && std::equal(bytes.begin(), bytes.end(), file->bytes().begin(), file->bytes().end());
}

void put(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

void try_inputs(const fs::path& folder) {
  put(folder / "empty", "");
  put(folder / "one", "1");
  const auto empty = MappedFile::open(folder / "empty");
  expect(empty && empty->bytes().empty(), "an empty file is an empty span");
  const auto none = MappedFile::open(folder / "none");
  expect(!none && none.error().code == ErrorCode::kIo, "a file that is not there is an error");
  if (!none) std::printf("  %s\n", none.error().detail.c_str());
  const auto of_folder = MappedFile::open(folder);
  expect(!of_folder && of_folder.error().detail == "not a regular file", "a folder is no input");
  const auto id = find_file_id(folder / "one"), other = find_file_id(folder / "empty");
  expect(id && other && *id != *other, "two files have two ids");
  expect(find_file_id(folder / "." / "one") == id, "one file has one id");
  const auto one = MappedFile::open(folder / "one");
  expect(one && id && one->id() == *id, "an open file has its id");
  expect(!find_file_id(folder / "none"), "what is not there has none");
}

void try_outputs(const fs::path& folder) {
  const fs::path path = folder / fs::path(u8"größe.bin");
  const Bytes first(100000, 1), second(300000, 2);
  OutputFiles files;
  expect(files.write(path, first).ok() && has_bytes(path, first), "a file is written, whatever its name");
  const Status again = files.write(path, second);
  expect(!again && again.error().code == ErrorCode::kUsage && has_bytes(path, first), "an output is not overwritten");
  expect(write_file_atomically(path, second).ok() && has_bytes(path, second), "a file is replaced");
  OutputFiles reader;
  if (const auto id = find_file_id(path)) reader.keep(*id);
  const Status kept = reader.write(folder / "." / path.filename(), first);
  expect(!kept && kept.error().code == ErrorCode::kUsage && has_bytes(path, second), "an input is not overwritten");
  const Status lost = reader.write(folder / "none" / "a", first);
  expect(!lost && lost.error().code == ErrorCode::kIo, "a folder that is not there is an error");
  if (!lost) std::printf("  %s\n", lost.error().detail.c_str());
  expect(!reader.write(folder, first).ok(), "a folder is no output");
  expect(is_same_place(path, folder / "." / path.filename()), "one place has many names");
  expect(is_same_place(folder / "new", folder / "." / "new"), "also where nothing is yet");
  expect(!is_same_place(path, folder / "one"), "two places are two");
  reader.abandon();
  expect(!reader.write(folder / "late", first).ok() && !fs::exists(folder / "late"),
         "nothing is written after the end");
}

void try_locks(const fs::path& folder) {
  const fs::path dead = folder / ".meshlode-0123456789abcdef.tmp", living = folder / ".meshlode-fedcba9876543210.tmp";
  put(dead, "left");
  system::Handle file = system::kNoHandle;
  expect(system::create_locked(living, file) == system::Created::kYes, "a temporary file is made");
  system::Handle other = system::kNoHandle;
  expect(system::create_locked(living, other) == system::Created::kNameTaken, "its name is taken");
  expect(OutputFiles().claim(folder / "a").ok() && !fs::exists(dead), "what the dead left is removed");
  expect(fs::exists(living), "what the living write is not");
  expect(system::write_all(file, Bytes(10, 7)) && system::sync(file), "an open file is written");
  expect(system::rename_over(living, folder / "one"), "and renamed while it is open");
  expect(system::close(file) && has_bytes(folder / "one", Bytes(10, 7)), "over what was there");
  expect(system::random_number() != system::random_number(), "names are drawn");
}

void try_memory() {
  expect(available_memory().value_or(0) > 0, "there is memory to be had");
  expect(resident_memory() > 0, "and some is in use");
  give_back_freed_memory();
}

int run_all(std::span<char* const> arguments) {
  const fs::path folder = arguments[1];
  try_inputs(folder);
  try_outputs(folder);
  try_locks(folder);
  try_memory();
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  for (const std::string& name : names) std::printf("left: %s\n", name.c_str());
  for (const char* asset : arguments.subspan(3)) read_asset(asset);
  std::printf(failures == 0 ? "all holds\n" : "%d FAILED\n", failures);
  return failures == 0 ? 0 : 1;
}

}  // namespace
}  // namespace meshlode

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  return meshlode::run_all({argv, static_cast<std::size_t>(argc)});
}
