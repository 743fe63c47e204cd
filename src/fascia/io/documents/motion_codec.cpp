#include <fascia/io/documents/character_codecs.h>
#include <fascia/io/documents/tunable_fields.h>

namespace fascia {
namespace {

constexpr NumberRange kTime = tunableOf(&Key::time_s).range;
// Whatever the channel's unit: a time, or a value as the reader then checks it.
constexpr NumberRange kKeyNumber = {};

// What a track animates decides the unit of its keys.
class ChannelUnit {
 public:
  explicit ChannelUnit(const TrackDef& track) {
    if (track.target == TrackDef::Target::joint) {
      dof_ = dofFromName(track.channel).value_or(Dof::rx);
      suffix_ = '_' + dofUnit(*dof_);
    } else {  // a morph's weight has neither a unit nor a parameter
      parameter_ = track.channel;
      suffix_ = isAngleName(parameter_) ? "_deg" : parameter_.ends_with("_m") ? "_m" : "";
    }
  }

  std::string valueKey() const { return "value" + suffix_; }
  Json write(double value) const {
    return dof_ ? dofJson(*dof_, value) : parameterJson(parameter_, value);
  }
  bool read(const Json& json, const JsonPath& path, Reading& reading, double& value) const {
    return dof_ ? readDofValue(*dof_, json, path, reading, value)
                : readParameter(parameter_, json, path, reading, kKeyValue.range, value);
  }

 private:
  std::optional<Dof> dof_;
  std::string parameter_, suffix_;
};

// [time, value], or {"t_s": 2, "value_deg": -10, "tension": 0.5}.
void readKey(const Json& json, const JsonPath& path, Reading& reading, const ChannelUnit& unit,
             Key& key) {
  if (json.is(Json::Kind::list) && json.list().size() == 2) {
    readNumber(json.list()[0], path[0], reading, kTime, key.time_s);
    unit.read(json.list()[1], path[1], reading, key.value);
    return;
  }
  if (!json.is(Json::Kind::object)) {
    reading.unexpected(json, path, "[time, value] or an object");
    return;
  }
  const std::string valueKey = unit.valueKey();
  for (const Json::Member& member : json.object()) {
    const JsonPath at = path[std::string_view(member.key)];
    NearestName nearest(member.key);
    nearest.offer(valueKey);
    bool known = member.key == valueKey;
    if (known) unit.read(member.value, at, reading, key.value);
    forEachTunable<Key>([&](const auto& row) {
      nearest.offer(row.key);
      if (member.key != row.key) return;
      readNumber(member.value, at, reading, row.range, key.*row.member);
      known = true;
    });
    if (!known) {
      reading.fault(member.value, at, "unknown key " + shown(member.key), nearest.hint());
    }
  }
  for (const std::string& name : {std::string("t_s"), valueKey}) {
    if (!json.find(name)) reading.fault(json, path, "the key " + shown(name) + " is missing");
  }
}

Json keyJson(const Key& key, const ChannelUnit& unit) {
  if (key.tension == 0 && key.continuity == 0 && key.bias == 0) {
    return Json::List{key.time_s, unit.write(key.value)};
  }
  Json out;
  forEachTunable<Key>([&](const auto& row) {
    if (row.isRequired || key.*row.member != 0) out.set(std::string(row.key), key.*row.member);
    if (row.member == &Key::time_s) out.set(unit.valueKey(), unit.write(key.value));
  });
  return out;
}

Json typed(const char* type) {
  Json out;
  out.set("type", type);
  return out;
}

Json keySchema() {
  Json pair = typed("array");
  pair.set("description", "[time in seconds, value]");
  pair.set("minItems", 2);
  pair.set("maxItems", 2);
  pair.set("items", numberSchema(kKeyNumber));
  Json properties;
  Json::List values;
  for (const char* key : {"value_deg", "value_m", "value"}) {
    properties.set(key, numberSchema(kKeyNumber));
    Json one;
    one.set("required", Json::List{key});
    values.push_back(std::move(one));
  }
  forEachTunable<Key>([&](const auto& row) {
    Json property = numberSchema(row.range);
    property.set("description", std::string(row.help));
    properties.set(std::string(row.key), std::move(property));
  });
  Json full = typed("object");
  full.set("properties", std::move(properties));
  full.set("required", Json::List{"t_s"});
  full.set("oneOf", std::move(values));
  full.set("additionalProperties", false);
  Json out;
  out.set("anyOf", Json::List{std::move(pair), std::move(full)});
  return out;
}

// What a track animates, and which number of it: as its file names them.
struct TrackKind {
  TrackDef::Target target;
  const char* what;
  const char* channel;  // nullptr: there is only one
};
constexpr TrackKind kTrackKinds[] = {{TrackDef::Target::joint, "joint", "dof"},
                                     {TrackDef::Target::solid, "solid", "parameter"},
                                     {TrackDef::Target::morph, "morph", nullptr}};

const TrackKind& kindOf(const TrackDef& track) {
  return *std::ranges::find(kTrackKinds, track.target, &TrackKind::target);
}
// Of a track that names nothing: a joint's.
const TrackKind& kindIn(const Json& json) {
  const auto named = [&](const TrackKind& kind) { return json.find(kind.what) != nullptr; };
  const auto found = std::find_if(std::begin(kTrackKinds) + 1, std::end(kTrackKinds), named);
  return found == std::end(kTrackKinds) ? kTrackKinds[0] : *found;
}

// {"joint": "hips", "dof": "rx", "keys": …}, {"solid": "belly", "parameter": "radius_m", …} or
// {"morph": "smile", …}.
class TrackCodec final : public Codec<TrackDef> {
 public:
  void read(const Json& json, const JsonPath& path, Reading& reading,
            TrackDef& track) const override {
    if (!reading.expect(json, Json::Kind::object, path)) return;
    const TrackKind& kind = kindIn(json);
    track.target = kind.target;
    std::vector<std::string_view> known{kind.what, "keys"};
    if (kind.channel) known.insert(known.begin() + 1, kind.channel);
    for (const Json::Member& member : json.object()) {
      if (std::find(std::begin(known), std::end(known), member.key) != std::end(known)) continue;
      NearestName nearest(member.key);
      for (const std::string_view name : known) nearest.offer(name);
      reading.fault(member.value, path[std::string_view(member.key)],
                    "unknown key " + shown(member.key), nearest.hint());
    }
    for (const std::string_view name : known) {
      if (!json.find(name)) reading.fault(json, path, "the key " + shown(name) + " is missing");
    }
    if (const Json* name = json.find(known[0])) {
      names()->read(*name, path[known[0]], reading, track.name);
    }
    if (kind.channel) {
      const Json* channel = json.find(kind.channel);
      if (!channel || !readChannel(*channel, path[kind.channel], reading, track)) return;
    }
    const Json* keys = json.find("keys");
    if (!keys) return;
    readKeys(*keys, path["keys"], reading, track);
  }

