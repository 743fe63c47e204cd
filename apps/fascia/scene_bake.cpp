#include "scene_bake.h"

#include <fascia/io/cache/mdd.h>
#include <fascia/io/cache/pc2.h>
#include <fascia/io/cache/scene_cache.h>
#include <fascia/io/documents/stats_writer.h>
#include <fascia/io/file/file.h>
#include <fascia/io/glb_export/scene_gltf.h>
#include <fascia/world/stage_surface.h>

#include "outputs.h"
#include "stage_run.h"

namespace fascia {
namespace {

void writeOutput(const Stage& stage, const StageRecording& recording, const std::string& path) {
  const std::string ending = endingOf(path);
  if (ending == ".glb") writeSceneGlb(stage, recording, path);
  if (ending == ".fcache") writeSceneCache(stage, recording, path);
  if (ending == ".pc2") writePc2(surfaceRecording(stage, recording), path);
  if (ending == ".mdd") writeMdd(surfaceRecording(stage, recording), path);
}

}  // namespace

void bakeScene(const SceneBake& bake, const Console& console) {
  checkOverwriting(bake.outputs, bake.stats);
  const Stage stage = prepareStage(bake.scene, bake.simulation, console);
  const StageRecording recording = perform(stage, stageRecordOptions(bake.simulation), console);
  for (const std::string& path : bake.outputs) {
    writeOutput(stage, recording, path);
    console.say("wrote " + path);
  }
  if (!bake.stats.empty()) writeFileWhole(bake.stats, statsJson(stage, recording));
  reportPerformance(stage, recording, bake.outputs, console);
}

}  // namespace fascia
