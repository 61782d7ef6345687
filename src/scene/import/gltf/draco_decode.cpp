// SPDX-License-Identifier: GPL-3.0-or-later
// The one file of this room that sees Draco. The decoder believes the counts in its stream and allocates by them, so
// it runs with guards: the header is read here first, and the two mesh decoders are derived from so that the counts
// they arrive at are compared with glTF's own before the next, larger step begins.
#include "scene/import/gltf/draco_decode.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <optional>
#include <string>

#include <draco/compression/attributes/prediction_schemes/prediction_scheme_decoder_interface.h>
#include <draco/compression/attributes/sequential_attribute_decoders_controller.h>
#include <draco/compression/attributes/sequential_integer_attribute_decoder.h>
#include <draco/compression/attributes/sequential_quantization_attribute_decoder.h>
#include <draco/compression/config/decoder_options.h>
#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/core/decoder_buffer.h>
#include <draco/mesh/mesh.h>

#include "base/guarded.h"
#include "base/try.h"
#include "scene/import/gltf/gltf.h"

namespace meshlode::scene {

namespace {

Error invalid_draco(std::string detail) {
  return {ErrorCode::kInvalid, "", "Draco: " + std::move(detail)};
}

constexpr int kMaxAttributes = 32;
constexpr int kMaxComponents = 64;  // of all attributes together: Draco allocates them all per point

/// Reads the head of a stream as the bitstream specification 2.2 lays it out; every read is bounded.
class HeadReader {
 public:
  explicit HeadReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  [[nodiscard]] bool ok() const { return ok_; }
  std::uint8_t byte() {
    if (at_ >= bytes_.size()) {
      ok_ = false;
      return 0;
    }
    return bytes_[at_++];
  }
  std::uint32_t varint() {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 35; shift += 7) {
      const std::uint8_t b = byte();
      value |= std::uint64_t{b & 0x7Fu} << shift;
      if ((b & 0x80u) == 0) {
        if (value > 0xFFFFFFFFu) ok_ = false;
        return static_cast<std::uint32_t>(value);
      }
    }
    ok_ = false;
    return 0;
  }
  void skip(std::uint64_t count) {
    if (count > bytes_.size() - at_) {
      ok_ = false;
    } else {
      at_ += count;
    }
  }
  /// Names and values of anything; the depth is bounded because Draco walks it without a bound of ours.
  void metadata(int depth) {
    if (depth > 8) ok_ = false;
    const std::uint32_t entries = varint();
    for (std::uint32_t i = 0; ok_ && i < entries; ++i) {
      skip(byte());
      skip(varint());
    }
    const std::uint32_t children = varint();
    for (std::uint32_t i = 0; ok_ && i < children; ++i) {
      skip(byte());
      metadata(depth + 1);
    }
  }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  bool ok_ = true;
};

enum class Method { kSequential, kEdgebreaker };

/// Compares the stream's own counts with what is expected, before any of Draco's code sees them.
Result<Method> check_head(std::span<const std::uint8_t> bytes, const DracoExpectation& expected) {
  HeadReader head(bytes);
  for (const char c : {'D', 'R', 'A', 'C', 'O'}) {
    if (head.byte() != static_cast<std::uint8_t>(c)) return invalid_draco("the bytes do not begin with DRACO");
  }
  const std::uint8_t major = head.byte();
  const std::uint8_t minor = head.byte();
  const std::uint8_t type = head.byte();
  const std::uint8_t method = head.byte();
  const unsigned flags = head.byte() | static_cast<unsigned>(head.byte()) << 8U;
  if (!head.ok()) return invalid_draco("the header is cut short");
  if (major != 2 || minor != 2) {
    return invalid_draco("bitstream version " + std::to_string(major) + "." + std::to_string(minor) +
                         ", glTF asks for 2.2");
  }
  if (type != 1) return invalid_draco("not a triangular mesh");
  if (method > 1) return invalid_draco("an unknown encoding method");
  if ((flags & 0x8000u) != 0) {
    const std::uint32_t attribute_count = head.varint();
    for (std::uint32_t i = 0; head.ok() && i < attribute_count; ++i) {
      head.varint();
      head.metadata(0);
    }
    head.metadata(0);
  }
  std::uint64_t faces = 0;
  std::uint64_t points = 0;
  if (method == 1) {
    head.byte();  // traversal type
    points = head.varint();
    faces = head.varint();
    head.byte();  // attribute data count
    const std::uint64_t symbols = head.varint();
    const std::uint64_t splits = head.varint();
    if (symbols > faces || splits > symbols) return invalid_draco("counts that contradict each other");
  } else {
    faces = head.varint();
    points = head.varint();
  }
  if (!head.ok()) return invalid_draco("the header is cut short");
  if (faces > expected.max_face_count || (expected.is_face_count_exact && faces != expected.max_face_count)) {
    return invalid_draco("the stream has " + std::to_string(faces) + " triangles where the accessors say " +
                         std::to_string(expected.max_face_count));
  }
  // Edgebreaker's vertices are split along seams afterwards; sequential points are final.
  if (points > expected.point_count || (method == 0 && points != expected.point_count)) {
    return invalid_draco("the stream has " + std::to_string(points) + " points where the accessors say " +
                         std::to_string(expected.point_count));
  }
  return method == 1 ? Method::kEdgebreaker : Method::kSequential;
}

/// Texture coordinates are predicted with one flag per vertex, whose count Draco reads and loops over unchecked: two
/// thousand million turns for four bytes. Looks at the count first, and hands everything else through.
class GuardedPrediction : public draco::PredictionSchemeTypedDecoderInterface<std::int32_t> {
 public:
  using Inner = draco::PredictionSchemeTypedDecoderInterface<std::int32_t>;
  GuardedPrediction(std::unique_ptr<Inner> inner, std::int64_t max_flags)
      : inner_(std::move(inner)), max_flags_(max_flags) {}

