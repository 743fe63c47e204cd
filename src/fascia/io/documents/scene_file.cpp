#include <fascia/io/documents/scene_file.h>

#include <fascia/io/documents/character_file.h>
#include <fascia/io/documents/document.h>
#include <fascia/io/documents/scene_codecs.h>
#include <fascia/io/file/file.h>
#include <fascia/io/file/inside_folder.h>
#include <fascia/io/rig_import/mesh_file.h>

namespace fascia {
namespace {

constexpr std::size_t kMostScriptBytes = 1 << 20;

// Told from the scene's file: where in the other file each fault is goes into the message.
void addFaults(const Error& error, const std::string& subject, const std::string& pointer,
               std::vector<Issue>& issues) {
  for (const Issue& fault : error.issues()) {
    Issue issue;
    issue.where.pointer = pointer;
    // insideFolder() knows the place, and names the subject itself.
    issue.message = fault.where.pointer == pointer ? fault.message : subject + " " + fault.text();
    issue.hint = fault.where.pointer == pointer ? fault.hint : std::string();
    issues.push_back(std::move(issue));
  }
}

// Runs `read` on the file's real place; what goes wrong is told from `pointer`.
template <class Read>
void readBeside(const SceneDef& def, const std::string& name, const std::string& subject,
                const std::string& pointer, std::vector<Issue>& issues, const Read& read) {
  try {
    read(insideFolder(def.folder, name, subject, pointer));
  } catch (const Error& error) {
    addFaults(error, subject, pointer, issues);
  }
}

void readOthers(SceneDef& def, const BuildOptions& options) {
  std::vector<Issue> issues;
  for (std::size_t i = 0; i < def.characters.size(); ++i) {
    SceneCharacterDef& character = def.characters[i];
    readBeside(def, character.file, "the character", "/characters/" + std::to_string(i) + "/file",
               issues, [&](const std::string& place) {
                 character.character =
                     std::make_shared<const Character>(loadCharacter(place, options));
               });
  }
  for (std::size_t i = 0; i < def.bodies.size(); ++i) {
    SceneBodyDef& body = def.bodies[i];
    if (body.form != SceneBodyDef::Form::mesh) continue;
    readBeside(def, body.mesh_file, "the mesh", "/bodies/" + std::to_string(i) + "/mesh", issues,
               [&](const std::string& place) {
                 body.mesh = std::make_shared<const TriangleMesh>(readMeshFile(place));
               });
  }
  if (!def.script.empty())
    readBeside(def, def.script, "the script", "/script", issues, [&](const std::string& place) {
      def.script_text = readFile(place, kMostScriptBytes);
    });
  if (!issues.empty()) throw Error(std::move(issues));
}

}  // namespace

SceneFile readSceneText(std::string_view text, const std::string& file) {
  SceneFile out;
  out.def = readDocument(text, kSceneKind, *sceneCodec(), file, out.lines);
  return out;
}

SceneFile readSceneFile(const std::string& path, const BuildOptions& options) {
  SceneFile out = readSceneText(readFile(path, JsonLimits{}.bytes), path);
  out.def.folder = folderOf(path);
  try {
    readOthers(out.def, options);
  } catch (const Error& error) {
    throw Error(out.lines.locate(error.issues()));
  }
  return out;
}

Stage loadStage(const std::string& path, const BuildOptions& options) {
  SceneFile file = readSceneFile(path, options);
  if (options.step_s > 0) file.def.simulation.step_s = options.step_s;
  try {
    Stage stage(std::move(file.def));
    stage.setWarnings(file.lines.locate(stage.warnings()));
    return stage;
  } catch (const Error& error) {
    throw Error(file.lines.locate(error.issues()));
  }
}

std::string sceneText(const SceneDef& def) {
  return documentText(kSceneKind, sceneCodec()->write(def));
}

void writeSceneFile(const SceneDef& def, const std::string& path) {
  writeFileWhole(path, sceneText(def));
}

std::string sceneSchema() {
  return documentSchema(kSceneKind, "Fascia scene file", sceneCodec()->schema());
}

bool isSceneFile(const std::string& path) {
  return documentKind(readFile(path, JsonLimits{}.bytes)) == kSceneKind;
}

}  // namespace fascia
