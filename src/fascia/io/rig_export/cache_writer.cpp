#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include <fascia/base/index.h>
#include <fascia/io/cache/mdd.h>
#include <fascia/io/cache/pc2.h>
#include <fascia/io/gltf/gltf_accessor.h>
#include <fascia/io/rig_export/other_channels.h>
#include <fascia/io/rig_export/rig_source.h>

namespace fascia {
namespace {

// A mesh as importers count its vertices: primitive after primitive, without vertices that no
// triangle uses.
struct CachedMesh {
  std::string name;
  std::vector<std::size_t> parts;
  std::vector<std::uint32_t> vertices;  // of the model
};

std::vector<std::uint32_t> usedVertices(const RiggedModel& model, const RigPart& part) {
  std::vector<std::uint32_t> used;
  for (std::uint32_t t = part.firstTriangle; t < part.firstTriangle + part.triangleCount; ++t) {
    used.insert(used.end(), model.drawnTriangles[t].begin(), model.drawnTriangles[t].end());
  }
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  return used;
}

std::vector<CachedMesh> meshesOf(const RiggedModel& model) {
  std::vector<CachedMesh> meshes;
  int last = -1;
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    const RigPart& part = model.parts[p];
    const std::vector<std::uint32_t> used = usedVertices(model, part);
    if (used.empty()) continue;
    if (part.node != last) meshes.push_back({part.name, {}, {}});
    last = part.node;
    meshes.back().parts.push_back(p);
    meshes.back().vertices.insert(meshes.back().vertices.end(), used.begin(), used.end());
  }
  return meshes;
}

void collectExtensions(const Json& json, std::set<std::string>& names) {
  if (json.is(Json::Kind::list)) {
    for (const Json& item : json.list()) collectExtensions(item, names);
  }
  if (!json.is(Json::Kind::object)) return;
  for (const Json::Member& member : json.object()) {
    if (member.key == "extensions" && member.value.is(Json::Kind::object)) {
      for (const Json::Member& extension : member.value.object()) names.insert(extension.key);
    }
    collectExtensions(member.value, names);
  }
}

void dropUnusedExtensions(Json& root) {
  std::set<std::string> names;
  collectExtensions(root, names);
  for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
    Json* used = findMember(root, list);
    if (!used || !used->is(Json::Kind::list)) continue;
    std::erase_if(used->list(), [&](const Json& name) {
      return !name.is(Json::Kind::text) || names.count(name.text()) == 0;
    });
    if (used->list().empty()) eraseMember(root, list);
  }
}

// Turns the source into a still picture of the rest surface: materials stay, what moves goes.
class StillWriter {
 public:
  explicit StillWriter(RigSource& source) : source_(source), model_(source.clip.model) {}

  void write(const std::vector<CachedMesh>& cached) {
    Json::List meshes, nodes, top;
    for (const CachedMesh& mesh : cached) {
      Json node{Json::Object{}};
      node.set("name", mesh.name);
      node.set("mesh", static_cast<int>(meshes.size()));
      top.emplace_back(static_cast<int>(nodes.size()));
      nodes.push_back(std::move(node));
      meshes.push_back(still(mesh));
    }
    Json& root = source_.document.json();
    Json scene{Json::Object{}};
    scene.set("nodes", std::move(top));
    putMember(root, "meshes", std::move(meshes));
    putMember(root, "nodes", std::move(nodes));
    putMember(root, "scenes", Json::List{std::move(scene)});
    putMember(root, "scene", 0);
    for (const char* moving : {"animations", "skins", "cameras"}) eraseMember(root, moving);
    keepMaterialVariants(root);
    dropUnusedExtensions(root);
  }

 private:
  Json still(const CachedMesh& cached) {
    const RigPart& first = model_.parts[cached.parts.front()];
    Json mesh = source_.document.item("meshes", first.mesh);
    eraseMember(mesh, "weights");
    if (Json* extras = findMember(mesh, "extras")) eraseMember(*extras, "targetNames");
    Json::List primitives;
    for (const std::size_t p : cached.parts) primitives.push_back(still(model_.parts[p]));
    putMember(mesh, "primitives", std::move(primitives));
    return mesh;
  }

