// A reduced glTF document as read by tinygltf. Only for the few files that turn it into meshes.
#pragma once

// tinygltf is compiled under its own namespace name here. draco's library exports another build of tinygltf, with other
// layouts under the same names, so the link order would decide which of the two a program gets.
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

/// The document with the bytes of its buffers. check_document() has reduced and checked everything before, so tinygltf
/// sees no faults, no images, and no files except the buffers. Throws bad_input if a buffer cannot be read.
tinygltf::Model parse_model(const InputFile& file, const Container& container, const Document& document);

}  // namespace palpa::geometry::gltf
