#pragma once

namespace CLI {
class App;
}

namespace fascia {

class Console;

// One file per benchmark. Each adds one subcommand to `fascia bench`, and is called in bench.cpp.
void addPaperBench(CLI::App& group, Console& console);
void addScalingBench(CLI::App& group, Console& console);
void addDeformationBench(CLI::App& group, Console& console);
void addReflexesBench(CLI::App& group, Console& console);
void addEditingBench(CLI::App& group, Console& console);
void addDrawingBench(CLI::App& group, Console& console);
void addSheetBench(CLI::App& group, Console& console);

}  // namespace fascia
