#include <fascia/io/documents/body_codec.h>
#include <fascia/io/documents/character_codecs.h>
#include <fascia/io/documents/solid_members.h>
#include <fascia/io/documents/tunable_fields.h>

namespace fascia {
namespace {

// [[jointValue, parameter], …] in the joint's and the parameter's file units.
Json driverPointsJson(const DriverDef& def) {
  Json::List out;
  for (const DriverDef::Point& point : def.points) {
    out.emplace_back(Json::List{dofJson(def.dof, point.jointValue),
                                parameterJson(def.parameter, point.parameter)});
  }
  return out;
}

// Points depend on the joint's unit and the parameter's, so they are read with the whole driver.
class DriverCodec final : public ObjectCodec<DriverDef> {
 public:
  DriverCodec() : ObjectCodec("A joint value drives a parameter of this solid.") {
    field("parameter", &DriverDef::parameter, std::make_shared<ParameterNameCodec>(),
          "The driven parameter: \"radius_m\", or \"taper.amount\"", Need::required);
    field("joint", &DriverDef::joint, names(), "The driving joint", Need::required);
    field("dof", &DriverDef::dof, dofCodec(), "Its degree of freedom", Need::required);
    field("interpolation", &DriverDef::interpolation,
          words<DriverDef::Interpolation>({{DriverDef::Interpolation::piecewise, "piecewise"},
                                           {DriverDef::Interpolation::smooth, "smooth"}}),
          "Straight pieces, or a smooth curve that never overshoots");
  }

  void read(const Json& json, const JsonPath& path, Reading& reading,
            DriverDef& value) const override {
    ObjectCodec::read(json, path, reading, value);
    if (json.is(Json::Kind::object) && !json.find("points")) {
      reading.fault(json, path, "the key 'points' is missing");
    }
  }

 protected:
  bool readOther(const Json& whole, const Json::Member& member, const JsonPath& path,
                 Reading& reading, DriverDef& driver) const override {
    if (member.key != "points") return false;
    if (!reading.expect(member.value, Json::Kind::list, path)) return true;
    const Dof dof = dofFromName(textOf(whole, "dof", "rx")).value_or(Dof::rx);
    const std::string parameter = memoryName(textOf(whole, "parameter", {}));
    const Json::List& points = member.value.list();
    if (points.size() < 2 || points.size() > DriverDef::kMost) {
      reading.unexpected(member.value, path,
                         "2 to " + std::to_string(DriverDef::kMost) + " points");
      return true;
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Json& pair = points[i];
      if (!pair.is(Json::Kind::list) || pair.list().size() != 2) {
        reading.unexpected(pair, path[i], "[joint value, parameter]");
        continue;
      }
      DriverDef::Point point{};
      const JsonPath at = path[i];
      readDofValue(dof, pair.list()[0], at[0], reading, point.jointValue);
      readParameter(parameter, pair.list()[1], at[1], reading, kKeyValue.range, point.parameter);
      driver.points.push_back(point);
    }
    return true;
  }
  void offerOthers(const Json&, NearestName& nearest) const override { nearest.offer("points"); }
  void writeOthers(const DriverDef& driver, Json& out) const override {
    out.set("points", driverPointsJson(driver));
  }
  void schemaOthers(Json& properties) const override {
    Json pair;
    pair.set("type", "array");
    pair.set("minItems", 2);
    pair.set("maxItems", 2);
    pair.set("items", numberSchema({}));
    Json points;
    points.set("type", "array");
    points.set(
        "description",
        "[joint value, parameter] with increasing joint value: degrees for rotations, metres "
        "for translations; constant outside");
    points.set("minItems", 2);
    points.set("maxItems", static_cast<int>(DriverDef::kMost));
    points.set("items", std::move(pair));
    properties.set("points", std::move(points));
  }

 private:
  class ParameterNameCodec final : public Codec<std::string> {
   public:
    void read(const Json& json, const JsonPath& path, Reading& reading,
              std::string& value) const override {
      if (reading.expect(json, Json::Kind::text, path)) value = memoryName(json.text());
    }
    Json write(const std::string& value) const override { return fileName(value); }
    Json schema() const override { return names()->schema(); }
    bool same(const std::string& a, const std::string& b) const override { return a == b; }
  };
};

CodecPtr<SoftSolidDef> softCodec() {
  auto codec = std::make_shared<ObjectCodec<SoftSolidDef>>(
      "This solid is a soft body that sags, lags and jiggles (Witkin & Welch 1990).");
  codec->field("basis", &SoftSolidDef::basis, bodyBasisCodec(),
               "Which shapes it takes: affine stretches and shears, quadratic bends too");
  addTunables<BodyMaterialDef>(*codec);
  codec->field("held_m", &SoftSolidDef::held_m,
               listOf<Vec3>(vectors({-1e6, 1e6}), kMostHeldPoints, Vec3::Zero()),
               "Points in the solid's frame that the joint carries; otherwise some at the end "
               "nearest to the joint");
  return codec;
}

class SolidCodec final : public SolidOwnerCodec<FleshSolidDef> {
 public:
  SolidCodec() : SolidOwnerCodec("A solid on a joint, with the parameters of its shape.") {
    field("name", &FleshSolidDef::name, names(), "The solid's name", Need::required);
    field("joint", &FleshSolidDef::joint, names(), "The joint it moves with", Need::required);
    addTunables<FleshSolidDef>(*this);
    field("color", &FleshSolidDef::color, colors(), "Its colour in the layer view");
    field("drivers", &FleshSolidDef::drivers,
          listOf<DriverDef>(std::make_shared<DriverCodec>(), kMaxListed),
          "Parameters that joint values drive");
    field("soft", &FleshSolidDef::soft, optionally(softCodec()), "");
  }
};

}  // namespace

CodecPtr<FleshSolidDef> solidCodec() {
  return std::make_shared<SolidCodec>();
}

}  // namespace fascia
