// SPDX-License-Identifier: GPL-3.0-or-later
// tinygltf's declarations, and what every file of this room must agree on to see them: no file system, no images, and
// a namespace of our own, because Debian's TinyGLTF library is the same code with other options and a program that
// links both must not mix them. Nobody outside this folder includes this.
#pragma once

#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_FS
#define tinygltf meshlode_tinygltf  // NOLINT(readability-identifier-naming): a namespace of theirs
#include <tiny_gltf.h>
#undef tinygltf

namespace meshlode::scene {

namespace tinygltf = ::meshlode_tinygltf;

}  // namespace meshlode::scene
