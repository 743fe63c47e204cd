#pragma once

// GLSL of the renderer. Kept to what GLSL ES 3.00 has too, apart from the version line, so that the
// same sources can serve a browser.
namespace fascia::shaders {

// Vertex shaders.
extern const char* const kMeshVertex;        // every mesh, in every pass
extern const char* const kFullScreenVertex;  // one triangle over the whole target

// Fragment shaders.
extern const char* const kDepthFragment;      // nothing but depth, where there are colours: none
extern const char* const kGeometryFragment;   // view normal and depth
extern const char* const kOcclusionFragment;  // ambient occlusion, key shadow, thickness
extern const char* const kBlurFragment;       // edge-keeping blur of the above
extern const char* const kBackgroundFragment;
extern const char* const kLayerFragment;  // a picture of the target's size

// Pieces of the lit fragment shader, to be joined in this order, with one of the defines
// SKIN, MUSCLE, BONE, PLAIN, GROUND in front.
extern const char* const kStudio;     // lights, tone mapping, background
extern const char* const kLitInputs;  // of the material
extern const char* const kSurface;    // specular terms and what the occlusion pass left
extern const char* const kMaterial;   // light towards the eye
extern const char* const kLitMain;
// In the fast look these take the places of kSurface and kMaterial.
extern const char* const kFastSurface;
extern const char* const kFastMaterial;

}  // namespace fascia::shaders
