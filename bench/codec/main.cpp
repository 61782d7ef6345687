// SPDX-License-Identifier: GPL-3.0-or-later
// What the disk codecs cost and save on the pages of assets: bytes, and decoding on one thread. And how long it takes
// to open each asset and have its root page. The best of many repetitions, in seconds of the thread's own time, because
// other work on the machine is not the codec's.
//
//   bench_codec [--codec NAME] [--repetitions 51] bunny.lode dragon.lode ...     assets of any codec
#include <time.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "builder/pack/pack.h"
#include "format/names.h"
#include "format/page_streams.h"
#include "run/read/asset.h"
#include "run/unpack/unpack.h"
#include "run/unpack/unpack_page.h"
#include "thread_clock.h"

namespace {

using namespace meshlode;

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

[[noreturn]] void fail(const std::string& where, const std::string& detail) {
  std::fprintf(stderr, "bench_codec: %s: %s\n", where.c_str(), detail.c_str());
  std::exit(1);
}

struct Totals {
  double source_triangles = 0.0, stored_triangles = 0.0;
};

Totals count_triangles(const run::Asset& asset) {
  Totals totals;
  for (const format::MeshRecord& mesh : asset.meshes())
    totals.source_triangles += static_cast<double>(mesh.source_triangles);
  for (const format::ClusterRecord& cluster : asset.clusters()) totals.stored_triangles += cluster.triangle_count();
  return totals;
}

/// What the streams of the codec strips weigh, over all pages.
void print_streams(const run::Asset& asset, const std::vector<builder::PackedPage>& packed) {
  static constexpr const char* kNames[] = {"triples", "starts", "lengths", "references", "twins"};
  const double triangles = count_triangles(asset).source_triangles;
  std::array<double, format::kMaxStreams> bytes{};
  double side = 0.0;
  double twins = 0.0;
  double vertices = 0.0;
  for (const format::ClusterRecord& cluster : asset.clusters()) vertices += cluster.vertex_count();
  const std::uint32_t streams = format::kFieldStreams + format::field_count(asset.meshes()[0]);
  for (const builder::PackedPage& page : packed) {
    if (page.codec != format::Codec::kStrips) continue;
    format::StoredHeader header;
    std::memcpy(&header, page.bytes.data(), sizeof(header));
    side += static_cast<double>(sizeof(header) + header.side_stored + streams * sizeof(std::uint32_t));
    twins += header.twin_count;
    for (std::uint32_t s = 0; s < streams; ++s) {
      std::uint32_t size = 0;
      std::memcpy(&size, page.bytes.data() + sizeof(header) + header.side_stored + s * sizeof(size), sizeof(size));
      bytes[s] += size;
    }
  }
  std::printf("    heads, ranges, code lengths %.3f", side / triangles);
  for (std::uint32_t s = 0; s < streams; ++s) {
    if (s < format::kFieldStreams)
      std::printf(" · %s %.3f", kNames[s], bytes[s] / triangles);
    else
      std::printf(" · field %u %.3f", s - format::kFieldStreams, bytes[s] / triangles);
  }
  std::printf(" B/source triangle; %.0f of %.0f vertices are twins\n", twins, vertices);
}

void measure_codec(const run::Asset& asset, const std::vector<std::vector<std::uint32_t>>& pages, format::Codec codec,
                   const char* name, int repetitions) {
  const Totals totals = count_triangles(asset);
  std::vector<builder::PackedPage> packed;
  double decoded_bytes = 0.0;
  double stored_bytes = 0.0;
  for (std::size_t p = 0; p < pages.size(); ++p) {
    const auto& mesh = asset.meshes()[asset.groups()[asset.pages()[p].first_group].mesh];
    const std::span<const std::uint8_t> bytes{reinterpret_cast<const std::uint8_t*>(pages[p].data()),
                                              pages[p].size() * 4};
    auto page = builder::pack_page(mesh, bytes, codec);
    if (!page) fail(name, page.error().detail);
    decoded_bytes += static_cast<double>(bytes.size());
    stored_bytes += static_cast<double>(page->codec == format::Codec::kNone ? bytes.size() : page->bytes.size());
    packed.push_back(std::move(*page));
  }
  std::vector<double> seconds;
  std::vector<std::uint32_t> out(format::kMaxPageBytes / 4);
  for (int r = 0; r < repetitions; ++r) {
    double sum = 0.0;
    for (std::size_t p = 0; p < pages.size(); ++p) {
      if (packed[p].codec == format::Codec::kNone) continue;
      format::PageRecord record = asset.pages()[p];
      record.codec = codec;
      const auto& mesh = asset.meshes()[asset.groups()[record.first_group].mesh];
      const std::span<std::uint32_t> page = std::span(out).first(pages[p].size());
      const double start = bench::thread_seconds();
      std::fill(page.begin(), page.end(), 0U);
      const run::UnpackOutcome outcome = run::unpack_page(mesh, record, packed[p].bytes, page);
      sum += bench::thread_seconds() - start;
      if (outcome != run::UnpackOutcome::kOk || !std::equal(page.begin(), page.end(), pages[p].begin())) {
        fail(name, "page " + std::to_string(p) + " did not come back");
      }
    }
    seconds.push_back(sum);
  }
  const double time = *std::min_element(seconds.begin(), seconds.end());
  std::printf("  %-6s %8.3f B/source triangle %6.3f B/stored triangle", name, stored_bytes / totals.source_triangles,
              stored_bytes / totals.stored_triangles);
  if (time > 0.0) {
    std::printf("  decode %7.0f MB/s of page bytes %7.1f M stored triangles/s", decoded_bytes / time * 1e-6,
                totals.stored_triangles / time * 1e-6);
  }
  std::printf("\n");
  if (codec == format::Codec::kStrips && asset.meshes().size() == 1) print_streams(asset, packed);
}

void measure_opening(const std::string& path, int repetitions) {
  std::vector<double> seconds;
  for (int r = 0; r < repetitions; ++r) {
    const double start = bench::thread_seconds();
    const auto asset = run::Asset::open(path);
    if (!asset) fail(path, asset.error().detail);
    if (!asset->pages().empty()) {
      const auto page = run::load_page(*asset, PageId{0U});
      if (!page) fail(path, page.error().detail);
    }
    seconds.push_back(bench::thread_seconds() - start);
  }
  std::printf("  opening the file as it is and loading its root page: best %.3f ms, median %.3f ms\n",
              *std::min_element(seconds.begin(), seconds.end()) * 1e3, median(seconds) * 1e3);
}

}  // namespace

