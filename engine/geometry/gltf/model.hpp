// A reduced glTF document as tinygltf reads it. Only for the few files that turn it into meshes.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <vector>

#include "base/files/input_file.hpp"
#include "base/math.hpp"
#include "geometry/gltf_document/container.hpp"
#include "geometry/gltf_document/document.hpp"

// tinygltf is compiled under its own namespace name here. draco's library exports another build of tinygltf, with other
// layouts under the same names, so the link order would decide which of the two a program gets.
#define tinygltf palpa_tinygltf
#define TINYGLTF_NO_INCLUDE_JSON  // it would include its own copy, or hide the names of palpa's
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE_WRITE
#include <tiny_gltf.h>

namespace palpa::geometry::gltf {

/// The item that an index names. tinygltf stores indices as int; they have been checked.
template <typename T>
const T& at(const std::vector<T>& items, int index) {
  return items[static_cast<std::size_t>(index)];
}

/// An extension's object; nullptr if it is absent.
const tinygltf::Value* find(const tinygltf::ExtensionMap& extensions, const char* name);

/// From the node's coordinates to its parent's.
Transform local_transform(const tinygltf::Node& node);

/// The document with the bytes of its buffers; empties document.json. tinygltf sees no faults, no pictures and no
/// paths: it asks for the buffers by their numbers. Throws bad_input if a buffer cannot be read, see load_buffer().
tinygltf::Model read_model(const InputFile& file, const Container& container, Document& document);

}  // namespace palpa::geometry::gltf
