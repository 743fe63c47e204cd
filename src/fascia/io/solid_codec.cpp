#include <algorithm>
#include <iterator>

#include <fascia/io/body_codec.h>
#include <fascia/io/character_codecs.h>

namespace fascia {
namespace {

using ParameterList = std::span<const ParameterInfo>;

// Parameters of a shape or deformation stand beside the fixed keys, under their own names.
const ParameterInfo* findParameter(ParameterList list, std::string_view memory) {
  for (const ParameterInfo& info : list) {
    if (info.name == memory) return &info;
  }
  return nullptr;
}

std::vector<double> standardValues(ParameterList list) {
  std::vector<double> values;
  for (const ParameterInfo& info : list) values.push_back(info.standard);
  return values;
}

void readInto(ParameterList list, const Json::Member& member, const JsonPath& path,
              Reading& reading, std::vector<double>& values) {
  const ParameterInfo* info = findParameter(list, memoryName(member.key));
  const auto index = static_cast<std::size_t>(info - list.data());
  if (values.size() < list.size()) values = standardValues(list);
  readParameter(info->name, member.value, path, reading, {info->min, info->max}, values[index]);
}

void writeFrom(ParameterList list, const std::vector<double>& values, Json& out) {
  for (std::size_t i = 0; i < list.size() && i < values.size(); ++i) {
    if (values[i] == list[i].standard) continue;
    out.set(fileName(list[i].name), parameterJson(list[i].name, values[i]));
  }
}

// One property per name; shapes that share a name share the widest range.
void addToSchema(const std::string& owner, ParameterList list, Json& properties) {
  for (const ParameterInfo& info : list) {
    const std::string key = fileName(info.name);
    const bool angle = isAngleName(info.name);
    const NumberRange range =
        angle ? NumberRange{degrees(info.min), degrees(info.max)} : NumberRange{info.min, info.max};
    std::string help = owner;
    help += ": ";
    help += info.help;
    help += "; normally ";
    help += shortestDigits(angle ? degrees(info.standard) : info.standard);
    Json* known = nullptr;
    for (Json::Member& member : properties.object()) {
      if (member.key == key) known = &member.value;
    }
    if (!known) {
      Json property;
      property.set("type", "number");
      property.set("minimum", range.min);
      property.set("maximum", range.max);
      property.set("description", help);
      properties.set(key, std::move(property));
      continue;
    }
    for (Json::Member& member : known->object()) {
      if (member.key == "minimum") member.value = std::min(member.value.number(), range.min);
      if (member.key == "maximum") member.value = std::max(member.value.number(), range.max);
      if (member.key == "description") member.value = member.value.text() + ". " + help;
    }
  }
}

template <class T>
CodecPtr<std::string> typeNames(std::span<const T* const> all) {
  std::vector<std::pair<std::string, std::string>> known;
  for (const T* entry : all) known.emplace_back(entry->name(), entry->name());
  return words(std::move(known));
}

std::string textOf(const Json& object, std::string_view key, const std::string& otherwise) {
  const Json* found = object.find(key);
  return found && found->is(Json::Kind::text) ? found->text() : otherwise;
}

class StepCodec final : public ObjectCodec<SolidDef::Step> {
 public:
  StepCodec() : ObjectCodec("A global deformation along the solid's z axis (Barr 1984).") {
    field("type", &SolidDef::Step::type, typeNames(fascia::deformations()), "Which deformation",
          Need::required);
  }

 protected:
  bool readOther(const Json& whole, const Json::Member& member, const JsonPath& path,
                 Reading& reading, SolidDef::Step& step) const override {
    const ParameterList list = parametersOf(whole);
    if (!findParameter(list, memoryName(member.key))) return false;
    readInto(list, member, path, reading, step.parameters);
    return true;
  }
  void offerOthers(const Json& whole, NearestName& nearest) const override {
    for (const ParameterInfo& info : parametersOf(whole)) nearest.offer(fileName(info.name));
  }
  void writeOthers(const SolidDef::Step& step, Json& out) const override {
    if (const Deformation* type = findDeformation(step.type)) {
      writeFrom(type->parameters(), step.parameters, out);
    }
  }
  void schemaOthers(Json& properties) const override {
    for (const Deformation* type : fascia::deformations()) {
      addToSchema(std::string(type->name()), type->parameters(), properties);
    }
  }