  bool DecodePredictionData(draco::DecoderBuffer* buffer) override {
    std::int32_t flag_count = 0;
    if (!buffer->Peek(&flag_count) || flag_count < 0 || flag_count > max_flags_) return false;
    return inner_->DecodePredictionData(buffer);
  }
  bool ComputeOriginalValues(const std::int32_t* corrections, std::int32_t* out, int size, int component_count,
                             const draco::PointIndex* points) override {
    return inner_->ComputeOriginalValues(corrections, out, size, component_count, points);
  }
  draco::PredictionSchemeMethod GetPredictionMethod() const override { return inner_->GetPredictionMethod(); }
  const draco::PointAttribute* GetAttribute() const override { return inner_->GetAttribute(); }
  bool IsInitialized() const override { return inner_->IsInitialized(); }
  int GetNumParentAttributes() const override { return inner_->GetNumParentAttributes(); }
  draco::GeometryAttribute::Type GetParentAttributeType(int i) const override {
    return inner_->GetParentAttributeType(i);
  }
  bool SetParentAttribute(const draco::PointAttribute* attribute) override {
    return inner_->SetParentAttribute(attribute);
  }
  bool AreCorrectionsPositive() override { return inner_->AreCorrectionsPositive(); }
  draco::PredictionSchemeTransformType GetTransformType() const override { return inner_->GetTransformType(); }

 private:
  std::unique_ptr<Inner> inner_;
  std::int64_t max_flags_;
};

/// Whether the number that `value` holds is in [first, end), looked at as bytes.
template <class Number, class Enum>
[[nodiscard]] bool is_between(const Enum& value, Number first, Number end) {
  static_assert(sizeof(Enum) == sizeof(Number));
  Number number;
  std::memcpy(&number, &value, sizeof(number));
  return first <= number && number < end;
}

/// Draco's integer or quantization decoder with that guard.
template <class Decoder>
class GuardedAttribute : public Decoder {
 public:
  explicit GuardedAttribute(std::int64_t max_flags) : max_flags_(max_flags) {}

 protected:
  std::unique_ptr<GuardedPrediction::Inner> CreateIntPredictionScheme(
      draco::PredictionSchemeMethod method, draco::PredictionSchemeTransformType transform) override {
    // Draco makes both of any byte of the stream and leaves what they mean to this function: until they are known to be
    // enumerators, even to look at them as such is undefined.
    if (!is_between<int>(method, draco::PREDICTION_NONE, draco::NUM_PREDICTION_SCHEMES) ||
        !is_between<int>(transform, draco::PREDICTION_TRANSFORM_NONE, draco::NUM_PREDICTION_SCHEME_TRANSFORM_TYPES)) {
      return nullptr;
    }
    // The deprecated scheme is older than bitstream 2.2 and counts in another way.
    if (method == draco::MESH_PREDICTION_TEX_COORDS_DEPRECATED) return nullptr;
    auto scheme = Decoder::CreateIntPredictionScheme(method, transform);
    if (scheme == nullptr || scheme->GetPredictionMethod() != draco::MESH_PREDICTION_TEX_COORDS_PORTABLE) return scheme;
    return std::make_unique<GuardedPrediction>(std::move(scheme), max_flags_);
  }

