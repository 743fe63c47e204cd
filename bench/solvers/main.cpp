// fascia_bench_solvers: position error against cost of several stepping schemes for one skin, as
// comma-separated values. See docs/solvers.md.
#include <cmath>
#include <cstdio>
#include <string>

#include <CLI/CLI.hpp>

#include <fascia/base/parallel.h>
#include <fascia/io/documents/character_file.h>

#include "solvers/timeline.h"

namespace fascia {
namespace {

struct Options {
  std::string character;
  std::string motion;
  double seconds = 2;
  int columns = 64, rows = 16;
  double stiffness_N_per_m = 0;  // 0: as in the file
  double interval_s = 1.0 / 60;  // between contact tests
  bool libraryOnly = false;      // no prototypes
};

// How much finer than the default the reference's steps and contact intervals are.
constexpr int kRefinement = 16;

// Everything that is measured on one skin.
class Comparison {
 public:
  explicit Comparison(const Options& options)
      : options_(options), def_(readCharacterFile(options.character).def) {
    if (!def_.skin) throw Error("the character has no skin");
    if (options.stiffness_N_per_m > 0) {
      SkinMaterialDef& m = def_.skin->material;
      const double scale = options.stiffness_N_per_m / m.stretch_u_N_per_m;
      for (double* s : {&m.stretch_u_N_per_m, &m.stretch_v_N_per_m, &m.shear_N_per_m}) *s *= scale;
    }
    const Character usual = build("leapfrog", 0, options.interval_s);
    step_s_ = usual.skin()->defaultStep_s();
    run_.motion = usual.findMotion(options.motion);
    if (run_.motion < 0) throw Error("no motion is named '" + options.motion + "'");
    run_.frames = static_cast<int>(std::lround(options.seconds / kFrame_s));
    layout_ = usual.skin()->grid()->layout();
    height_m_ = heightOf(usual.skin()->restPosition());
    const Character fine =
        build("leapfrog", step_s_ / kRefinement, options.interval_s / kRefinement);
    start_ = initialState(fine, fine.source(run_.motion)).skin;
    reference_ = runLibrary(fine, start_, run_);
  }

  void run() {
    std::printf(
        "scheme,passes,points,stretch_N_per_m,default_step_ms,steps_per_frame,cpu_us_per_frame,"
        "stepping_us_per_frame,rms_mm,max_mm,rms_over_height,max_over_height\n");
    const Character half =
        build("leapfrog", 2 * step_s_ / kRefinement, 2 * options_.interval_s / kRefinement);
    print("reference-halved", 0, runLibrary(half, start_, run_));
    print("auto", 0, runLibrary(build("auto", 0, options_.interval_s), start_, run_));
    const Character usual = build("leapfrog", 0, options_.interval_s);
    for (int steps = 1; steps <= kMostSteps; steps *= 2) {
      print("leapfrog", 0,
            runLibrary(build("leapfrog", kFrame_s / steps, options_.interval_s), start_, run_));
      if (options_.libraryOnly) continue;
      printScheme("leapfrog-scalar", 0, usual, *makeScalarLeapfrog(*usual.skin()), steps);
      printScheme("xpbd-small-steps", 1, usual, *makeXpbd(*usual.skin()), steps);
      for (const int passes : {2, 8, 32})
        if (steps * passes <= kMostPasses)
          printScheme("block-descent", passes, usual, *makeBlockDescent(*usual.skin(), passes),
                      steps);
    }
    if (options_.libraryOnly) return;
    print("implicit-euler", 0,
          runLibrary(build("implicit-euler", 0, options_.interval_s), start_, run_));
  }

 private:
  static constexpr int kMostSteps = 256;
  static constexpr int kMostPasses = 64;  // of block descent per frame; each is slow

  Character build(const std::string& integrator, double step_s, double interval_s) const {
    return Character(def_, {.columns = options_.columns,
                            .rows = options_.rows,
                            .integrator = integrator,
                            .step_s = step_s,
                            .interval_s = interval_s});
  }

  double heightOf(const VectorArray& rest) const {
    Box box;
    for (int j = 0; j < layout_.rows; ++j)
      for (int i = 0; i < layout_.columns; ++i) {
        const std::size_t k = layout_.at(i, j);
        box.add(Vec3(rest.x[k], rest.y[k], rest.z[k]));
      }
    return box.size().y();
  }

  void printScheme(const char* name, int passes, const Character& character, Scheme& scheme,
                   int steps) const {
    print(name, passes, runScheme(character, start_, run_, scheme, steps));
  }

  void print(const char* name, int passes, const Trajectory& t) const {
    const Difference d = difference(layout_, t, reference_);
    const double perFrame = 1.0 / run_.frames;
    std::printf("%s,%d,%zu,%g,%.4f,%.1f,%.2f,%.2f,%.4f,%.4f,%.3g,%.3g\n", name, passes,
                layout_.pointCount(), def_.skin->material.stretch_u_N_per_m, 1e3 * step_s_,
                t.steps * perFrame, 1e6 * t.cpu_s * perFrame, 1e6 * t.stepping_s * perFrame,
                1e3 * d.rms_m, 1e3 * d.max_m, d.rms_m / height_m_, d.max_m / height_m_);
    std::fflush(stdout);
  }

  Options options_;
  CharacterDef def_;
  RunOptions run_;
  GridLayout layout_;
  double step_s_ = 0, height_m_ = 1;
  SkinState start_;
  Trajectory reference_;
};

}  // namespace
}  // namespace fascia

int main(int argc, char** argv) {
  fascia::Options options;
  CLI::App program("Error against cost of stepping schemes for one skin, as CSV",
                   "fascia_bench_solvers");
  program.add_option("character", options.character, "Character file")->required();
  program.add_option("--motion", options.motion, "Motion (default: the first)");
  program.add_option("--seconds", options.seconds, "Simulated seconds (default: 2)")
      ->check(CLI::Range(0.1, 60.0));
  program.add_option("--columns", options.columns, "Points around (default: 64)");
  program.add_option("--rows", options.rows, "Points along (default: 16)");
  program.add_option("--stiffness", options.stiffness_N_per_m,
                     "Stretching stiffness, N/m (default: the file's)");
  program.add_option("--interval", options.interval_s, "Seconds between contact tests");
  program.add_flag("--library-only", options.libraryOnly,
                   "Only 'auto' and 'leapfrog' with growing numbers of steps");
  CLI11_PARSE(program, argc, argv);
  try {
    const fascia::ThreadLimit oneThread(1);
    fascia::Comparison(options).run();
  } catch (const fascia::Error& error) {
    for (const fascia::Issue& issue : error.issues())
      std::fprintf(stderr, "error: %s\n", issue.text().c_str());
    return 1;
  }
  return 0;
}
