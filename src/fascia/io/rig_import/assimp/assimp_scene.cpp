#include <fascia/io/rig_import/assimp/assimp_scene.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <assimp/GltfMaterial.h>
#include <assimp/material.h>
#include <assimp/scene.h>

#include <fascia/base/error.h>
#include <fascia/base/suggest.h>
#include <fascia/io/file/file.h>
#include <fascia/io/file/inside_folder.h>
#include <fascia/io/picture/image.h>
#include <fascia/io/rig_import/assimp/assimp_motion.h>
#include <fascia/io/rig_model/rig_limits.h>
#include <fascia/io/rig_model/simulated_surface.h>

namespace fascia {
namespace {

constexpr std::size_t kMaxPictureFileBytes = std::size_t{256} << 20;

Eigen::Vector3f vectorOf(const aiVector3D& v) {
  return {v.x, v.y, v.z};
}

// FBX says how many centimetres its unit is; the other formats are converted to metres.
double unitOf(const aiScene& scene) {
  double centimetres = 0;
  float single = 0;
  if (!scene.mMetaData) return 1;
  if (!scene.mMetaData->Get("UnitScaleFactor", centimetres)) {
    if (!scene.mMetaData->Get("UnitScaleFactor", single)) return 1;
    centimetres = single;
  }
  return centimetres > 1e-6 && centimetres < 1e6 ? 0.01 * centimetres : 1;
}

class AssimpAssembler {
 public:
  AssimpAssembler(const aiScene& scene, const std::string& path, double scale)
      : scene_(scene), path_(path), nodes_(scene, scale * unitOf(scene)) {
    model_.sourceFile = path;
  }

  RiggedModel build() {
    addJoints();
    makeNamesUnique(model_);
    for (unsigned m = 0; m < scene_.mNumMaterials; ++m) addMaterial(*scene_.mMaterials[m]);
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
      const aiNode& node = nodes_.node(n);
      for (unsigned m = 0; m < node.mNumMeshes; ++m) addPart(n, *scene_.mMeshes[node.mMeshes[m]]);
    }
    noteLeftOut();
    buildSimulatedSurface(positions_m_, weights_, model_);
    sampleMotions(scene_, nodes_, nodeOfJoint_, model_);
    return std::move(model_);
  }

 private:
  void addJoints();
  AssimpFrame placeOf(std::size_t node, const aiMesh& mesh) const;
  std::map<std::size_t, AssimpFrame> bindPoses() const;
  void addMaterial(const aiMaterial& material);
  std::vector<std::uint8_t> pictureOf(const std::string& name) const;
  void addPart(std::size_t node, const aiMesh& mesh);
  void addVertices(std::size_t node, const aiMesh& mesh);
  void addTriangles(std::size_t node, const aiMesh& mesh, std::uint32_t firstVertex);
  void addWeights(std::size_t node, const aiMesh& mesh);
  void noteLeftOut();
  [[noreturn]] void refuse(const std::string& message, const std::string& hint = {}) const;

