// The only file that includes draco's headers. Its decoders check that a stream is valid, but not that its size is
// reasonable: a few bytes can request gigabytes. The classes below therefore check the counts between the steps of
// decoding.
#include "geometry/gltf/draco.hpp"

#include <draco/compression/attributes/sequential_attribute_decoders_controller.h>
#include <draco/compression/attributes/sequential_integer_attribute_decoder.h>
#include <draco/compression/attributes/sequential_quantization_attribute_decoder.h>
#include <draco/compression/config/decoder_options.h>
#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/mesh/mesh.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <iterator>
#include <memory>
#include <utility>

#include "base/text.hpp"

namespace palpa::geometry::gltf {
namespace {

using Controller = draco::SequentialAttributeDecodersController;

// draco gives no access to a controller's sequencer; an explicit instantiation may name private members.
std::unique_ptr<draco::PointsSequencer>& sequencer_of(Controller& controller);
template <auto member>
struct Opener {
  friend std::unique_ptr<draco::PointsSequencer>& sequencer_of(Controller& controller) { return controller.*member; }
};
template struct Opener<&Controller::sequencer_>;

struct Limits {
  std::size_t points, triangles;
  std::uint64_t& spare_bytes;  // of attributes
  std::string fault;           // the exceeded limit

  // A stream may split vertices that the file only counts once, so it has more of them, but never more than corners.
  std::size_t most_points() const { return std::max(points, 3 * triangles); }
};

// Each attribute that is stored separately from the positions has its own connectivity, about ten bytes per corner.
constexpr std::uint64_t most_attribute_corners = 32 << 20;

bool modest_triangles(Limits& limits, std::uint64_t triangles, std::uint64_t attribute_groups) {
  if (triangles > limits.triangles) {
    limits.fault = fmt::format("hold {} triangles where the file promises {}", triangles, limits.triangles);
  } else if (3 * triangles * attribute_groups > most_attribute_corners) {
    limits.fault = fmt::format("hold {} groups of attributes of {} triangles; palpa reads no more than {} corners",
                               attribute_groups, triangles, most_attribute_corners);
  }
  return limits.fault.empty();
}

bool modest_points(Limits& limits, std::uint64_t points) {
  if (points > limits.most_points())
    limits.fault = fmt::format("hold {} vertices where the file promises {}", points, limits.points);
  return limits.fault.empty();
}

bool modest_attributes(Limits& limits, const draco::PointCloud& cloud) {
  if (!modest_points(limits, cloud.num_points())) return false;
  std::uint64_t bytes_per_point = 0;
  for (int i = 0; i < cloud.num_attributes(); ++i)
    // Once as stored, once more as integers while decoding.
    bytes_per_point += static_cast<std::uint64_t>(cloud.attribute(i)->byte_stride()) +
                       4 * static_cast<std::uint64_t>(cloud.attribute(i)->num_components());
  const std::uint64_t bytes = bytes_per_point * cloud.num_points();
  if (bytes > limits.spare_bytes) {
    limits.fault =
        fmt::format("hold {} attributes of {} vertices; palpa reads no more than {} bytes of them in all of a file",
                    cloud.num_attributes(), cloud.num_points(), most_draco_bytes);
    return false;
  }
  limits.spare_bytes -= bytes;
  return true;
}

// Predicts texture coordinates. The stream states the number of their orientations (at most one per corner of a
// triangle) in four bytes that draco does not check.
class BoundedScheme : public draco::PredictionSchemeTypedDecoderInterface<std::int32_t> {
 public:
  BoundedScheme(std::unique_ptr<draco::PredictionSchemeTypedDecoderInterface<std::int32_t>> scheme, std::size_t most)
      : scheme_(std::move(scheme)), most_(most) {}

  bool DecodePredictionData(draco::DecoderBuffer* buffer) override {
    draco::DecoderBuffer ahead = *buffer;
    std::int32_t orientations = 0;
    if (!ahead.Decode(&orientations) || orientations < 0 || static_cast<std::size_t>(orientations) > most_)
      return false;
    return scheme_->DecodePredictionData(buffer);
  }
  bool ComputeOriginalValues(const std::int32_t* corrections, std::int32_t* out, int size, int components,
                             const draco::PointIndex* points) override {
    return scheme_->ComputeOriginalValues(corrections, out, size, components, points);
  }
  draco::PredictionSchemeMethod GetPredictionMethod() const override { return scheme_->GetPredictionMethod(); }
  const draco::PointAttribute* GetAttribute() const override { return scheme_->GetAttribute(); }
  bool IsInitialized() const override { return scheme_->IsInitialized(); }
  int GetNumParentAttributes() const override { return scheme_->GetNumParentAttributes(); }
  draco::GeometryAttribute::Type GetParentAttributeType(int i) const override {
    return scheme_->GetParentAttributeType(i);
  }
  bool SetParentAttribute(const draco::PointAttribute* attribute) override {
    return scheme_->SetParentAttribute(attribute);
  }
  bool AreCorrectionsPositive() override { return scheme_->AreCorrectionsPositive(); }
  draco::PredictionSchemeTransformType GetTransformType() const override { return scheme_->GetTransformType(); }

