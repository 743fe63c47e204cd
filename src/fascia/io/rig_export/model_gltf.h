#pragma once

#include <fascia/io/gltf/gltf_document.h>
#include <fascia/rig/rigged_model.h>

namespace fascia {

// A model as a glTF of its own: a node per joint in their order, a skinned mesh per part, materials
// with their pictures, all motions, lengths in metres. Reading it back gives the model again, and
// models of formats other than glTF number their nodes as it does (see finishModel).
GltfDocument gltfOf(const RiggedModel& model);

// What is written for a model is made out of this: the glTF that it came from, with all that we do
// not understand, or else gltfOf(model). Throws Error.
struct SourceDocument {
  GltfDocument document;
  double scale;  // that reading it needs to give the model again
};
// `scale`: that the model was read with.
SourceDocument sourceDocumentOf(const RiggedModel& model, double scale);

}  // namespace fascia
