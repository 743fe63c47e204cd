#pragma once

// How values look in a file. One table of fields per structure serves reading, writing and the
// published JSON Schema, so that the three cannot disagree.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <fascia/base/suggest.h>
#include <fascia/io/json/json.h>

namespace fascia {

// Where a reader is: a chain of keys and indices on the stack, turned into text only for a fault.
struct JsonPath {
  const JsonPath* parent = nullptr;
  std::string_view key;
  std::size_t index = 0;
  bool isIndex = false;

  JsonPath operator[](std::string_view k) const { return {this, k, 0, false}; }
  JsonPath operator[](std::size_t i) const { return {this, {}, i, true}; }
  std::string text() const;
};

// Collects every fault of one document.
class Reading {
 public:
  void fault(const Json& at, const JsonPath& path, std::string message, std::string hint = {});
  // "found …, expected …"
  void unexpected(const Json& at, const JsonPath& path, const std::string& expected);
  // Reports and returns false unless `at` is of the kind.
  bool expect(const Json& at, Json::Kind kind, const JsonPath& path);

  std::vector<Issue> issues;
};

std::string shown(std::string_view text);  // quoted, and cut when long, for messages
std::string described(const Json& value);  // "the number 3", "a list of 2", for messages

template <class T>
class Codec {
 public:
  Codec() = default;
  virtual ~Codec() = default;
  Codec(const Codec&) = delete;
  Codec& operator=(const Codec&) = delete;

  // Leaves `value` as it was where the document is faulty.
  virtual void read(const Json& json, const JsonPath& path, Reading& reading, T& value) const = 0;
  virtual Json write(const T& value) const = 0;
  virtual Json schema() const = 0;
  virtual bool same(const T& a, const T& b) const = 0;  // a default is left out when writing
};

template <class T>
using CodecPtr = std::shared_ptr<const Codec<T>>;

// A list of anything.
template <class T>
class ListCodec final : public Codec<std::vector<T>> {
 public:
  explicit ListCodec(CodecPtr<T> item, std::size_t maxCount, T blank = {})
      : item_(std::move(item)), maxCount_(maxCount), blank_(std::move(blank)) {}

  void read(const Json& json, const JsonPath& path, Reading& reading,
            std::vector<T>& value) const override {
    if (!reading.expect(json, Json::Kind::list, path)) return;
    const Json::List& items = json.list();
    if (items.size() > maxCount_) {
      reading.unexpected(json, path, "at most " + std::to_string(maxCount_) + " entries");
      return;
    }
    value.clear();
    for (std::size_t i = 0; i < items.size(); ++i) {
      T entry = blank_;
      item_->read(items[i], path[i], reading, entry);
      value.push_back(std::move(entry));
    }
  }
  Json write(const std::vector<T>& value) const override {
    Json::List out;
    for (const T& entry : value) out.push_back(item_->write(entry));
    return out;
  }
  Json schema() const override {
    Json out;
    out.set("type", "array");
    out.set("maxItems", shortJson(maxCount_));
    out.set("items", item_->schema());
    return out;
  }
  bool same(const std::vector<T>& a, const std::vector<T>& b) const override {
    return a.empty() && b.empty();  // lists have no other default than none
  }

 private:
  static Json shortJson(std::size_t count) { return Json(static_cast<double>(count)); }

  CodecPtr<T> item_;
  std::size_t maxCount_;
  T blank_;
};

// Absent, or a value.
template <class T>
class OptionalCodec final : public Codec<std::optional<T>> {
 public:
  explicit OptionalCodec(CodecPtr<T> inner) : inner_(std::move(inner)) {}

  void read(const Json& json, const JsonPath& path, Reading& reading,
            std::optional<T>& value) const override {
    T entry{};
    inner_->read(json, path, reading, entry);
    value = std::move(entry);
  }
  Json write(const std::optional<T>& value) const override {
    return value ? inner_->write(*value) : Json();
  }
  Json schema() const override { return inner_->schema(); }
  bool same(const std::optional<T>& a, const std::optional<T>& b) const override {
    return !a && !b;  // a value that is there is always written: it may be an empty object
  }

 private:
  CodecPtr<T> inner_;
};

// An object with named members, each bound to a member of T.
template <class T>
class ObjectCodec : public Codec<T> {
 public:
  enum class Need { optional, required };

  explicit ObjectCodec(std::string help = {}) : help_(std::move(help)) {}

  template <class M>
  ObjectCodec& field(std::string name, M T::*member, std::type_identity_t<CodecPtr<M>> codec,
                     std::string help, Need need = Need::optional) {
    return bind<M>(
        [member](auto& value) -> auto& { return value.*member; }, std::move(name), std::move(codec),
        std::move(help), need);
  }
  // A member of a part that files do not nest.
  template <class P, class M>
  ObjectCodec& field(std::string name, P T::*part, M P::*member,
                     std::type_identity_t<CodecPtr<M>> codec, std::string help,
                     Need need = Need::optional) {
    return bind<M>(
        [=](auto& value) -> auto& { return value.*part.*member; }, std::move(name),
        std::move(codec), std::move(help), need);
  }

