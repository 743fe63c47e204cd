#include <fascia/io/rig_import/makehuman/makehuman_rig.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <unordered_map>

#include <fascia/base/error.h>
#include <fascia/base/suggest.h>
#include <fascia/io/file/gzip.h>
#include <fascia/io/json/json.h>

namespace fascia {
namespace {

constexpr std::size_t kMaxRigBytes = std::size_t{64} << 20;
constexpr std::size_t kMaxBones = 4096;

Json readJson(const std::string& path) {
  JsonLimits limits;
  limits.bytes = kMaxRigBytes;
  std::vector<Issue> issues;
  Json json = parseJson(readFileUnpacked(path, kMaxRigBytes), limits, issues);
  for (Issue& issue : issues) issue.where.file = path;
  if (!issues.empty()) throw Error(std::move(issues));
  return json;
}

// A member's value with the place of its kind of fault.
class Reader {
 public:
  explicit Reader(const std::string& file) : file_(file) {}

  const Json& member(const Json& object, std::string_view key, Json::Kind kind) const {
    const Json* value = object.find(key);
    if (!value) fail(object, std::string("has no ") + quotedName(key));
    if (!value->is(kind)) fail(*value, quotedName(key) + " is of the wrong kind");
    return *value;
  }
  std::size_t index(const Json& value, std::size_t count) const {
    const double number = value.is(Json::Kind::number) ? value.number() : -1;
    if (!(number >= 0) || number >= static_cast<double>(count) || number != std::floor(number)) {
      fail(value, "expected the number of one of " + std::to_string(count) + " points");
    }
    return static_cast<std::size_t>(number);
  }
  [[noreturn]] void fail(const Json& at, std::string message) const {
    Issue issue;
    issue.where = {file_, at.line(), {}};
    issue.message = std::move(message);
    throw Error(std::move(issue));
  }

