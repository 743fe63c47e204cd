#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <fascia/base/parallel.h>
#include <fascia/io/cache/cache.h>
#include <fascia/io/cache/scene_cache.h>
#include <fascia/io/documents/character_file.h>
#include <fascia/io/documents/scene_file.h>
#include <fascia/io/motion/motion_file.h>
#include <fascia/io/rig_import/rig_import.h>
#include <fascia/math/ode/integrators.h>
#include <fascia/render/gl_context.h>
#include <fascia/skin/grid/grid_skin.h>
#include <fascia/skin/surface/surface_rest.h>

#include "commands.h"
#include "console.h"
#include "example_files.h"
#include "facts.h"
#include "input_kind.h"
#include "outputs.h"
#include "scene_facts.h"

namespace fascia {
namespace {

constexpr const char* kInfoFooter =
    R"(Without a file: about the program and this machine, for a bug report.

With --motion FILE.bvh: how the joints of a motion capture file would drive the rig's; the lines are
a joint map to edit and give back with --joint-map.

Examples:
  fascia info
  fascia info examples/penguin.fascia.json
  fascia info examples/sky-hook.fascia.json
  fascia info fox.glb
  fascia bake examples/penguin.fascia.json -o penguin.fcache
  fascia info penguin.fcache --json)";

struct InfoOptions {
  std::string file, motion, joint_map;
};

std::string motionText(const std::string& name, double duration_s, bool loop) {
  return fmt::format("{}, {:.4g} s{}", name, duration_s, loop ? ", loops" : "");
}

// Left out where there are none, as in most files.
void addMorphs(const RiggedModel& rig, Facts& facts) {
  if (rig.morphs.empty()) return;
  Json::List morphs;
  std::vector<std::string> texts;
  for (const RigMorph& morph : rig.morphs) {
    morphs.push_back(Json::Object{{"name", morph.name},
                                  {"points", static_cast<int>(morph.points.size())},
                                  {"rest", double{morph.rest}}});
    texts.push_back(fmt::format("{}, {} points", morph.name, morph.points.size()));
  }
  facts.add("rig_morphs", std::move(morphs), texts);
}

// What an imported file holds. Its motions are told with the character's, or by addRigMotions.
void addRig(const RiggedModel& rig, Facts& facts) {
  facts.add("rig", rig.sourceFile);
  facts.add("rig_joints", count(rig.joints.size()));
  facts.add("rig_points", count(rig.points_m.size()));
  facts.add("rig_triangles", count(rig.triangles.size()));
  facts.add("rig_pieces", static_cast<int>(rig.componentCount));
  facts.add("rig_height_m", rig.height_m());
  Json::List parts, materials, notes;
  std::vector<std::string> partTexts, materialTexts;
  for (const RigPart& part : rig.parts) {
    const auto m = static_cast<std::size_t>(part.material);
    const std::string material = part.material < 0 ? "" : rig.materials[m].name;
    parts.push_back(Json::Object{{"name", part.name},
                                 {"material", material},
                                 {"triangles", static_cast<int>(part.triangleCount)}});
    partTexts.push_back(fmt::format("{}, {} triangles{}{}", part.name, part.triangleCount,
                                    material.empty() ? "" : " of ", material));
  }
  for (const RigMaterial& material : rig.materials) {
    materials.push_back(
        Json::Object{{"name", material.name}, {"textured", !material.texture.empty()}});
    materialTexts.push_back(material.name + (material.texture.empty() ? "" : ", textured"));
  }
  for (const std::string& note : rig.notes) notes.push_back(note);
  facts.add("rig_parts", std::move(parts), partTexts);
  addMorphs(rig, facts);
  facts.add("rig_materials", std::move(materials), materialTexts);
  facts.add("rig_notes", std::move(notes), rig.notes);
}

void addRigMotions(const RiggedModel& rig, Facts& facts) {
  Json::List motions;
  std::vector<std::string> texts;
  for (const SampledMotion& motion : rig.motions) {
    motions.push_back(Json::Object{
        {"name", motion.name}, {"duration_s", motion.duration_s()}, {"loop", motion.loop}});
    texts.push_back(motionText(motion.name, motion.duration_s(), motion.loop));
  }
  facts.add("motions", std::move(motions), texts);
}

void addCharacter(const Character& character, Facts& facts) {
  const CharacterDef& def = character.def();
  facts.add("name", def.name);
  if (!def.description.empty()) facts.add("description", def.description);
  facts.add("joints", count(character.skeleton().jointCount()));
  facts.add("freedoms", count(character.skeleton().valueCount()));
  facts.add("solids", count(character.flesh().solidCount()));
  facts.add("ornaments", count(character.ornaments().solidCount()));
  if (const Skin* skin = character.skin()) {
    if (skin->grid()) {
      facts.add("skin_columns", skin->grid()->columns());
      facts.add("skin_rows", skin->grid()->rows());
    }
    facts.add("skin_points", count(skin->pointCount()));
    if (skin->surface()) facts.add("skin_triangles", count(skin->surface()->triangles.size()));
  }
  if (def.rig && def.rig->model) addRig(*def.rig->model, facts);
  facts.add("integrator", def.simulation.integrator);
  facts.add("frame_rate_hz", def.simulation.frame_rate_hz);
  Json::List motions;
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < character.motionCount(); ++i) {
    const BoundClip& motion = character.motion(i);
    motions.push_back(Json::Object{
        {"name", motion.name}, {"duration_s", motion.duration_s}, {"loop", motion.loop}});
    texts.push_back(motionText(motion.name, motion.duration_s, motion.loop));
  }
  facts.add("motions", std::move(motions), texts);
}

