// SPDX-License-Identifier: GPL-3.0-or-later
// tinygltf's code, alone in its file: its warnings are not ours to mend.
#include <fstream>  // which it needs with TINYGLTF_NO_FS too and does not include

#define TINYGLTF_IMPLEMENTATION
#include "scene/import/gltf/tinygltf.h"
