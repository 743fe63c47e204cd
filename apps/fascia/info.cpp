#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <fascia/base/hash.h>
#include <fascia/base/parallel.h>
#include <fascia/io/cache.h>
#include <fascia/io/character_file.h>
#include <fascia/io/file.h>
#include <fascia/math/ode/integrators.h>
#include <fascia/render/gl_context.h>

#include "commands.h"
#include "console.h"

namespace fascia {
namespace {

constexpr const char* kFooter = R"(
Without a file: about the program and this machine, for a bug report.

Examples:
  fascia info
  fascia info examples/penguin.fascia.json
  fascia info penguin.fcache --json)";

constexpr std::size_t kMaxFileBytes = std::size_t{1} << 32;

// Names and values, printed one a line or as a JSON object.
class Facts {
 public:
  void add(const std::string& name, Json value) { facts_.push_back({name, std::move(value)}); }

  void show(const Console& console) {
    for (const Json::Member& fact : facts_)
      if (!fact.value.is(Json::Kind::list))
        console.say(fmt::format("{:12}  {}", fact.key, plain(fact.value)));
      else
        for (const Json& entry : fact.value.list())
          console.say(fmt::format("{:12}  {}", fact.key, plain(entry)));
    Json answer = Json::Object{{"ok", true}};
    for (Json::Member& fact : facts_) answer.set(fact.key, std::move(fact.value));
    console.answer(answer);
  }

 private:
  // The members of an object follow each other; its keys are for machines.
  static std::string plain(const Json& value) {
    if (value.is(Json::Kind::text)) return value.text();
    if (value.is(Json::Kind::number)) return value.digits();
    if (value.is(Json::Kind::boolean)) return value.boolean() ? "yes" : "no";
    std::string text;
    if (value.is(Json::Kind::object))
      for (const Json::Member& member : value.object())
        text += (text.empty() ? "" : ", ") + member.key + " " + plain(member.value);
    return text;
  }

  Json::Object facts_;
};

int count(std::size_t n) {
  return static_cast<int>(n);
}

void addCharacter(const Character& character, Facts& facts) {
  const CharacterDef& def = character.def();
  facts.add("name", def.name);
  if (!def.description.empty()) facts.add("description", def.description);
  facts.add("joints", count(character.skeleton().jointCount()));
  facts.add("freedoms", count(character.skeleton().valueCount()));
  facts.add("solids", count(character.flesh().solidCount()));
  facts.add("ornaments", count(character.ornaments().solidCount()));
  if (const Skin* skin = character.skin()) {
    facts.add("skin_columns", skin->columns());
    facts.add("skin_rows", skin->rows());
    facts.add("skin_points", count(skin->pointCount()));
  }
  facts.add("integrator", def.simulation.integrator);
  facts.add("frame_rate_hz", def.simulation.frame_rate_hz);
  Json::List motions;
  for (std::size_t i = 0; i < character.motionCount(); ++i) {
    const BoundClip& motion = character.motion(i);
    motions.push_back(Json::Object{
        {"name", motion.name}, {"duration_s", motion.duration_s}, {"loop", motion.loop}});
  }
  facts.add("motion", std::move(motions));
}

void addRecording(const Recording& recording, Facts& facts) {
  facts.add("recorded", recording.motion);
  facts.add("frames", count(recording.frames.size()));
  facts.add("recorded_frame_rate_hz", recording.frame_rate_hz);
  facts.add("vertices", count(recording.skin.positions.size()));
  facts.add("simulated_s", recording.simulated_s);
  StateHash hash;
  facts.add("state_hash", fmt::format("{:016x}", recording.state_hash));
}

void describeFile(const std::string& path, Facts& facts) {
  const std::string bytes = readFile(path, kMaxFileBytes);
  facts.add("file", path);
  if (!isCache(bytes)) return addCharacter(loadCharacter(path), facts);
  const Cache cache = parseCache(bytes, path);
  addCharacter(Character(cache.def), facts);
  addRecording(cache.recording, facts);
}

std::string openGl() {
  try {
    return GlContext().description();
  } catch (const Error& error) {
    return std::string("none: ") + error.what();
  }
}

void describeProgram(Facts& facts) {
  facts.add("version", FASCIA_VERSION);
  facts.add("threads", hardwareThreads());
  facts.add("opengl", openGl());
  Json::List methods;
  for (const IntegratorInfo& info : integrators())
    methods.push_back(Json::Object{{"name", std::string(info.name)},
                                   {"description", std::string(info.description)}});
  facts.add("integrator", std::move(methods));
}

void info(const std::string& path, const Console& console) {
  Facts facts;
  if (path.empty())
    describeProgram(facts);
  else
    describeFile(path, facts);
  facts.show(console);
}

}  // namespace

void addInfo(CLI::App& program, Console& console) {
  CLI::App& command =
      *program.add_subcommand("info", "Tell what is in a file, or about the program");
  const auto path = std::make_shared<std::string>();
  command.add_option("FILE", *path, "A *.fascia.json or *.fcache file");
  console.addFlags(command);
  command.footer(kFooter);
  command.callback([path, &console] { info(*path, console); });
}

}  // namespace fascia