int main(int argc, char** argv) {
  std::string only;
  int repetitions = 51;
  int first = 1;
  for (; first + 2 < argc && std::string(argv[first]).starts_with("--"); first += 2) {
    if (std::string(argv[first]) == "--codec")
      only = argv[first + 1];
    else if (std::string(argv[first]) == "--repetitions")
      repetitions = std::max(1, std::atoi(argv[first + 1]));
    else
      fail(argv[first], "is no option");
  }
  for (int i = first; i < argc; ++i) {
    const std::string path = argv[i];
    const auto asset = run::Asset::open(path);
    if (!asset) fail(path, asset.error().detail);
    const Totals totals = count_triangles(*asset);
    std::vector<std::vector<std::uint32_t>> pages;
    for (std::size_t p = 0; p < asset->pages().size(); ++p) {
      const auto page = run::load_page(*asset, PageId{p});
      if (!page) fail(path, page.error().detail);
      pages.emplace_back(page->words().begin(), page->words().end());
    }
    std::printf("%s: %.0f source triangles, %.0f stored, %zu pages, file %.3f B/source triangle\n",
                std::filesystem::path(path).filename().c_str(), totals.source_triangles, totals.stored_triangles,
                pages.size(), static_cast<double>(asset->bytes().size()) / totals.source_triangles);
    for (const auto& [codec, name] : format::kWrittenCodecNames) {
      if (only.empty() || only == name) measure_codec(*asset, pages, codec, name, repetitions);
    }
    measure_opening(path, 2 * repetitions);
  }
  return 0;
}