 private:
  std::unique_ptr<draco::PredictionSchemeTypedDecoderInterface<std::int32_t>> scheme_;
  std::size_t most_;
};

// One of draco's integer decoders with bounded predictions.
template <typename Base>
class Bounded : public Base {
 public:
  explicit Bounded(std::size_t corners) : corners_(corners) {}

 protected:
  std::unique_ptr<draco::PredictionSchemeTypedDecoderInterface<std::int32_t>> CreateIntPredictionScheme(
      draco::PredictionSchemeMethod method, draco::PredictionSchemeTransformType transform) override {
    auto scheme = Base::CreateIntPredictionScheme(method, transform);
    if (scheme == nullptr || method != draco::MESH_PREDICTION_TEX_COORDS_PORTABLE) return scheme;
    return std::make_unique<BoundedScheme>(std::move(scheme), corners_);
  }

 private:
  std::size_t corners_;
};

class BoundedController : public Controller {
 public:
  BoundedController(std::unique_ptr<draco::PointsSequencer> sequencer, std::size_t corners)
      : Controller(std::move(sequencer)), corners_(corners) {}

 protected:
  std::unique_ptr<draco::SequentialAttributeDecoder> CreateSequentialDecoder(std::uint8_t type) override {
    if (type == draco::SEQUENTIAL_ATTRIBUTE_ENCODER_INTEGER)
      return std::make_unique<Bounded<draco::SequentialIntegerAttributeDecoder>>(corners_);
    if (type == draco::SEQUENTIAL_ATTRIBUTE_ENCODER_QUANTIZATION)
      return std::make_unique<Bounded<draco::SequentialQuantizationAttributeDecoder>>(corners_);
    return Controller::CreateSequentialDecoder(type);
  }

 private:
  std::size_t corners_;
};

class Edgebreaker : public draco::MeshEdgebreakerDecoder {
 public:
  explicit Edgebreaker(Limits& limits) : limits_(limits) {}

 protected:
  bool DecodeConnectivity() override {
    // Reads the stream's next values ahead from a copy: vertices, faces, groups of attributes besides the positions.
    draco::DecoderBuffer ahead = *buffer();
    std::uint32_t vertices = 0, faces = 0;
    std::uint8_t groups = 0;
    if (!draco::DecodeVarint(&vertices, &ahead) || !draco::DecodeVarint(&faces, &ahead) || !ahead.Decode(&groups))
      return false;
    return modest_triangles(limits_, faces, groups) && MeshEdgebreakerDecoder::DecodeConnectivity();
  }
  bool CreateAttributesDecoder(std::int32_t decoder) override {
    if (!MeshEdgebreakerDecoder::CreateAttributesDecoder(decoder)) return false;
    auto* made = dynamic_cast<const Controller*>(attributes_decoder(decoder));
    if (made == nullptr) return false;
    auto sequencer = std::move(sequencer_of(const_cast<Controller&>(*made)));
    return SetAttributesDecoder(
        decoder, std::make_unique<BoundedController>(std::move(sequencer), std::size_t{3} * mesh()->num_faces()));
  }
  bool DecodeAllAttributes() override {
    return modest_attributes(limits_, *point_cloud()) && MeshEdgebreakerDecoder::DecodeAllAttributes();
  }

 private:
  Limits& limits_;
};

class Sequential : public draco::MeshSequentialDecoder {
 public:
  explicit Sequential(Limits& limits) : limits_(limits) {}

 protected:
  bool DecodeConnectivity() override {
    draco::DecoderBuffer ahead = *buffer();
    std::uint32_t faces = 0, points = 0;
    if (!draco::DecodeVarint(&faces, &ahead) || !draco::DecodeVarint(&points, &ahead)) return false;
    return modest_triangles(limits_, faces, 0) && modest_points(limits_, points) &&
           MeshSequentialDecoder::DecodeConnectivity();
  }
  bool DecodeAllAttributes() override {
    return modest_attributes(limits_, *point_cloud()) && MeshSequentialDecoder::DecodeAllAttributes();
  }