 private:
  static ParameterList parametersOf(const Json& whole) {
    const Deformation* type = findDeformation(textOf(whole, "type", {}));
    return type ? type->parameters() : ParameterList{};
  }
};

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
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Json& pair = points[i];
      if (!pair.is(Json::Kind::list) || pair.list().size() != 2) {
        reading.unexpected(pair, path[i], "[joint value, parameter]");
        continue;
      }
      DriverDef::Point point{};
      const JsonPath at = path[i];
      readDofValue(dof, pair.list()[0], at[0], reading, point.jointValue);
      readParameter(parameter, pair.list()[1], at[1], reading, {}, point.parameter);
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
    pair.set("items", NumberRange{}.schema());
    Json points;
    points.set("type", "array");
    points.set(
        "description",
        "[joint value, parameter] with increasing joint value: degrees for rotations, metres "
        "for translations; constant outside");
    points.set("minItems", 2);
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
  constexpr std::size_t kMaxHeld = 64;
  auto codec = std::make_shared<ObjectCodec<SoftSolidDef>>(
      "This solid is a soft body that sags, lags and jiggles (Witkin & Welch 1990).");
  codec->field("basis", &SoftSolidDef::basis, bodyBasisCodec(),
               "Which shapes it takes: affine stretches and shears, quadratic bends too");
  addMaterialFields(*codec);
  codec->field("held_m", &SoftSolidDef::held_m,
               listOf<Vec3>(vectors({-1e6, 1e6}), kMaxHeld, Vec3::Zero()),
               "Points in the solid's frame that the joint carries; otherwise some at the end "
               "nearest to the joint");
  return codec;
}

// The order in which a person reads a solid: what it is before where it is.
int rank(std::string_view key) {
  static constexpr std::string_view kFirst[] = {"name", "joint", "shape"};
  static constexpr std::string_view kLast[] = {"position_m",   "orientation_deg", "color",
                                               "deformations", "drivers",         "soft"};
  const auto first = std::find(std::begin(kFirst), std::end(kFirst), key) - std::begin(kFirst);
  if (first < std::ssize(kFirst)) return static_cast<int>(first) - 10;
  const auto last = std::find(std::begin(kLast), std::end(kLast), key) - std::begin(kLast);
  return last < std::ssize(kLast) ? static_cast<int>(last) + 10 : 0;
}

class SolidCodec final : public ObjectCodec<FleshSolidDef> {
 public:
  SolidCodec() : ObjectCodec("A solid on a joint, with the parameters of its shape.") {
    field("name", &FleshSolidDef::name, names(), "The solid's name", Need::required);
    field("joint", &FleshSolidDef::joint, names(), "The joint it moves with", Need::required);
    field("position_m", &FleshSolidDef::position_m, vectors({-1e6, 1e6}), "In the joint's frame");
    field("orientation_deg", &FleshSolidDef::orientation_rad, angleVectors(),
          "Turns about x, y, z; applied as Rz Ry Rx");
    field("color", &FleshSolidDef::color, colors(), "Its colour in the layer view");
    field("drivers", &FleshSolidDef::drivers,
          listOf<DriverDef>(std::make_shared<DriverCodec>(), kMaxListed),
          "Parameters that joint values drive");
    field("soft", &FleshSolidDef::soft, optionally(softCodec()), "");
  }

  Json write(const FleshSolidDef& value) const override {
    Json out = ObjectCodec::write(value);
    std::stable_sort(
        out.object().begin(), out.object().end(),
        [](const Json::Member& a, const Json::Member& b) { return rank(a.key) < rank(b.key); });
    return out;
  }

 protected:
  bool readOther(const Json& whole, const Json::Member& member, const JsonPath& path,
                 Reading& reading, FleshSolidDef& value) const override {
    SolidDef& solid = value.solid;
    if (member.key == "shape") {
      shape_->read(member.value, path, reading, solid.shape);
      return true;
    }
    if (member.key == "deformations") {
      steps_->read(member.value, path, reading, solid.deformations);
      return true;
    }
    const Shape* shape = findShape(textOf(whole, "shape", SolidDef{}.shape));
    if (!shape) return isParameterOfAny(member.key);  // the unknown shape is fault enough
    if (!findParameter(shape->parameters(), memoryName(member.key))) return false;
    readInto(shape->parameters(), member, path, reading, solid.parameters);
    return true;
  }
  void offerOthers(const Json& whole, NearestName& nearest) const override {
    nearest.offer("shape");
    nearest.offer("deformations");
    if (const Shape* shape = findShape(textOf(whole, "shape", SolidDef{}.shape))) {
      for (const ParameterInfo& info : shape->parameters()) nearest.offer(fileName(info.name));
    }
  }
  void writeOthers(const FleshSolidDef& value, Json& out) const override {
    out.set("shape", value.solid.shape);
    if (const Shape* shape = findShape(value.solid.shape)) {
      writeFrom(shape->parameters(), value.solid.parameters, out);
    }
    if (!value.solid.deformations.empty()) {
      out.set("deformations", steps_->write(value.solid.deformations));
    }
  }
  void schemaOthers(Json& properties) const override {
    Json shape = shape_->schema();
    shape.set("description", "Which shape");
    shape.set("default", SolidDef{}.shape);
    properties.set("shape", std::move(shape));
    Json steps = steps_->schema();
    steps.set("description", "Deformations, applied in this order");
    properties.set("deformations", std::move(steps));
    for (const Shape* entry : fascia::shapes()) {
      addToSchema(std::string(entry->name()), entry->parameters(), properties);
    }
  }

 private:
  static bool isParameterOfAny(const std::string& key) {
    for (const Shape* shape : fascia::shapes()) {
      if (findParameter(shape->parameters(), memoryName(key))) return true;
    }
    return false;
  }

  CodecPtr<std::string> shape_ = typeNames(fascia::shapes());
  CodecPtr<std::vector<SolidDef::Step>> steps_ =
      listOf<SolidDef::Step>(std::make_shared<StepCodec>(), 64);
};

}  // namespace

CodecPtr<FleshSolidDef> solidCodec() {
  return std::make_shared<SolidCodec>();
}

}  // namespace fascia
