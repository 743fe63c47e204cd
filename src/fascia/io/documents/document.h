#pragma once

#include <string>
#include <string_view>

#include <fascia/io/documents/codec.h>
#include <fascia/io/json/line_tree.h>

namespace fascia {

// What all *.fascia.json files have in common: a version, and a kind.

// The version of the format that we write, and the newest that we read.
inline constexpr int kDocumentFormat = 1;

inline constexpr std::string_view kCharacterKind = "character", kSceneKind = "scene";

// A document without its header. Throws Error: no JSON, another version, another kind. `file` is
// what messages call it.
Json parseDocument(std::string_view text, std::string_view kind, const std::string& file);

// Reads a whole document by its codec. Throws Error with every fault: file, line, JSON pointer.
// `lines` gives faults that building finds a file and a line.
template <class T>
T readDocument(std::string_view text, std::string_view kind, const Codec<T>& codec,
               const std::string& file, LineIndex& lines) {
  Json body = parseDocument(text, kind, file);
  Reading reading;
  T def;
  codec.read(body, {}, reading, def);
  for (Issue& issue : reading.issues) issue.where.file = file;
  if (!reading.issues.empty()) throw Error(std::move(reading.issues));
  lines =
      LineIndex(std::make_shared<const LineIndex::Tree>(LineIndex::Tree{std::move(body)}), file);
  return def;
}

// The kind that a text says it is, "character" if it does not say; that of a text that is no JSON
// is "character" too: reading it then tells what is wrong.
std::string documentKind(std::string_view text);

// The text of a document. Throws Error if it holds NaN or infinities.
std::string documentText(std::string_view kind, const Json& body);
// The published JSON Schema (draft-07) of documents of a kind.
std::string documentSchema(std::string_view kind, const std::string& title, Json body);

}  // namespace fascia
