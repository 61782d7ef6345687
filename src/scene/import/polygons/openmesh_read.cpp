// SPDX-License-Identifier: GPL-3.0-or-later
// The one file of this room that sees OpenMesh: its readers, with an importer that fills flat arrays. Its half-edge
// mesh is not used, because it refuses complex edges and aborts on bad faces.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <exception>
#include <limits>
#include <map>
#include <mutex>
#include <new>
#include <sstream>

#include <OpenMesh/Core/IO/Options.hh>
#include <OpenMesh/Core/IO/importer/BaseImporter.hh>
#include <OpenMesh/Core/IO/reader/OBJReader.hh>
#include <OpenMesh/Core/IO/reader/PLYReader.hh>
#include <OpenMesh/Core/IO/reader/STLReader.hh>
#include <OpenMesh/Core/System/omstream.hh>

#include "base/guarded.h"
#include "scene/import/polygons/polygon_soup.h"

namespace meshlode::scene {

namespace {

namespace om = OpenMesh;

/// Receives vertices and faces in the readers' order.
class SoupImporter : public om::IO::BaseImporter {
 public:
  SoupImporter(const CheckedMeshFile& file, PolygonSoup& soup)
      : soup_(soup),
        has_normals_(file.has_normals),
        has_uvs_(file.has_uvs),
        has_colors_(file.has_colors),
        splits_wedges_(file.format == CheckedMeshFile::Format::kObj && (file.has_normals || file.has_uvs)) {}

  om::VertexHandle add_vertex(const om::Vec3f& p) override {
    soup_.positions.emplace_back(p[0], p[1], p[2]);
    if (has_normals_) soup_.normals.emplace_back(0.0F);
    if (has_uvs_) soup_.uvs.emplace_back(0.0F);
    if (has_colors_) soup_.colors.emplace_back(1.0F);
    return om::VertexHandle(static_cast<int>(soup_.positions.size()) - 1);
  }
  om::VertexHandle add_vertex(const om::Vec3d& p) override { return add_vertex(om::Vec3f(p)); }
  om::VertexHandle add_vertex() override { return add_vertex(om::Vec3f(0.0F, 0.0F, 0.0F)); }
  void set_point(om::VertexHandle v, const om::Vec3f& p) override {
    if (is_vertex(v)) soup_.positions[index(v)] = Vec3d(p[0], p[1], p[2]);
  }

  om::FaceHandle add_face(const VHandles& corners) override {
    for (const om::VertexHandle corner : corners) {
      if (!is_vertex(corner)) broken = true;
    }
    if (broken || corners.size() < 3) return om::FaceHandle();
    for (const om::VertexHandle corner : corners) {
      soup_.corners.push_back(splits_wedges_ ? take_wedge(corner) : static_cast<std::uint32_t>(corner.idx()));
    }
    pending_.clear();
    soup_.polygon_sizes.push_back(static_cast<std::uint32_t>(corners.size()));
    return om::FaceHandle(static_cast<int>(soup_.polygon_sizes.size()) - 1);
  }

  void set_normal(om::VertexHandle v, const om::Vec3f& n) override {
    if (!is_vertex(v) || !has_normals_) return;
    if (splits_wedges_) {
      pending(v).normal = Vec3f(n[0], n[1], n[2]);
    } else {
      soup_.normals[index(v)] = Vec3f(n[0], n[1], n[2]);
    }
  }
  void set_normal(om::VertexHandle v, const om::Vec3d& n) override { set_normal(v, om::Vec3f(n)); }
  void set_texcoord(om::VertexHandle v, const om::Vec2f& t) override {
    if (!is_vertex(v) || !has_uvs_) return;
    if (splits_wedges_) {
      pending(v).uv = Vec2f(t[0], t[1]);
    } else {
      soup_.uvs[index(v)] = Vec2f(t[0], t[1]);
    }
  }
  void set_texcoord(om::VertexHandle v, const om::Vec3f& t) override { set_texcoord(v, om::Vec2f(t[0], t[1])); }
  void set_color(om::VertexHandle v, const om::Vec3uc& c) override {
    put_color(v, Vec4f(c[0], c[1], c[2], 255.0F) / 255.0F);
  }
  void set_color(om::VertexHandle v, const om::Vec4uc& c) override {
    put_color(v, Vec4f(c[0], c[1], c[2], c[3]) / 255.0F);
  }
  void set_color(om::VertexHandle v, const om::Vec3f& c) override { put_color(v, Vec4f(c[0], c[1], c[2], 1.0F)); }
  void set_color(om::VertexHandle v, const om::Vec4f& c) override { put_color(v, Vec4f(c[0], c[1], c[2], c[3])); }