 private:
  std::int64_t max_flags_;
};

class GuardedController : public draco::SequentialAttributeDecodersController {
 public:
  GuardedController(std::unique_ptr<draco::PointsSequencer> sequencer, std::int64_t max_flags)
      : SequentialAttributeDecodersController(std::move(sequencer)), max_flags_(max_flags) {}

 protected:
  std::unique_ptr<draco::SequentialAttributeDecoder> CreateSequentialDecoder(std::uint8_t type) override {
    switch (type) {
      case draco::SEQUENTIAL_ATTRIBUTE_ENCODER_INTEGER:
        return std::make_unique<GuardedAttribute<draco::SequentialIntegerAttributeDecoder>>(max_flags_);
      case draco::SEQUENTIAL_ATTRIBUTE_ENCODER_QUANTIZATION:
        return std::make_unique<GuardedAttribute<draco::SequentialQuantizationAttributeDecoder>>(max_flags_);
      default: return SequentialAttributeDecodersController::CreateSequentialDecoder(type);
    }
  }

 private:
  std::int64_t max_flags_;
};

/// The mesh decoders make their controllers themselves, so a guarded one can only take the place of Draco's and with it
/// its sequencer, which is private. An explicit instantiation may name private members (C++20, [temp.spec.general]).
/// cmake/CheckDracoVersion.cmake refuses a Draco of any other version than the one that this was written against.
struct SequencerOf {
  using Member = std::unique_ptr<draco::PointsSequencer> draco::SequentialAttributeDecodersController::*;
  friend Member member_of(SequencerOf);
};
template <class Tag, typename Tag::Member kMember>
struct NamePrivateMember {
  friend typename Tag::Member member_of(Tag) { return kMember; }
};
template struct NamePrivateMember<SequencerOf, &draco::SequentialAttributeDecodersController::sequencer_>;

/// A decoder that stops where the counts leave what the glTF says.
template <class Decoder>
class GuardedDecoder : public Decoder {
 public:
  explicit GuardedDecoder(const DracoExpectation& expected) : expected_(expected) {}

 protected:
  bool DecodeConnectivity() override {
    if (!Decoder::DecodeConnectivity()) return false;
    const draco::Mesh& mesh = *this->mesh();
    if (mesh.num_points() != expected_.point_count || mesh.num_faces() > expected_.max_face_count) return false;
    for (draco::FaceIndex f(0); f < mesh.num_faces(); ++f) {
      for (const draco::PointIndex& point : mesh.face(f)) {
        if (point.value() >= mesh.num_points()) return false;
      }
    }
    return true;
  }
  bool CreateAttributesDecoder(std::int32_t id) override {
    if (!Decoder::CreateAttributesDecoder(id) || id < 0 || id >= this->num_attributes_decoders()) return false;
    auto* made = dynamic_cast<draco::SequentialAttributeDecodersController*>(
        const_cast<draco::AttributesDecoderInterface*>(this->attributes_decoder(id)));
    if (made == nullptr) return false;
    auto sequencer = std::move(made->*member_of(SequencerOf{}));
    const std::int64_t corner_count = std::int64_t{3} * this->mesh()->num_faces();
    return this->SetAttributesDecoder(id, std::make_unique<GuardedController>(std::move(sequencer), corner_count));
  }
  bool DecodeAllAttributes() override {
    const draco::PointCloud& cloud = *this->point_cloud();
    if (cloud.num_attributes() > kMaxAttributes) return false;
    int component_count = 0;
    for (int i = 0; i < cloud.num_attributes(); ++i) component_count += cloud.attribute(i)->num_components();
    // As integers of 32 bits while they are predicted, and as what they become.
    const std::uint64_t bytes_each = 2 * sizeof(std::int32_t) * static_cast<std::uint64_t>(component_count);
    if (component_count > kMaxComponents || bytes_each * cloud.num_points() > expected_.max_bytes) return false;
    return Decoder::DecodeAllAttributes();
  }

