#include <fascia/io/character_file.h>

#include <fascia/io/character_codecs.h>
#include <fascia/io/file.h>
#include <fascia/io/rig_file.h>
#include <fascia/io/texture.h>

namespace fascia {
namespace {

constexpr const char* kVersionKey = "fascia";
constexpr const char* kKindKey = "kind";
constexpr const char* kSchemaKey = "$schema";  // editors look for it; we do not
constexpr const char* kCharacterKind = "character";

std::vector<Issue> inFile(std::vector<Issue> issues, const std::string& file) {
  for (Issue& issue : issues) issue.where.file = file;
  return issues;
}

// A file of another kind or version would only drown the person in faults: these come alone.
void checkHeader(const Json& root, Reading& reading) {
  const JsonPath top;
  if (!reading.expect(root, Json::Kind::object, top)) return;
  const Json* version = root.find(kVersionKey);
  if (!version) {
    reading.fault(root, top, "the key 'fascia' is missing",
                  "a character file starts with \"fascia\": 1");
    return;
  }
  const bool number = version->is(Json::Kind::number);
  if (number && version->number() > kCharacterFormat) {
    reading.fault(*version, top[kVersionKey],
                  "found format " + version->digits() + ", this program reads up to format " +
                      std::to_string(kCharacterFormat),
                  "a newer Fascia reads it");
  } else if (!number || version->number() != kCharacterFormat) {
    reading.unexpected(*version, top[kVersionKey], std::to_string(kCharacterFormat));
  }
  const Json* kind = root.find(kKindKey);
  if (kind && (!kind->is(Json::Kind::text) || kind->text() != kCharacterKind)) {
    reading.unexpected(*kind, top[kKindKey], "\"character\"");
  }
}

Json withoutHeader(Json root) {
  std::erase_if(root.object(), [](const Json::Member& member) {
    return member.key == kVersionKey || member.key == kKindKey || member.key == kSchemaKey;
  });
  return root;
}

}  // namespace

CharacterFile readCharacterText(std::string_view text, const std::string& file) {
  Reading reading;
  Json root = parseJson(text, JsonLimits{}, reading.issues);
  if (!reading.issues.empty()) throw Error(inFile(std::move(reading.issues), file));
  checkHeader(root, reading);
  if (!reading.issues.empty()) throw Error(inFile(std::move(reading.issues), file));
  root = withoutHeader(std::move(root));
  CharacterFile out;
  characterCodec()->read(root, {}, reading, out.def);
  if (!reading.issues.empty()) throw Error(inFile(std::move(reading.issues), file));
  out.lines = LineIndex(std::move(root), file);
  return out;
}

CharacterFile readCharacterFile(const std::string& path) {
  CharacterFile out = readCharacterText(readFile(path, JsonLimits{}.bytes), path);
  out.def.folder = folderOf(path);
  try {
    loadTexture(out.def);
    if (out.def.rig) out.def.rig->model = loadRig(out.def);
  } catch (const Error& error) {
    throw Error(out.lines.locate(error.issues()));
  }
  return out;
}

std::string characterText(const CharacterDef& def) {
  Json out;
  out.set(kVersionKey, kCharacterFormat);
  const Json body = characterCodec()->write(def);
  for (const Json::Member& member : body.object()) out.set(member.key, member.value);
  return printJson(out);
}

void writeCharacterFile(const CharacterDef& def, const std::string& path) {
  writeFileWhole(path, characterText(def));
}

std::string characterSchema() {
  Json out;
  out.set("$schema", "http://json-schema.org/draft-07/schema#");
  out.set("title", "Fascia character file, format " + std::to_string(kCharacterFormat));
  Json body = characterCodec()->schema();
  for (Json::Member& member : body.object()) {
    if (member.key == "properties") {
      Json version;
      version.set("const", kCharacterFormat);
      version.set("description", "The version of the format");
      Json kind;
      kind.set("const", kCharacterKind);
      kind.set("default", kCharacterKind);
      kind.set("description", "What the file holds");
      Json link;
      link.set("type", "string");
      link.set("description", "The address of this schema, for editors");
      Json::Object& properties = member.value.object();
      properties.insert(properties.begin(),
                        {{kVersionKey, version}, {kKindKey, kind}, {kSchemaKey, link}});
    }
    if (member.key == "required") {
      member.value.list().insert(member.value.list().begin(), kVersionKey);
    }
    out.set(std::move(member.key), std::move(member.value));
  }
  return printJson(out);
}

}  // namespace fascia
