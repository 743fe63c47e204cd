// A ball of flesh with a skin, hopping once: described, simulated and written as glTF.
#include <cstdio>

#include <fascia/character/recording.h>
#include <fascia/io/glb_export/gltf_writer.h>
#include <fascia/render/scene.h>

namespace {

fascia::CharacterDef ball() {
  fascia::CharacterDef def;
  def.name = "ball";
  def.skeleton.joints.push_back(
      {.name = "middle", .dofs = {{.dof = fascia::Dof::ty, .min = 0, .max = 1}}});
  fascia::FleshSolidDef solid{.name = "flesh", .joint = "middle"};
  solid.solid = {.shape = "sphere", .parameters = {0.2}};  // radius_m
  def.flesh.solids.push_back(solid);

  fascia::SkinDef skin;
  skin.columns = skin.rows = 16;
  skin.bottom = {.joint = "middle", .axis = {0, -1, 0}};
  skin.top = {.joint = "middle", .axis = {0, 1, 0}};
  def.skin = skin;

  fascia::MotionDef hop{.name = "hop"};
  hop.tracks.push_back(
      {.name = "middle", .channel = "ty", .keys = {{0, 0}, {0.25, 0.3}, {0.5, 0}}});
  def.motions.push_back(hop);
  return def;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const fascia::Character character(ball());
    const fascia::Recording recording = fascia::record(character, character.source(0));
    std::printf("%zu frames\n", recording.frames.size());
    fascia::writeGlb(character, recording, argc > 1 ? argv[1] : "ball.glb");
    return 0;
  } catch (const fascia::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
