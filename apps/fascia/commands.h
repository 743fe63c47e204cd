#pragma once

namespace CLI {
class App;
}

namespace fascia {

class Console;

// Each adds one subcommand to the program; its work runs when the command line has been read.
void addBake(CLI::App& program, Console& console);
void addRender(CLI::App& program, Console& console);
void addCompare(CLI::App& program, Console& console);
void addCheck(CLI::App& program, Console& console);
void addInfo(CLI::App& program, Console& console);
void addFlesh(CLI::App& program, Console& console);
void addBench(CLI::App& program, Console& console);

}  // namespace fascia
