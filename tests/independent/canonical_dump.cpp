// SPDX-License-Identifier: GPL-3.0-or-later
// canonical_dump FILE | -: every integer of an asset as the program's own reader and decoder see it, floats as their
// bits: the text that lode.py prints too. Field by field, in the order of docs/reference/format.md, so that neither
// layout nor decoding is taken from the other side. -: of each file named on a line of the input, its text and a line
// with `=`, its exit code, and what is wrong: to begin a program takes longer than to read a small file.
#include <bit>
#include <cstdio>
#include <iostream>
#include <string>
#include <string_view>
#include <type_traits>

#include "base/try.h"
#include "run/decode/decode.h"
#include "run/read/asset.h"

namespace {

using namespace meshlode;

class Line {
 public:
  explicit Line(const std::string& head) : text_(head) {}
  template <class T>
  Line& operator<<(T value) {
    text_ += ' ';
    char buffer[32];
    if constexpr (std::is_same_v<T, float>) {
      std::snprintf(buffer, sizeof buffer, "%08x", std::bit_cast<std::uint32_t>(value));
    } else if constexpr (std::is_same_v<T, double>) {
      std::snprintf(buffer, sizeof buffer, "%016llx",
                    static_cast<unsigned long long>(std::bit_cast<std::uint64_t>(value)));
    } else if constexpr (std::is_enum_v<T>) {
      std::snprintf(buffer, sizeof buffer, "%lu", static_cast<unsigned long>(value));
    } else if constexpr (std::is_signed_v<T>) {
      std::snprintf(buffer, sizeof buffer, "%lld", static_cast<long long>(value));
    } else {
      std::snprintf(buffer, sizeof buffer, "%llu", static_cast<unsigned long long>(value));
    }
    text_ += buffer;
    return *this;
  }
  template <class T, std::size_t n>
  Line& operator<<(const T (&values)[n]) {
    for (const T value : values) *this << value;
    return *this;
  }
  Line& operator<<(format::StringRef ref) { return *this << ref.offset << ref.bytes; }
  ~Line() { std::puts(text_.c_str()); }
  Line(const Line&) = delete;
  Line& operator=(const Line&) = delete;