  Json still(const RigPart& part) {
    Json primitive = source_.primitive(part);
    for (const char* gone : {"targets", "mode"}) eraseMember(primitive, gone);
    const std::vector<std::uint32_t> used = usedVertices(model_, part);
    Json& attributes = ensureMember(primitive, "attributes");
    std::erase_if(attributes.object(), [](const Json::Member& member) {
      return member.key.starts_with("JOINTS_") || member.key.starts_with("WEIGHTS_") ||
             member.key == "TANGENT";
    });
    for (Json::Member& attribute : attributes.object()) gather(part, used, attribute);
    std::vector<std::uint32_t> number(part.vertexCount, 0), indices;
    for (std::size_t k = 0; k < used.size(); ++k) {
      number[used[k] - part.firstVertex] = static_cast<std::uint32_t>(k);
    }
    for (std::uint32_t t = part.firstTriangle; t < part.firstTriangle + part.triangleCount; ++t) {
      for (const std::uint32_t v : model_.drawnTriangles[t]) {
        indices.push_back(number[v - part.firstVertex]);
      }
    }
    putMember(primitive, "indices", source_.document.addIndices(indices));
    return primitive;
  }

  void gather(const RigPart& part, const std::vector<std::uint32_t>& used,
              Json::Member& attribute) {
    std::vector<float> values;
    if (attribute.key == "POSITION" || attribute.key == "NORMAL") {
      const bool positions = attribute.key == "POSITION";
      for (const std::uint32_t v : used) {
        const Eigen::Vector3f& value =
            positions ? model_.points_m[model_.vertices[v].point] : model_.vertices[v].normal;
        values.insert(values.end(), value.data(), value.data() + 3);
      }
      attribute.value = source_.document.addFloats(values, "VEC3", positions);
      return;
    }
    if (used.size() == part.vertexCount) return;
    const auto accessor = static_cast<int>(attribute.value.number());
    const std::string type = source_.document.root()["accessors"].at(at(accessor))["type"].text();
    const int width = componentCount(type);
    const std::vector<float> all = source_.document.floats(accessor, width);
    for (const std::uint32_t v : used) {
      const auto from = all.begin() + std::ptrdiff_t{width} * (v - part.firstVertex);
      values.insert(values.end(), from, from + width);
    }
    attribute.value = source_.document.addFloats(values, type);
  }

  // The other extensions of a whole file (lights, avatars) speak of nodes.
  static void keepMaterialVariants(Json& root) {
    Json* extensions = findMember(root, "extensions");
    if (!extensions || !extensions->is(Json::Kind::object)) return;
    std::erase_if(extensions->object(), [](const Json::Member& member) {
      return member.key != "KHR_materials_variants";
    });
    if (extensions->object().empty()) eraseMember(root, "extensions");
  }

  RigSource& source_;
  const RiggedModel& model_;
};

std::size_t sizeOf(const GltfDocument& document, const char* list) {
  return document.root()[list].size();
}

// What a still picture and its caches cannot hold, for a person; empty if that is nothing.
std::string leftOutOf(const RigSource& source) {
  const GltfDocument& document = source.document;
  std::string text;
  const auto add = [&](std::size_t count, const char* what) {
    if (count > 0) text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + what;
  };
  add(source.clip.model.joints.size(), "joints");
  add(sizeOf(document, "animations"), "animations");
  add(sizeOf(document, "cameras"), "cameras");
  std::size_t morphed = 0;
  const GltfPlace meshes = document.root()["meshes"];
  for (const RigPart& part : source.clip.model.parts)
    morphed += meshes.at(at(part.mesh))["primitives"].at(at(part.primitive))["targets"].size() > 0;
  add(morphed, "primitives' morph targets");
  const Json* extensions = document.json().find("extensions");
  for (const Json::Member& member :
       extensions && extensions->is(Json::Kind::object) ? extensions->object() : Json::Object{})
    if (member.key != "KHR_materials_variants") text += ", the extension " + jsonText(member.key);
  return text.empty() ? text : "a cache holds no skeleton: left out are " + text;
}