  std::size_t n_vertices() const override { return soup_.positions.size(); }
  std::size_t n_faces() const override { return soup_.polygon_sizes.size(); }
  std::size_t n_edges() const override { return 0; }

  // What half-edge meshes and other formats would add.
  om::HalfedgeHandle add_edge(om::VertexHandle, om::VertexHandle) override { return om::HalfedgeHandle(); }
  om::FaceHandle add_face(om::HalfedgeHandle) override { return om::FaceHandle(); }
  void add_face_texcoords(om::FaceHandle, om::VertexHandle, const std::vector<om::Vec2f>&) override {}
  void add_face_texcoords(om::FaceHandle, om::VertexHandle, const std::vector<om::Vec3f>&) override {}
  void set_face_texindex(om::FaceHandle, int) override {}
  void set_halfedge(om::VertexHandle, om::HalfedgeHandle) override {}
  void set_status(om::VertexHandle, const om::Attributes::StatusInfo&) override {}
  void set_next(om::HalfedgeHandle, om::HalfedgeHandle) override {}
  void set_face(om::HalfedgeHandle, om::FaceHandle) override {}
  void request_face_texcoords2D() override {}
  void set_texcoord(om::HalfedgeHandle, const om::Vec2f&) override {}
  void set_texcoord(om::HalfedgeHandle, const om::Vec3f&) override {}
  void set_status(om::HalfedgeHandle, const om::Attributes::StatusInfo&) override {}
  void set_color(om::EdgeHandle, const om::Vec3uc&) override {}
  void set_color(om::EdgeHandle, const om::Vec4uc&) override {}
  void set_color(om::EdgeHandle, const om::Vec3f&) override {}
  void set_color(om::EdgeHandle, const om::Vec4f&) override {}
  void set_status(om::EdgeHandle, const om::Attributes::StatusInfo&) override {}
  void set_normal(om::FaceHandle, const om::Vec3f&) override {}
  void set_normal(om::FaceHandle, const om::Vec3d&) override {}
  void set_color(om::FaceHandle, const om::Vec3uc&) override {}
  void set_color(om::FaceHandle, const om::Vec4uc&) override {}
  void set_color(om::FaceHandle, const om::Vec3f&) override {}
  void set_color(om::FaceHandle, const om::Vec4f&) override {}
  void set_status(om::FaceHandle, const om::Attributes::StatusInfo&) override {}
  void add_texture_information(int, std::string) override {}

  bool broken = false;

 private:
  /// OBJ gives normals and UVs per corner, just before the face: kept until add_face asks.
  struct Corner {
    std::uint32_t vertex = 0;
    Vec2f uv{0.0F};
    Vec3f normal{0.0F};
  };
  using WedgeKey = std::array<std::uint32_t, 6>;

  [[nodiscard]] bool is_vertex(om::VertexHandle v) const {
    return v.idx() >= 0 && static_cast<std::size_t>(v.idx()) < soup_.positions.size();
  }
  static std::size_t index(om::VertexHandle v) { return static_cast<std::size_t>(v.idx()); }
  Corner& pending(om::VertexHandle v) {
    if (pending_.empty() || pending_.back().vertex != index(v)) {
      pending_.push_back({static_cast<std::uint32_t>(v.idx()), Vec2f(0.0F), Vec3f(0.0F)});
    }
    return pending_.back();
  }
  void put_color(om::VertexHandle v, const Vec4f& color) {
    if (is_vertex(v) && has_colors_) soup_.colors[index(v)] = color;
  }
  /// The stored vertex with this position and the pending attributes: the vertex itself the first time it is used.
  std::uint32_t take_wedge(om::VertexHandle v) {
    const auto vertex = static_cast<std::uint32_t>(v.idx());
    Corner corner{vertex, Vec2f(0.0F), Vec3f(0.0F)};
    for (const Corner& c : pending_) {
      if (c.vertex == vertex) {
        corner = c;
        break;
      }
    }
    const WedgeKey key{vertex,
                       std::bit_cast<std::uint32_t>(corner.uv.x),
                       std::bit_cast<std::uint32_t>(corner.uv.y),
                       std::bit_cast<std::uint32_t>(corner.normal.x),
                       std::bit_cast<std::uint32_t>(corner.normal.y),
                       std::bit_cast<std::uint32_t>(corner.normal.z)};
    const auto [known, is_new] = wedges_.try_emplace(key, 0);
    if (!is_new) return known->second;
    if (is_used_.size() < soup_.positions.size()) is_used_.resize(soup_.positions.size(), false);
    std::uint32_t stored = vertex;
    if (is_used_[vertex]) {
      stored = static_cast<std::uint32_t>(soup_.positions.size());
      soup_.positions.push_back(Vec3d(soup_.positions[vertex]));
      source_vertex.push_back(vertex);
      if (has_normals_) soup_.normals.emplace_back(0.0F);
      if (has_uvs_) soup_.uvs.emplace_back(0.0F);
      if (has_colors_) soup_.colors.push_back(Vec4f(soup_.colors[vertex]));
    } else {
      is_used_[vertex] = true;
    }
    if (has_uvs_) soup_.uvs[stored] = corner.uv;
    if (has_normals_) soup_.normals[stored] = corner.normal;
    known->second = stored;
    return stored;
  }

