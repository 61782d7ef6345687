// SPDX-License-Identifier: GPL-3.0-or-later
// Table rules: every id, range, enumeration and number of the record tables (L101 … L115).
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "base/hash.h"
#include "format/grid.h"
#include "judge/validate/file_tables.h"
#include "run/read/limits.h"

namespace meshlode::judge {

namespace {

class TableChecker {
 public:
  TableChecker(const FileTables& file, RuleLog& log) : file_(file), log_(log) {}

  bool run() {
    bool sound = check_meshes();
    for (std::size_t i = 0; i < file_.materials.size(); ++i) check_material(i);
    for (std::size_t i = 0; i < file_.instances.size(); ++i) sound &= check_instance(i);
    check_blobs();
    if (sound) sound = check_groups();
    if (sound) sound = check_clusters();
    if (sound) check_levels();
    return sound && log_.count_of(Rule::kL101) == 0 && log_.count_of(Rule::kL106) == 0 &&
           log_.count_of(Rule::kL104) == 0;
  }

 private:
  using Text = std::string;

  void check_string(format::StringRef ref, const Text& where) {
    const bool inside = ref.offset <= file_.strings.size() && ref.bytes <= file_.strings.size() - ref.offset;
    log_.expect(
        inside, Rule::kL101, [&] { return where; },
        [&] {
          return differs("end", std::uint64_t{ref.offset} + ref.bytes, "bytes of STRS",
                         std::uint64_t{file_.strings.size()});
        });
    if (inside && ref.bytes <= name_bytes_left_) {
      name_bytes_left_ -= ref.bytes;
      log_.expect(
          is_utf8(file_.strings.substr(ref.offset, ref.bytes)), Rule::kL101, [&] { return where; },
          [] { return Text("is not UTF-8"); });
    } else if (inside) {
      log_.expect(
          false, Rule::kL101, [&] { return where; },
          [] { return Text("names that share bytes are more than the file's size justifies"); });
    }
  }

  bool is_range_next(std::uint32_t first, std::uint32_t count, std::uint64_t& next, std::uint64_t size, Rule rule,
                     const Text& where) {
    const bool fits = first == next && count <= size - next;
    log_.expect(
        fits, rule, [&] { return where; },
        [&] {
          return "range " + std::to_string(first) + " + " + std::to_string(count) + " should start at " +
                 std::to_string(next) + " and end by " + std::to_string(size);
        });
    if (fits) next += count;
    return fits;
  }

  void check_mesh_numbers(const format::MeshRecord& mesh, const Text& where) {
    const auto at = [&] { return where; };
    const bool finite = std::isfinite(mesh.origin[0]) && std::isfinite(mesh.origin[1]) && std::isfinite(mesh.origin[2]);
    log_.expect(finite, Rule::kL104, at, [] { return Text("origin is not finite"); });
    // Positions are decoded in floats: every step · q must be a normal float.
    const bool has_grid =
        mesh.grid.mantissa >= 1 && mesh.grid.mantissa < (1U << 24) && mesh.grid.log2 >= -126 && mesh.grid.log2 <= 104;
    log_.expect(has_grid, Rule::kL104, at, [&] {
      return "grid " + std::to_string(mesh.grid.mantissa) + " * 2^" + std::to_string(mesh.grid.log2) +
             " is out of range";
    });
    for (int axis = 0; axis < 3; ++axis) {
      const std::int64_t lo = mesh.bounds_min[axis];
      const std::int64_t hi = mesh.bounds_max[axis];
      log_.expect(lo <= hi || mesh.cluster_count == 0, Rule::kL104, at,
                  [&] { return "bounds are upside down on axis " + std::to_string(axis); });
      const std::int64_t limit = (std::int64_t{1} << 24) / std::max<std::uint32_t>(mesh.grid.mantissa, 1);
      log_.expect(lo >= -limit && hi <= limit && lo >= -format::kMaxGridCoordinate && hi <= format::kMaxGridCoordinate,
                  Rule::kL104, at,
                  [&] { return "bounds leave the 24 bits that float decode keeps, axis " + std::to_string(axis); });
    }
    log_.expect(std::isfinite(mesh.diagonal) && mesh.diagonal >= 0.0, Rule::kL105, at,
                [&] { return "diagonal is " + std::to_string(mesh.diagonal); });
    log_.expect(std::isfinite(mesh.level0_deviation) && mesh.level0_deviation >= 0.0F, Rule::kL105, at,
                [&] { return "level0_deviation is " + std::to_string(mesh.level0_deviation); });
    if (has_grid) {
      const double step = format::exp2_exact(mesh.grid.log2) * mesh.grid.mantissa;
      // A vertex moves by half a step an axis at most: sqrt(3)/2 of a step, and a rounding.
      log_.expect(mesh.level0_deviation <= 0.8661 * step, Rule::kL105, at,
                  [&] { return differs("level0_deviation", double{mesh.level0_deviation}, "step", step); });
      double squared = 0.0;
      for (int axis = 0; axis < 3; ++axis) {
        const double side = (double(mesh.bounds_max[axis]) - double(mesh.bounds_min[axis])) * step;
        squared += side * side;
      }
      const double diagonal = std::sqrt(squared);
      // The source's box may be larger where its corners belong to triangles that were dropped. Smaller by what the
      // grid moves both ends of an axis at most, each by half a cell's diagonal, where a needle is kept: sqrt(3) steps
      // an axis, 3 steps in all.
      log_.expect(mesh.diagonal >= (diagonal - 3.0 * step) * (1.0 - 1e-9) - 1e-300, Rule::kL105, at,
                  [&] { return differs("diagonal", mesh.diagonal, "diagonal of the bounds", diagonal); });
    }
  }