  const aiScene& scene_;
  const std::string& path_;
  AssimpNodes nodes_;
  std::vector<std::size_t> nodeOfJoint_;
  std::vector<int> jointOfNode_;  // -1: none
  RiggedModel model_;
  std::vector<Eigen::Vector3f> positions_m_;
  std::vector<PointWeights> weights_;
  std::size_t pictureBytes_ = 0, badCorners_ = 0, missingPictures_ = 0, morphed_ = 0;
  std::size_t unskinned_ = 0, loose_ = 0;
};

void AssimpAssembler::refuse(const std::string& message, const std::string& hint) const {
  Issue issue;
  issue.where.file = path_;
  issue.message = message;
  issue.hint = hint;
  throw Error(std::move(issue));
}

// A bone of a mesh: where its node is, and where the skin says that it is against the mesh.
struct BoundBone {
  AssimpFrame world, inMesh, toBone;
};

// How far bones are from their nodes if the mesh stands at `mesh`, each counting at most 1.
double misfit(const std::vector<BoundBone>& bones, const AssimpFrame& mesh, double size) {
  const auto axes = [](const AssimpFrame& frame) -> Mat3 {
    return frame.linear().colwise().normalized();
  };
  double sum = 0;
  for (const BoundBone& bone : bones) {
    const AssimpFrame bound = mesh * bone.inMesh;
    const double off = (bound.translation() - bone.world.translation()).norm() / size +
                       (axes(bound) - axes(bone.world)).norm();
    sum += std::min(1.0, std::isfinite(off) ? off : 1.0);
  }
  return sum;
}

// Where a mesh stands in the bind pose: at its node, unless the skin says that it was bound
// elsewhere or in another size (Collada's bind shape matrix), which brings the bones much nearer to
// their nodes.
AssimpFrame AssimpAssembler::placeOf(std::size_t node, const aiMesh& mesh) const {
  constexpr std::size_t kMostCandidates = 64;
  constexpr double kSame = 1e-3;        // of the skeleton's size and a unit axis, per bone
  constexpr double kMuchNearer = 0.25;  // of what is left at the node
  const AssimpFrame& usual = nodes_.world(node);
  std::vector<BoundBone> bones;
  Box box;
  for (unsigned b = 0; b < mesh.mNumBones; ++b) {
    const int bone = nodes_.find(mesh.mBones[b]->mName.C_Str());
    const AssimpFrame toBone = affineOf(mesh.mBones[b]->mOffsetMatrix);
    if (bone < 0 || !(std::abs(toBone.linear().determinant()) >= 1e-30)) continue;
    bones.push_back({nodes_.world(static_cast<std::size_t>(bone)), toBone.inverse(), toBone});
    box.add(bones.back().world.translation());
  }
  const double size = box.empty() || !(box.size().norm() > 1e-9) ? 1 : box.size().norm();
  const double atNode = misfit(bones, usual, size);
  if (atNode < kSame * static_cast<double>(bones.size())) return usual;
  AssimpFrame best = usual;
  double least = kMuchNearer * atNode;
  for (std::size_t b = 0; b < bones.size(); b += bones.size() / kMostCandidates + 1) {
    const AssimpFrame candidate = bones[b].world * bones[b].toBone;
    const double found = misfit(bones, candidate, size);
    if (found < least) least = found, best = candidate;
  }
  return best;
}

// Where the skins say that their bones are: node -> frame in the world. The first mesh decides.
std::map<std::size_t, AssimpFrame> AssimpAssembler::bindPoses() const {
  std::map<std::size_t, AssimpFrame> poses;
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const aiNode& node = nodes_.node(n);
    for (unsigned m = 0; m < node.mNumMeshes; ++m) {
      const aiMesh& mesh = *scene_.mMeshes[node.mMeshes[m]];
      const AssimpFrame place = placeOf(n, mesh);
      for (unsigned b = 0; b < mesh.mNumBones; ++b) {
        const int bone = nodes_.find(mesh.mBones[b]->mName.C_Str());
        const AssimpFrame toBone = affineOf(mesh.mBones[b]->mOffsetMatrix);
        if (bone < 0 || std::abs(toBone.linear().determinant()) < 1e-30) continue;
        poses.try_emplace(static_cast<std::size_t>(bone), place * toBone.inverse());
      }
    }
  }
  return poses;
}

// Every bone and all that it hangs on, up to the lowest node that holds all of them.
void AssimpAssembler::addJoints() {
  const std::map<std::size_t, AssimpFrame> poses = bindPoses();
  if (poses.empty() && scene_.mNumMeshes == 0)
    refuse("needs a surface: found a skeleton without a mesh",
           "a motion alone goes onto another character: export it as .bvh or .glb and give it "
           "with --motion; or export it with its skin");
  if (poses.empty())
    refuse("needs a rig: found a surface without bones",
           "rig it in another program, or take a file that has bones");
  std::vector<std::size_t> bonesBelow(nodes_.size(), 0);
  for (const auto& [bone, pose] : poses) {
    for (int n = static_cast<int>(bone); n >= 0; n = nodes_.parent(static_cast<std::size_t>(n))) {
      ++bonesBelow[static_cast<std::size_t>(n)];
    }
  }
  jointOfNode_.assign(nodes_.size(), -1);
  std::vector<AssimpFrame> frames;
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const int up = nodes_.parent(n);
    const int parent = up < 0 ? -1 : jointOfNode_[static_cast<std::size_t>(up)];
    // The root is the lowest that holds all bones and hangs on none.
    const bool holdsAll = bonesBelow[n] == poses.size();
    const auto below = [&](std::size_t child) {
      return nodes_.parent(child) == static_cast<int>(n) && bonesBelow[child] == poses.size();
    };
    bool isLowest = holdsAll;
    for (std::size_t c = n + 1; isLowest && !poses.contains(n) && c < nodes_.size(); ++c) {
      isLowest = !below(c);
    }
    if (bonesBelow[n] == 0 || (parent < 0 && !isLowest)) continue;
    if (model_.joints.size() == kMostRigJoints)
      refuse("more than " + std::to_string(kMostRigJoints) + " joints");
    const auto pose = poses.find(n);
    const AssimpFrame frame = pose != poses.end() ? pose->second
                              : parent >= 0       ? frames[static_cast<std::size_t>(parent)] *
                                                  affineOf(nodes_.node(n).mTransformation)
                                            : nodes_.world(n);
    jointOfNode_[n] = static_cast<int>(model_.joints.size());
    nodeOfJoint_.push_back(n);
    frames.push_back(frame);
    model_.joints.push_back({nodes_.node(n).mName.C_Str(), parent, rigidOf(frame), -1});
  }
}