Recording cacheOf(const CachedMesh& mesh, const Recording& recording) {
  Recording out;
  out.frame_rate_hz = recording.frame_rate_hz;
  for (const Recording::Frame& frame : recording.frames) {
    Recording::Frame& kept = out.frames.emplace_back();
    kept.time_s = frame.time_s - recording.frames.front().time_s;
    kept.skin_m.reserve(mesh.vertices.size());
    for (const std::uint32_t v : mesh.vertices) kept.skin_m.push_back(frame.skin_m[v]);
  }
  out.skin.positions = out.frames.front().skin_m;
  return out;
}

// Letters, digits, dots and dashes of a name; different for every mesh.
std::string fileNameOf(const std::string& name, std::set<std::string>& taken) {
  std::string clean;
  for (const char c : name) {
    const auto u = static_cast<unsigned char>(c);
    clean += std::isalnum(u) || c == '-' || c == '_' ? c : '_';
  }
  std::string fresh = clean;
  for (int n = 2; !taken.insert(fresh).second; ++n)
    fresh = clean + std::string("_") + std::to_string(n);
  return fresh;
}

// Both caches, read back, against what should be in them.
double largestDifference(const Recording& wanted, const PointCache& pc2, const MddCache& mdd,
                         double& sum_m2) {
  double largest = 0;
  std::size_t i = 0;
  for (const Recording::Frame& frame : wanted.frames) {
    for (const Eigen::Vector3f& p : frame.skin_m) {
      const auto e = static_cast<double>(
          std::max((pc2.positions_m.at(i) - p).norm(), (mdd.positions_m.at(i) - p).norm()));
      sum_m2 += e * e;
      largest = std::max(largest, e);
      ++i;
    }
  }
  return largest;
}

}  // namespace

std::vector<std::string> filesOfRigCache(const RiggedModel& model, const std::string& path) {
  const std::vector<CachedMesh> meshes = meshesOf(model);
  const std::string base = std::filesystem::path(path).replace_extension().string();
  std::vector<std::string> files{path};
  std::set<std::string> taken;
  for (const CachedMesh& mesh : meshes) {
    std::string stem = base;
    if (meshes.size() > 1) stem.append(1, '.').append(fileNameOf(mesh.name, taken));
    files.insert(files.end(), {stem + ".pc2", stem + ".mdd"});
  }
  return files;
}

RigBakeReport writeRigAsCache(const RigClip& clip, const std::string& path) {
  RigSource source = RigSource::open(std::span<const RigClip>(&clip, 1));
  const std::vector<CachedMesh> meshes = meshesOf(clip.model);
  RigBakeReport report;
  report.files = filesOfRigCache(clip.model, path);
  double sum_m2 = 0, entries = 0;
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    const std::string &pc2 = report.files[2 * m + 1], &mdd = report.files[2 * m + 2];
    const Recording cache = cacheOf(meshes[m], clip.recording);
    writePc2(cache, pc2);
    writeMdd(cache, mdd);
    const double largest = largestDifference(cache, readPc2(pc2), readMdd(mdd), sum_m2);
    report.error.max_mm = std::max(report.error.max_mm, 1e3 * largest);
    entries += static_cast<double>(cache.frames.size() * meshes[m].vertices.size());
  }
  report.error.rms_mm = 1e3 * std::sqrt(sum_m2 / entries);
  report.notes = notesOfMotions(source.clips, 0);
  report.notes.push_back(leftOutOf(source));
  StillWriter(source).write(meshes);
  source.document.writeGlb(path);
  return report;
}

}  // namespace fascia