  void check_mesh_channels(const format::MeshRecord& mesh, const Text& where) {
    const auto at = [&] { return where; };
    const auto tier = static_cast<std::uint32_t>(mesh.error_tier);
    const auto normals = static_cast<std::uint32_t>(mesh.normal_mode);
    log_.expect(tier <= 2, Rule::kL102, at, [&] { return "error_tier " + std::to_string(tier); });
    log_.expect(normals <= 2, Rule::kL102, at, [&] { return "normal_mode " + std::to_string(normals); });
    const bool stored = mesh.normal_mode == format::NormalMode::kStored;
    log_.expect(stored ? mesh.normal_scale >= 1 && mesh.normal_scale <= 8191 : mesh.normal_scale == 0, Rule::kL106, at,
                [&] { return "normal_scale " + std::to_string(mesh.normal_scale); });
    log_.expect(mesh.material == format::kNone || mesh.material < file_.materials.size(), Rule::kL106, at,
                [&] { return "material " + std::to_string(mesh.material) + " does not exist"; });
    log_.expect(mesh.sphere_log2 >= -126 && mesh.sphere_log2 <= 104, Rule::kL106, at,
                [&] { return "sphere_log2 " + std::to_string(mesh.sphere_log2); });
    log_.expect(mesh.uv_set_count <= format::kMaxUvSets, Rule::kL106, at,
                [&] { return "uv_set_count " + std::to_string(mesh.uv_set_count); });
    log_.expect(mesh.has_color <= 1, Rule::kL106, at, [&] { return "has_color " + std::to_string(mesh.has_color); });
    for (std::uint32_t set = 0; set < format::kMaxUvSets; ++set) {
      const std::int32_t log2 = mesh.uv_log2[set];
      if (set < mesh.uv_set_count) {
        log_.expect(log2 >= -126 && log2 <= 104, Rule::kL106, at, [&] { return "uv grid 2^" + std::to_string(log2); });
        bool is_new = mesh.uv_set_source[set] < format::kMaxUvSets;
        for (std::uint32_t before = 0; before < set; ++before)
          is_new &= mesh.uv_set_source[before] != mesh.uv_set_source[set];
        log_.expect(is_new, Rule::kL106, at,
                    [&] { return "uv_set_source[" + std::to_string(set) + "] is stored already or above 3"; });
      } else {
        log_.expect(log2 == 0 && mesh.uv_set_source[set] == 0, Rule::kL103, at,
                    [&] { return "unused UV set " + std::to_string(set) + " is not zero"; });
      }
    }
  }