std::vector<std::uint8_t> AssimpAssembler::pictureOf(const std::string& name) const {
  std::vector<std::uint8_t> bytes;
  const aiTexture* embedded = scene_.GetEmbeddedTexture(name.c_str());
  if (embedded && embedded->mHeight == 0) {  // as it was encoded
    const auto* data = reinterpret_cast<const std::uint8_t*>(embedded->pcData);
    bytes.assign(data, data + embedded->mWidth);
  } else if (!embedded) {
    // Paths in such files are of the machine that made them: only the name is used.
    const std::size_t slash = name.find_last_of("/\\");
    const std::string bare = slash == std::string::npos ? name : name.substr(slash + 1);
    try {
      const std::string place = insideFolder(folderOf(path_), bare, "the picture", "");
      const std::string text = readFile(place, kMaxPictureFileBytes);
      bytes.assign(text.begin(), text.end());
    } catch (const Error&) {
      bytes.clear();  // a character without its picture is still a character
    }
  }
  if (!isPicture(bytes)) bytes.clear();
  return bytes;
}

void AssimpAssembler::addMaterial(const aiMaterial& material) {
  RigMaterial out;
  aiString text;
  if (material.Get(AI_MATKEY_NAME, text) == AI_SUCCESS) out.name = text.C_Str();
  aiColor4D color(0.8f, 0.8f, 0.8f, 1);
  if (material.Get(AI_MATKEY_BASE_COLOR, color) != AI_SUCCESS) {
    material.Get(AI_MATKEY_COLOR_DIFFUSE, color);
  }
  for (unsigned i = 0; i < 4; ++i) {
    const float value = color[i];
    out.color[i] = std::isfinite(value) ? std::clamp(value, 0.0f, 1.0f) : 1;
  }
  int twoSided = 0;
  if (material.Get(AI_MATKEY_TWOSIDED, twoSided) == AI_SUCCESS) out.doubleSided = twoSided != 0;
  for (const aiTextureType type : {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE}) {
    if (out.texture.empty() && material.GetTexture(type, 0, &text) == AI_SUCCESS) {
      out.texture = pictureOf(text.C_Str());
      if (out.texture.empty()) ++missingPictures_;
    }
  }
  if (out.texture.size() > kMostPictureBytes - pictureBytes_) {
    model_.notes.push_back("the pictures of the materials are too large: left out from " +
                           quotedName(out.name) + " on");
    out.texture.clear();
  }
  pictureBytes_ += out.texture.size();
  model_.materials.push_back(std::move(out));
}

void AssimpAssembler::addWeights(std::size_t node, const aiMesh& mesh) {
  std::vector<std::vector<std::pair<std::uint16_t, float>>> influences(mesh.mNumVertices);
  for (unsigned b = 0; b < mesh.mNumBones; ++b) {
    const aiBone& bone = *mesh.mBones[b];
    const int found = nodes_.find(bone.mName.C_Str());
    const int joint = found < 0 ? -1 : jointOfNode_[static_cast<std::size_t>(found)];
    if (joint < 0) continue;
    for (unsigned w = 0; w < bone.mNumWeights; ++w) {
      const aiVertexWeight& weight = bone.mWeights[w];
      if (weight.mVertexId >= mesh.mNumVertices) continue;
      influences[weight.mVertexId].emplace_back(static_cast<std::uint16_t>(joint), weight.mWeight);
    }
  }
  // What has no bones moves with the joint that holds it.
  int carrier = static_cast<int>(node);
  while (carrier >= 0 && jointOfNode_[static_cast<std::size_t>(carrier)] < 0) {
    carrier = nodes_.parent(static_cast<std::size_t>(carrier));
  }
  PointWeights rigid;
  rigid.joint[0] =
      carrier < 0 ? std::uint16_t{0}
                  : static_cast<std::uint16_t>(jointOfNode_[static_cast<std::size_t>(carrier)]);
  rigid.weight[0] = 1;
  for (auto& list : influences) {
    PointWeights packed;
    const bool skinned = packWeights(list, packed);
    weights_.push_back(skinned ? packed : rigid);
    if (!skinned && mesh.mNumBones > 0) ++unskinned_;
  }
  if (mesh.mNumBones == 0) ++loose_;
}

