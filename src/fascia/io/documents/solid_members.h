#pragma once

#include <fascia/field/solid.h>
#include <fascia/io/documents/plain_codecs.h>

namespace fascia {

// The members of an object that say which solid it is: the shape, its parameters under their own
// names, and deformations. They stand beside the other members of whatever has a solid.
class SolidMembers {
 public:
  SolidMembers();
  // Whether the member is one of these; `whole` is the object that it stands in.
  bool read(const Json& whole, const Json::Member& member, const JsonPath& path, Reading& reading,
            SolidDef& solid) const;
  void offer(const Json& whole, NearestName& nearest) const;
  void write(const SolidDef& solid, Json& out) const;
  void addToSchema(Json& properties) const;
  // Sorts members into the order in which a person reads a solid: what it is before where it is.
  static void sortForPeople(Json& object);

 private:
  CodecPtr<std::string> shape_;
  CodecPtr<std::vector<SolidDef::Step>> steps_;
};

// An object that has a solid, as its member `solid`.
template <class T>
class SolidOwnerCodec : public ObjectCodec<T> {
 public:
  using ObjectCodec<T>::ObjectCodec;

  Json write(const T& value) const override {
    Json out = ObjectCodec<T>::write(value);
    SolidMembers::sortForPeople(out);
    return out;
  }

 protected:
  bool readOther(const Json& whole, const Json::Member& member, const JsonPath& path,
                 Reading& reading, T& value) const override {
    return members_.read(whole, member, path, reading, value.solid);
  }
  void offerOthers(const Json& whole, NearestName& nearest) const override {
    members_.offer(whole, nearest);
  }
  void writeOthers(const T& value, Json& out) const override { members_.write(value.solid, out); }
  void schemaOthers(Json& properties) const override { members_.addToSchema(properties); }

 private:
  SolidMembers members_;
};

// A text member of an object, or `otherwise`.
std::string textOf(const Json& object, std::string_view key, const std::string& otherwise);

}  // namespace fascia