  Json write(const TrackDef& track) const override {
    const bool joint = track.target == TrackDef::Target::joint;
    const TrackKind& kind = kindOf(track);
    Json out;
    out.set(kind.what, track.name);
    if (kind.channel) out.set(kind.channel, joint ? track.channel : fileName(track.channel));
    const ChannelUnit unit(track);
    Json::List keys;
    for (const Key& key : track.keys) keys.push_back(keyJson(key, unit));
    out.set("keys", std::move(keys));
    return out;
  }

  Json schema() const override {
    Json keys = typed("array");
    keys.set("description",
             "Kochanek-Bartels keys by increasing time; degrees for rotations, else metres or the "
             "parameter's own unit");
    keys.set("items", keySchema());
    Json out;
    out.set("description", "One animated number: of a joint, of a solid, or a morph's weight");
    out.set("anyOf", Json::List{variant("joint", "dof", dofCodec()->schema(), keys),
                                variant("solid", "parameter", names()->schema(), keys),
                                variant("morph", nullptr, {}, keys)});
    return out;
  }

  bool same(const TrackDef&, const TrackDef&) const override { return false; }

 private:
  static bool readChannel(const Json& json, const JsonPath& path, Reading& reading,
                          TrackDef& track) {
    if (track.target == TrackDef::Target::joint) {
      const std::size_t before = reading.issues.size();
      Dof dof = Dof::rx;
      dofCodec()->read(json, path, reading, dof);
      track.channel = name(dof);
      return reading.issues.size() == before;
    }
    names()->read(json, path, reading, track.channel);
    track.channel = memoryName(track.channel);
    return !track.channel.empty();
  }

  static void readKeys(const Json& json, const JsonPath& path, Reading& reading, TrackDef& track) {
    if (!reading.expect(json, Json::Kind::list, path)) return;
    if (json.list().size() > kMaxKeys) {
      reading.unexpected(json, path, "at most " + std::to_string(kMaxKeys) + " keys");
      return;
    }
    const ChannelUnit unit(track);
    for (std::size_t i = 0; i < json.list().size(); ++i) {
      Key key;
      readKey(json.list()[i], path[i], reading, unit, key);
      track.keys.push_back(key);
    }
  }

  static Json variant(const char* what, const char* channel, Json channelSchema, const Json& keys) {
    Json properties;
    properties.set(what, names()->schema());
    Json::List required{what};
    if (channel) {
      properties.set(channel, std::move(channelSchema));
      required.emplace_back(channel);
    }
    properties.set("keys", keys);
    required.emplace_back("keys");
    Json out = typed("object");
    out.set("properties", std::move(properties));
    out.set("required", std::move(required));
    out.set("additionalProperties", false);
    return out;
  }
};

}  // namespace

CodecPtr<MotionDef> motionCodec() {
  using M = MotionDef;
  using Object = ObjectCodec<M>;
  auto codec = std::make_shared<Object>("A motion: keyed tracks.");
  codec->field("name", &M::name, names(), "The motion's name", Object::Need::required);
  addTunables<M>(*codec);
  codec->field("tracks", &M::tracks, listOf<TrackDef>(std::make_shared<TrackCodec>(), kMostTracks),
               "What moves");
  return codec;
}

}  // namespace fascia
