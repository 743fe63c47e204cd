#pragma once

#include <cmath>

#include <fascia/base/error.h>
#include <fascia/world/performance.h>

// Scenes for the tests.
namespace fascia::test {

inline SceneBodyDef ball(const std::string& name, const Vec3& position_m, double radius_m = 0.2) {
  SceneBodyDef body;
  body.name = name;
  body.solid.shape = "sphere";
  body.solid.parameters = {radius_m};
  body.position_m = position_m;
  body.points.push_back({"top", Vec3(0, radius_m, 0)});
  return body;
}

inline SceneBodyDef plate(const std::string& name, const Vec3& position_m) {
  SceneBodyDef body;
  body.name = name;
  body.form = SceneBodyDef::Form::outline;
  body.outline_m = {{-0.2, -0.1}, {0.2, -0.1}, {0.2, 0.1}, {-0.2, 0.1}};
  body.position_m = position_m;
  body.points.push_back({"end", Vec3(0.2, 0, 0)});
  return body;
}

inline void run(Performance& performance, double seconds) {
  for (int i = 0; i < std::lround(60 * seconds); ++i) performance.advance(1.0 / 60);
}

// Everything that is wrong with a scene, "pointer: message" each.
inline std::vector<std::string> faultsOf(const SceneDef& def) {
  std::vector<std::string> out;
  try {
    const Stage stage(def);
  } catch (const Error& error) {
    for (const Issue& issue : error.issues())
      out.push_back(issue.where.pointer + ": " + issue.message);
  }
  return out;
}

}  // namespace fascia::test
