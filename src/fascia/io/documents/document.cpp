#include <fascia/io/documents/document.h>

namespace fascia {
namespace {

constexpr const char* kVersionKey = "fascia";
constexpr const char* kKindKey = "kind";
constexpr const char* kSchemaKey = "$schema";  // editors look for it; we do not

std::vector<Issue> inFile(std::vector<Issue> issues, const std::string& file) {
  for (Issue& issue : issues) issue.where.file = file;
  return issues;
}

// Without a kind a document is a character: the first files had none.
std::string_view kindOf(const Json& root) {
  const Json* kind = root.find(kKindKey);
  return kind && kind->is(Json::Kind::text) ? std::string_view(kind->text()) : kCharacterKind;
}

// A file of another kind or version would only drown the person in faults: these come alone.
void checkHeader(const Json& root, std::string_view wanted, Reading& reading) {
  const JsonPath top;
  if (!reading.expect(root, Json::Kind::object, top)) return;
  const Json* version = root.find(kVersionKey);
  if (!version) {
    reading.fault(root, top, "the key 'fascia' is missing",
                  std::string("a ") + std::string(wanted) + " file starts with \"fascia\": 1");
    return;
  }
  const bool number = version->is(Json::Kind::number);
  if (number && version->number() > kDocumentFormat) {
    reading.fault(*version, top[kVersionKey],
                  "found format " + version->digits() + ", this program reads up to format " +
                      std::to_string(kDocumentFormat),
                  "a newer Fascia reads it");
  } else if (!number || version->number() != kDocumentFormat) {
    reading.unexpected(*version, top[kVersionKey], std::to_string(kDocumentFormat));
  }
  const Json* kind = root.find(kKindKey);
  if (kind && (!kind->is(Json::Kind::text) || kind->text() != wanted)) {
    reading.unexpected(*kind, top[kKindKey], jsonText(wanted));
  } else if (!kind && wanted != kCharacterKind) {
    reading.fault(root, top, "the key 'kind' is missing",
                  std::string("write \"kind\": ") + jsonText(wanted));
  }
}

Json withoutHeader(Json root) {
  std::erase_if(root.object(), [](const Json::Member& member) {
    return member.key == kVersionKey || member.key == kKindKey || member.key == kSchemaKey;
  });
  return root;
}

Json headerProperty(std::string_view kind) {
  Json out;
  out.set("const", kind);
  if (kind == kCharacterKind) out.set("default", kind);
  out.set("description", "What the file holds");
  return out;
}

}  // namespace

Json parseDocument(std::string_view text, std::string_view kind, const std::string& file) {
  Reading reading;
  Json root = parseJson(text, JsonLimits{}, reading.issues);
  if (!reading.issues.empty()) throw Error(inFile(std::move(reading.issues), file));
  checkHeader(root, kind, reading);
  if (!reading.issues.empty()) throw Error(inFile(std::move(reading.issues), file));
  return withoutHeader(std::move(root));
}

std::string documentKind(std::string_view text) {
  std::vector<Issue> issues;
  const Json root = parseJson(text, JsonLimits{}, issues);
  return std::string(issues.empty() ? kindOf(root) : kCharacterKind);
}

std::string documentText(std::string_view kind, const Json& body) {
  Json out;
  out.set(kVersionKey, kDocumentFormat);
  if (kind != kCharacterKind) out.set(kKindKey, kind);
  for (const Json::Member& member : body.object()) out.set(member.key, member.value);
  return printJson(out);
}

std::string documentSchema(std::string_view kind, const std::string& title, Json body) {
  Json out;
  out.set("$schema", "http://json-schema.org/draft-07/schema#");
  out.set("title", title + ", format " + std::to_string(kDocumentFormat));
  for (Json::Member& member : body.object()) {
    if (member.key == "properties") {
      Json version;
      version.set("const", kDocumentFormat);
      version.set("description", "The version of the format");
      Json link;
      link.set("type", "string");
      link.set("description", "The address of this schema, for editors");
      Json::Object& properties = member.value.object();
      properties.insert(
          properties.begin(),
          {{kVersionKey, version}, {kKindKey, headerProperty(kind)}, {kSchemaKey, link}});
    }
    if (member.key == "required") {
      Json::List& required = member.value.list();
      if (kind != kCharacterKind) required.insert(required.begin(), kKindKey);
      required.insert(required.begin(), kVersionKey);
    }
    out.set(std::move(member.key), std::move(member.value));
  }
  return printJson(out);
}

}  // namespace fascia
