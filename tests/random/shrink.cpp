// SPDX-License-Identifier: GPL-3.0-or-later
#include "shrink.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace meshlode::test {

namespace {

class Shrinker {
 public:
  Shrinker(RandomScene scene, const StillFails& still_fails, double seconds)
      : scene_(std::move(scene)),
        still_fails_(still_fails),
        end_(std::chrono::steady_clock::now() +
             std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(seconds))) {}

  RandomScene run() {
    for (bool changed = true; changed && has_time();) {
      changed = drop_parts();
      changed = drop_triangles() || changed;
      changed = drop_extras() || changed;
    }
    drop_unused_vertices(scene_);
    return std::move(scene_);
  }

 private:
  [[nodiscard]] bool has_time() const { return std::chrono::steady_clock::now() < end_; }

  bool try_this(RandomScene candidate) {
    if (!has_time() || candidate.triangle_count() == 0) return false;
    drop_unused_vertices(candidate);
    if (!still_fails_(candidate)) return false;
    scene_ = std::move(candidate);
    return true;
  }

  static void drop_unused_vertices(RandomScene& scene) {
    for (RandomMesh& mesh : scene.meshes) {
      for (RandomPrimitive& primitive : mesh.primitives) {
        std::vector<std::uint32_t> renamed(primitive.positions.size(), 0xFFFFFFFFU);
        for (const auto& t : primitive.triangles) {
          for (const std::uint32_t v : t) renamed[v] = 0;
        }
        std::uint32_t next = 0;
        const auto keep = [&](auto& values) {
          if (values.empty()) return;
          std::size_t kept = 0;
          for (std::size_t v = 0; v < renamed.size(); ++v) {
            if (renamed[v] != 0xFFFFFFFFU) values[kept++] = values[v];
          }
          values.resize(kept);
        };
        keep(primitive.normals);
        keep(primitive.uvs);
        keep(primitive.colors);
        keep(primitive.positions);
        for (std::uint32_t& name : renamed) name = name == 0xFFFFFFFFU ? name : next++;
        for (auto& t : primitive.triangles) {
          for (std::uint32_t& v : t) v = renamed[v];
        }
      }
    }
  }

  /// Meshes, primitives, instances.
  bool drop_parts() {
    bool changed = false;
    for (std::size_t m = scene_.meshes.size(); m-- > 0 && scene_.meshes.size() > 1;) {
      RandomScene without = scene_;
      without.meshes.erase(without.meshes.begin() + static_cast<std::ptrdiff_t>(m));
      std::erase_if(without.instances, [&](const RandomInstance& instance) { return instance.mesh == m; });
      for (RandomInstance& instance : without.instances) instance.mesh -= instance.mesh > m ? 1U : 0U;
      changed = try_this(std::move(without)) || changed;
    }
    for (std::size_t m = 0; m < scene_.meshes.size(); ++m) {
      for (std::size_t p = scene_.meshes[m].primitives.size(); p-- > 0;) {
        RandomScene without = scene_;
        without.meshes[m].primitives.erase(without.meshes[m].primitives.begin() + static_cast<std::ptrdiff_t>(p));
        changed = try_this(std::move(without)) || changed;
      }
    }
    for (std::size_t i = scene_.instances.size(); i-- > 0 && scene_.instances.size() > 1;) {
      RandomScene without = scene_;
      without.instances.erase(without.instances.begin() + static_cast<std::ptrdiff_t>(i));
      changed = try_this(std::move(without)) || changed;
    }
    return changed;
  }

  /// Options, attributes, textures, materials.
  bool drop_extras() {
    bool changed = false;
    for (std::size_t i = 0; i + 1 < scene_.build_options.size();) {
      RandomScene without = scene_;
      const auto at = without.build_options.begin() + static_cast<std::ptrdiff_t>(i);
      without.build_options.erase(at, at + 2);
      if (try_this(std::move(without))) {
        changed = true;
      } else {
        i += 2;
      }
    }
    const auto change_all = [&](auto change) {
      RandomScene plain = scene_;
      bool is_other = false;
      for (RandomMesh& mesh : plain.meshes) {
        for (RandomPrimitive& primitive : mesh.primitives) is_other = change(primitive) || is_other;
      }
      if (is_other) changed = try_this(std::move(plain)) || changed;
    };
    const auto clear = [](auto& values) {
      const bool had = !values.empty();
      values.clear();
      return had;
    };
    change_all([&](RandomPrimitive& p) { return clear(p.colors); });
    change_all([&](RandomPrimitive& p) { return clear(p.uvs); });
    change_all([&](RandomPrimitive& p) { return clear(p.normals); });
    change_all([&](RandomPrimitive& p) { return std::exchange(p.material, 0U) != 0; });
    RandomScene plain = scene_;
    plain.materials.assign(1, RandomMaterial());
    const bool one_material = std::all_of(plain.meshes.begin(), plain.meshes.end(), [](const RandomMesh& mesh) {
      return std::all_of(mesh.primitives.begin(), mesh.primitives.end(), [](const auto& p) { return p.material == 0; });
    });
    if (one_material && (scene_.materials.size() > 1 || scene_.materials[0].is_textured))
      changed = try_this(std::move(plain)) || changed;
    return changed;
  }

  /// The scene without triangles [first, last) of all, counted through.
  [[nodiscard]] RandomScene without_triangles(std::size_t first, std::size_t last) const {
    RandomScene out = scene_;
    std::size_t at = 0;
    for (RandomMesh& mesh : out.meshes) {
      for (RandomPrimitive& primitive : mesh.primitives) {
        std::erase_if(primitive.triangles, [&](const auto&) {
          const std::size_t t = at++;
          return t >= first && t < last;
        });
      }
    }
    return out;
  }

  bool drop_triangles() {
    const std::uint64_t before = scene_.triangle_count();
    for (std::size_t chunk = std::max<std::size_t>(1, before / 2);; chunk /= 2) {
      for (std::size_t first = 0; first < scene_.triangle_count() && has_time();) {
        if (!try_this(without_triangles(first, first + chunk))) first += chunk;
      }
      if (chunk <= 1 || !has_time()) break;
    }
    return scene_.triangle_count() < before;
  }

  RandomScene scene_;
  const StillFails& still_fails_;
  std::chrono::steady_clock::time_point end_;
};

}  // namespace

RandomScene shrink_scene(RandomScene scene, const StillFails& still_fails, double seconds) {
  return Shrinker(std::move(scene), still_fails, seconds).run();
}

}  // namespace meshlode::test