void addRecording(const Recording& recording, Facts& facts) {
  facts.add("recorded", recording.motion);
  facts.add("frames", count(recording.frames.size()));
  facts.add("recorded_hz", recording.frame_rate_hz);
  facts.add("vertices", count(recording.skin.positions.size()));
  facts.add("simulated_s", recording.simulated_s);
  facts.add("state_hash", fmt::format("{:016x}", recording.state_hash));
}

bool isDocument(const std::string& path) {
  return endingOf(path) == ".json";
}

// How a motion capture file fits a character's or a bare file's rig.
void describeMap(const InfoOptions& options, Facts& facts) {
  std::shared_ptr<const RiggedModel> rig;
  if (isDocument(options.file)) {
    const CharacterDef def = readCharacterFile(options.file).def;
    if (def.rig) rig = def.rig->model;
  } else {
    rig = std::make_shared<const RiggedModel>(readRiggedModel(options.file));
  }
  if (!rig) throw Error("'" + options.file + "' has no rig that a motion could drive");
  MotionFile motion = readMotionFile(options.motion, *rig, options.joint_map);
  const SampledMotion mapped = ontoRig(motion, *rig);
  facts.add("motion", motionText(mapped.name, mapped.duration_s(), mapped.loop));
  facts.add("joints", count(motion.figure.joints.size()));
  facts.add("unit", motion.unit);
  Json::List pairs, notes;
  for (const JointPair& pair : motion.map)
    pairs.push_back(
        Json::Object{{"source", pair.source}, {"target", pair.target}, {"why", pair.why}});
  for (const std::string& note : motion.notes) notes.push_back(note);
  facts.add("notes", std::move(notes), motion.notes);
  facts.addLines("joint_map", std::move(pairs), printJointMap(motion.map));
}

void describeFile(const InfoOptions& options, Facts& facts) {
  facts.add("file", options.file);
  if (!options.motion.empty()) return describeMap(options, facts);
  if (isDocument(options.file) && isSceneFile(options.file))
    return addScene(loadStage(options.file), facts);
  if (isDocument(options.file)) return addCharacter(loadCharacter(options.file), facts);
  if (endingOf(options.file) != ".fcache") {
    const RiggedModel rig = readRiggedModel(options.file);
    addRig(rig, facts);
    return addRigMotions(rig, facts);
  }
  const std::string bytes = readCacheBytes(options.file);
  if (isSceneCache(bytes)) {
    const SceneCache cache = parseSceneCache(bytes, options.file);
    addScene(cache.stage, facts);
    return addPerformance(cache.stage, cache.recording, facts);
  }
  const Cache cache = parseCache(bytes, options.file);
  addCharacter(Character(cache.def), facts);
  addRecording(cache.recording, facts);
}

std::string openGl() {
  try {
    return GlContext().description();
  } catch (const Error& error) {
    return std::string("none: ") + error.what();
  }
}

void describeProgram(Facts& facts) {
  facts.add("version", std::string(FASCIA_VERSION));
  facts.add("threads", hardwareThreads());
  facts.add("opengl", openGl());
  Json::List methods;
  std::vector<std::string> texts;
  for (const IntegratorInfo& info : integrators()) {
    methods.push_back(Json::Object{{"name", std::string(info.name)},
                                   {"description", std::string(info.description)}});
    texts.push_back(fmt::format("{}: {}", info.name, info.description));
  }
  facts.add("integrators", std::move(methods), texts);
}

void info(const InfoOptions& options, const Console& console) {
  Facts facts;
  if (options.file.empty())
    describeProgram(facts);
  else
    withInput(
        options.file,
        {.command = "info", .character = true, .scene = true, .recording = true, .model = true},
        [&] { describeFile(options, facts); });
  facts.show(console);
}

}  // namespace

void addInfo(CLI::App& program, Console& console) {
  CLI::App& command =
      *program.add_subcommand("info", "Tell what is in a file, or about the program");
  const auto options = std::make_shared<InfoOptions>();
  CLI::Option* file =
      command.add_option("FILE", options->file,
                         "A *.fascia.json or *.fcache file of a character or scene, "
                         "or a rig: .glb, .gltf");
  file->transform(exampleFiles())->type_name("");
  command
      .add_option("--motion", options->motion,
                  "Show how the joints of this .bvh, .glb or .fbx file would drive the rig's")
      ->type_name("FILE")
      ->check(endsIn({".bvh", ".gz", ".glb", ".gltf", ".vrm", ".vrma", ".fbx", ".dae"}))
      ->needs(file);
  command
      .add_option("--joint-map", options->joint_map, "Pairs of joints that win over the guesses")
      ->type_name("FILE");
  console.addFlags(command);
  command.footer(kInfoFooter);
  command.callback([options, &console] { info(*options, console); });
}

}  // namespace fascia