 private:
  std::string text_;
};

void print(Line& line, const format::MeshRecord& r) {
  line << r.name << r.origin << r.grid.log2 << r.grid.mantissa << r.bounds_min << r.bounds_max << r.diagonal
       << r.level0_deviation << r.error_tier << r.normal_mode << r.normal_scale << r.uv_set_count << r.has_color
       << r.uv_log2 << r.uv_set_source << r.material << r.sphere_log2 << r.level_count << r.source_triangles
       << r.source_vertices << r.dropped_degenerate << r.dropped_duplicate << r.dropped_repaired << r.grid_collapsed
       << r.first_group << r.group_count << r.first_cluster << r.cluster_count << r.first_node << r.node_count;
}
void print(Line& line, const format::MaterialRecord& r) {
  line << r.name << r.source_index << r.alpha_mode << r.base_color << r.alpha_cutoff << r.double_sided
       << r.base_color_texture << r.base_color_uv_set;
}
void print(Line& line, const format::InstanceRecord& r) {
  line << r.transform << r.scale << r.mesh << r.node << r.flags << r.name;
}
void print(Line& line, const format::GroupRecord& r) {
  line << r.center << r.radius << r.error << r.quadric_error << r.deviation << r.normal_deviation << r.uv_deviation
       << r.first_cluster << r.mesh << r.page << r.cluster_count << r.level << r.flags << r.stuck_reason;
}
void print(Line& line, const format::ClusterRecord& r) {
  line << r.center << r.radius << r.cone_axis << r.cone_cutoff << r.own_group << r.coarser_group << r.vertices_less_1
       << r.triangles_less_1 << r.level;
}
void print(Line& line, const format::NodeRecord& r) {
  line << r.center << r.radius << r.error << r.first << r.child_count;
}
void print(Line& line, const format::PageRecord& r) {
  line << r.offset << r.stored_bytes << r.bytes << r.codec << r.first_group << r.group_count << r.first_cluster
       << r.cluster_count << r.first_dependency << r.dependency_count << r.checksum << r.decoded_checksum;
}
void print(Line& line, const format::BlobRecord& r) {
  line << r.name << r.mime_type << r.offset << r.bytes << r.kind << r.source_index << r.checksum;
}

void print(Line& line, const format::PromiseMeshRecord& r) {
  line << r.promises << r.normal_object;
  for (const auto& set : r.uv_object) line << set;
  line << r.level0_texels << r.level0_appearance;
}
void print(Line& line, const format::PromiseGroupRecord& r) {
  line << r.texel_error << r.appearance_error;
}

void print(Line& line, const format::PageHintRecord& r) {
  line << r.center << r.radius << r.largest_error << r.smallest_error;
}

template <class Record>
void print_table(const char* name, std::span<const Record> records) {
  for (std::size_t i = 0; i < records.size(); ++i) {
    Line line(std::string(name) + ' ' + std::to_string(i));
    print(line, records[i]);
  }
}

void print_hex(const std::string& head, std::span<const std::uint8_t> bytes) {
  std::string text = head;
  for (const std::uint8_t byte : bytes) {
    char buffer[4];
    std::snprintf(buffer, sizeof buffer, "%02x", byte);
    text += buffer;
  }
  std::puts(text.c_str());
}

void print_text(const char* name, std::string_view text) {
  print_hex(std::string(name) + ' ', {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

Status print_clusters(const run::Asset& asset) {
  TRY_LET(decoded, run::decode_all(asset));
  for (std::size_t c = 0; c < decoded->size(); ++c) {
    const run::DecodedCluster& cluster = (*decoded)[c];
    Line("cluster") << c << cluster.vertex_count << cluster.triangle_count;
    for (std::size_t v = 0; v < cluster.vertex_count; ++v) {
      Line line("v");
      for (std::size_t k = 0; k < cluster.channel_count; ++k) line << cluster.channels[v * cluster.channel_count + k];
    }
    for (std::size_t t = 0; t < cluster.triangle_count; ++t) {
      Line line("t");
      for (const std::uint8_t corner : cluster.triangles[t]) line << corner;
      line << cluster.triangle_material[t];
    }
  }
  return Ok{};
}

Status print_file(const std::string& path) {
  TRY_LET(asset, run::Asset::open(path));
  print_hex("lode " + std::to_string(asset->header().version) + ' ', asset->header().content_hash);
  print_text("META", asset->meta_json());
  print_text("SCNE", asset->scene_json());
  print_text("STRS", asset->strings());
  print_table("MESH", asset->meshes());
  print_table("MATL", asset->materials());
  print_table("INST", asset->instances());
  print_table("GRUP", asset->groups());
  print_table("CLUS", asset->clusters());
  print_table("NODE", asset->nodes());
  print_table("PAGT", asset->pages());
  print_table("BLBT", asset->blobs());
  print_table("PRMS", asset->promises());
  print_table("PRMG", asset->promise_errors());
  print_table("PHNT", asset->page_hints());
  for (std::size_t i = 0; i < asset->page_dependencies().size(); ++i) {
    Line("PDEP") << i << asset->page_dependencies()[i];
  }
  return print_clusters(*asset);
}

int code_of(const Status& status) {
  return status ? 0 : static_cast<int>(status.error().code);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 1;
  if (std::string_view(argv[1]) != "-") {
    const Status status = print_file(argv[1]);
    if (!status) std::fprintf(stderr, "%s\n", status.error().message().c_str());
    return code_of(status);
  }
  for (std::string path; std::getline(std::cin, path);) {
    const Status status = print_file(path);
    std::printf("= %d %s\n", code_of(status), status ? "" : status.error().message().c_str());
    std::fflush(stdout);
  }
  return 0;
}
