#define TINYGLTF_IMPLEMENTATION
#include "geometry/gltf/model.hpp"

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "geometry/gltf_document/buffers.hpp"
#include "geometry/text.hpp"

namespace palpa::geometry::gltf {
namespace {

struct Source {
  BufferLoader loader;
  std::optional<Error> fault;  // exceptions must not pass through tinygltf
};

// `path` is "buffer N" as Data (gltf_document/data.cpp) writes it, or its placeholder "unused".
bool read_whole_file(std::vector<unsigned char>* out, std::string* error, const std::string& path, void* user) {
  Source& source = *static_cast<Source*>(user);
  out->assign(1, 0);
  const std::size_t digits = path.rfind(' ');
  if (digits == std::string::npos) return true;
  const std::size_t index = std::strtoull(path.c_str() + digits, nullptr, 10);
  try {
    *out = source.loader.load(index);
    return true;
  } catch (const Error& e) {
    source.fault = e;
    *error = e.what();
    return false;
  }
}

// tinygltf calls back for every file that the document names; no file is opened here. Versions differ in their
// callbacks, and all callbacks must be set.
template <typename Callbacks>
Callbacks callbacks_of(Source& source) {
  Callbacks callbacks{};
  callbacks.FileExists = [](const std::string&, void*) { return true; };
  callbacks.ExpandFilePath = [](const std::string& path, void*) { return path; };
  callbacks.ReadWholeFile = read_whole_file;
  callbacks.WriteWholeFile = [](std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
    return false;
  };
  // Since 2.9, tinygltf asks for a file's size before it reads the file. BufferLoader checks sizes itself.
  if constexpr (requires { callbacks.GetFileSizeInBytes; })
    callbacks.GetFileSizeInBytes = [](std::size_t* size, std::string*, const std::string&, void*) {
      *size = 1;
      return true;
    };
  callbacks.user_data = &source;
  return callbacks;
}

}  // namespace

tinygltf::Model parse_model(const InputFile& file, const Container& container, const Document& document) {
  Source source{BufferLoader(file, container.bin, document.buffers), std::nullopt};
  tinygltf::TinyGLTF reader;
  reader.SetFsCallbacks(callbacks_of<tinygltf::FsCallbacks>(source));
  reader.SetImageLoader([](tinygltf::Image*, int, std::string*, std::string*, int, int, const unsigned char*, int,
                           void*) { return true; },
                        nullptr);
  tinygltf::Model model;
  std::string error, warning;
  const bool done = reader.LoadASCIIFromString(&model, &error, &warning, document.json.c_str(),
                                               static_cast<unsigned>(document.json.size()), "");
  if (source.fault) throw *source.fault;
  if (!done) throw bad_input(file.name(), "cannot be read as glTF: " + text::quoted(error));
  for (const std::uint32_t accessor : document.without_view)
    model.accessors[accessor].bufferView = -1;
  return model;
}

}  // namespace palpa::geometry::gltf
