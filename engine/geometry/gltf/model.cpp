#define TINYGLTF_IMPLEMENTATION
#include "geometry/gltf/model.hpp"

#include <algorithm>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/units.hpp"
#include "geometry/gltf_document/buffers.hpp"
#include "geometry/text.hpp"

namespace palpa::geometry::gltf {
namespace {

struct Source {
  const InputFile& file;
  const Container& container;
  const std::vector<BufferSource>& buffers;
  const tinygltf::Model& model;  // has the buffers before the requested one
};

std::vector<unsigned char> load(const Source& source, std::size_t index) {
  const BufferSource& buffer = source.buffers[index];
  if (buffer.length == 0) return std::vector<unsigned char>(1);
  if (!buffer.packed) return load_buffer(source.file, source.container.bin, index, buffer);
  const MeshoptBufferView& view = *buffer.packed;
  const std::span<const unsigned char> packed(source.model.buffers[view.buffer].data);
  return unpack_meshopt(source.file.name(), view, packed.subspan(view.offset, view.length));
}

// tinygltf calls back for every buffer; no file is opened here by a name. All callbacks must be set, and versions
// differ in them.
template <typename Callbacks>
Callbacks callbacks_of(Source& source) {
  Callbacks callbacks{};
  callbacks.FileExists = [](const std::string&, void*) { return true; };
  callbacks.ExpandFilePath = [](const std::string& path, void*) { return path; };
  callbacks.ReadWholeFile = [](std::vector<unsigned char>* bytes, std::string*, const std::string& path, void* user) {
    *bytes = load(*static_cast<const Source*>(user), parse_whole<std::size_t>(path).value());
    return true;
  };
  callbacks.WriteWholeFile = [](std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
    return false;
  };
  if constexpr (requires { callbacks.GetFileSizeInBytes; }) {  // since 2.9; the size was checked before
    callbacks.GetFileSizeInBytes = [](std::size_t* size, std::string*, const std::string&, void*) {
      *size = 1;
      return true;
    };
  }
  callbacks.user_data = &source;
  return callbacks;
}

// Adds the members that tinygltf requires, even of items that the scene does not need. Returns a buffer view that
// stands for none: tinygltf 2.7 requires one for all indices.
int complete(Json& json, const std::vector<BufferSource>& buffers) {
  const auto fill = [&](const char* key, const Json& members) {
    for (Json& item : json[key])
      item.insert(members.begin(), members.end());
  };
  const auto none = static_cast<int>(json["bufferViews"].size());
  json["bufferViews"].push_back(Json::object());
  fill("bufferViews", {{"buffer", 0}, {"byteLength", 1}});
  fill("accessors", {{"bufferView", none}, {"componentType", 5126}, {"count", 1}, {"type", "SCALAR"}});
  fill("skins", {{"joints", Json::array()}});
  json["buffers"] = Json::array();
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    const std::uint64_t length = std::max<std::uint64_t>(buffers[i].length, 1);
    json["buffers"].push_back({{"byteLength", length}, {"uri", std::to_string(i)}});
  }
  return none;
}

}  // namespace

const tinygltf::Value* find(const tinygltf::ExtensionMap& extensions, const char* name) {
  const auto found = extensions.find(name);
  return found == extensions.end() ? nullptr : &found->second;
}

Transform local_transform(const tinygltf::Node& node) {
  if (!node.matrix.empty()) return glm::make_mat4(node.matrix.data());
  Transform T(1);
  if (const auto& q = node.rotation; !q.empty()) T = glm::mat4_cast(glm::normalize(glm::dquat(q[3], q[0], q[1], q[2])));
  for (std::size_t i = 0; i < node.scale.size(); ++i)
    T[static_cast<int>(i)] *= node.scale[i];
  if (const auto& t = node.translation; !t.empty()) T[3] = Vec4(t[0], t[1], t[2], 1);
  return T;
}

tinygltf::Model read_model(const InputFile& file, const Container& container, Document& document) {
  const int no_view = complete(document.json, document.buffers);
  const std::string text = std::exchange(document.json, {}).dump();
  tinygltf::Model model;
  Source source{file, container, document.buffers, model};
  tinygltf::TinyGLTF reader;
  reader.SetFsCallbacks(callbacks_of<tinygltf::FsCallbacks>(source));
  std::string error, warning;
  if (!reader.LoadASCIIFromString(&model, &error, &warning, text.data(), static_cast<unsigned>(text.size()), ""))
    throw bad_input(file.name(), "tinygltf cannot read it: " + text::quoted(error));
  for (tinygltf::Accessor& accessor : model.accessors) {
    if (accessor.bufferView == no_view) accessor.bufferView = -1;
  }
  return model;
}

}  // namespace palpa::geometry::gltf
