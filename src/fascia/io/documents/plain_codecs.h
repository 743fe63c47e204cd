#pragma once

#include <array>

#include <fascia/base/tunable.h>
#include <fascia/io/documents/codec.h>
#include <fascia/math/types.h>

namespace fascia {

struct Color;

Json numberSchema(const NumberRange& range);  // {"type": "number", …}

CodecPtr<double> numbers(NumberRange range = {});
CodecPtr<int> integers(NumberRange range);
CodecPtr<bool> booleans();
CodecPtr<std::string> texts(std::size_t maxBytes);
CodecPtr<std::string> names();  // short, not empty
CodecPtr<Vec3> vectors(NumberRange range = {});
// Degrees in the file, radians in memory.
CodecPtr<double> angles(NumberRange range_deg);
CodecPtr<Vec3> angleVectors(NumberRange range_deg);
CodecPtr<std::string> wordsOf(std::vector<std::string_view> known);
CodecPtr<Color> colors();  // "#rrggbb", or [r, g, b] where that would not be exact
CodecPtr<std::array<float, 3>> colorArrays();

// Reads a number in the range; reports and returns false if there is none.
bool readNumber(const Json& json, const JsonPath& path, Reading& reading, const NumberRange& range,
                double& value);

// Degrees are for people. Written with as many digits as it takes to come back to the same
// radians; read with more than double precision, or some radians could never be reached.
double radiansFromDegrees(const std::string& digits);
std::string degreesDigits(double radians);
bool readAngle(const Json& json, const JsonPath& path, Reading& reading,
               const NumberRange& range_deg, double& radians);

// A parameter's name in memory ("twist.angle_rad") and in a file ("twist.angle_deg").
bool isAngleName(std::string_view memoryName);
std::string fileName(std::string_view memoryName);
std::string memoryName(std::string_view fileName);
// A number in a parameter's own unit, by the name in memory: angles are degrees in the file.
Json parameterJson(std::string_view memoryName, double value);
bool readParameter(std::string_view memoryName, const Json& json, const JsonPath& path,
                   Reading& reading, const NumberRange& range, double& value);

// One of a few words.
template <class T>
class EnumCodec final : public Codec<T> {
 public:
  using Names = std::vector<std::pair<T, std::string>>;
  explicit EnumCodec(Names names) : names_(std::move(names)) {}

  void read(const Json& json, const JsonPath& path, Reading& reading, T& value) const override {
    if (!reading.expect(json, Json::Kind::text, path)) return;
    NearestName nearest(json.text());
    std::string all;
    for (const auto& [entry, name] : names_) {
      if (name == json.text()) {
        value = entry;
        return;
      }
      nearest.offer(name);
      all += (all.empty() ? "" : ", ") + name;
    }
    reading.fault(json, path, "found " + shown(json.text()) + ", expected one of " + all,
                  nearest.hint());
  }
  Json write(const T& value) const override {
    for (const auto& [entry, name] : names_) {
      if (entry == value) return name;
    }
    return {};
  }
  Json schema() const override {
    Json::List all;
    for (const auto& [entry, name] : names_) all.emplace_back(name);
    Json out;
    out.set("enum", std::move(all));
    return out;
  }
  bool same(const T& a, const T& b) const override { return a == b; }

 private:
  Names names_;
};

template <class T>
CodecPtr<T> words(std::vector<std::pair<T, std::string>> names) {
  return std::make_shared<EnumCodec<T>>(std::move(names));
}

}  // namespace fascia
