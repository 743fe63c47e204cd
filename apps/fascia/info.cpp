#include <fmt/core.h>
#include <CLI/CLI.hpp>

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

constexpr const char* kFooter =
    R"(Without a file: about the program and this machine, for a bug report.

Examples:
  fascia info
  fascia info examples/penguin.fascia.json
  fascia info penguin.fcache --json)";

constexpr std::size_t kMaxFileBytes = std::size_t{1} << 32;

// What there is to tell: lines for a person, an object for a machine.
class Facts {
 public:
  void add(const std::string& name, int value) { add(name, value, fmt::format("{}", value)); }
  void add(const std::string& name, double value) { add(name, value, fmt::format("{:g}", value)); }
  void add(const std::string& name, const std::string& value) { add(name, value, value); }
  void add(const std::string& name, Json value, const std::string& text) {
    add(name, std::move(value), std::vector<std::string>{text});
  }
  void add(const std::string& name, Json value, const std::vector<std::string>& texts) {
    for (const std::string& text : texts) lines_.push_back(fmt::format("{:13}  {}", name, text));
    answer_.set(name, std::move(value));
  }

  void show(const Console& console) const {
    for (const std::string& line : lines_) console.say(line);
    console.answer(answer_);
  }

 private:
  std::vector<std::string> lines_;
  Json answer_ = Json::Object{{"ok", true}};
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
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < character.motionCount(); ++i) {
    const BoundClip& motion = character.motion(i);
    motions.push_back(Json::Object{
        {"name", motion.name}, {"duration_s", motion.duration_s}, {"loop", motion.loop}});
    texts.push_back(
        fmt::format("{}, {:g} s{}", motion.name, motion.duration_s, motion.loop ? ", loops" : ""));
  }
  facts.add("motions", std::move(motions), texts);
}

void addRecording(const Recording& recording, Facts& facts) {
  facts.add("recorded", recording.motion);
  facts.add("frames", count(recording.frames.size()));
  facts.add("recorded_hz", recording.frame_rate_hz);
  facts.add("vertices", count(recording.skin.positions.size()));
  facts.add("simulated_s", recording.simulated_s);
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
  facts.add("version", std::string(FASCIA_VERSION));
  facts.add("threads", hardwareThreads());
  facts.add("opengl", openGl());
  Json::List methods;
  std::vector<std::string> texts;
  for (const IntegratorInfo& info : integrators()) {
    methods.push_back(Json::Object{{"name", std::string(info.name)},
                                   {"description", std::string(info.description)}});
    texts.push_back(fmt::format("{}: {}", info.name, info.description));
  }
  facts.add("integrators", std::move(methods), texts);
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
  command.add_option("FILE", *path, "A *.fascia.json or *.fcache file")->type_name("");
  console.addFlags(command);
  command.footer(kFooter);
  command.callback([path, &console] { info(*path, console); });
}

}  // namespace fascia
