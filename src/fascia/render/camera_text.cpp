#include <charconv>
#include <cmath>
#include <string>
#include <vector>

#include <fascia/base/error.h>
#include <fascia/render/camera.h>

namespace fascia {
namespace {

constexpr const char* kAllowed =
    "use front, side, back, top or three-quarter, and az=, el= (degrees), dist= (metres), "
    "fov= (degrees), eye=x,y,z, target=x,y,z, separated by , or ;";

std::string_view trimmed(std::string_view s) {
  const auto first = s.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return s.substr(first, s.find_last_not_of(" \t") - first + 1);
}

// Splits at ';', and at ',' too; a piece that begins with a number continues the one before it, so
// that "eye=1,2,3,az=4" has two settings.
std::vector<std::string> settings(std::string_view text) {
  std::vector<std::string> result;
  while (!text.empty()) {
    const auto end = std::min(text.find_first_of(",;"), text.size());
    const std::string_view piece = trimmed(text.substr(0, end));
    const bool continues = !result.empty() && !piece.empty() &&
                           piece.find_first_not_of("+-.0123456789eE") == std::string_view::npos;
    if (continues)
      result.back().append(",").append(piece);
    else
      result.emplace_back(piece);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return result;
}

std::vector<double> numbers(std::string_view text) {
  std::vector<double> result;
  while (true) {
    const auto end = std::min(text.find(','), text.size());
    std::string_view piece = trimmed(text.substr(0, end));
    if (!piece.empty() && piece.front() == '+') piece.remove_prefix(1);
    double value = 0;
    const auto [rest, fault] = std::from_chars(piece.data(), piece.data() + piece.size(), value);
    if (fault != std::errc{} || rest != piece.data() + piece.size() || !std::isfinite(value))
      return {};
    result.push_back(value);
    if (end == text.size()) return result;
    text.remove_prefix(end + 1);
  }
}

class CameraReader {
 public:
  void read(const std::string& setting) {
    const auto equals = setting.find('=');
    if (equals == std::string::npos) return preset(setting);
    const std::string_view key = trimmed(std::string_view(setting).substr(0, equals));
    const std::string value(trimmed(std::string_view(setting).substr(equals + 1)));
    if (key == "az") {
      if (scalar(key, value, -3600, 3600)) spec_.azimuth_rad = radians(number_);
    } else if (key == "el") {
      if (scalar(key, value, -89, 90)) spec_.elevation_rad = radians(number_);
    } else if (key == "dist") {
      if (scalar(key, value, 1e-3, 1e6)) spec_.distance_m = number_;
    } else if (key == "fov") {
      if (scalar(key, value, 1, 150)) spec_.vertical_fov_rad = radians(number_);
    } else if (key == "eye") {
      vector(key, value, spec_.eye_m);
    } else if (key == "target") {
      vector(key, value, spec_.target_m);
    } else {
      fault("camera: unknown setting \"" + std::string(key) + "\"");
    }
  }

  CameraSpec finish() {
    if (spec_.eye_m && spec_.target_m && (*spec_.eye_m - *spec_.target_m).norm() < 1e-6)
      fault("camera: eye and target are the same point");
    if (!issues_.empty()) throw Error(issues_);
    return spec_;
  }

 private:
  void preset(const std::string& name) {
    struct Preset {
      std::string_view name;
      double azimuth_deg, elevation_deg;
    };
    constexpr Preset presets[] = {{"three-quarter", 32, 9},
                                  {"front", 0, 4},
                                  {"side", 90, 4},
                                  {"back", 180, 6},
                                  {"top", 0, 90}};
    for (const Preset& p : presets)
      if (p.name == name) {
        spec_.azimuth_rad = radians(p.azimuth_deg);
        spec_.elevation_rad = radians(p.elevation_deg);
        return;
      }
    fault(name.empty() ? "camera: found nothing, expected a view"
                       : "camera: unknown view \"" + name + "\"");
  }

  bool scalar(std::string_view key, const std::string& value, double min, double max) {
    const auto list = numbers(value);
    if (list.size() == 1 && list[0] >= min && list[0] <= max) {
      number_ = list[0];
      return true;
    }
    fault("camera: " + std::string(key) + ": found \"" + value + "\", expected a number in [" +
          std::to_string(min) + ", " + std::to_string(max) + "]");
    return false;
  }

  void vector(std::string_view key, const std::string& value, std::optional<Vec3>& out) {
    const auto list = numbers(value);
    if (list.size() == 3 &&
        std::max({std::abs(list[0]), std::abs(list[1]), std::abs(list[2])}) < 1e6)
      out = Vec3(list[0], list[1], list[2]);
    else
      fault("camera: " + std::string(key) + ": found \"" + value +
            "\", expected three numbers x,y,z in metres");
  }

  void fault(std::string message) { issues_.push_back({{}, std::move(message), kAllowed}); }

  CameraSpec spec_;
  double number_ = 0;
  std::vector<Issue> issues_;
};

}  // namespace

CameraSpec parseCamera(std::string_view text) {
  CameraReader reader;
  const auto list = settings(text);
  if (list.empty()) reader.read("");
  for (const std::string& setting : list) reader.read(setting);
  return reader.finish();
}

}  // namespace fascia
