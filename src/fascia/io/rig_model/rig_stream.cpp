#include <fascia/io/rig_model/rig_stream.h>

#include <cmath>

namespace fascia {
namespace {

// Eigen's vectors and our structs of them lie without gaps.
static_assert(sizeof(RigVertex) == 24 && sizeof(PointWeights) == 48);

// A list of things of unequal length; each takes a byte at least, which bounds the count.
template <class T, class ReadOne>
void readList(ByteReader& in, std::vector<T>& list, const ReadOne& readOne) {
  const auto count = in.value<std::uint64_t>();
  if (count > in.left()) in.fail("is cut short");
  for (std::uint64_t i = 0; i < count; ++i) list.push_back(readOne(in));
}

void require(bool holds, const ByteReader& in, const char* what) {
  if (!holds) in.fail(std::string("has a rig with ") + what);
}

void writeTransform(const Transform& t, ByteWriter& out) {
  out.array(t.rotation.data(), 9);
  out.array(t.translation_m.data(), 3);
}

Transform readTransform(ByteReader& in) {
  Transform t;
  for (Eigen::Index i = 0; i < 9; ++i) t.rotation.data()[i] = in.value<double>();
  for (Eigen::Index i = 0; i < 3; ++i) t.translation_m[i] = in.value<double>();
  const bool rigid = t.translation_m.allFinite() &&
                     (t.rotation * t.rotation.transpose() - Mat3::Identity()).norm() < 1e-4;
  require(rigid, in, "a joint that is not rigid");
  return t;
}

void writeMotion(const SampledMotion& motion, ByteWriter& out) {
  out.text(motion.name);
  out.value(motion.rate_hz);
  out.value(static_cast<std::uint8_t>(motion.loop));
  out.value(static_cast<std::uint64_t>(motion.joints.size()));
  for (const std::string& joint : motion.joints) out.text(joint);
  out.list(motion.rotation);
  out.list(motion.translation_m);
}

// Of a file that knows of morphs.
void writeWeights(const SampledMotion& motion, ByteWriter& out) {
  out.value(static_cast<std::uint64_t>(motion.morphs.size()));
  for (const std::string& morph : motion.morphs) out.text(morph);
  out.list(motion.weights);
}

void readWeights(SampledMotion& motion, ByteReader& in) {
  readList(in, motion.morphs, [](ByteReader& from) { return from.text(); });
  in.list(motion.weights);
  require(motion.weights.size() == motion.frameCount() * motion.morphs.size(), in,
          "a motion of unequal parts");
  for (const float w : motion.weights) require(std::isfinite(w), in, "a weight that is no number");
}

void writeMorph(const RigMorph& morph, ByteWriter& out) {
  out.text(morph.name);
  out.value(morph.node);
  out.value(morph.target);
  out.value(morph.rest);
  out.list(morph.points);
  out.list(morph.displacement_m);
}

RigMorph readMorph(ByteReader& in) {
  RigMorph morph;
  morph.name = in.text();
  morph.node = in.value<int>();
  morph.target = in.value<int>();
  morph.rest = in.value<float>();
  in.list(morph.points);
  in.list(morph.displacement_m);
  require(morph.displacement_m.size() == morph.points.size() && std::isfinite(morph.rest), in,
          "a morph of unequal parts");
  for (const Eigen::Vector3f& d : morph.displacement_m)
    require(d.allFinite(), in, "a morph that is not finite numbers");
  return morph;
}

SampledMotion readMotion(ByteReader& in) {
  SampledMotion motion;
  motion.name = in.text();
  motion.rate_hz = in.value<double>();
  motion.loop = in.value<std::uint8_t>() != 0;
  readList(in, motion.joints, [](ByteReader& from) { return from.text(); });
  in.list(motion.rotation);
  in.list(motion.translation_m);
  const std::size_t frames = motion.frameCount();
  require(motion.rate_hz > 0 && motion.rate_hz < 1e6 && frames > 0 &&
              motion.rotation.size() == frames * motion.joints.size() &&
              motion.translation_m.size() == motion.rotation.size(),
          in, "a motion of unequal parts");
  for (const Eigen::Quaternionf& q : motion.rotation)
    require(std::abs(q.norm() - 1) < 1e-3f, in, "a turn that is none");
  for (const Eigen::Vector3f& t : motion.translation_m)
    require(t.allFinite(), in, "a place that is not a finite number");
  return motion;
}

void writePart(const RigPart& part, ByteWriter& out) {
  out.text(part.name);
  for (const int index : {part.node, part.mesh, part.primitive, part.material}) out.value(index);
  for (const std::uint32_t n :
       {part.firstVertex, part.vertexCount, part.firstTriangle, part.triangleCount})
    out.value(n);
}

RigPart readPart(ByteReader& in) {
  RigPart part;
  part.name = in.text();
  for (int* index : {&part.node, &part.mesh, &part.primitive, &part.material})
    *index = in.value<int>();
  for (std::uint32_t* n :
       {&part.firstVertex, &part.vertexCount, &part.firstTriangle, &part.triangleCount})
    *n = in.value<std::uint32_t>();
  return part;
}

void writeMaterial(const RigMaterial& material, ByteWriter& out) {
  out.text(material.name);
  out.value(material.color);
  out.value(material.roughness);
  out.value(material.metallic);
  out.value(static_cast<std::uint8_t>(material.doubleSided));
  out.list(material.texture);
}

RigMaterial readMaterial(ByteReader& in) {
  RigMaterial material;
  material.name = in.text();
  material.color = in.value<std::array<float, 4>>();
  material.roughness = in.value<float>();
  material.metallic = in.value<float>();
  material.doubleSided = in.value<std::uint8_t>() != 0;
  in.list(material.texture);
  for (const float c : material.color) require(std::isfinite(c), in, "a colour that is none");
  require(std::isfinite(material.roughness) && std::isfinite(material.metallic), in,
          "a material out of range");
  return material;
}

RigJoint readJoint(ByteReader& in) {
  RigJoint joint;
  joint.name = in.text();
  joint.parent = in.value<int>();
  joint.rest_world = readTransform(in);
  joint.node = in.value<int>();
  return joint;
}

void checkJoints(const RiggedModel& model, const ByteReader& in) {
  require(!model.joints.empty(), in, "no joints");
  for (std::size_t j = 0; j < model.joints.size(); ++j) {
    const int parent = model.joints[j].parent;
    require(j == 0 ? parent == -1 : parent >= 0 && static_cast<std::size_t>(parent) < j, in,
            "a joint that hangs from nothing");
  }
}

void checkPoints(const RiggedModel& model, const ByteReader& in) {
  const std::size_t points = model.points_m.size();
  require(model.weights.size() == points && model.component.size() == points, in,
          "points of unequal parts");
  for (const Eigen::Vector3f& p : model.points_m)
    require(p.allFinite(), in, "a point that is not a finite number");
  for (const std::uint32_t c : model.component)
    require(c < model.componentCount, in, "a piece out of range");
  for (const PointWeights& weights : model.weights) {
    float sum = 0;
    for (std::size_t k = 0; k < PointWeights::kMost; ++k) {
      require(weights.joint[k] < model.joints.size() && weights.weight[k] >= 0, in,
              "weights out of range");
      sum += weights.weight[k];
    }
    require(std::abs(sum - 1) < 1e-3f, in, "weights that do not sum to one");
  }
  for (const auto& triangle : model.triangles)
    for (const std::uint32_t p : triangle)
      require(p < points, in, "a triangle that points nowhere");
}

void checkDrawn(const RiggedModel& model, const ByteReader& in) {
  const std::size_t vertices = model.vertices.size(), triangles = model.drawnTriangles.size();
  for (const RigVertex& v : model.vertices)
    require(v.point < model.points_m.size() && v.normal.allFinite() && v.uv.allFinite(), in,
            "a vertex out of range");
  for (const auto& triangle : model.drawnTriangles)
    for (const std::uint32_t v : triangle)
      require(v < vertices, in, "a triangle that points nowhere");
  const auto within = [](std::uint32_t first, std::uint32_t count, std::size_t size) {
    return first <= size && count <= size - first;
  };
  for (const RigPart& part : model.parts)
    require(within(part.firstVertex, part.vertexCount, vertices) &&
                within(part.firstTriangle, part.triangleCount, triangles) && part.material >= -1 &&
                part.material < static_cast<int>(model.materials.size()),
            in, "a part out of range");
}

}  // namespace

void writeRig(const RiggedModel& model, std::span<const SampledMotion> motions, ByteWriter& out) {
  out.text(model.name);
  out.text(model.sourceFile);
  out.value(static_cast<std::uint64_t>(model.joints.size()));
  for (const RigJoint& joint : model.joints) {
    out.text(joint.name);
    out.value(joint.parent);
    writeTransform(joint.rest_world, out);
    out.value(joint.node);
  }
  out.list(model.points_m);
  out.list(model.weights);
  out.list(model.triangles);
  out.list(model.component);
  out.value(model.componentCount);
  out.list(model.vertices);
  out.list(model.drawnTriangles);
  out.value(static_cast<std::uint64_t>(model.parts.size()));
  for (const RigPart& part : model.parts) writePart(part, out);
  out.value(static_cast<std::uint64_t>(model.materials.size()));
  for (const RigMaterial& material : model.materials) writeMaterial(material, out);
  out.value(static_cast<std::uint64_t>(motions.size()));
  for (const SampledMotion& motion : motions) writeMotion(motion, out);
}

void writeRigMorphs(const RiggedModel& model, std::span<const SampledMotion> motions,
                    ByteWriter& out) {
  out.value(static_cast<std::uint64_t>(model.morphs.size()));
  for (const RigMorph& morph : model.morphs) writeMorph(morph, out);
  for (const SampledMotion& motion : motions) writeWeights(motion, out);
}

void readRigMorphs(ByteReader& in, RiggedModel& model) {
  readList(in, model.morphs, readMorph);
  for (const RigMorph& morph : model.morphs)
    for (const std::uint32_t p : morph.points)
      require(p < model.points_m.size(), in, "a morph of points that are not there");
  for (SampledMotion& motion : model.motions) readWeights(motion, in);
}

RiggedModel readRig(ByteReader& in) {
  RiggedModel model;
  model.name = in.text();
  model.sourceFile = in.text();
  readList(in, model.joints, readJoint);
  in.list(model.points_m);
  in.list(model.weights);
  in.list(model.triangles);
  in.list(model.component);
  model.componentCount = in.value<std::uint32_t>();
  in.list(model.vertices);
  in.list(model.drawnTriangles);
  readList(in, model.parts, readPart);
  readList(in, model.materials, readMaterial);
  readList(in, model.motions, readMotion);
  checkJoints(model, in);
  checkPoints(model, in);
  checkDrawn(model, in);
  for (const SampledMotion& motion : model.motions)
    require(motion.joints.size() == model.joints.size(), in,
            "a motion of other joints than its own");
  return model;
}

}  // namespace fascia