  bool check_meshes() {
    std::uint64_t group = 0;
    std::uint64_t cluster = 0;
    std::uint64_t node = 0;
    bool sound = true;
    for (const Rule rule : {Rule::kL107, Rule::kL108, Rule::kL109}) log_.check(rule);
    for (std::size_t i = 0; i < file_.meshes.size(); ++i) {
      const format::MeshRecord& mesh = file_.meshes[i];
      const Text where = place("mesh", i);
      check_string(mesh.name, where + ", name");
      check_mesh_numbers(mesh, where);
      check_mesh_channels(mesh, where);
      sound &= is_range_next(mesh.first_group, mesh.group_count, group, file_.groups.size(), Rule::kL107, where);
      sound &=
          is_range_next(mesh.first_cluster, mesh.cluster_count, cluster, file_.clusters.size(), Rule::kL108, where);
      sound &= is_range_next(mesh.first_node, mesh.node_count, node, file_.nodes.size(), Rule::kL109, where);
      log_.expect((mesh.cluster_count == 0) == (mesh.group_count == 0), Rule::kL110, [&] { return where; },
                  [&] {
                    return differs("clusters", std::uint64_t{mesh.cluster_count}, "groups",
                                   std::uint64_t{mesh.group_count});
                  });
      log_.expect(
          (mesh.node_count == 0) == (mesh.group_count == 0), Rule::kL401, [&] { return where; },
          [&] { return differs("nodes", std::uint64_t{mesh.node_count}, "groups", std::uint64_t{mesh.group_count}); });
    }
    const auto whole = [&](std::uint64_t end, std::size_t size, Rule rule, const char* what) {
      return log_.expect(
          end == size, rule, [] { return Text("meshes"); },
          [&] {
            return differs(std::string(what) + " of meshes", end, std::string(what) + " in the table",
                           std::uint64_t{size});
          });
    };
    sound &= whole(group, file_.groups.size(), Rule::kL107, "groups");
    sound &= whole(cluster, file_.clusters.size(), Rule::kL108, "clusters");
    sound &= whole(node, file_.nodes.size(), Rule::kL109, "nodes");
    return sound;
  }

  void check_material(std::size_t i) {
    const format::MaterialRecord& material = file_.materials[i];
    const auto at = [&] { return place("material", i); };
    check_string(material.name, at() + ", name");
    log_.expect(static_cast<std::uint32_t>(material.alpha_mode) <= 2, Rule::kL102, at,
                [] { return Text("alpha_mode"); });
    bool is_finite = std::isfinite(material.alpha_cutoff);
    for (const float c : material.base_color) is_finite &= std::isfinite(c);
    log_.expect(is_finite, Rule::kL112, at, [] { return Text("base_color or alpha_cutoff is not finite"); });
    log_.expect(material.double_sided <= 1, Rule::kL112, at, [] { return Text("double_sided is not 0 or 1"); });
    const bool has_texture = material.base_color_texture != format::kNone;
    log_.expect(has_texture || material.base_color_uv_set == format::kNone, Rule::kL112, at,
                [] { return Text("a UV set without a texture"); });
  }

  bool check_instance(std::size_t i) {
    const format::InstanceRecord& instance = file_.instances[i];
    const auto at = [&] { return place("instance", i); };
    check_string(instance.name, at() + ", name");
    log_.expect(instance.reserved == 0, Rule::kL103, at, [] { return Text("reserved is not zero"); });
    log_.expect((instance.flags & ~(format::kInstanceMirrored | format::kInstanceSingular)) == 0, Rule::kL103, at,
                [] { return Text("unknown flags"); });
    check_transform(instance, at());
    return log_.expect(instance.mesh < file_.meshes.size(), Rule::kL111, at,
                       [&] { return "mesh " + std::to_string(instance.mesh) + " does not exist"; });
  }

