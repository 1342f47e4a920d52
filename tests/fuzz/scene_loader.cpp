// SPDX-License-Identifier: Apache-2.0
// libFuzzer target: scene files and meshes of arbitrary bytes load or give one SceneError; nothing
// else. The first byte says what the rest is: 'x' a scene, 's' one with substitutes for what is not
// supported, 'o' an OBJ mesh, 'p' a PLY mesh.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "golden/scene/scene.hpp"
#include "tests/fuzz/folder.hpp"

namespace {

// A picture of one texel: an uncompressed TGA, whatever its name.
const std::string kTexture("\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\30\0\100\200\300", 21);

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const photonloom::fuzz::Folder folder;
  static const bool meshes_have_scenes = [] {
    for (const std::string type : {"obj", "ply"})
      folder.write(type + ".xml",
                   "<scene version=\"0.6.0\"><sensor type=\"perspective\"/><shape type=\"" + type +
                       "\"><string name=\"filename\" value=\"mesh." + type +
                       "\"/><emitter type=\"area\"/></shape></scene>");
    folder.write("texture.png", kTexture);
    return true;
  }();
  if (size == 0 || !meshes_have_scenes) return -1;
  const std::string bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  std::string scene = "scene.xml";
  if (data[0] == 'x' || data[0] == 's') {
    folder.write(scene, bytes);
  } else if (data[0] == 'o' || data[0] == 'p') {
    const std::string type = data[0] == 'o' ? "obj" : "ply";
    folder.write("mesh." + type, bytes);
    scene = type + ".xml";
  } else {
    return -1;  // not kept in the corpus
  }
  try {
    photonloom::load_scene(
        (folder.path / scene).string(), {},
        data[0] == 's' ? photonloom::Unsupported::kSubstitute : photonloom::Unsupported::kRefuse);
  } catch (const photonloom::SceneError& error) {
    if (std::string(error.what()).empty()) std::abort();
  }
  return 0;
}
