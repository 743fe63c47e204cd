#include <fascia/io/documents/body_codec.h>
#include <fascia/io/documents/character_codecs.h>
#include <fascia/io/documents/scene_codecs.h>
#include <fascia/io/documents/solid_members.h>
#include <fascia/io/documents/tunable_fields.h>

namespace fascia {
namespace {

constexpr std::size_t kMostBodies = 20'000, kMostOutlinePoints = 2048;

// Coordinates of a place or vector: at least `kLeast` of them, what is missing is 0.
template <class Vector, std::size_t kLeast>
class CoordinatesCodec final : public Codec<Vector> {
 public:
  explicit CoordinatesCodec(NumberRange range = kSceneLengths) : range_(range) {}
  void read(const Json& json, const JsonPath& path, Reading& reading,
            Vector& value) const override {
    if (!json.is(Json::Kind::list) || json.list().size() < kLeast || json.list().size() > kMost) {
      reading.unexpected(json, path,
                         kLeast == kMost ? "a list of 2 numbers" : "a list of 2 or 3 numbers");
      return;
    }
    Vector found = Vector::Zero();
    for (std::size_t i = 0; i < json.list().size(); ++i)
      readNumber(json.list()[i], path[i], reading, range_, found[static_cast<int>(i)]);
    value = found;
  }
  Json write(const Vector& value) const override {
    Json::List out;
    for (const double x : value) out.emplace_back(x);
    return out;
  }
  Json schema() const override {
    Json out;
    out.set("type", "array");
    out.set("minItems", static_cast<int>(kLeast));
    out.set("maxItems", static_cast<int>(kMost));
    out.set("items", numberSchema(range_));
    return out;
  }
  bool same(const Vector& a, const Vector& b) const override { return a == b; }

 private:
  static constexpr std::size_t kMost = Vector::RowsAtCompileTime;
  NumberRange range_;
};

// [x, y, z], or [x, y] in the plane z = 0.
using PlaceCodec = CoordinatesCodec<Vec3, 2>;

// As tunable_fields.h does it, but for places.
struct PlaceCodecs {
  template <class T>
  CodecPtr<Vec3> operator()(const Tunable<T, Vec3>& row) const {
    if (row.isAngle()) return angleVectors(row.range);
    return std::make_shared<PlaceCodec>(row.range);
  }
  template <class T>
  CodecPtr<std::optional<Vec3>> operator()(const Tunable<T, std::optional<Vec3>>& row) const {
    return optionally<Vec3>((*this)(Tunable<T, Vec3>{{row}, nullptr}));
  }
  auto operator()(const auto& row) const { return codecOf(row); }
};

template <class Def, class T>
void addSceneTunables(ObjectCodec<T>& codec,
                      std::initializer_list<std::string_view> leaveOut = {}) {
  addTunables<Def>(codec, leaveOut, PlaceCodecs());
}

// {"tip": [0, 1, 0], …}: places by their names.
class NamedPlacesCodec final : public Codec<std::vector<NamedPlaceDef>> {
 public:
  void read(const Json& json, const JsonPath& path, Reading& reading,
            std::vector<NamedPlaceDef>& value) const override {
    if (!reading.expect(json, Json::Kind::object, path)) return;
    if (json.object().size() > kMaxListed) {
      reading.unexpected(json, path, "at most " + std::to_string(kMaxListed) + " names");
      return;
    }
    value.clear();
    for (const Json::Member& member : json.object()) {
      NamedPlaceDef place{member.key};
      const JsonPath at = path[std::string_view(member.key)];
      name_->read(Json(member.key), at, reading, place.name);
      place_.read(member.value, at, reading, place.position_m);
      value.push_back(std::move(place));
    }
  }
  Json write(const std::vector<NamedPlaceDef>& value) const override {
    Json out{Json::Object{}};
    for (const NamedPlaceDef& place : value) out.set(place.name, place_.write(place.position_m));
    return out;
  }
  Json schema() const override {
    Json out;
    out.set("type", "object");
    out.set("additionalProperties", place_.schema());
    return out;
  }
  bool same(const std::vector<NamedPlaceDef>& a,
            const std::vector<NamedPlaceDef>& b) const override {
    return a.empty() && b.empty();
  }

