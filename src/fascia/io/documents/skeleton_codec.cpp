#include <fascia/io/documents/character_codecs.h>
#include <fascia/io/documents/tunable_fields.h>

namespace fascia {
namespace {

constexpr Dof kDofs[] = {Dof::tx, Dof::ty, Dof::tz, Dof::rx, Dof::ry, Dof::rz};
constexpr double kUnlimited = 1e9;  // the default of DofDef's min and max, in memory's units

// {"rx": [-30, 30], "ty": {"min_m": 0, "max_m": 1, "rest_m": 0.5}, "rz": {}}: {} has no limits.
class DofsCodec final : public Codec<std::vector<DofDef>> {
 public:
  void read(const Json& json, const JsonPath& path, Reading& reading,
            std::vector<DofDef>& value) const override {
    if (!reading.expect(json, Json::Kind::object, path)) return;
    value.clear();
    for (const Json::Member& member : json.object()) {
      const JsonPath at = path[std::string_view(member.key)];
      if (const std::optional<Dof> dof = dofFromName(member.key)) {
        DofDef def{*dof, -kUnlimited, kUnlimited, 0};
        readOne(member.value, at, reading, def);
        value.push_back(def);
      } else {
        reading.fault(member.value, at, "unknown degree of freedom " + shown(member.key),
                      "expected one of tx, ty, tz, rx, ry, rz");
      }
    }
  }

  Json write(const std::vector<DofDef>& value) const override {
    Json out{Json::Object{}};
    for (const DofDef& def : value) out.set(std::string(name(def.dof)), writeOne(def));
    return out;
  }

  Json schema() const override {
    Json properties;
    for (const Dof dof : kDofs) properties.set(std::string(name(dof)), oneSchema(dof));
    Json out;
    out.set("type", "object");
    out.set("properties", std::move(properties));
    out.set("additionalProperties", false);
    return out;
  }

  bool same(const std::vector<DofDef>& a, const std::vector<DofDef>& b) const override {
    return a.empty() && b.empty();
  }

 private:
  static void readOne(const Json& json, const JsonPath& path, Reading& reading, DofDef& def) {
    if (json.is(Json::Kind::list) && json.list().size() == 2) {
      readDofValue(def.dof, json.list()[0], path[0], reading, def.min);
      readDofValue(def.dof, json.list()[1], path[1], reading, def.max);
    } else if (json.is(Json::Kind::object)) {
      readObject(json, path, reading, def);
    } else {
      reading.unexpected(json, path, "[min, max] or an object with min, max and rest");
    }
  }

  static void readObject(const Json& json, const JsonPath& path, Reading& reading, DofDef& def) {
    const std::string unit = '_' + dofUnit(def.dof);
    const std::pair<std::string, double*> known[] = {
        {"min" + unit, &def.min}, {"max" + unit, &def.max}, {"rest" + unit, &def.rest}};
    for (const Json::Member& member : json.object()) {
      const JsonPath at = path[std::string_view(member.key)];
      NearestName nearest(member.key);
      bool found = false;
      for (const auto& [key, target] : known) {
        nearest.offer(key);
        if (key != member.key) continue;
        readDofValue(def.dof, member.value, at, reading, *target);
        found = true;
      }
      if (!found) {
        reading.fault(member.value, at, "unknown key " + shown(member.key), nearest.hint());
      }
    }
  }

  static Json writeOne(const DofDef& def) {
    const bool limited = def.min != -kUnlimited && def.max != kUnlimited;
    if (limited && def.rest == 0) {
      return Json::List{dofJson(def.dof, def.min), dofJson(def.dof, def.max)};
    }
    const std::string unit = '_' + dofUnit(def.dof);
    Json out{Json::Object{}};
    if (def.min != -kUnlimited) out.set("min" + unit, dofJson(def.dof, def.min));
    if (def.max != kUnlimited) out.set("max" + unit, dofJson(def.dof, def.max));
    if (def.rest != 0) out.set("rest" + unit, dofJson(def.dof, def.rest));
    return out;
  }

  static Json oneSchema(Dof dof) {
    const std::string unit = '_' + dofUnit(dof);
    Json pair;
    pair.set("type", "array");
    pair.set("description", isRotation(dof) ? "[min, max] in degrees" : "[min, max] in metres");
    pair.set("minItems", 2);
    pair.set("maxItems", 2);
    pair.set("items", numberSchema(dofInfo(dof).range));
    Json properties;
    for (const char* key : {"min", "max", "rest"}) {
      properties.set(key + unit, numberSchema(dofInfo(dof).range));
    }
    Json full;
    full.set("type", "object");
    full.set("properties", std::move(properties));
    full.set("additionalProperties", false);
    Json out;
    out.set("description", isRotation(dof)
                               ? "Turning about this axis: limits, and the value at rest"
                               : "Moving along this axis: limits, and the value at rest");
    out.set("anyOf", Json::List{std::move(pair), std::move(full)});
    return out;
  }
};

}  // namespace

std::string dofUnit(Dof dof) {
  return isRotation(dof) ? "deg" : "m";
}

Json dofJson(Dof dof, double value) {
  return isRotation(dof) ? Json(Json::Number{degreesDigits(value)}) : Json(value);
}

bool readDofValue(Dof dof, const Json& json, const JsonPath& path, Reading& reading,
                  double& value) {
  const NumberRange& range = dofInfo(dof).range;
  return isRotation(dof) ? readAngle(json, path, reading, range, value)
                         : readNumber(json, path, reading, range, value);
}

CodecPtr<Dof> dofCodec() {
  std::vector<std::pair<Dof, std::string>> all;
  for (const Dof dof : kDofs) all.emplace_back(dof, std::string(name(dof)));
  return words(std::move(all));
}

CodecPtr<JointDef> jointCodec() {
  using Object = ObjectCodec<JointDef>;
  auto codec = std::make_shared<Object>("A joint: a frame in its parent's frame.");
  codec->field("name", &JointDef::name, names(), "The joint's name", Object::Need::required)
      .field("parent", &JointDef::parent, texts(200), "The parent's name; none for the root");
  addTunables<JointDef>(*codec);
  codec->field("dofs", &JointDef::dofs, std::make_shared<DofsCodec>(),
               "Degrees of freedom: translation first, then Rz Ry Rx");
  return codec;
}

}  // namespace fascia
