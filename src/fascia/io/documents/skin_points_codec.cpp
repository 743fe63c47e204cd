#include <charconv>
#include <cmath>
#include <span>

#include <fascia/io/documents/character_codecs.h>
#include <fascia/skin/point/quantities.h>

namespace fascia {
namespace {

using Triple = std::array<float, 3>;

// Entries of a row: "0.01*12 0.012": numbers apart by spaces, *n repeats; triples are "x,y,z".
// Few JSON values, diffs that show the row that changed, and exact to the last bit.
std::string entryText(float value) {
  return shortestDigits(value);
}
std::string entryText(int value) {
  return std::to_string(value);
}
std::string entryText(const Triple& value) {
  return entryText(value[0]) + ',' + entryText(value[1]) + ',' + entryText(value[2]);
}

template <class Number>
bool parseNumber(const char*& at, const char* end, Number& value) {
  const auto [next, error] = std::from_chars(at, end, value);
  at = next;
  return error == std::errc();
}

bool parseEntry(const char*& at, const char* end, int& value) {
  return parseNumber(at, end, value);
}
bool parseEntry(const char*& at, const char* end, float& value) {
  return parseNumber(at, end, value) && std::isfinite(value);
}
bool parseEntry(const char*& at, const char* end, Triple& value) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (i > 0 && (at == end || *at++ != ',')) return false;
    if (!parseEntry(at, end, value[i])) return false;
  }
  return true;
}

bool inRange(const NumberRange& range, float value) {
  return range.contains(value);
}
bool inRange(const NumberRange& range, int value) {
  return range.contains(static_cast<double>(value));
}
bool inRange(const NumberRange& range, const Triple& value) {
  return inRange(range, value[0]) && inRange(range, value[1]) && inRange(range, value[2]);
}

// Same bits: -0 and 0 are not a run.
bool identical(float a, float b) {
  return a == b && std::signbit(a) == std::signbit(b);
}
bool identical(int a, int b) {
  return a == b;
}
bool identical(const Triple& a, const Triple& b) {
  return identical(a[0], b[0]) && identical(a[1], b[1]) && identical(a[2], b[2]);
}

template <class T>
std::string rowText(std::span<const T> row) {
  std::string out;
  for (std::size_t i = 0; i < row.size();) {
    std::size_t end = i + 1;
    while (end < row.size() && identical(row[end], row[i])) ++end;
    if (!out.empty()) out += ' ';
    out += entryText(row[i]);
    if (end - i > 1) out += '*' + std::to_string(end - i);
    i = end;
  }
  return out;
}

// Appends exactly `count` entries; a message if the row is otherwise.
template <class T>
std::string parseRow(const std::string& text, std::size_t count, const NumberRange& range,
                     std::vector<T>& out) {
  const char* at = text.data();
  const char* const end = at + text.size();
  std::size_t found = 0;
  while (at != end) {
    if (*at == ' ') {
      ++at;
      continue;
    }
    const char* const start = at;
    T value{};
    std::size_t repeat = 1;
    bool good = parseEntry(at, end, value);
    if (good && at != end && *at == '*') good = parseNumber(++at, end, repeat) && repeat > 0;
    good = good && (at == end || *at == ' ');
    if (!good) {
      return "found " + shown(std::string_view(start, static_cast<std::size_t>(end - start))) +
             ", expected entries like \"0.01*12 0.012\"";
    }
    if (!inRange(range, value)) return "found " + entryText(value) + ", expected " + range.text();
    if (repeat > count - found) return "expected " + std::to_string(count) + " entries, found more";
    out.insert(out.end(), repeat, value);
    found += repeat;
  }
  if (found == count) return {};
  return "found " + std::to_string(found) + " entries, expected " + std::to_string(count);
}

template <class T>
void readRows(const Json& json, const JsonPath& path, Reading& reading, const NumberRange& range,
              const SkinPointsDef& grid, SharedList<T>& list) {
  std::vector<T>& out = list.edit();
  const auto columns = static_cast<std::size_t>(grid.columns);
  const auto rows = static_cast<std::size_t>(grid.rows);
  if constexpr (std::is_same_v<T, float>) {
    double uniform = 0;
    if (json.is(Json::Kind::number)) {
      if (!readNumber(json, path, reading, range, uniform)) return;
      float value = 0;
      const std::string& digits = json.digits();
      std::from_chars(digits.data(), digits.data() + digits.size(), value);
      out.assign(columns * rows, value);
      return;
    }
  }
  if (!reading.expect(json, Json::Kind::list, path)) return;
  if (json.list().size() != rows) {
    reading.unexpected(json, path, "one text per row: " + std::to_string(rows));
    return;
  }
  for (std::size_t j = 0; j < rows; ++j) {
    const Json& row = json.list()[j];
    if (!reading.expect(row, Json::Kind::text, path[j])) return;
    const std::string message = parseRow(row.text(), columns, range, out);
    if (!message.empty()) reading.fault(row, path[j], message);
  }
}

template <class T>
Json rowsJson(const std::vector<T>& values, const SkinPointsDef& grid, const std::string& name) {
  const auto columns = static_cast<std::size_t>(grid.columns);
  const auto rows = static_cast<std::size_t>(grid.rows);
  if (values.size() != columns * rows) {
    throw Error("skin points: " + name + " has " + std::to_string(values.size()) +
                " entries, expected " + std::to_string(columns * rows));
  }
  if constexpr (std::is_same_v<T, float>) {
    const std::string all = rowText(std::span<const T>(values));
    if (all.find(' ') == std::string::npos) return Json::Number{entryText(values[0])};
  }
  Json::List out;
  for (std::size_t j = 0; j < rows; ++j) {
    out.emplace_back(rowText(std::span<const T>(values).subspan(j * columns, columns)));
  }
  return out;
}

