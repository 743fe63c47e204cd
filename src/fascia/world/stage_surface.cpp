#include <fascia/world/stage_surface.h>

#include <fascia/deformable/body/carried_mesh.h>

namespace fascia {
namespace {

void append(const TriangleMesh& mesh, TriangleMesh& out) {
  const auto first = static_cast<std::uint32_t>(out.positions.size());
  out.positions.insert(out.positions.end(), mesh.positions.begin(), mesh.positions.end());
  for (const auto& t : mesh.triangles)
    out.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

struct Carried {
  BodyId body;
  CarriedMesh mesh;
};

std::vector<Carried> carriedMeshes(const Stage& stage) {
  std::vector<Carried> out;
  const std::size_t count = stage.bodies().bodyCount();
  for (std::size_t b = 0; b < count; ++b)
    out.push_back({BodyId(b), {stage.bodies().shape(BodyId(b)), stage.look(BodyId(b))}});
  for (std::size_t b = 0; b < count; ++b)
    for (const TriangleMesh& mesh : stage.ornaments(BodyId(b)))
      out.push_back({BodyId(b), {stage.bodies().shape(BodyId(b)), mesh}});
  return out;
}

}  // namespace

Recording surfaceRecording(const Stage& stage, const StageRecording& recording) {
  const std::vector<Carried> meshes = carriedMeshes(stage);
  Recording out;
  out.motion = "performance";
  out.frame_rate_hz = recording.frame_rate_hz;
  for (std::size_t f = 0; f < recording.frames.size(); ++f) {
    const StageRecording::Frame& frame = recording.frames[f];
    TriangleMesh whole;
    for (const Carried& carried : meshes) {
      TriangleMesh mesh;
      carried.mesh.carry(stage.bodies().part(carried.body, std::span<const double>(frame.bodies)),
                         mesh);
      append(mesh, whole);
    }
    for (std::size_t i = 0; i < recording.characters.size(); ++i) {
      TriangleMesh skin = recording.characters[i].skin;
      skin.positions = recording.characters[i].frames[f].skin_m;
      const Transform place = placeOf(stage.def().characters[i]);
      for (Eigen::Vector3f& p : skin.positions) p = place.point(p.cast<double>()).cast<float>();
      append(skin, whole);
    }
    out.frames.push_back({frame.time_s, {}, whole.positions, {}});
    if (f == 0) out.skin = std::move(whole);
  }
  return out;
}

}  // namespace fascia
