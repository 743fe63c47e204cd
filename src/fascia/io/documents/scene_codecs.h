#pragma once

#include <fascia/io/documents/codec.h>
#include <fascia/world/scene_def.h>

namespace fascia {

CodecPtr<SceneDef> sceneCodec();

}  // namespace fascia
