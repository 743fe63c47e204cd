#include <fascia/io/cache/cache.h>

#include <cmath>
#include <functional>
#include <span>

#include <fascia/io/documents/character_file.h>
#include <fascia/io/file/byte_stream.h>
#include <fascia/io/file/file.h>
#include <fascia/io/rig_model/rig_stream.h>

namespace fascia {
namespace {

// Layout, little-endian: magic, u32 version; texts (u64 length, bytes): character file, texture,
// motion; the rig if the character has one (version 2 and later), and its morphs (version 5, of
// characters with morphs only); how many numbers the soft solids' shapes are (version 3 and later);
// rate, loop; the mesh; per frame time, posture, shapes, weights of morphs, positions as float32;
// stats (version 4: with the depth of faces), without how long anything took, so that equal runs
// give equal files: zeros stand there, for programs that expect a number.
constexpr std::string_view kCacheMagic("FCACHE\x1a\n", 8);
constexpr std::uint32_t kPlainVersion = 1, kSoftVersion = 3, kFaceVersion = 4, kMorphVersion = 5;
constexpr std::size_t kMaxCacheBytes = std::size_t{8} << 30;

template <class Vector>
void checkFinite(const ByteReader& in, const std::vector<Vector>& values) {
  for (const Vector& v : values) {
    if (!v.allFinite()) in.fail("holds a value that is not a finite number");
  }
}

void checkFinite(const ByteReader& in, double value) {
  if (!std::isfinite(value)) in.fail("holds a value that is not a finite number");
}

void writeMesh(ByteWriter& out, const TriangleMesh& mesh) {
  out.list(mesh.positions);
  out.list(mesh.normals);
  out.list(mesh.uvs);
  out.list(mesh.triangles);
}

TriangleMesh readMesh(ByteReader& in) {
  TriangleMesh mesh;
  in.list(mesh.positions);
  in.list(mesh.normals);
  in.list(mesh.uvs);
  in.list(mesh.triangles);
  const std::size_t count = mesh.positions.size();
  const auto fits = [&](std::size_t size) { return size == 0 || size == count; };
  if (!fits(mesh.normals.size()) || !fits(mesh.uvs.size())) in.fail("has a mesh of unequal parts");
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle) {
      if (v >= count) in.fail("has a triangle that points nowhere");
    }
  }
  checkFinite(in, mesh.positions);
  checkFinite(in, mesh.normals);
  checkFinite(in, mesh.uvs);
  return mesh;
}

// Of a rig's motions only the recorded one is kept.
std::span<const SampledMotion> motionNamed(const RiggedModel& model, const std::string& name) {
  for (const SampledMotion& motion : model.motions)
    if (motion.name == name) return {&motion, 1};
  return {};
}

template <class Stats, class Visit>
void eachSkinStat(Stats& s, std::uint32_t version, const Visit& visit) {
  visit(s.steps), visit(s.rejected_steps), visit(s.step_min_s), visit(s.step_max_s);
  visit(s.forces_s), visit(s.constraints_s), visit(s.other_s), visit(s.max_penetration_m);
  visit(s.max_edge_stretch), visit(s.repaired_points);
  if (version >= kFaceVersion) visit(s.max_face_depth_m);
}

std::size_t valueCount(const CharacterDef& def) {
  std::size_t count = 0;
  for (const JointDef& joint : def.skeleton.joints) count += joint.dofs.size();
  return count;
}

std::size_t shapeSize(const Recording& recording) {
  return recording.frames.empty() ? 0 : recording.frames.front().soft_shapes.size();
}

std::size_t morphCount(const CharacterDef& def) {
  return def.rig && def.rig->model ? def.rig->model->morphs.size() : 0;
}

// How many numbers a frame has of each kind.
struct FrameSize {
  std::size_t posture, shapes, morphs, vertices;
};

Recording::Frame readFrame(ByteReader& in, const FrameSize& size) {
  Recording::Frame frame;
  frame.time_s = in.value<double>();
  checkFinite(in, frame.time_s);
  in.array(frame.posture, size.posture);
  in.array(frame.soft_shapes, size.shapes);
  in.array(frame.morphs, size.morphs);
  for (const auto* values : {&frame.posture, &frame.soft_shapes, &frame.morphs})
    for (const double value : *values) checkFinite(in, value);
  if (in.value<std::uint8_t>() != 0) in.array(frame.skin_m, size.vertices);
  checkFinite(in, frame.skin_m);
  return frame;
}

}  // namespace

bool isCache(std::string_view bytes) {
  return bytes.starts_with(kCacheMagic);
}

