#include <fascia/io/cache/scene_cache.h>

#include <cmath>

#include <fascia/io/cache/cache.h>
#include <fascia/io/documents/scene_file.h>
#include <fascia/io/file/byte_stream.h>
#include <fascia/io/file/file.h>

namespace fascia {
namespace {

// Layout, little-endian: magic, u32 version; the scene file's text; per character its own cache;
// per body made of a mesh the mesh; rate; per frame time and bodies; what the script said; stats;
// from version 2 on: troubles.
constexpr std::string_view kSceneMagic("FSCENE\x1a\n", 8);
constexpr std::uint32_t kSceneVersion = 2;

template <class Stats, class Visit>
void eachBodyStat(Stats& s, const Visit& visit) {
  visit(s.steps), visit(s.iterations), visit(s.halved), visit(s.unconverged), visit(s.stopped);
}

void writeBodyMesh(ByteWriter& out, const TriangleMesh& mesh) {
  out.list(mesh.positions);
  out.list(mesh.triangles);
}

std::shared_ptr<const TriangleMesh> readBodyMesh(ByteReader& in) {
  auto mesh = std::make_shared<TriangleMesh>();
  in.list(mesh->positions);
  in.list(mesh->triangles);
  for (const Eigen::Vector3f& p : mesh->positions)
    if (!p.allFinite()) in.fail("holds a value that is not a finite number");
  for (const auto& triangle : mesh->triangles)
    for (const std::uint32_t v : triangle)
      if (v >= mesh->positions.size()) in.fail("has a triangle that points nowhere");
  return mesh;
}

bool hasMesh(const SceneBodyDef& body) {
  return body.form == SceneBodyDef::Form::mesh;
}

// The scene, without its script.
SceneDef readScene(ByteReader& in, const std::string& file, std::vector<Texture>& textures,
                   std::vector<Recording>& recordings) {
  SceneDef def = readSceneText(in.text(), file).def;
  for (SceneCharacterDef& character : def.characters) {
    Cache cache = parseCache(in.text(), file);
    character.character = std::make_shared<const Character>(cache.def);
    textures.push_back(std::move(cache.texture));
    recordings.push_back(std::move(cache.recording));
  }
  for (SceneBodyDef& body : def.bodies)
    if (hasMesh(body)) body.mesh = readBodyMesh(in);
  return def;
}

void readFrames(ByteReader& in, std::size_t coordinates, StageRecording& out) {
  const auto count = in.value<std::uint64_t>();
  for (std::uint64_t f = 0; f < count; ++f) {
    StageRecording::Frame frame;
    frame.time_s = in.value<double>();
    in.array(frame.bodies, coordinates);
    bool finite = std::isfinite(frame.time_s);
    for (const double q : frame.bodies) finite = finite && std::isfinite(q);
    if (!finite) in.fail("holds a value that is not a finite number");
    out.frames.push_back(std::move(frame));
  }
}

void writeTroubles(ByteWriter& out, const std::vector<BodyTrouble>& troubles) {
  out.value(static_cast<std::uint64_t>(troubles.size()));
  for (const BodyTrouble& t : troubles) {
    out.value(static_cast<std::uint8_t>(t.kind));
    out.value(static_cast<std::uint64_t>(t.body.index()));
    out.text(t.with);
    out.value(t.from_s), out.value(t.to_s), out.value(t.worst);
    out.value(static_cast<std::uint8_t>(t.lasts));
  }
}

void readTroubles(ByteReader& in, std::size_t bodies, std::vector<BodyTrouble>& troubles) {
  const auto count = in.value<std::uint64_t>();
  for (std::uint64_t i = 0; i < count; ++i) {
    const auto kind = in.value<std::uint8_t>();
    const auto body = in.value<std::uint64_t>();
    if (kind > static_cast<std::uint8_t>(BodyTrouble::Kind::letGo) || body >= bodies)
      in.fail("tells of a trouble that is none");
    BodyTrouble trouble{static_cast<BodyTrouble::Kind>(kind), BodyId(body), in.text(), 0, 0, 0};
    trouble.from_s = in.value<double>();
    trouble.to_s = in.value<double>();
    trouble.worst = in.value<double>();
    trouble.lasts = in.value<std::uint8_t>() != 0;
    troubles.push_back(std::move(trouble));
  }
}

}  // namespace

void writeSceneCache(const Stage& stage, const StageRecording& recording, const std::string& path) {
  const SceneDef& def = stage.def();
  ByteWriter out;
  out.bytes = kSceneMagic;
  out.value(kSceneVersion);
  out.text(sceneText(def));
  for (std::size_t i = 0; i < def.characters.size(); ++i)
    out.text(cacheBytes(def.characters[i].character->def(), recording.characters[i]));
  for (const SceneBodyDef& body : def.bodies)
    if (hasMesh(body)) writeBodyMesh(out, *body.mesh);
  out.value(recording.frame_rate_hz);
  out.value(static_cast<std::uint64_t>(recording.frames.size()));
  for (const StageRecording::Frame& frame : recording.frames) {
    if (frame.bodies.size() != stage.bodies().size())
      throw Error("the recording is not of this scene");
    out.value(frame.time_s);
    out.array(frame.bodies.data(), frame.bodies.size());
  }
  out.value(static_cast<std::uint8_t>(recording.outcome));
  out.text(recording.reason);
  eachBodyStat(recording.bodies, [&](const auto& value) { out.value(value); });
  out.value(0.0);  // wall_s: equal runs give equal files
  out.value(recording.simulated_s);
  out.value(recording.state_hash);
  writeTroubles(out, recording.troubles);
  writeFileWhole(path, out.bytes);
}

SceneCache parseSceneCache(std::string_view bytes, const std::string& file) {
  ByteReader in(bytes, file);
  if (!isSceneCache(bytes)) in.fail("is not a Fascia scene cache");
  in.take(kSceneMagic.size());
  const auto version = in.value<std::uint32_t>();
  if (version < 1 || version > kSceneVersion)
    in.fail("has scene cache format " + std::to_string(version) +
            ", this program reads formats up to " + std::to_string(kSceneVersion));
  std::vector<Texture> textures;
  std::vector<Recording> characters;
  SceneDef def = readScene(in, file, textures, characters);
  SceneCache out{Stage(std::move(def)), std::move(textures), {}};
  StageRecording& recording = out.recording;
  recording.characters = std::move(characters);
  recording.frame_rate_hz = in.value<double>();
  if (!(recording.frame_rate_hz > 0 && recording.frame_rate_hz <= 1e6))
    in.fail("has a frame rate out of range");
  readFrames(in, out.stage.bodies().size(), recording);
  for (const Recording& character : recording.characters)
    if (character.frames.size() != recording.frames.size())
      in.fail("has a character with another number of frames");
  const auto kind = in.value<std::uint8_t>();
  if (kind > static_cast<std::uint8_t>(ScriptOutcome::failed))
    in.fail("has an outcome that is none");
  recording.outcome = static_cast<ScriptOutcome>(kind);
  recording.reason = in.text();
  eachBodyStat(recording.bodies,
               [&](auto& value) { value = in.value<std::decay_t<decltype(value)>>(); });
  recording.wall_s = in.value<double>();
  recording.simulated_s = in.value<double>();
  recording.state_hash = in.value<std::uint64_t>();
  if (version >= 2) readTroubles(in, out.stage.bodies().bodyCount(), recording.troubles);
  if (in.left() > 0) in.fail("has bytes after its end");
  return out;
}

bool isSceneCache(std::string_view bytes) {
  return bytes.starts_with(kSceneMagic);
}

}  // namespace fascia