struct TripleList {
  const char* name;
  SharedList<Triple> SkinPointsDef::*member;
};
const TripleList kTripleLists[] = {
    {"anchor", &SkinPointsDef::anchor},
    {"rest_position_m", &SkinPointsDef::rest_position_m},
};
constexpr const char* kAnchorSolid = "anchor_solid";
constexpr NumberRange kAnchorRange{-1, static_cast<double>(kMostSolids)};
constexpr NumberRange kPlaceRange{-1e6, 1e6};

class SkinPointsCodec final : public Codec<SkinPointsDef> {
 public:
  void read(const Json& json, const JsonPath& path, Reading& reading,
            SkinPointsDef& value) const override {
    if (!reading.expect(json, Json::Kind::object, path)) return;
    if (!readGrid(json, path, reading, value)) return;
    for (const Json::Member& member : json.object()) {
      readMember(member, path[std::string_view(member.key)], reading, value);
    }
  }

  Json write(const SkinPointsDef& value) const override {
    Json out;
    out.set("columns", value.columns);
    out.set("rows", value.rows);
    for (const QuantityInfo& info : quantityInfos()) {
      const std::vector<float>& entries = pointValues(value, info.quantity);
      const std::string name(info.listKey);
      if (!entries.empty()) out.set(name, rowsJson(entries, value, name));
    }
    if (!value.anchor_solid.empty()) {
      out.set(kAnchorSolid, rowsJson(value.anchor_solid.values(), value, kAnchorSolid));
    }
    for (const TripleList& list : kTripleLists) {
      const std::vector<Triple>& entries = value.*list.member;
      if (!entries.empty()) out.set(list.name, rowsJson(entries, value, list.name));
    }
    return out;
  }

  Json schema() const override {
    Json side = integers({1, kMostGridPoints})->schema();  // a mesh has one long row
    Json properties;
    properties.set("columns", side);
    properties.set("rows", side);
    for (const QuantityInfo& info : quantityInfos()) {
      Json either;
      either.set("description", "One number for all, or a text per row: \"0.01*12 0.012\"");
      either.set("anyOf",
                 Json::List{numberSchema(info.uniform.range), rowsSchema("One text per row")});
      properties.set(std::string(info.listKey), std::move(either));
    }
    properties.set(kAnchorSolid, rowsSchema("Index of each point's solid; -1: no tissue"));
    properties.set("anchor", rowsSchema("Material coordinates x,y,z on that solid"));
    properties.set("rest_position_m", rowsSchema("x,y,z in the world, rest posture"));
    Json out;
    out.set("type", "object");
    out.set("properties", std::move(properties));
    out.set("required", Json::List{"columns", "rows"});
    out.set("additionalProperties", false);
    return out;
  }

  bool same(const SkinPointsDef&, const SkinPointsDef&) const override { return false; }

 private:
  static Json rowsSchema(const char* help) {
    Json item;
    item.set("type", "string");
    Json out;
    out.set("type", "array");
    out.set("description", help);
    out.set("maxItems", kMostGridPoints);
    out.set("items", std::move(item));
    return out;
  }

  static bool readGrid(const Json& json, const JsonPath& path, Reading& reading,
                       SkinPointsDef& value) {
    const CodecPtr<int> side = integers({1, kMostGridPoints});
    for (const auto& [name, target] :
         {std::pair{"columns", &value.columns}, std::pair{"rows", &value.rows}}) {
      const Json* found = json.find(name);
      if (!found) {
        reading.fault(json, path, "the key " + shown(name) + " is missing");
        return false;
      }
      side->read(*found, path[std::string_view(name)], reading, *target);
    }
    if (value.columns < 1 || value.rows < 1) return false;
    if (value.columns <= kMostGridPoints / value.rows) return true;
    reading.fault(json, path, "more than " + std::to_string(kMostGridPoints) + " points");
    return false;
  }

  static void readMember(const Json::Member& member, const JsonPath& path, Reading& reading,
                         SkinPointsDef& value) {
    if (member.key == "columns" || member.key == "rows") return;
    NearestName nearest(member.key);
    for (const QuantityInfo& info : quantityInfos()) {
      if (member.key == info.listKey) {
        return readRows(member.value, path, reading, info.uniform.range, value,
                        pointValues(value, info.quantity));
      }
      nearest.offer(info.listKey);
    }
    for (const TripleList& list : kTripleLists) {
      if (member.key == list.name) {
        return readRows(member.value, path, reading, kPlaceRange, value, value.*list.member);
      }
      nearest.offer(list.name);
    }
    if (member.key == kAnchorSolid) {
      return readRows(member.value, path, reading, kAnchorRange, value, value.anchor_solid);
    }
    nearest.offer(kAnchorSolid);
    reading.fault(member.value, path, "unknown key " + shown(member.key), nearest.hint());
  }
};

}  // namespace

CodecPtr<SkinPointsDef> skinPointsCodec() {
  return std::make_shared<SkinPointsCodec>();
}

}  // namespace fascia
