#include <CLI/CLI.hpp>

#include <new>
#include <sstream>

#include <fascia/io/file/inputs.h>

#include "commands.h"
#include "console.h"
#include "interrupt.h"

namespace {

enum ExitCode { ok = 0, badInput = 1, badUsage = 2 };

constexpr const char* kProgramFooter = R"(Examples:
  fascia check examples/penguin.fascia.json
  fascia bake examples/penguin.fascia.json -o penguin.glb
  fascia render examples/penguin.fascia.json -o penguin.mp4
  fascia render examples/sky-hook.fascia.json -o sky-hook.mp4

Your own rigged character comes alive in two steps:
  fascia flesh fox.glb -o fox.fascia.json
  fascia bake fox.fascia.json --motion Run -o fox_alive.glb

'fascia COMMAND --help' explains a command.
Exit codes: 0 done, 1 something is wrong with the input, 2 the command line makes no sense.)";

int run(CLI::App& program, fascia::Console& console, int argc, char** argv) {
  try {
    program.parse(argc, argv);
    return ok;
  } catch (const CLI::ParseError& error) {
    std::ostringstream help, usage;
    const int code = program.exit(error, help, usage);
    console.print(help.str());
    console.refuse(usage.str());
    return code == 0 ? ok : badUsage;
  } catch (const fascia::Error& error) {
    console.fail(error);
  } catch (const std::bad_alloc&) {
    console.fail(fascia::Error("out of memory"));
  } catch (const std::exception& error) {
    console.fail(fascia::Error(error.what()));
  }
  return badInput;
}

}  // namespace

int main(int argc, char** argv) {
  fascia::holdStandardStreams();
  fascia::keepWriteErrors();
  fascia::watchInterrupts();
  const fascia::InputGuard nothingReadIsWrittenOver;
  fascia::Console console;
  CLI::App program(
      "Layered elastic characters: a skeleton, flesh on it, and a skin that lives; and scenes of "
      "elastic bodies around them.",
      "fascia");
  program.footer(kProgramFooter);
  program.set_version_flag("--version", "fascia " FASCIA_VERSION);
  program.require_subcommand(0, 1);  // none is refused below: an unknown one then gets named
  program.callback([&program] {
    if (program.get_subcommands().empty()) throw CLI::RequiredError("A command");
  });
  program.failure_message(CLI::FailureMessage::simple);
  fascia::addBake(program, console);
  fascia::addRender(program, console);
  fascia::addCompare(program, console);
  fascia::addCheck(program, console);
  fascia::addInfo(program, console);
  fascia::addFlesh(program, console);
  fascia::addBench(program, console);
  const int code = run(program, console, argc, argv);
  return console.delivered() ? code : badInput;
}
