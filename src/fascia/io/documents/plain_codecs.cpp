#include <fascia/io/documents/plain_codecs.h>

#include <charconv>
#include <cmath>

#include <fascia/flesh/flesh.h>

namespace fascia {
namespace {

constexpr long double kRadiansPerDegree = 3.14159265358979323846264338327950288L / 180.0L;

long double longNumber(const std::string& digits) {
  long double value = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), value);
  return value;
}

class NumberCodec final : public Codec<double> {
 public:
  explicit NumberCodec(NumberRange range) : range_(range) {}
  void read(const Json& json, const JsonPath& path, Reading& reading,
            double& value) const override {
    readNumber(json, path, reading, range_, value);
  }
  Json write(const double& value) const override { return value; }
  Json schema() const override { return numberSchema(range_); }
  bool same(const double& a, const double& b) const override { return a == b; }

 private:
  NumberRange range_;
};

class IntegerCodec final : public Codec<int> {
 public:
  explicit IntegerCodec(NumberRange range) : range_(range) {}
  void read(const Json& json, const JsonPath& path, Reading& reading, int& value) const override {
    const bool number = json.is(Json::Kind::number);
    const double found = number ? json.number() : 0;
    if (!number || found != std::floor(found) || !range_.contains(found)) {
      reading.unexpected(json, path, range_.wholeText());
      return;
    }
    value = static_cast<int>(found);
  }
  Json write(const int& value) const override { return value; }
  Json schema() const override {
    Json out;
    out.set("type", "integer");
    out.set("minimum", range_.min);
    out.set("maximum", range_.max);
    return out;
  }
  bool same(const int& a, const int& b) const override { return a == b; }

 private:
  NumberRange range_;
};

class AngleCodec final : public Codec<double> {
 public:
  explicit AngleCodec(NumberRange range_deg) : range_deg_(range_deg) {}
  void read(const Json& json, const JsonPath& path, Reading& reading,
            double& value) const override {
    readAngle(json, path, reading, range_deg_, value);
  }
  Json write(const double& value) const override { return Json::Number{degreesDigits(value)}; }
  Json schema() const override { return numberSchema(range_deg_); }
  bool same(const double& a, const double& b) const override { return a == b; }

 private:
  NumberRange range_deg_;
};

class WordCodec final : public Codec<std::string> {
 public:
  explicit WordCodec(std::vector<std::string_view> known) : known_(std::move(known)) {}
  void read(const Json& json, const JsonPath& path, Reading& reading,
            std::string& value) const override {
    if (!reading.expect(json, Json::Kind::text, path)) return;
    std::string hint;
    const std::string fault = wordFault(json.text(), known_, hint);
    if (fault.empty()) {
      value = json.text();
    } else {
      reading.fault(json, path, fault, hint);
    }
  }
  Json write(const std::string& value) const override { return value; }
  Json schema() const override {
    Json::List all;
    for (const std::string_view word : known_) all.emplace_back(std::string(word));
    Json out;
    out.set("enum", std::move(all));
    return out;
  }
  bool same(const std::string& a, const std::string& b) const override { return a == b; }

 private:
  std::vector<std::string_view> known_;
};

class BooleanCodec final : public Codec<bool> {
 public:
  void read(const Json& json, const JsonPath& path, Reading& reading, bool& value) const override {
    if (reading.expect(json, Json::Kind::boolean, path)) value = json.boolean();
  }
  Json write(const bool& value) const override { return value; }
  Json schema() const override {
    Json out;
    out.set("type", "boolean");
    return out;
  }
  bool same(const bool& a, const bool& b) const override { return a == b; }
};

class TextCodec final : public Codec<std::string> {
 public:
  TextCodec(std::size_t min, std::size_t max) : min_(min), max_(max) {}
  void read(const Json& json, const JsonPath& path, Reading& reading,
            std::string& value) const override {
    if (!reading.expect(json, Json::Kind::text, path)) return;
    if (json.text().size() < min_) {
      reading.fault(json, path, "found an empty text, expected a name");
    } else if (json.text().size() > max_) {
      reading.fault(json, path,
                    "found a text of " + std::to_string(json.text().size()) +
                        " bytes, expected at most " + std::to_string(max_));
    } else {
      value = json.text();
    }
  }
  Json write(const std::string& value) const override { return value; }
  Json schema() const override {
    Json out;
    out.set("type", "string");
    if (min_ > 0) out.set("minLength", static_cast<int>(min_));
    out.set("maxLength", static_cast<int>(max_));
    return out;
  }
  bool same(const std::string& a, const std::string& b) const override { return a == b; }