 private:
  Limits& limits_;
};

// Returns an empty string on success.
std::string decode(std::span<const unsigned char> stream, Limits& limits, draco::Mesh& mesh) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(stream.data()), stream.size());
  draco::DecoderBuffer ahead = buffer;
  draco::DracoHeader header{};
  if (!draco::PointCloudDecoder::DecodeHeader(&ahead, &header).ok()) return "do not begin with draco's header";
  if (header.encoder_type != draco::TRIANGULAR_MESH) return "are not a triangle mesh";
  if (header.version_major != 2 || header.version_minor != 2) {
    return fmt::format("have the bitstream version {}.{}; glTF's is 2.2", header.version_major, header.version_minor);
  }
  const draco::DecoderOptions options;
  draco::Status status;
  if (header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING) {
    status = Edgebreaker(limits).Decode(options, &buffer, &mesh);
  } else if (header.encoder_method == draco::MESH_SEQUENTIAL_ENCODING) {
    status = Sequential(limits).Decode(options, &buffer, &mesh);
  } else {
    return fmt::format("have the unknown method {}", header.encoder_method);
  }
  if (!limits.fault.empty()) return limits.fault;
  if (!status.ok()) return fmt::format("cannot be decoded ({})", printable(status.error_msg_string(), 60));
  return {};
}

template <typename T>
double stored(const draco::PointAttribute& attribute, draco::AttributeValueIndex index, std::size_t component) {
  T value;
  std::memcpy(&value, attribute.GetAddress(index) + component * sizeof value, sizeof value);
  return static_cast<double>(value);
}

using Stored = double (*)(const draco::PointAttribute&, draco::AttributeValueIndex, std::size_t);

// nullptr for types that glTF does not have.
Stored reader_of(draco::DataType type) {
  static constexpr std::pair<draco::DataType, Stored> readers[]{
      {draco::DT_INT8, stored<std::int8_t>},   {draco::DT_UINT8, stored<std::uint8_t>},
      {draco::DT_INT16, stored<std::int16_t>}, {draco::DT_UINT16, stored<std::uint16_t>},
      {draco::DT_INT32, stored<std::int32_t>}, {draco::DT_UINT32, stored<std::uint32_t>},
      {draco::DT_FLOAT32, stored<float>}};
  const auto found = std::ranges::find(readers, type, &std::pair<draco::DataType, Stored>::first);
  return found == std::end(readers) ? nullptr : found->second;
}

std::string copy_attribute(const draco::Mesh& mesh, const DracoAttribute& wanted, std::vector<double>& values) {
  const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(wanted.id);
  if (attribute == nullptr) return fmt::format("have no attribute {}", wanted.id);
  if (static_cast<std::size_t>(attribute->num_components()) != wanted.width) {
    return fmt::format("have {} components in attribute {}, which needs {}", attribute->num_components(), wanted.id,
                       wanted.width);
  }
  const Stored read = reader_of(attribute->data_type());
  if (read == nullptr) return fmt::format("store attribute {} as a type that glTF does not have", wanted.id);
  if (attribute->buffer() == nullptr ||
      attribute->buffer()->data_size() < attribute->size() * static_cast<std::size_t>(attribute->byte_stride())) {
    return fmt::format("lack values of attribute {}", wanted.id);
  }
  values.resize(mesh.num_points() * wanted.width);
  for (std::uint32_t p = 0; p < mesh.num_points(); ++p) {
    const draco::AttributeValueIndex index = attribute->mapped_index(draco::PointIndex(p));
    if (index.value() >= attribute->size())
      return fmt::format("lack a value of vertex {} in attribute {}", p, wanted.id);
    for (std::size_t i = 0; i < wanted.width; ++i)
      values[p * wanted.width + i] = read(*attribute, index, i);
  }
  return {};
}

}  // namespace

std::optional<DracoMesh> decode_draco(std::span<const unsigned char> stream,
                                      const std::vector<DracoAttribute>& attributes, std::size_t points,
                                      std::size_t triangles, std::uint64_t& spare_bytes, std::string& fault) {
  try {
    Limits limits{points, triangles, spare_bytes, {}};
    draco::Mesh mesh;
    fault = decode(stream, limits, mesh);
    if (!fault.empty()) return std::nullopt;
    DracoMesh result;
    result.points = mesh.num_points();
    result.triangles.reserve(mesh.num_faces());
    for (draco::FaceIndex f(0); f < mesh.num_faces(); ++f) {
      const draco::Mesh::Face& face = mesh.face(f);
      for (const draco::PointIndex& corner : face) {
        if (corner.value() >= mesh.num_points()) {
          fault = fmt::format("name vertex {} in triangle {}, but have only {}", corner.value(), f.value(),
                              mesh.num_points());
          return std::nullopt;
        }
      }
      result.triangles.emplace_back(face[0].value(), face[1].value(), face[2].value());
    }
    result.values.resize(attributes.size());
    for (std::size_t i = 0; i < attributes.size(); ++i) {
      fault = copy_attribute(mesh, attributes[i], result.values[i]);
      if (!fault.empty()) return std::nullopt;
    }
    return result;
  } catch (const std::exception&) {
    // Lengths within a stream that draco trusts without checking them.
    fault = "cannot be decoded";
    return std::nullopt;
  }
}

}  // namespace palpa::geometry::gltf
