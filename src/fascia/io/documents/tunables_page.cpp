#include <fascia/io/documents/tunables_page.h>

#include <fascia/field/registry.h>
#include <fascia/io/documents/all_tunables.h>
#include <fascia/io/documents/tunable_fields.h>

namespace fascia {
namespace {

constexpr const char* kHead = R"(# Everything you can set

Made from the tables that the reader, the builder and the [JSON Schema](../schema) go by: what is out of
its range is refused, with file, line and place. A `*` in a place stands for any index. Files hold degrees
where a key says `_deg`. What a file leaves out has the default.

)";

constexpr const char* kTableHead =
    "| key | unit | range | default | what it does |\n|---|---|---|---|---|\n";

std::string line(std::string_view key, std::string_view unit, const std::string& range,
                 const std::string& standard, std::string_view help) {
  std::string out = "| `";
  out += key;
  out += "` | ";
  out += unit.empty() ? "–" : unit;
  out += " | " + range + " | " + standard + " | ";
  out += help;
  return out + " |\n";
}

std::string rangeText(const NumberRange& range) {
  return range.text().substr(std::string_view("a number in ").size());
}

std::string asText(const Json& json) {
  if (json.is(Json::Kind::null)) return "none";
  std::string text = printJson(json);
  text.erase(text.find_last_not_of('\n') + 1);
  return text;
}

template <class T, class M>
std::string rowLine(const Tunable<T, M>& row, const M& standard) {
  const std::string range = std::is_same_v<M, bool> ? "true, false" : rangeText(row.range);
  const std::string value =
      row.isRequired ? "must be given" : asText(codecOf(row)->write(standard));
  return line(row.key, row.unit, range, value, row.help);
}

template <class T>
std::string rowLine(const WordTunable<T>& row, const std::string& standard) {
  std::string all;
  for (const std::string_view word : row.words())
    all += (all.empty() ? "" : ", ") + std::string(word);
  return line(row.key, {}, all, standard, row.help);
}

std::string infoLine(const TunableInfo& row, const std::string& standard) {
  return line(row.key, row.unit, rangeText(row.range), standard, row.help);
}

// Rows that files hold in another form than a key and its value, at the place of a table.
std::string otherRows(std::string_view place) {
  const auto side = [](int count) { return std::to_string(count); };
  if (place == "/skeleton/*")
    return infoLine(kDofAngle, "no limits, 0") + infoLine(kDofShift, "no limits, 0");
  if (place == "/solids/*/soft" || place == "/bodies/*")
    return infoLine(kBasisOrder, side(BodyBasisDef{}.order)) +
           infoLine(kBasisCells, "affine, without cells");
  if (place == "/skin")
    return infoLine(kGridSide,
                    '[' + side(SkinGridDef{}.columns) + ", " + side(SkinGridDef{}.rows) + ']');
  if (place == "/skin/regions/*")
    return infoLine(kRegionU, "[0, 1]") + infoLine(kRegionV, "[0, 1]");
  if (place == "/motions/*/tracks/*/keys/*") return infoLine(kKeyValue, "must be given");
  return {};
}

std::string outlineRows() {
  const SceneBodyDef body;
  return rowLine(kSmoothOutline, body.smooth_outline) + rowLine(kPlateThickness, body.thickness_m) +
         rowLine(kInflated, body.inflated);
}

template <class Def>
std::string section(const std::string& place) {
  std::string out = "### `" + place + "`\n\n" + kTableHead;
  const Def standard{};
  forEachTunable<Def>([&](const auto& row) { out += rowLine(row, standard.*row.member); });
  out += otherRows(place);
  if (place == "/bodies/*") out += outlineRows();
  return out + '\n';
}

std::string parameterLine(const ParameterInfo& info) {
  const auto inFile = [&](double value) {
    return isAngleName(info.name) ? degreesDigits(value) : shortestText(value);
  };
  const std::string key = fileName(info.name);
  const std::string_view unit = key.ends_with("_deg") ? "deg" : key.ends_with("_m") ? "m" : "";
  return line(key, unit, '[' + inFile(info.min) + ", " + inFile(info.max) + ']',
              inFile(info.standard), info.help);
}

template <class List>
std::string kinds(const List& list) {
  std::string out;
  for (const auto* kind : list) {
    out += "### `" + std::string(kind->name()) + "`\n\n" + kTableHead;
    for (const ParameterInfo& info : kind->parameters()) out += parameterLine(info);
    out += '\n';
  }
  return out;
}

}  // namespace

std::string tunablesPage() {
  std::string out = kHead;
  const auto add = [&]<class Def>(std::type_identity<Def>, const std::string& place) {
    out += section<Def>(place);
  };
  out += "## Characters\n\n";
  forEachCharacterTable(add);
  out += "## Scenes\n\n";
  forEachSceneTable(add);
  out += "## Shapes of solids\n\n" + kinds(shapes());
  out += "## Deformations of solids\n\n" + kinds(deformations());
  out.pop_back();
  return out;
}

}  // namespace fascia