void AssimpAssembler::noteLeftOut() {
  const auto note = [&](std::size_t count, const char* text) {
    if (count > 0) model_.notes.push_back(std::to_string(count) + text);
  };
  note(badCorners_, " triangles name vertices that are not there: left out");
  note(missingPictures_, " pictures are not beside the file, or neither PNG nor JPEG: left out");
  note(morphed_, " meshes have morph targets: left out");
  note(unskinned_, " vertices have no weights: moved by the joint that holds their mesh");
  note(loose_, " meshes without bones move rigidly with the joint above, or with the root");
  note(scene_.mNumCameras, " cameras are left out");
  note(scene_.mNumLights, " lights are left out");
}

void AssimpAssembler::addVertices(std::size_t node, const aiMesh& mesh) {
  if (mesh.mNumVertices > kMostRigVertices - model_.vertices.size())
    refuse("more than " + std::to_string(kMostRigVertices) + " vertices in one character");
  const AssimpFrame world = placeOf(node, mesh);
  const Eigen::Matrix3f toNormal = world.linear().inverse().transpose().cast<float>();
  for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
    const Vec3 place = world * vectorOf(mesh.mVertices[v]).cast<double>();
    if (!isSane(place.x()) || !isSane(place.y()) || !isSane(place.z()))
      refuse(std::string("has a vertex that is no number, in mesh ") +
             nodes_.node(node).mName.C_Str());
    positions_m_.push_back(place.cast<float>());
    RigVertex vertex;
    if (mesh.mNormals) vertex.normal = (toNormal * vectorOf(mesh.mNormals[v])).normalized();
    const bool isUnit = std::abs(vertex.normal.norm() - 1) < 1e-3f;  // not of zeros, no numbers
    if (!isUnit) vertex.normal = Eigen::Vector3f::UnitY();
    if (mesh.mTextureCoords[0]) {
      const aiVector3D& uv = mesh.mTextureCoords[0][v];
      if (isSane(uv.x) && isSane(uv.y)) vertex.uv = {uv.x, 1 - uv.y};
    }
    model_.vertices.push_back(vertex);
  }
}

void AssimpAssembler::addTriangles(std::size_t node, const aiMesh& mesh,
                                   std::uint32_t firstVertex) {
  const bool mirrored = placeOf(node, mesh).linear().determinant() < 0;
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    if (face.mNumIndices != 3) continue;
    if (std::max({face.mIndices[0], face.mIndices[1], face.mIndices[2]}) >= mesh.mNumVertices) {
      ++badCorners_;
      continue;
    }
    std::array<std::uint32_t, 3> corners;
    for (unsigned k = 0; k < 3; ++k) corners[k] = firstVertex + face.mIndices[k];
    if (mirrored) std::swap(corners[1], corners[2]);
    model_.drawnTriangles.push_back(corners);
  }
  if (3 * model_.drawnTriangles.size() > kMostRigCorners)
    refuse("more than " + std::to_string(kMostRigCorners) + " corners of triangles");
}

void AssimpAssembler::addPart(std::size_t node, const aiMesh& mesh) {
  if (mesh.mNumVertices == 0 || (mesh.mPrimitiveTypes & aiPrimitiveType_TRIANGLE) == 0) return;
  if (mesh.mNumAnimMeshes > 0) ++morphed_;
  RigPart part;
  part.name = nodes_.node(node).mName.C_Str();
  part.material = static_cast<int>(mesh.mMaterialIndex);
  part.firstVertex = static_cast<std::uint32_t>(model_.vertices.size());
  part.vertexCount = mesh.mNumVertices;
  part.firstTriangle = static_cast<std::uint32_t>(model_.drawnTriangles.size());
  addVertices(node, mesh);
  addTriangles(node, mesh, part.firstVertex);
  part.triangleCount =
      static_cast<std::uint32_t>(model_.drawnTriangles.size()) - part.firstTriangle;
  addWeights(node, mesh);
  model_.parts.push_back(std::move(part));
}

}  // namespace

RiggedModel rigFromAssimp(const aiScene& scene, const std::string& path, double scale) {
  return AssimpAssembler(scene, path, scale).build();
}

}  // namespace fascia
