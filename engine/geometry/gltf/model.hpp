// A reduced glTF document as tinygltf reads it. For the few files that turn it into meshes.
#pragma once

// Under a name of our own, not from its library: draco's library exports another build of tinygltf, with other layouts
// under the same names, and which of the two a program gets would depend on the order in which it links.
#define tinygltf palpa_tinygltf
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE_WRITE
#include <tiny_gltf.h>

#include "base/input_file.hpp"
#include "geometry/gltf_document/check.hpp"
#include "geometry/gltf_document/container.hpp"

namespace palpa::geometry::gltf {

/// The document with the bytes of its buffers. tinygltf meets no faults, no images, and no files but the buffers: all
/// has been reduced and proved by check_document(). Throws bad_input where a buffer cannot be read.
tinygltf::Model parse_model(const InputFile& file, const Container& container, const Document& document);

}  // namespace palpa::geometry::gltf
