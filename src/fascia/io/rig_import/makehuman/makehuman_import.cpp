#include <fascia/io/rig_import/makehuman/makehuman_import.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <system_error>

#include <fascia/base/error.h>
#include <fascia/io/file/gzip.h>
#include <fascia/io/rig_import/makehuman/makehuman_rig.h>
#include <fascia/io/rig_model/finish_model.h>
#include <fascia/io/rig_model/simulated_surface.h>

namespace fascia {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxMeshBytes = std::size_t{256} << 20;
constexpr double kDecimetre_m = 0.1;  // the unit of MakeHuman's meshes

// The first that exists: CMU's names fit most motion capture; MakeHuman's own has a face.
constexpr std::array kRigs = {"rig.cmu_mb.json", "default.mhskel", "rig.default.json",
                              "rig.game_engine.json"};

// What of the base mesh belongs to the figure.
struct KeptGroup {
  const char* name;
  const char* shown;
  std::array<float, 4> color;
  float roughness;
};
constexpr std::array<KeptGroup, 6> kGroups = {
    {{"body", "body", {0.80f, 0.55f, 0.44f, 1}, 0.6f},
     {"helper-l-eye", "left eye", {0.85f, 0.85f, 0.85f, 1}, 0.2f},
     {"helper-r-eye", "right eye", {0.85f, 0.85f, 0.85f, 1}, 0.2f},
     {"helper-upper-teeth", "upper teeth", {0.85f, 0.82f, 0.72f, 1}, 0.3f},
     {"helper-lower-teeth", "lower teeth", {0.85f, 0.82f, 0.72f, 1}, 0.3f},
     {"helper-tongue", "tongue", {0.65f, 0.25f, 0.25f, 1}, 0.4f}}};

bool isThere(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

bool isRigName(const fs::path& path) {
  const std::string name = path.filename().string();
  return path.extension() == ".mhskel" || (name.starts_with("rig.") && path.extension() == ".json");
}

fs::path meshFor(const fs::path& rig) {
  const fs::path beside = rig.parent_path() / "base.obj";
  return isThere(beside) ? beside : rig.parent_path() / ".." / "base.obj";
}

fs::path rigFor(const fs::path& mesh) {
  for (const char* name : kRigs) {
    const fs::path rig = mesh.parent_path() / "rigs" / name;
    if (isThere(rig)) return rig;
  }
  return {};
}

// A bone's frame as Blender's: y along the bone, turned the shortest way from +y and then by roll
// about the bone. Blender's z is up, ours is y.
Transform restFrame(const MakeHumanBone& bone, double unit_m) {
  Mat3 toOurs;
  toOurs << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  const Vec3 along = toOurs.transpose() * (bone.tail - bone.head);
  Transform frame;
  frame.translation_m = unit_m * bone.head;
  if (along.norm() > 1e-9) {
    const Quat shortest = Quat::FromTwoVectors(Vec3::UnitY(), along);
    const Eigen::AngleAxisd roll(bone.roll_rad, along.normalized());
    frame.rotation = toOurs * (roll * shortest).normalized().toRotationMatrix();
  }
  return frame;
}

class MakeHumanAssembler {
 public:
  MakeHumanAssembler(const ObjMesh& mesh, const MakeHumanRig& rig, double scale)
      : mesh_(mesh), rig_(rig) {
    unit_m_ = kDecimetre_m * scale;
    double floor = 1e300;
    for (const KeptGroup& kept : kGroups) {
      const ObjMesh::Group* group = mesh.find(kept.name);
      if (!group) continue;
      for (const ObjMesh::Corner& c : group->corners) {
        floor = std::min(floor, mesh.positions[c.position].y());
      }
    }
    floor_ = floor < 1e300 ? floor : 0;
  }

  RiggedModel build() {
    for (const MakeHumanBone& bone : rig_.bones) {
      Transform frame = restFrame(bone, unit_m_);
      frame.translation_m.y() -= unit_m_ * floor_;
      model_.joints.push_back({bone.name, bone.parent, frame, -1});
    }
    makeNamesUnique(model_);
    for (const KeptGroup& kept : kGroups) {
      const ObjMesh::Group* group = mesh_.find(kept.name);
      if (group && !group->corners.empty()) addPart(kept, *group);
    }
    setNormals();
    buildSimulatedSurface(positions_m_, weights_, model_);
    return std::move(model_);
  }

 private:
  void addPart(const KeptGroup& kept, const ObjMesh::Group& group);
  std::uint32_t vertexFor(const ObjMesh::Corner& corner);
  void setNormals();

  const ObjMesh& mesh_;
  const MakeHumanRig& rig_;
  double unit_m_ = 1, floor_ = 0;
  RiggedModel model_;
  std::vector<Eigen::Vector3f> positions_m_;  // per vertex
  std::vector<PointWeights> weights_;
  std::vector<std::uint32_t> source_;  // per vertex: the mesh's point
  std::map<std::pair<std::uint32_t, std::int32_t>, std::uint32_t> vertexOf_;
};

std::uint32_t MakeHumanAssembler::vertexFor(const ObjMesh::Corner& corner) {
  const auto [found, isNew] = vertexOf_.try_emplace(
      {corner.position, corner.uv}, static_cast<std::uint32_t>(model_.vertices.size()));
  if (!isNew) return found->second;
  RigVertex vertex;
  if (corner.uv >= 0) {
    const Vec2 uv = mesh_.uvs[static_cast<std::size_t>(corner.uv)];
    vertex.uv = Vec2(uv.x(), 1 - uv.y()).cast<float>();
  }
  model_.vertices.push_back(vertex);
  const Vec3 place = mesh_.positions[corner.position] - Vec3(0, floor_, 0);
  positions_m_.push_back((unit_m_ * place).cast<float>());
  auto influences = rig_.weights[corner.position];
  PointWeights packed;
  if (!packWeights(influences, packed)) packed.weight[0] = 1;  // of the root
  weights_.push_back(packed);
  source_.push_back(corner.position);
  return found->second;
}

void MakeHumanAssembler::addPart(const KeptGroup& kept, const ObjMesh::Group& group) {
  vertexOf_.clear();  // parts share no vertices
  RigPart part;
  part.name = kept.shown;
  part.material = static_cast<int>(model_.materials.size());
  part.firstVertex = static_cast<std::uint32_t>(model_.vertices.size());
  part.firstTriangle = static_cast<std::uint32_t>(model_.drawnTriangles.size());
  std::size_t first = 0;
  for (const std::uint32_t count : group.faceCorners) {
    const std::uint32_t a = vertexFor(group.corners[first]);
    for (std::uint32_t k = 2; k < count; ++k) {
      const std::uint32_t b = vertexFor(group.corners[first + k - 1]);
      model_.drawnTriangles.push_back({a, b, vertexFor(group.corners[first + k])});
    }
    first += count;
  }
  part.vertexCount = static_cast<std::uint32_t>(model_.vertices.size()) - part.firstVertex;
  part.triangleCount =
      static_cast<std::uint32_t>(model_.drawnTriangles.size()) - part.firstTriangle;
  RigMaterial material;
  material.name = kept.shown;
  material.color = kept.color;
  material.roughness = kept.roughness;
  model_.materials.push_back(std::move(material));
  model_.parts.push_back(std::move(part));
}

// Smooth across UV seams: of the mesh's points, not of the vertices that they were cut into.
void MakeHumanAssembler::setNormals() {
  std::vector<Eigen::Vector3f> points(mesh_.positions.size());
  for (std::size_t p = 0; p < points.size(); ++p) points[p] = mesh_.positions[p].cast<float>();
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (const auto& [a, b, c] : model_.drawnTriangles) {
    triangles.push_back({source_[a], source_[b], source_[c]});
  }
  std::vector<Eigen::Vector3f> normals;
  computeNormals(points, triangles, normals);
  for (std::size_t v = 0; v < model_.vertices.size(); ++v) {
    model_.vertices[v].normal = normals[source_[v]];
  }
}

}  // namespace

bool isMakeHuman(const std::string& path) {
  const fs::path file(path);
  if (isRigName(file)) return isThere(meshFor(file));
  return file.filename() == "base.obj" && !rigFor(file).empty();
}

RiggedModel readMakeHuman(const std::string& path, const RigImportOptions& options) {
  const bool isRig = isRigName(path);
  const fs::path mesh = isRig ? meshFor(path) : fs::path(path);
  const fs::path rig = isRig ? fs::path(path) : rigFor(path);
  if (rig.empty()) {
    Issue issue;
    issue.where.file = path;
    issue.message = "found no rig in rigs/ beside the mesh";
    issue.hint = std::string("expected one of MakeHuman's, as ") + kRigs.front();
    throw Error(std::move(issue));
  }
  const ObjMesh parsed = parseObj(readFileUnpacked(mesh.string(), kMaxMeshBytes), mesh.string());
  const MakeHumanRig bones = readMakeHumanRig(rig.string(), parsed);
  RiggedModel model = MakeHumanAssembler(parsed, bones, options.scale).build();
  finishModel(path, options.scale, model);
  return model;
}

}  // namespace fascia