 private:
  std::size_t min_, max_;
};

Json tripleSchema(Json item) {
  Json out;
  out.set("type", "array");
  out.set("minItems", 3);
  out.set("maxItems", 3);
  out.set("items", std::move(item));
  return out;
}

bool expectTriple(const Json& json, const JsonPath& path, Reading& reading) {
  if (json.is(Json::Kind::list) && json.list().size() == 3) return true;
  reading.unexpected(json, path, "a list of 3 numbers");
  return false;
}

class VectorCodec final : public Codec<Vec3> {
 public:
  explicit VectorCodec(NumberRange range) : range_(range) {}
  void read(const Json& json, const JsonPath& path, Reading& reading, Vec3& value) const override {
    if (!expectTriple(json, path, reading)) return;
    for (std::size_t i = 0; i < 3; ++i) {
      readNumber(json.list()[i], path[i], reading, range_, value[static_cast<int>(i)]);
    }
  }
  Json write(const Vec3& value) const override {
    return Json::List{value.x(), value.y(), value.z()};
  }
  Json schema() const override { return tripleSchema(numberSchema(range_)); }
  bool same(const Vec3& a, const Vec3& b) const override { return a == b; }

 private:
  NumberRange range_;
};

class AngleVectorCodec final : public Codec<Vec3> {
 public:
  explicit AngleVectorCodec(NumberRange range_deg) : range_deg_(range_deg) {}
  void read(const Json& json, const JsonPath& path, Reading& reading, Vec3& value) const override {
    if (!expectTriple(json, path, reading)) return;
    for (std::size_t i = 0; i < 3; ++i) {
      readAngle(json.list()[i], path[i], reading, range_deg_, value[static_cast<int>(i)]);
    }
  }
  Json write(const Vec3& value) const override {
    Json::List out;
    for (int i = 0; i < 3; ++i) out.emplace_back(Json::Number{degreesDigits(value[i])});
    return out;
  }
  Json schema() const override { return tripleSchema(numberSchema(range_deg_)); }
  bool same(const Vec3& a, const Vec3& b) const override { return a == b; }

 private:
  NumberRange range_deg_;
};

class ColorCodec final : public Codec<std::array<float, 3>> {
 public:
  using Rgb = std::array<float, 3>;
  void read(const Json& json, const JsonPath& path, Reading& reading, Rgb& value) const override {
    if (json.is(Json::Kind::list)) {
      if (expectTriple(json, path, reading)) readList(json, path, reading, value);
    } else if (!json.is(Json::Kind::text) || !readHex(json.text(), value)) {
      reading.unexpected(json, path, "a colour as \"#rrggbb\" or [r, g, b] with 0 to 1");
    }
  }
  Json write(const Rgb& value) const override {
    std::string hex = "#";
    bool exact = true;
    for (const float c : value) {
      const int byte = static_cast<int>(std::lround(std::clamp(c, 0.0f, 1.0f) * 255));
      exact = exact && fromByte(byte) == c;
      hex += "0123456789abcdef"[byte >> 4];
      hex += "0123456789abcdef"[byte & 15];
    }
    if (exact) return hex;
    Json::List out;
    for (const float c : value) out.emplace_back(Json::Number{shortestDigits(c)});
    return out;
  }
  Json schema() const override {
    Json hex;
    hex.set("type", "string");
    hex.set("pattern", "^#[0-9a-fA-F]{6}$");
    Json out;
    out.set("anyOf", Json::List{hex, tripleSchema(numberSchema({0, 1}))});
    return out;
  }
  bool same(const Rgb& a, const Rgb& b) const override { return a == b; }

 private:
  static float fromByte(int byte) { return static_cast<float>(byte / 255.0); }

  static bool readHex(const std::string& text, Rgb& value) {
    if (text.size() != 7 || text[0] != '#') return false;
    unsigned rgb = 0;
    const auto [end, error] = std::from_chars(text.data() + 1, text.data() + 7, rgb, 16);
    if (error != std::errc() || end != text.data() + 7) return false;
    for (unsigned i = 0; i < 3; ++i) {
      value[i] = fromByte(static_cast<int>((rgb >> (16 - 8 * i)) & 255u));
    }
    return true;
  }
  static void readList(const Json& json, const JsonPath& path, Reading& reading, Rgb& value) {
    for (std::size_t i = 0; i < 3; ++i) {
      double component = 0;
      if (!readNumber(json.list()[i], path[i], reading, {0, 1}, component)) continue;
      const std::string& digits = json.list()[i].digits();
      std::from_chars(digits.data(), digits.data() + digits.size(), value[i]);
    }
  }
};