  /// Largest singular value by Jacobi rotations of MᵀM in extended precision (Jacobi 1846).
  static long double largest_singular_value(const std::array<std::array<long double, 3>, 3>& m) {
    std::array<std::array<long double, 3>, 3> a{};
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t k = 0; k < 3; ++k) a[r][c] += m[k][r] * m[k][c];
      }
    }
    for (int sweep = 0; sweep < 60; ++sweep) {
      for (std::size_t p = 0; p < 2; ++p) {
        for (std::size_t q = p + 1; q < 3; ++q) {
          if (a[p][q] == 0.0L) continue;
          const long double theta = (a[q][q] - a[p][p]) / (2.0L * a[p][q]);
          const long double t = (theta >= 0 ? 1.0L : -1.0L) / (std::fabs(theta) + std::sqrt(theta * theta + 1.0L));
          const long double cosine = 1.0L / std::sqrt(t * t + 1.0L);
          const long double sine = t * cosine;
          for (std::size_t k = 0; k < 3; ++k) {
            const long double x = a[k][p];
            const long double y = a[k][q];
            a[k][p] = cosine * x - sine * y;
            a[k][q] = sine * x + cosine * y;
          }
          for (std::size_t k = 0; k < 3; ++k) {
            const long double x = a[p][k];
            const long double y = a[q][k];
            a[p][k] = cosine * x - sine * y;
            a[q][k] = sine * x + cosine * y;
          }
        }
      }
    }
    return std::sqrt(std::max({a[0][0], a[1][1], a[2][2], 0.0L}));
  }

  void check_transform(const format::InstanceRecord& instance, const Text& where) {
    const auto at = [&] { return where; };
    log_.check(Rule::kL113);
    const bool singular = (instance.flags & format::kInstanceSingular) != 0;
    const bool mirrored = (instance.flags & format::kInstanceMirrored) != 0;
    bool finite = true;
    for (const double v : instance.transform) finite &= std::isfinite(v);
    if (!log_.expect(finite && std::isfinite(instance.scale) && instance.scale >= 0.0, Rule::kL113, at,
                     [] { return Text("transform or scale is not finite, or negative"); })) {
      return;
    }
    log_.expect(!(singular && mirrored), Rule::kL113, at, [] { return Text("marked singular and mirrored"); });
    std::array<std::array<long double, 3>, 3> m{};
    long double largest = 0.0L;
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 3; ++c) {
        m[r][c] = instance.transform[r * 4 + c];
        largest = std::max(largest, std::fabs(m[r][c]));
      }
    }
    if (largest == 0.0L) {
      log_.expect(singular, Rule::kL113, at, [] { return Text("a zero transform is not marked singular"); });
      return;
    }
    for (auto& row : m) {
      for (long double& v : row) v /= largest;
    }
    const long double sigma = largest_singular_value(m);
    const long double det = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                            m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                            m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    // Between "surely singular" and "surely not" either mark is right: the determinant of doubles is itself rounded.
    const bool surely_regular = std::fabs(det) > 1e-12L;
    const bool surely_singular = std::fabs(det) < 1e-40L;
    log_.expect(!(surely_regular && singular) && !(surely_singular && !singular), Rule::kL113, at,
                [&] { return Text(singular ? "marked singular and is not" : "singular and not marked"); });
    if (surely_regular) {
      log_.expect(mirrored == (det < 0.0L), Rule::kL113, at,
                  [&] { return Text(mirrored ? "marked mirrored and is not" : "mirrored and not marked"); });
    }
    if (singular) return;
    const long double truth = sigma * largest;
    log_.expect(instance.scale >= truth * (1.0L - 1e-16L) && instance.scale <= truth * (1.0L + 1.1e-11L), Rule::kL113,
                at,
                [&] { return differs("scale", instance.scale, "largest singular value", static_cast<double>(truth)); });
  }

  void check_blobs() {
    log_.check(Rule::kL114);
    std::uint64_t end = file_.blob_data.offset;
    const std::uint64_t limit = file_.blob_data.offset + file_.blob_data.bytes;
    for (std::size_t i = 0; i < file_.blobs.size(); ++i) {
      const format::BlobRecord& blob = file_.blobs[i];
      const auto at = [&] { return place("blob", i); };
      check_string(blob.name, at() + ", name");
      check_string(blob.mime_type, at() + ", mime_type");
      const auto kind = static_cast<std::uint32_t>(blob.kind);
      log_.expect(kind == 1 || kind == 2, Rule::kL102, at, [&] { return "kind " + std::to_string(kind); });
      const std::uint64_t start =
          (end + format::kSectionAlignment - 1) / format::kSectionAlignment * format::kSectionAlignment;
      const bool inside =
          log_.expect(blob.offset == start && start <= limit && blob.bytes <= limit - start, Rule::kL114, at,
                      [] { return Text("does not follow the blob before it inside the section"); });
      if (!inside) return;
      for (std::uint64_t byte = end; byte < start; ++byte) {
        log_.expect(file_.bytes[byte] == 0, Rule::kL114, at, [] { return Text("padding before it is not zero"); });
      }
      end = blob.offset + blob.bytes;
      log_.expect(hash64(file_.bytes.subspan(blob.offset, blob.bytes)) == blob.checksum, Rule::kL114, at,
                  [] { return Text("checksum does not match"); });
    }
    log_.expect(
        end == limit, Rule::kL114, [] { return Text("section BLOB"); },
        [] { return Text("does not end with the last blob"); });
  }

  bool check_groups() {
    bool sound = true;
    bool has_aggregate = false;
    log_.check(Rule::kL110);
    for (std::size_t m = 0; m < file_.meshes.size(); ++m) {
      const format::MeshRecord& mesh = file_.meshes[m];
      std::uint64_t next = mesh.first_cluster;
      const std::uint64_t end = next + mesh.cluster_count;
      for (std::uint32_t k = 0; k < mesh.group_count; ++k) {
        const std::size_t g = std::size_t{mesh.first_group} + k;
        const format::GroupRecord& group = file_.groups[g];
        const auto at = [&] { return place("mesh", m, "group", g); };
        sound &=
            log_.expect(group.mesh == m, Rule::kL110, at, [&] { return "names mesh " + std::to_string(group.mesh); });
        sound &= is_range_next(group.first_cluster, group.cluster_count, next, end, Rule::kL110, at());
        log_.expect(group.cluster_count > 0, Rule::kL501, at, [] { return Text("has no member"); });
        // Aggregates came with version 2.
        const std::uint16_t aggregate = file_.header.version == format::kPlainVersion ? 0 : format::kGroupAggregate;
        log_.expect((group.flags & ~(format::kGroupTerminal | format::kGroupStuck | aggregate)) == 0, Rule::kL103, at,
                    [] { return Text("unknown flags"); });
        has_aggregate = has_aggregate || (group.flags & format::kGroupAggregate) != 0;
        log_.expect(static_cast<std::uint32_t>(group.stuck_reason) <= 7, Rule::kL102, at,
                    [&] { return "stuck_reason " + std::to_string(static_cast<std::uint32_t>(group.stuck_reason)); });
        sound &= log_.expect(group.page < file_.pages.size(), Rule::kL111, at,
                             [&] { return "page " + std::to_string(group.page) + " does not exist"; });
      }
      sound &= log_.expect(
          next == end, Rule::kL110, [&] { return place("mesh", m); },
          [&] { return differs("clusters in groups", next, "end of the mesh's", end); });
    }
    log_.expect(
        has_aggregate || file_.header.version == format::kPlainVersion, Rule::kL103, [] { return Text("header"); },
        [] { return Text("version 2, and no group is an aggregate's"); });
    return sound;
  }

  bool check_clusters() {
    bool sound = true;
    log_.check(Rule::kL111);
    for (std::size_t m = 0; m < file_.meshes.size(); ++m) {
      const format::MeshRecord& mesh = file_.meshes[m];
      const auto is_group_of_mesh = [&](std::uint32_t id) {
        return id >= mesh.first_group && id - mesh.first_group < mesh.group_count;
      };
      for (std::uint32_t k = 0; k < mesh.cluster_count; ++k) {
        const std::size_t c = std::size_t{mesh.first_cluster} + k;
        const format::ClusterRecord& cluster = file_.clusters[c];
        const auto at = [&] { return place("mesh", m, "cluster", c); };
        sound &= log_.expect(is_group_of_mesh(cluster.coarser_group), Rule::kL111, at, [&] {
          return "coarser_group " + std::to_string(cluster.coarser_group) + " is not of its mesh";
        });
        sound &= log_.expect(cluster.own_group == format::kNone || is_group_of_mesh(cluster.own_group), Rule::kL111, at,
                             [&] { return "own_group " + std::to_string(cluster.own_group) + " is not of its mesh"; });
        sound &= log_.expect(cluster.vertex_count() <= 3U * cluster.triangle_count(), Rule::kL501, at, [&] {
          return differs("triangles", std::uint64_t{cluster.triangle_count()}, "vertices",
                         std::uint64_t{cluster.vertex_count()});
        });
      }
    }
    return sound;
  }

  void check_levels() {
    log_.check(Rule::kL115);
    for (std::size_t m = 0; m < file_.meshes.size(); ++m) {
      const format::MeshRecord& mesh = file_.meshes[m];
      std::uint64_t levels = 0;
      for (std::uint32_t k = 0; k < mesh.cluster_count; ++k) {
        levels = std::max(levels, std::uint64_t{file_.clusters[mesh.first_cluster + k].level} + 1U);
      }
      log_.expect(
          mesh.level_count == levels, Rule::kL115, [&] { return place("mesh", m); },
          [&] { return differs("level_count", std::uint64_t{mesh.level_count}, "levels", levels); });
    }
  }

  const FileTables& file_;
  RuleLog& log_;
  /// Names may share their bytes: their sum is a product that a small file chooses.
  std::uint64_t name_bytes_left_ = run::decoded_limit(file_.bytes.size(), run::kDefaultMaxDecoded);
};

}  // namespace

bool check_tables(const FileTables& file, RuleLog& log) {
  return TableChecker(file, log).run();
}

}  // namespace meshlode::judge
