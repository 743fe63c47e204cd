#include <fascia/io/documents/solid_members.h>

#include <algorithm>
#include <iterator>

namespace fascia {

std::string textOf(const Json& object, std::string_view key, const std::string& otherwise) {
  const Json* found = object.find(key);
  return found && found->is(Json::Kind::text) ? found->text() : otherwise;
}

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
void addParameters(const std::string& owner, ParameterList list, Json& properties) {
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
      addParameters(std::string(type->name()), type->parameters(), properties);
    }
  }

 private:
  static ParameterList parametersOf(const Json& whole) {
    const Deformation* type = findDeformation(textOf(whole, "type", {}));
    return type ? type->parameters() : ParameterList{};
  }
};

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

bool isParameterOfAny(const std::string& key) {
  for (const Shape* shape : fascia::shapes()) {
    if (findParameter(shape->parameters(), memoryName(key))) return true;
  }
  return false;
}

}  // namespace

SolidMembers::SolidMembers()
    : shape_(typeNames(fascia::shapes())),
      steps_(listOf<SolidDef::Step>(std::make_shared<StepCodec>(), 64)) {}

bool SolidMembers::read(const Json& whole, const Json::Member& member, const JsonPath& path,
                        Reading& reading, SolidDef& solid) const {
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

void SolidMembers::offer(const Json& whole, NearestName& nearest) const {
  nearest.offer("shape");
  nearest.offer("deformations");
  if (const Shape* shape = findShape(textOf(whole, "shape", SolidDef{}.shape))) {
    for (const ParameterInfo& info : shape->parameters()) nearest.offer(fileName(info.name));
  }
}

void SolidMembers::write(const SolidDef& solid, Json& out) const {
  out.set("shape", solid.shape);
  if (const Shape* shape = findShape(solid.shape)) {
    writeFrom(shape->parameters(), solid.parameters, out);
  }
  if (!solid.deformations.empty()) out.set("deformations", steps_->write(solid.deformations));
}

void SolidMembers::addToSchema(Json& properties) const {
  Json shape = shape_->schema();
  shape.set("description", "Which shape");
  shape.set("default", SolidDef{}.shape);
  properties.set("shape", std::move(shape));
  Json steps = steps_->schema();
  steps.set("description", "Deformations, applied in this order");
  properties.set("deformations", std::move(steps));
  for (const Shape* entry : fascia::shapes()) {
    addParameters(std::string(entry->name()), entry->parameters(), properties);
  }
}

void SolidMembers::sortForPeople(Json& object) {
  std::stable_sort(
      object.object().begin(), object.object().end(),
      [](const Json::Member& a, const Json::Member& b) { return rank(a.key) < rank(b.key); });
}

}  // namespace fascia