  void read(const Json& json, const JsonPath& path, Reading& reading, T& value) const override {
    if (!reading.expect(json, Json::Kind::object, path)) return;
    for (const Json::Member& member : json.object()) {
      const JsonPath at = path[std::string_view(member.key)];
      if (const Field* known = find(member.key)) {
        known->read(member.value, at, reading, value);
      } else if (!readOther(json, member, at, reading, value)) {
        NearestName nearest(member.key);
        for (const auto& entry : fields_) nearest.offer(entry->name);
        offerOthers(json, nearest);
        reading.fault(member.value, at, "unknown key " + shown(member.key), nearest.hint());
      }
    }
    for (const auto& entry : fields_) {
      if (entry->need == Need::required && !json.find(entry->name)) {
        reading.fault(json, path, "the key " + shown(entry->name) + " is missing", entry->help);
      }
    }
  }

  Json write(const T& value) const override {
    Json out{Json::Object{}};
    const T standard{};
    for (const auto& entry : fields_) {
      if (entry->need == Need::required || !entry->same(value, standard)) {
        out.set(entry->name, entry->write(value));
      }
    }
    writeOthers(value, out);
    return out;
  }

  Json schema() const override {
    Json properties{Json::Object{}};
    Json::List required;
    const T standard{};
    for (const auto& entry : fields_) {
      Json property = entry->schema();
      if (!entry->help.empty() && !property.find("description")) {
        property.set("description", entry->help);
      }
      const Json normally = entry->write(standard);
      const bool plain = normally.is(Json::Kind::number) || normally.is(Json::Kind::boolean) ||
                         (normally.is(Json::Kind::text) && !normally.text().empty()) ||
                         (normally.is(Json::Kind::list) && !normally.list().empty());
      if (plain && entry->need == Need::optional) property.set("default", normally);
      properties.set(entry->name, std::move(property));
      if (entry->need == Need::required) required.emplace_back(entry->name);
    }
    schemaOthers(properties);
    Json out;
    out.set("type", "object");
    if (!help_.empty()) out.set("description", help_);
    out.set("properties", std::move(properties));
    if (!required.empty()) out.set("required", std::move(required));
    out.set("additionalProperties", false);
    return out;
  }

  bool same(const T& a, const T& b) const override {
    for (const auto& entry : fields_) {
      if (!entry->same(a, b)) return false;
    }
    return true;
  }

 protected:
  // For members whose names depend on the value, such as a shape's parameters.
  virtual bool readOther(const Json&, const Json::Member&, const JsonPath&, Reading&, T&) const {
    return false;
  }
  virtual void offerOthers(const Json&, NearestName&) const {}
  virtual void writeOthers(const T&, Json&) const {}
  virtual void schemaOthers(Json&) const {}

 private:
  struct Field {
    std::string name, help;
    Need need = Need::optional;
    virtual ~Field() = default;
    virtual void read(const Json&, const JsonPath&, Reading&, T&) const = 0;
    virtual Json write(const T&) const = 0;
    virtual Json schema() const = 0;
    virtual bool same(const T&, const T&) const = 0;
  };
  // at(value): the member.
  template <class M, class At>
  struct TypedField final : Field {
    TypedField(At theAt, CodecPtr<M> theCodec) : at(theAt), codec(std::move(theCodec)) {}
    At at;
    CodecPtr<M> codec;
    void read(const Json& json, const JsonPath& path, Reading& reading, T& value) const override {
      codec->read(json, path, reading, at(value));
    }
    Json write(const T& value) const override { return codec->write(at(value)); }
    Json schema() const override { return codec->schema(); }
    bool same(const T& a, const T& b) const override { return codec->same(at(a), at(b)); }
  };

  template <class M, class At>
  ObjectCodec& bind(At at, std::string name, CodecPtr<M> codec, std::string help, Need need) {
    auto entry = std::make_unique<TypedField<M, At>>(at, std::move(codec));
    entry->name = std::move(name), entry->help = std::move(help), entry->need = need;
    fields_.push_back(std::move(entry));
    return *this;
  }

  const Field* find(std::string_view name) const {
    for (const auto& entry : fields_) {
      if (entry->name == name) return entry.get();
    }
    return nullptr;
  }

  std::string help_;
  std::vector<std::unique_ptr<Field>> fields_;
};

template <class T>
CodecPtr<std::vector<T>> listOf(CodecPtr<T> item, std::size_t maxCount, T blank = {}) {
  return std::make_shared<ListCodec<T>>(std::move(item), maxCount, std::move(blank));
}
template <class T>
CodecPtr<std::optional<T>> optionally(CodecPtr<T> inner) {
  return std::make_shared<OptionalCodec<T>>(std::move(inner));
}

}  // namespace fascia
