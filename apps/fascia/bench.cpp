#include <CLI/CLI.hpp>

#include "bench/benches.h"
#include "commands.h"

namespace fascia {

void addBench(CLI::App& program, Console& console) {
  CLI::App& group = *program.add_subcommand("bench", "Measure speed and quality, beside others'");
  group.require_subcommand(1);
  group.footer(
      "Examples:\n  fascia bench paper\n  fascia bench scaling --points 10000\n  fascia bench "
      "paper --seconds 1 --json");
  addPaperBench(group, console);
  addScalingBench(group, console);
  addDeformationBench(group, console);
  addReflexesBench(group, console);
  addEditingBench(group, console);
  addDrawingBench(group, console);
  addSheetBench(group, console);
}

}  // namespace fascia