 private:
  CodecPtr<std::string> name_ = names();
  PlaceCodec place_;
};

class PlacedSolidCodec final : public SolidOwnerCodec<PlacedSolidDef> {
 public:
  enum class Role { ornament, prop };
  explicit PlacedSolidCodec(Role role)
      : SolidOwnerCodec(role == Role::prop ? "A rigid solid that stands; bodies collide with it."
                                           : "A solid that a body carries for the looks.") {
    using P = PlacedSolidDef;
    field("name", &P::name, names(), "Its name",
          role == Role::prop ? Need::required : Need::optional);
    if (role == Role::prop) addSceneTunables<P>(*this);
    if (role == Role::ornament) addSceneTunables<P>(*this, {"friction"});
    field("color", &P::color, colors(), "Its colour");
  }
};

CodecPtr<ScatterDef> scatterCodec() {
  using S = ScatterDef;
  auto codec = std::make_shared<ObjectCodec<S>>(
      "How much the start differs from seed to seed: uniformly up to plus or minus these.");
  addSceneTunables<S>(*codec);
  return codec;
}

// A body is a solid, with the members of its shape, or has an outline or a mesh instead.
class SceneBodyCodec final : public ObjectCodec<SceneBodyDef> {
 public:
  SceneBodyCodec()
      : ObjectCodec(
            "A linear deformable body (Witkin & Welch 1990): a solid; or the outline of a plate, "
            "in "
            "two dimensions; or the inside of a closed mesh.") {
    using B = SceneBodyDef;
    field("name", &B::name, names(), "Its name, without '.'", Need::required);
    field("basis", &B::basis, bodyBasisCodec(), "The shapes that it can take");
    addSceneTunables<B>(*this);
    field("scatter", &B::scatter, scatterCodec(), "");
    field("points", &B::points, std::make_shared<NamedPlacesCodec>(),
          "Points of the undeformed body by name; elsewhere they are called \"body.point\"");
    field("color", &B::color, colors(), "Its colour");
    field("ornaments", &B::ornaments,
          listOf<PlacedSolidDef>(
              std::make_shared<PlacedSolidCodec>(PlacedSolidCodec::Role::ornament), kMaxListed),
          "Carried along, without mass: eyes, teeth");
  }

  void read(const Json& json, const JsonPath& path, Reading& reading,
            SceneBodyDef& body) const override {
    ObjectCodec::read(json, path, reading, body);
    const bool outline = json.find("outline_m"), mesh = json.find("mesh");
    body.form = outline ? SceneBodyDef::Form::outline
                : mesh  ? SceneBodyDef::Form::mesh
                        : SceneBodyDef::Form::solid;
    if (json.is(Json::Kind::object) && outline + mesh + (json.find("shape") ? 1 : 0) > 1)
      reading.fault(json, path, "found several of \"shape\", \"outline_m\" and \"mesh\"",
                    "a body is made of one of them");
  }

  Json write(const SceneBodyDef& value) const override {
    Json out = ObjectCodec::write(value);
    SolidMembers::sortForPeople(out);
    return out;
  }

 protected:
  bool readOther(const Json& whole, const Json::Member& member, const JsonPath& path,
                 Reading& reading, SceneBodyDef& body) const override {
    if (const Field* field = findField(member.key)) {
      field->read(member.value, path, reading, body);
      return true;
    }
    return members_.read(whole, member, path, reading, body.solid);
  }
  void offerOthers(const Json& whole, NearestName& nearest) const override {
    for (const Field& field : fields_) nearest.offer(field.name);
    members_.offer(whole, nearest);
  }
  void writeOthers(const SceneBodyDef& body, Json& out) const override {
    using Form = SceneBodyDef::Form;
    if (body.form == Form::solid) members_.write(body.solid, out);
    if (body.form == Form::mesh) out.set("mesh", body.mesh_file);
    if (body.form != Form::outline) return;
    out.set("outline_m", outline_->write(body.outline_m));
    if (body.smooth_outline) out.set("smooth_outline", true);
    out.set("thickness_m", body.thickness_m);
    if (body.inflated) out.set("inflated", true);
  }
  void schemaOthers(Json& properties) const override {
    for (const Field& field : fields_) properties.set(field.name, field.schema());
    members_.addToSchema(properties);
  }

 private:
  // Members of outlines and meshes only: written where they mean something.
  struct Field {
    std::string name;
    std::function<void(const Json&, const JsonPath&, Reading&, SceneBodyDef&)> read;
    std::function<Json()> schema;
  };
  template <class M>
  static Field own(std::string name, M SceneBodyDef::*member, CodecPtr<M> codec, std::string help) {
    return {std::move(name),
            [member, codec](const Json& json, const JsonPath& path, Reading& reading,
                            SceneBodyDef& body) { codec->read(json, path, reading, body.*member); },
            [codec, help] {
              Json out = codec->schema();
              out.set("description", help);
              return out;
            }};
  }
  template <class M>
  static Field own(const Tunable<SceneBodyDef, M>& row) {
    return own<M>(std::string(row.key), row.member, codecOf(row), std::string(row.help));
  }
  const Field* findField(std::string_view name) const {
    for (const Field& field : fields_)
      if (field.name == name) return &field;
    return nullptr;
  }