  PolygonSoup& soup_;
  bool has_normals_, has_uvs_, has_colors_, splits_wedges_;
  std::vector<Corner> pending_;
  std::vector<bool> is_used_;
  std::map<WedgeKey, std::uint32_t> wedges_;

 public:
  std::vector<std::uint32_t> source_vertex;  ///< of the vertices that were split off, in order
};

bool run_reader(CheckedMeshFile::Format format, std::istream& stream, om::IO::BaseImporter& importer,
                om::IO::Options options) {
  switch (format) {
    case CheckedMeshFile::Format::kPly: return om::IO::PLYReader().read(stream, importer, options);
    case CheckedMeshFile::Format::kObj: return om::IO::OBJReader().read(stream, importer, options);
    default: return om::IO::STLReader().read(stream, importer, options);
  }
}

/// The readers are singletons with state, and talk to std::cerr: one at a time, in silence.
class ReaderLock {
 public:
  ReaderLock() : lock_(mutex()), was_enabled_(omerr().is_enabled()) { omerr().disable(); }
  ~ReaderLock() {
    if (was_enabled_) omerr().enable();
  }
  ReaderLock(const ReaderLock&) = delete;
  ReaderLock& operator=(const ReaderLock&) = delete;

 private:
  static std::mutex& mutex() {
    static std::mutex mutex;
    return mutex;
  }
  std::lock_guard<std::mutex> lock_;
  bool was_enabled_;
};

/// OpenMesh on the text; what it throws is the text's fault, but for memory.
Status run_openmesh(CheckedMeshFile::Format format, std::istringstream& stream, SoupImporter& importer,
                    om::IO::Options options) {
  const ReaderLock lock;
  try {
    if (run_reader(format, stream, importer, options) && !importer.broken) return Ok{};
  } catch (const std::bad_alloc&) {
    return out_of_memory({});
  } catch (const std::exception& error) {
    return Error{ErrorCode::kInvalid, "", std::string("OpenMesh: ") + error.what()};
  }
  return Error{ErrorCode::kInvalid, "", "OpenMesh's reader refuses it"};
}

}  // namespace

Result<PolygonSoup> read_with_openmesh(CheckedMeshFile& file) {
  PolygonSoup soup;
  SoupImporter importer(file, soup);
  om::IO::Options options;
  if (file.has_normals) options += om::IO::Options::VertexNormal;
  if (file.has_uvs) options += om::IO::Options::VertexTexCoord;
  if (file.has_colors) options += om::IO::Options::VertexColor;
  if (file.format != CheckedMeshFile::Format::kObj) options += om::IO::Options::Binary;
  std::istringstream stream(std::move(file.text));
  if (const Status read = run_openmesh(file.format, stream, importer, options); !read) return read.error();
  if (!file.exact_positions.empty()) {
    if (file.exact_positions.size() + importer.source_vertex.size() != soup.positions.size()) {
      return Error{ErrorCode::kInvalid, "", "OpenMesh's reader found another number of vertices"};
    }
    std::copy(file.exact_positions.begin(), file.exact_positions.end(), soup.positions.begin());
    for (std::size_t i = 0; i < importer.source_vertex.size(); ++i) {
      soup.positions[file.exact_positions.size() + i] = file.exact_positions[importer.source_vertex[i]];
    }
  }
  return soup;
}

}  // namespace meshlode::scene