namespace {

// Everything in its order, piece by piece.
void putCache(const CharacterDef& def, const Recording& recording, const Texture* texture,
              const std::function<void(std::string_view)>& put) {
  const std::size_t postureSize = valueCount(def), morphs = morphCount(def);
  if (def.rig && !def.rig->model) throw Error("the character's rig was not read from its file");
  ByteWriter head;
  head.bytes = kCacheMagic;
  const std::size_t shapes = shapeSize(recording);
  head.value(morphs > 0 ? kMorphVersion : kFaceVersion);
  head.text(characterText(def));
  head.text(texture ? texture->bytes : loadTexture(def).bytes);
  head.text(recording.motion);
  if (def.rig) writeRig(*def.rig->model, motionNamed(*def.rig->model, recording.motion), head);
  if (morphs > 0)
    writeRigMorphs(*def.rig->model, motionNamed(*def.rig->model, recording.motion), head);
  head.value(static_cast<std::uint64_t>(shapes));
  head.value(recording.frame_rate_hz);
  head.value(static_cast<std::uint8_t>(recording.loop));
  writeMesh(head, recording.skin);
  head.value(static_cast<std::uint64_t>(recording.frames.size()));
  put(head.bytes);
  for (const Recording::Frame& frame : recording.frames) {
    const bool skin = !frame.skin_m.empty();
    if (frame.posture.size() != postureSize || frame.soft_shapes.size() != shapes ||
        frame.morphs.size() != morphs ||
        (skin && frame.skin_m.size() != recording.skin.positions.size())) {
      throw Error("the recording is not of this character");
    }
    ByteWriter out;
    out.value(frame.time_s);
    out.array(frame.posture.data(), frame.posture.size());
    out.array(frame.soft_shapes.data(), frame.soft_shapes.size());
    out.array(frame.morphs.data(), frame.morphs.size());
    out.value(static_cast<std::uint8_t>(skin));
    out.array(frame.skin_m.data(), frame.skin_m.size());
    put(out.bytes);
  }
  ByteWriter tail;
  SkinStats untimed = recording.stats;
  untimed.forces_s = untimed.constraints_s = untimed.other_s = 0;
  eachSkinStat(untimed, kFaceVersion, [&](const auto& value) { tail.value(value); });
  tail.value(0.0);  // wall_s
  tail.value(recording.simulated_s);
  tail.value(recording.state_hash);
  put(tail.bytes);
}

}  // namespace

void writeCache(const CharacterDef& def, const Recording& recording, const std::string& path,
                const Texture* texture) {
  WholeFile file(path);
  putCache(def, recording, texture, [&](std::string_view bytes) { file.write(bytes); });
  file.commit();
}

std::string cacheBytes(const CharacterDef& def, const Recording& recording,
                       const Texture* texture) {
  std::string out;
  putCache(def, recording, texture, [&](std::string_view bytes) { out += bytes; });
  return out;
}

Cache parseCache(std::string_view bytes, const std::string& file) {
  ByteReader in(bytes, file);
  if (!isCache(bytes)) in.fail("is not a Fascia cache");
  in.take(kCacheMagic.size());
  const auto version = in.value<std::uint32_t>();
  if (version < kPlainVersion || version > kMorphVersion) {
    in.fail("has cache format " + std::to_string(version) + ", this program reads up to format " +
            std::to_string(kMorphVersion));
  }
  Cache cache;
  cache.def = readCharacterText(in.text(), file).def;
  cache.texture.bytes = in.text();
  if (!cache.texture.empty() && imageFormat(cache.texture.bytes) == ImageFormat::unknown) {
    in.fail("has a texture that is neither a PNG nor a JPEG");
  }
  Recording& recording = cache.recording;
  recording.motion = in.text();
  if (cache.def.rig) {
    RiggedModel model = readRig(in);
    if (version >= kMorphVersion) readRigMorphs(in, model);
    cache.def.rig->model = std::make_shared<const RiggedModel>(std::move(model));
  }
  const auto shapes =
      version >= kSoftVersion ? static_cast<std::size_t>(in.value<std::uint64_t>()) : 0;
  recording.frame_rate_hz = in.value<double>();
  if (!(recording.frame_rate_hz > 0 && recording.frame_rate_hz <= 1e6)) {
    in.fail("has a frame rate out of range");
  }
  recording.loop = in.value<std::uint8_t>() != 0;
  recording.skin = readMesh(in);
  const std::size_t drawn = recording.skin.positions.size();
  if (cache.def.rig && drawn != 0 && drawn != cache.def.rig->model->vertices.size()) {
    in.fail("has a mesh that is not its rig's");
  }
  const auto frames = in.value<std::uint64_t>();
  const FrameSize size{valueCount(cache.def), shapes, morphCount(cache.def),
                       recording.skin.positions.size()};
  for (std::uint64_t f = 0; f < frames; ++f) {
    recording.frames.push_back(readFrame(in, size));
  }
  eachSkinStat(recording.stats, version,
               [&](auto& value) { value = in.value<std::decay_t<decltype(value)>>(); });
  recording.wall_s = in.value<double>();
  recording.simulated_s = in.value<double>();
  recording.state_hash = in.value<std::uint64_t>();
  if (in.left() > 0) in.fail("has bytes after its end");
  return cache;
}

std::string readCacheBytes(const std::string& path) {
  return readFile(path, kMaxCacheBytes);
}

Cache readCache(const std::string& path) {
  return parseCache(readCacheBytes(path), path);
}

}  // namespace fascia