  SolidMembers members_;
  CodecPtr<std::vector<Vec2>> outline_ =
      listOf<Vec2>(std::make_shared<CoordinatesCodec<Vec2, 2>>(), kMostOutlinePoints, Vec2::Zero());
  std::vector<Field> fields_{
      own("outline_m", &SceneBodyDef::outline_m, outline_,
          "Around a plate in the plane z = 0, for scenes of two dimensions"),
      own(kSmoothOutline), own(kPlateThickness), own(kInflated),
      own("mesh", &SceneBodyDef::mesh_file, names(),
          "A closed mesh: glTF or GLB in the folder of this file, or below it")};
};

CodecPtr<SceneConstraintDef> constraintCodec() {
  using C = SceneConstraintDef;
  using Object = ObjectCodec<C>;
  auto codec = std::make_shared<Object>("What ties points of bodies from the start.");
  codec->field("name", &C::name, names(), "For messages")
      .field("type", &C::kind,
             words<C::Kind>({{C::Kind::attach, "attach"},
                             {C::Kind::nail, "nail"},
                             {C::Kind::line, "line"},
                             {C::Kind::plane, "plane"},
                             {C::Kind::rod, "rod"},
                             {C::Kind::spring, "spring"}}),
             "attach: two points are one; nail: a point stays, where it is or at a place; line, "
             "plane: a point stays on it; rod: two keep their distance; spring: pulls",
             Object::Need::required)
      .field("points", &C::points, listOf<std::string>(names(), 2),
             "\"body.point\", or as the second a place", Object::Need::required);
  addSceneTunables<C>(*codec);
  return codec;
}

CodecPtr<ScenePathDef> pathCodec() {
  using P = ScenePathDef;
  using K = P::Key;
  auto key = std::make_shared<ObjectCodec<K>>("Where the point is at a time.");
  addSceneTunables<K>(*key);
  auto codec = std::make_shared<ObjectCodec<P>>("A keyframed way of a body's point.");
  codec->field("point", &P::point, names(), "\"body.point\"", ObjectCodec<P>::Need::required)
      .field("keys", &P::keys, listOf<K>(key, kMaxListed), "In the order of their times",
             ObjectCodec<P>::Need::required);
  addSceneTunables<P>(*codec);
  return codec;
}

CodecPtr<SceneCharacterDef> sceneCharacterCodec() {
  using C = SceneCharacterDef;
  using Object = ObjectCodec<C>;
  auto codec = std::make_shared<Object>("A character that performs among the bodies.");
  codec
      ->field("name", &C::name, names(), "Its joints are called \"name.joint\"",
              Object::Need::required)
      .field("file", &C::file, names(), "A character file in the folder of this file, or below it",
             Object::Need::required)
      .field("motion", &C::motion, names(), "What it does; missing: its first motion");
  addSceneTunables<C>(*codec);
  return codec;
}

CodecPtr<GroundDef> groundCodec() {
  auto codec = std::make_shared<ObjectCodec<GroundDef>>("A level floor that bodies collide with.");
  addSceneTunables<GroundDef>(*codec);
  return codec;
}

CodecPtr<ViewDef> viewCodec() {
  auto codec = std::make_shared<ObjectCodec<ViewDef>>("What a picture shows by itself.");
  codec->field("camera", &ViewDef::camera, texts(200),
               "As on the command line; missing: front in two dimensions, else three-quarter");
  addSceneTunables<ViewDef>(*codec);
  return codec;
}

CodecPtr<SceneSimulationDef> sceneSimulationCodec() {
  using S = SceneSimulationDef;
  auto codec = std::make_shared<ObjectCodec<S>>("How time passes.");
  addSceneTunables<S>(*codec);
  return codec;
}

}  // namespace

CodecPtr<SceneDef> sceneCodec() {
  using S = SceneDef;
  using Object = ObjectCodec<S>;
  auto codec = std::make_shared<Object>(
      "A scene: linear deformable bodies, what ties and drives them, characters among them. "
      "Metres, "
      "kilograms, seconds; angles in degrees; y is up.");
  codec->field("name", &S::name, names(), "The scene's name", Object::Need::required)
      .field("description", &S::description, texts(100'000), "For people")
      .field("dimension", &S::dimension, integers({2, 3}), "Of all bodies")
      .field("bodies", &S::bodies,
             listOf<SceneBodyDef>(std::make_shared<SceneBodyCodec>(), kMostBodies), "")
      .field("places", &S::places, std::make_shared<NamedPlacesCodec>(),
             "Fixed places by name, for constraints and the script")
      .field("constraints", &S::constraints, listOf(constraintCodec(), 4 * kMostBodies),
             "What ties points from the start")
      .field("paths", &S::paths, listOf(pathCodec(), kMaxListed), "Keyframed points")
      .field("characters", &S::characters, listOf(sceneCharacterCodec(), 64), "")
      .field("props", &S::props,
             listOf<PlacedSolidDef>(
                 std::make_shared<PlacedSolidCodec>(PlacedSolidCodec::Role::prop), kMostSolids),
             "Rigid solids that stand")
      .field("ground", &S::ground, optionally(groundCodec()), "")
      .field("view", &S::view, viewCodec(), "")
      .field("script", &S::script, names(),
             "A *.lua file in the folder of this file, or below it: see docs/scripting.md")
      .field("simulation", &S::simulation, sceneSimulationCodec(), "");
  return codec;
}

}  // namespace fascia