class FleshColorCodec final : public Codec<Color> {
 public:
  void read(const Json& json, const JsonPath& path, Reading& reading, Color& value) const override {
    std::array<float, 3> rgb{value.r, value.g, value.b};
    rgb_.read(json, path, reading, rgb);
    value = {rgb[0], rgb[1], rgb[2]};
  }
  Json write(const Color& c) const override { return rgb_.write({c.r, c.g, c.b}); }
  Json schema() const override { return rgb_.schema(); }
  bool same(const Color& a, const Color& b) const override {
    return a.r == b.r && a.g == b.g && a.b == b.b;
  }

 private:
  ColorCodec rgb_;
};

}  // namespace

Json numberSchema(const NumberRange& range) {
  Json out;
  out.set("type", "number");
  out.set(range.aboveMin ? "exclusiveMinimum" : "minimum", range.min);
  out.set("maximum", range.max);
  return out;
}

bool readNumber(const Json& json, const JsonPath& path, Reading& reading, const NumberRange& range,
                double& value) {
  if (!json.is(Json::Kind::number) || !range.contains(json.number())) {
    reading.unexpected(json, path, range.text());
    return false;
  }
  value = json.number();
  return true;
}

double radiansFromDegrees(const std::string& digits) {
  return static_cast<double>(longNumber(digits) * kRadiansPerDegree);
}

std::string degreesDigits(double radians) {
  if (radians == 0 || !std::isfinite(radians)) return shortestDigits(radians);
  const long double degrees = static_cast<long double>(radians) / kRadiansPerDegree;
  std::string digits;
  for (int precision = 15; precision <= 21; ++precision) {
    char buffer[64];
    const auto end = std::to_chars(buffer, buffer + sizeof buffer, degrees,
                                   std::chars_format::general, precision)
                         .ptr;
    digits.assign(buffer, end);
    if (radiansFromDegrees(digits) == radians) break;
  }
  return digits;
}

bool readAngle(const Json& json, const JsonPath& path, Reading& reading,
               const NumberRange& range_deg, double& radians) {
  double degrees = 0;
  if (!readNumber(json, path, reading, range_deg, degrees)) return false;
  radians = radiansFromDegrees(json.digits());
  return true;
}

bool isAngleName(std::string_view name) {
  return name.ends_with("_rad");
}

std::string fileName(std::string_view name) {
  std::string out(name);
  if (isAngleName(name)) out.replace(out.size() - 3, 3, "deg");
  return out;
}

std::string memoryName(std::string_view name) {
  std::string out(name);
  if (name.ends_with("_deg")) out.replace(out.size() - 3, 3, "rad");
  return out;
}

Json parameterJson(std::string_view name, double value) {
  return isAngleName(name) ? Json(Json::Number{degreesDigits(value)}) : Json(value);
}

bool readParameter(std::string_view name, const Json& json, const JsonPath& path, Reading& reading,
                   const NumberRange& range, double& value) {
  if (!isAngleName(name)) return readNumber(json, path, reading, range, value);
  // The range is open by a hair: its ends in degrees are rounded.
  const double slack = 1e-9;
  return readAngle(json, path, reading,
                   {degrees(range.min) - slack, degrees(range.max) + slack, range.aboveMin}, value);
}

CodecPtr<double> numbers(NumberRange range) {
  return std::make_shared<NumberCodec>(range);
}
CodecPtr<int> integers(NumberRange range) {
  return std::make_shared<IntegerCodec>(range);
}
CodecPtr<bool> booleans() {
  return std::make_shared<BooleanCodec>();
}
CodecPtr<std::string> texts(std::size_t maxBytes) {
  return std::make_shared<TextCodec>(0, maxBytes);
}
CodecPtr<std::string> names() {
  return std::make_shared<TextCodec>(1, 200);
}
CodecPtr<Vec3> vectors(NumberRange range) {
  return std::make_shared<VectorCodec>(range);
}
CodecPtr<double> angles(NumberRange range_deg) {
  return std::make_shared<AngleCodec>(range_deg);
}
CodecPtr<Vec3> angleVectors(NumberRange range_deg) {
  return std::make_shared<AngleVectorCodec>(range_deg);
}
CodecPtr<std::string> wordsOf(std::vector<std::string_view> known) {
  return std::make_shared<WordCodec>(std::move(known));
}
CodecPtr<Color> colors() {
  return std::make_shared<FleshColorCodec>();
}
CodecPtr<std::array<float, 3>> colorArrays() {
  return std::make_shared<ColorCodec>();
}

}  // namespace fascia