 private:
  const std::string& file_;
};

Vec3 meanOf(const Json& indices, const ObjMesh& mesh, const Reader& reader) {
  if (!indices.is(Json::Kind::list) || indices.list().empty()) {
    reader.fail(indices, "expected a list of points");
  }
  Vec3 sum = Vec3::Zero();
  for (const Json& i : indices.list())
    sum += mesh.positions[reader.index(i, mesh.positions.size())];
  return sum / static_cast<double>(indices.list().size());
}

// An end of a bone in MPFB's format: the middle of a cube of helper geometry, of points, or a
// point.
Vec3 endOf(const Json& end, const ObjMesh& mesh, const Reader& reader) {
  const std::string& strategy = reader.member(end, "strategy", Json::Kind::text).text();
  if (strategy == "CUBE") {
    const Json& name = reader.member(end, "cube_name", Json::Kind::text);
    const ObjMesh::Group* cube = mesh.find(name.text());
    if (!cube || cube->corners.empty()) {
      reader.fail(name, std::string("the mesh has no group ") + quotedName(name.text()));
    }
    return middleOf(mesh, *cube);
  }
  if (strategy == "MEAN")
    return meanOf(reader.member(end, "vertex_indices", Json::Kind::list), mesh, reader);
  if (strategy == "VERTEX") {
    const Json& vertex = reader.member(end, "vertex_index", Json::Kind::number);
    return mesh.positions[reader.index(vertex, mesh.positions.size())];
  }
  reader.fail(end, std::string("found strategy ") + quotedName(strategy) +
                       ", expected CUBE, MEAN or VERTEX");
}

struct NamedBone {
  MakeHumanBone bone;
  std::string parent;  // empty: the root
};

// Without a name, a bone would hang on itself: no parent is what the root has.
const std::string& nameOf(const Json::Member& member, const Reader& reader) {
  if (member.key.empty()) reader.fail(member.value, "found a bone without a name");
  return member.key;
}

NamedBone boneOfMpfb(const Json::Member& member, const ObjMesh& mesh, const Reader& reader) {
  const Json& json = member.value;
  NamedBone out;
  out.bone.name = nameOf(member, reader);
  out.parent = reader.member(json, "parent", Json::Kind::text).text();
  out.bone.head = endOf(reader.member(json, "head", Json::Kind::object), mesh, reader);
  out.bone.tail = endOf(reader.member(json, "tail", Json::Kind::object), mesh, reader);
  const Json* roll = json.find("roll");
  if (roll && roll->is(Json::Kind::number)) out.bone.roll_rad = roll->number();
  return out;
}

NamedBone boneOfMakeHuman(const Json::Member& member, const Json& joints, const ObjMesh& mesh,
                          const Reader& reader) {
  const Json& json = member.value;
  const auto place = [&](const char* key) {
    const std::string& name = reader.member(json, key, Json::Kind::text).text();
    return meanOf(reader.member(joints, name, Json::Kind::list), mesh, reader);
  };
  NamedBone out;
  out.bone.name = nameOf(member, reader);
  const Json* parent = json.find("parent");
  if (parent && parent->is(Json::Kind::text)) out.parent = parent->text();
  out.bone.head = place("head");
  out.bone.tail = place("tail");
  return out;
}

// Parents before children, otherwise in the file's order.
std::vector<MakeHumanBone> inOrder(std::vector<NamedBone> named, const Json& at,
                                   const Reader& reader) {
  std::unordered_map<std::string, std::vector<std::size_t>> children;
  for (std::size_t b = 0; b < named.size(); ++b) children[named[b].parent].push_back(b);
  if (children[""].size() != 1) {
    reader.fail(at, "found " + std::to_string(children[""].size()) +
                        " bones without a parent, expected one");
  }
  std::vector<MakeHumanBone> bones;
  std::vector<std::pair<std::size_t, int>> open{{children[""].front(), -1}};
  while (!open.empty()) {
    const auto [b, parent] = open.back();
    open.pop_back();
    const int self = static_cast<int>(bones.size());
    bones.push_back(named[b].bone);
    bones.back().parent = parent;
    const auto below = children.find(named[b].bone.name);
    if (below == children.end()) continue;
    for (std::size_t k = below->second.size(); k-- > 0;) open.emplace_back(below->second[k], self);
  }
  if (bones.size() != named.size()) {
    reader.fail(at, std::to_string(named.size() - bones.size()) +
                        " bones do not hang on the root, expected a tree");
  }
  return bones;
}

std::vector<MakeHumanBone> readBones(const Json& json, const ObjMesh& mesh, const Reader& reader) {
  // Older files of MPFB are the object of bones itself.
  const Json* inside = json.find("bones");
  const Json& bones = inside ? *inside : json;
  if (!bones.is(Json::Kind::object)) reader.fail(bones, "expected an object of bones");
  if (bones.object().size() > kMaxBones) {
    reader.fail(bones, "more than " + std::to_string(kMaxBones) + " bones");
  }
  const Json* joints = json.find("joints");
  std::vector<NamedBone> named;
  for (const Json::Member& member : bones.object()) {
    named.push_back(joints ? boneOfMakeHuman(member, *joints, mesh, reader)
                           : boneOfMpfb(member, mesh, reader));
  }
  return inOrder(std::move(named), bones, reader);
}

// rig.NAME.json -> weights.NAME.json; NAME.mhskel names its own. Either may be packed.
std::string weightsPath(const std::string& rigPath, const Json& rig, const Reader& reader) {
  const std::filesystem::path path(rigPath);
  std::string name = path.filename().string();
  if (path.extension() == ".mhskel") {
    const Json* file = rig.find("weights_file");
    name =
        file && file->is(Json::Kind::text) ? file->text() : path.stem().string() + "_weights.mhw";
    // From a stranger's file: nothing outside of its folder.
    const bool plain = name == std::filesystem::path(name).filename().string();
    if (!plain || name.empty() || name == "." || name == "..") {
      reader.fail(file ? *file : rig, "expected the name of a file beside it");
    }
  } else {
    name = std::string("weights.") + (name.starts_with("rig.") ? name.substr(4) : name);
  }
  const std::string plain = (path.parent_path() / name).string();
  std::error_code ignored;
  return std::filesystem::exists(plain, ignored) ? plain : plain + ".gz";
}

void readWeights(const std::string& path, const ObjMesh& mesh, MakeHumanRig& rig) {
  const Reader reader(path);
  const Json json = readJson(path);
  std::unordered_map<std::string, std::uint16_t> bones;
  for (std::size_t b = 0; b < rig.bones.size(); ++b) {
    bones.emplace(rig.bones[b].name, static_cast<std::uint16_t>(b));
  }
  rig.weights.resize(mesh.positions.size());
  for (const Json::Member& member : reader.member(json, "weights", Json::Kind::object).object()) {
    const auto bone = bones.find(member.key);
    if (bone == bones.end()) {
      reader.fail(member.value, std::string("weights of ") + quotedName(member.key) +
                                    ", which is no bone of the rig");
    }
    if (!member.value.is(Json::Kind::list)) reader.fail(member.value, "expected a list of weights");
    for (const Json& pair : member.value.list()) {
      if (!pair.is(Json::Kind::list) || pair.list().size() != 2 ||
          !pair.list()[1].is(Json::Kind::number)) {
        reader.fail(pair, "expected [point, weight]");
      }
      const std::size_t point = reader.index(pair.list()[0], mesh.positions.size());
      rig.weights[point].emplace_back(bone->second, static_cast<float>(pair.list()[1].number()));
    }
  }
}

}  // namespace

MakeHumanRig readMakeHumanRig(const std::string& path, const ObjMesh& mesh) {
  const Reader reader(path);
  const Json json = readJson(path);
  MakeHumanRig rig;
  rig.bones = readBones(json, mesh, reader);
  readWeights(weightsPath(path, json, reader), mesh, rig);
  return rig;
}

}  // namespace fascia