 private:
  const DracoExpectation& expected_;
};

template <class Decoder>
bool run_decoder(std::span<const std::uint8_t> bytes, const DracoExpectation& expected, draco::Mesh& mesh,
                 std::string& problem) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const draco::DecoderOptions options;
  GuardedDecoder<Decoder> decoder(expected);
  const draco::Status status = decoder.Decode(options, &buffer, &mesh);
  if (!status.ok()) problem = status.error_msg_string();
  return status.ok();
}

std::uint32_t gltf_component(draco::DataType type) {
  switch (type) {
    case draco::DT_INT8: return kGltfByte;
    case draco::DT_UINT8:
    case draco::DT_BOOL: return kGltfUnsignedByte;
    case draco::DT_INT16: return kGltfShort;
    case draco::DT_UINT16: return kGltfUnsignedShort;
    case draco::DT_UINT32: return kGltfUnsignedInt;
    case draco::DT_FLOAT32: return kGltfFloat;
    default: return 0;
  }
}

Result<DracoAttribute> copy_attribute(const draco::PointAttribute& attribute, std::uint32_t point_count) {
  DracoAttribute out;
  out.component_type = gltf_component(attribute.data_type());
  out.component_count = static_cast<std::uint32_t>(attribute.num_components());
  const std::uint64_t size = std::uint64_t{component_size(out.component_type)} * out.component_count;
  if (out.component_type == 0 || out.component_count < 1 || out.component_count > 4) {
    return invalid_draco("an attribute of a type that glTF does not have");
  }
  if (attribute.buffer() == nullptr || attribute.byte_stride() != static_cast<std::int64_t>(size)) {
    return invalid_draco("an attribute without data");
  }
  out.bytes.resize(size * point_count);
  const std::uint64_t available = attribute.buffer()->data_size();
  for (std::uint32_t p = 0; p < point_count; ++p) {
    if (!attribute.is_mapping_identity() && p >= attribute.indices_map_size())
      return invalid_draco("a map that is too short");
    const std::uint64_t value = attribute.mapped_index(draco::PointIndex(p)).value();
    if (value >= attribute.size() || value * size > available || size > available - value * size) {
      return invalid_draco("an attribute value out of range");
    }
    std::memcpy(out.bytes.data() + p * size, attribute.buffer()->data() + value * size, size);
  }
  return out;
}

/// Draco on the bytes; what it throws is their fault, but for memory.
Status run_draco(Method method, std::span<const std::uint8_t> bytes, const DracoExpectation& expected,
                 draco::Mesh& mesh) {
  std::string problem;
  try {
    const bool ok = method == Method::kEdgebreaker
                        ? run_decoder<draco::MeshEdgebreakerDecoder>(bytes, expected, mesh, problem)
                        : run_decoder<draco::MeshSequentialDecoder>(bytes, expected, mesh, problem);
    if (!ok) return invalid_draco(problem + " (or its counts are not the accessors')");
  } catch (const std::bad_alloc&) {
    return out_of_memory({});
  } catch (const std::exception& error) {
    return invalid_draco(error.what());
  }
  return Ok{};
}

}  // namespace

Result<DracoMesh> decode_draco(std::span<const std::uint8_t> bytes, const DracoExpectation& expected) {
  TRY_LET(method, check_head(bytes, expected));
  draco::Mesh mesh;
  TRY(run_draco(*method, bytes, expected, mesh));
  if (mesh.num_points() != expected.point_count ||
      (expected.is_face_count_exact && mesh.num_faces() != expected.max_face_count)) {
    return invalid_draco("it decodes to other counts than the accessors say");
  }
  DracoMesh out;
  out.point_count = mesh.num_points();
  out.indices.reserve(std::size_t{3} * mesh.num_faces());
  for (draco::FaceIndex f(0); f < mesh.num_faces(); ++f) {
    for (const draco::PointIndex& point : mesh.face(f)) {
      if (point.value() >= out.point_count) return invalid_draco("an index out of range");
      out.indices.push_back(point.value());
    }
  }
  for (const std::uint32_t id : expected.attribute_ids) {
    const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(id);
    if (attribute == nullptr) return invalid_draco("there is no attribute " + std::to_string(id));
    TRY_LET(copied, copy_attribute(*attribute, out.point_count));
    out.attributes.emplace(id, std::move(*copied));
  }
  return out;
}

}  // namespace meshlode::scene
